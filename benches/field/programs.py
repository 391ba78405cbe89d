"""The programs of the field, and how each renders a scene."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

from problem import Problem
from worker import Job

HERE = Path(__file__).resolve().parent

# Loading and compiling may take so many seconds beyond those of the render.
PATIENCE = 120


@dataclass(frozen=True)
class Program:
    """`integrator` and `sampler` are the program's own names; Metrolight and Mitsuba choose no sampler."""

    name: str
    integrator: str
    sampler: str = ""

    @property
    def label(self):
        return " ".join(filter(None, [self.name, self.integrator, self.sampler]))


@dataclass(frozen=True)
class Frame:
    """An image as it was after `seconds` of rendering, with `samples` samples (or mutations) per pixel:
    height x width x 3, linear, the first row on top."""

    seconds: float
    samples: float
    image: np.ndarray


@dataclass(frozen=True)
class Setting:
    """What all programs share in one scene: its files, the size of the image, and the number of threads."""

    directory: Path
    width: int
    height: int
    threads: int
    metrolight: Path


LUXCORE = [
    Program("LuxCore", "BIDIRCPU", "METROPOLIS"),
    Program("LuxCore", "BIDIRCPU", "SOBOL"),
    Program("LuxCore", "PATHCPU", "SOBOL"),
]

# BIDIRCPU's weights take Russian roulette into account where vertices are joined and not where they are made
# (LuxCore's engines/bidircpu/bidircputhread.cpp, ConnectVertices and Bounce), so that its images become too
# bright, by 4 to 8% in the scene cornell. It goes without among those that should be right, and here with it, as
# LuxCore's users know it.
ROULETTE = "+roulette"
LUXCORE_BIASED = [Program("LuxCore", "BIDIRCPU" + ROULETTE, sampler) for sampler in ("METROPOLIS", "SOBOL")]

MITSUBA = [Program("Mitsuba", "path")]


def metrolight(integrators):
    return [Program("Metrolight", integrator) for integrator in integrators]


def render(program, setting, seed, times):
    """The frames of one seed at `times`, in seconds and rising order."""
    if program.name == "Metrolight":
        return [_metrolight_frame(program, setting, seed, seconds) for seconds in times]
    worker, scene = {
        "LuxCore": ("luxcore_worker.py", "scene.scn"),
        "Mitsuba": ("mitsuba_worker.py", "scene.xml"),
    }[program.name]
    output = setting.directory / "frames"
    job = Job(
        scene=str(setting.directory / scene),
        width=setting.width,
        height=setting.height,
        threads=setting.threads,
        seed=seed,
        times=list(times),
        output=str(output),
        engine=program.integrator.removesuffix(ROULETTE) if program.sampler else "",
        sampler=program.sampler,
        roulette=program.integrator != "BIDIRCPU",
    )
    job_path = setting.directory / "job.json"
    job.write(job_path)
    said = _run([sys.executable, str(HERE / worker), str(job_path)], program, times[-1])
    if program.name == "Mitsuba" and said:
        print(f"  {said.strip()}", flush=True)
    return _read_frames(output, setting)


def _run(command, program, seconds):
    """What the command printed."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds + PATIENCE, check=False)
    except subprocess.TimeoutExpired as error:
        raise Problem(f"{program.label} did not end: {' '.join(command)}") from error
    if done.returncode != 0:
        said = done.stderr.strip()[-2000:]
        raise Problem(f"{program.label} ended with {done.returncode}: {' '.join(command)}\n{said}")
    return done.stdout


def _read_frames(directory, setting):
    frames = []
    described = json.loads((directory / "frames.json").read_text(encoding="utf-8"))
    for index, frame in enumerate(described):
        values = np.fromfile(directory / f"{index}.f32", dtype=np.float32)
        image = values.reshape(setting.height, setting.width, 3)
        frames.append(Frame(frame["seconds"], frame["samples"], image))
    return frames


def _metrolight_frame(program, setting, seed, seconds):
    """A render of its own: the command line keeps no image on the way."""
    image, statistics = setting.directory / "frame.exr", setting.directory / "frame.json"
    command = [str(setting.metrolight), "render", str(setting.directory / "scene.xml")]
    command += ["--integrator", program.integrator, "--time", f"{seconds}", "--seed", str(seed)]
    command += ["--threads", str(setting.threads), "--quiet", "-o", str(image), "--stats", str(statistics)]
    _run(command, program, seconds)
    figures = json.loads(statistics.read_text(encoding="utf-8"))
    samples = figures.get("samples", figures.get("mutations", 0))
    return Frame(figures["render_seconds"], samples / (setting.width * setting.height), read_exr(image))


def read_exr(path):
    # Mitsuba's reader waits for ever on a machine with one core, unless it has two threads.
    dr.set_thread_count(max(2, os.cpu_count() or 1))
    mi.set_variant("scalar_rgb")
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return np.array(bitmap)
