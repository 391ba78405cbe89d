"""Renders one image with LuxCore: `python luxcore_worker.py JOB.json`; see worker.py for the job.

This runs in a separate process, because pyluxcore has threads that do not terminate; the process ends with `os._exit`.
"""

import os
import sys
import time
from array import array

import pyluxcore

from worker import FrameWriter, read_job

# Maximum length of camera and light subpaths. BIDIRCPU limits the two subpaths, not the whole path
# (engines/bidircpu/bidircputhread.cpp), so no limit on path length is common to all programs. With roulette the limit is
# so large that it has no effect. Without roulette it is the largest max_depth of the scenes, and paths of up to 13 edges
# are complete.
MAX_DEPTH, MAX_DEPTH_WITHOUT_ROULETTE = 32, 12

# LuxCore's default.
ROULETTE_DEPTH = 3

# Threads use consecutive seeds starting from that of the render; the seeds of different renders must not overlap.
SEED_STEP = 1024


def configuration(job):
    """No clamping, no filter, linear values. The samplers have LuxCore's defaults, except that SOBOL is not adaptive. Lights
    are chosen by power; by default a lamp of many triangles would be chosen more often than its power justifies."""
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
    """Reverses the order of the rows: LuxCore stores the bottom row first."""
    row = 3 * width
    rows = [pixels[start : start + row] for start in range(0, len(pixels), row)]
    return b"".join(values.tobytes() for values in reversed(rows))


def render(job):
    """Renders the job. The clock starts after LuxCore has loaded the scene and built its acceleration structures."""
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
    except Exception as error:  # the process must terminate on any error
        print(f"LuxCore: {error}", file=sys.stderr, flush=True)
        os._exit(1)
    os._exit(0)


if __name__ == "__main__":
    main()
