"""Renders one image with LuxCore: `python luxcore_worker.py JOB.json`; see worker.py for the job.

A process of its own, for pyluxcore keeps threads that do not end, and is left by `os._exit`.
"""

import os
import sys
import time
from array import array

import pyluxcore

from worker import FrameWriter, read_job

# Length of paths from the eye and from lights. BIDIRCPU limits the two subpaths, not the path they make
# (engines/bidircpu/bidircputhread.cpp), so that no limit on path length can be shared with other programs:
# with roulette this one is beyond what matters, without it is the greatest max_depth of the scenes, and paths of
# up to 13 edges are complete.
MAX_DEPTH, MAX_DEPTH_WITHOUT_ROULETTE = 32, 12

# LuxCore's default.
ROULETTE_DEPTH = 3

# Threads have seeds counted up from that of the render, which must not be those of the next one.
SEED_STEP = 1024


def configuration(job):
    """No clamping, no filter, linear values; samplers are as LuxCore has them by default, but SOBOL is not
    adaptive. Lights are chosen by power: by default a lamp of many triangles would be chosen more often than
    its power is worth."""
    depth = MAX_DEPTH if job.roulette else MAX_DEPTH_WITHOUT_ROULETTE
    return {
        "renderengine.type": job.engine,
        "renderengine.seed": 1 + SEED_STEP * job.seed,
        "native.threads.count": job.threads,
        "sampler.type": job.sampler,
        "sampler.sobol.adaptive.strength": 0.0,
        "path.maxdepth": depth,
        "light.maxdepth": depth,
        "path.pathdepth.total": depth,
        "path.pathdepth.diffuse": depth,
        "path.pathdepth.glossy": depth,
        "path.pathdepth.specular": depth,
        "path.russianroulette.depth": ROULETTE_DEPTH if job.roulette else depth + 1,
        "path.clamping.variance.maxvalue": 0.0,
        "lightstrategy.type": "POWER",
        "film.width": job.width,
        "film.height": job.height,
        "film.filter.type": "NONE",
        "film.opencl.enable": False,
        "film.imagepipelines.0.0.type": "NOP",
        "film.outputs.0.type": "RGB_IMAGEPIPELINE",
        "film.outputs.0.filename": "unused.exr",
    }


def start_session(job):
    scene = pyluxcore.Scene()
    scene.Parse(pyluxcore.Properties(job.scene))
    properties = pyluxcore.Properties()
    for name, value in configuration(job).items():
        properties.Set(pyluxcore.Property(name, value))
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties, scene))
    session.Start()
    return session


def top_row_first(pixels, width):
    """LuxCore's first row is the lowest."""
    row = 3 * width
    rows = [pixels[start : start + row] for start in range(0, len(pixels), row)]
    return b"".join(values.tobytes() for values in reversed(rows))


def render(job):
    """The clock starts when LuxCore has loaded the scene and built its acceleration structures."""
    pyluxcore.Init()
    session = start_session(job)
    start = time.perf_counter()
    frames = FrameWriter(job.output)
    for seconds in job.times:
        time.sleep(max(0.0, start + seconds - time.perf_counter()))
        session.UpdateStats()
        elapsed = time.perf_counter() - start
        samples = session.GetStats().Get("stats.renderengine.total.samplecount").GetFloat()
        pixels = array("f", bytes(4 * 3 * job.width * job.height))
        session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB_IMAGEPIPELINE, pixels, 0, True)
        frames.add(elapsed, samples / (job.width * job.height), top_row_first(pixels, job.width))
    frames.finish()


def main():
    try:
        render(read_job(sys.argv[1]))
    except Exception as error:  # whatever it is, the process must end here
        print(f"LuxCore: {error}", file=sys.stderr, flush=True)
        os._exit(1)
    os._exit(0)


if __name__ == "__main__":
    main()
