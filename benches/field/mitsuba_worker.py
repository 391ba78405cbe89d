"""Renders one image with Mitsuba's `path`: `python mitsuba_worker.py JOB.json`; see worker.py for the job.

Mitsuba has no time limit, so the image is the mean of passes with different seeds, rendered until the time is over. The
first pass compiles the kernel and is not counted.
"""

import os
import sys
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

from worker import FrameWriter, read_job

# A pass takes about this fraction of the time to the first frame, so that the frames are close to their nominal times.
PASS_FRACTION = 0.1
MAX_PASS_SAMPLES = 256
CALIBRATION_SAMPLES = 2

# Distance between the seeds of different renders.
PASSES_PER_SEED = 1 << 16


def find_llvm():
    """Gives Dr.Jit the path of Debian's LLVM library, which it does not find by itself."""
    found = sorted(Path("/usr/lib").glob("*/libLLVM.so.*"))
    if found:
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(found[-1]))


def choose_variant(threads):
    """Selects `llvm_ad_rgb` if LLVM is available, else the slower `scalar_rgb`."""
    find_llvm()
    dr.set_thread_count(threads)
    if dr.has_backend(dr.JitBackend.LLVM):
        mi.set_variant("llvm_ad_rgb")
    else:
        print("LLVM is not available: Mitsuba renders with the slower variant scalar_rgb")
        mi.set_variant("scalar_rgb")


def render(job):
    choose_variant(job.threads)
    scene = mi.load_file(job.scene)

    def one_pass(samples, seed):
        return np.array(mi.render(scene, spp=samples, seed=seed))[:, :, :3]

    first_seed = (job.seed + 1) * PASSES_PER_SEED
    one_pass(CALIBRATION_SAMPLES, first_seed)
    start = time.perf_counter()
    one_pass(CALIBRATION_SAMPLES, first_seed)
    seconds_per_sample = (time.perf_counter() - start) / CALIBRATION_SAMPLES
    samples = int(np.clip(PASS_FRACTION * job.times[0] / seconds_per_sample, 1, MAX_PASS_SAMPLES))
    one_pass(samples, first_seed)

    frames = FrameWriter(job.output)
    total = np.zeros((job.height, job.width, 3))
    passes = 0
    start = time.perf_counter()
    for seconds in job.times:
        while passes == 0 or time.perf_counter() - start < seconds:
            passes += 1
            total += one_pass(samples, first_seed + passes)
        elapsed = time.perf_counter() - start
        frames.add(elapsed, passes * samples, (total / passes).astype(np.float32).tobytes())
    frames.finish()


if __name__ == "__main__":
    render(read_job(sys.argv[1]))
