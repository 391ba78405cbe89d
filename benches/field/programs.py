"""The programs that are compared, and how each renders a scene."""

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

# Seconds allowed for loading and compiling, in addition to the render time.
TIMEOUT_MARGIN = 120


@dataclass(frozen=True)
class Program:
    """`integrator` and `sampler` are the program's own names; `sampler` is empty for Metrolight and Mitsuba."""

    name: str
    integrator: str
    sampler: str = ""

    @property
    def label(self):
        return " ".join(filter(None, [self.name, self.integrator, self.sampler]))


@dataclass(frozen=True)
class Frame:
    """The image after `seconds` of rendering, with `samples` samples (or mutations) per pixel:
    height x width x 3, linear, top row first."""

    seconds: float
    samples: float
    image: np.ndarray


@dataclass(frozen=True)
class Setting:
    """Settings common to all programs in one scene: its files, the size of the image, and the number of threads."""

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

# BIDIRCPU's MIS weights include the roulette probability where vertices are connected but not where they are sampled
# (LuxCore's engines/bidircpu/bidircputhread.cpp, ConnectVertices and Bounce). Its images are therefore too bright, by 4
# to 8% in the scene cornell. LUXCORE renders without roulette, LUXCORE_BIASED with it, as is LuxCore's default.
ROULETTE = "+roulette"
LUXCORE_BIASED = [Program("LuxCore", "BIDIRCPU" + ROULETTE, sampler) for sampler in ("METROPOLIS", "SOBOL")]

MITSUBA = [Program("Mitsuba", "path")]


def metrolight(integrators):
    return [Program("Metrolight", integrator) for integrator in integrators]


def render(program, setting, seed, times):
    """Renders one seed and returns its frames at `times`, in seconds and ascending order."""
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
    output_text = _run([sys.executable, str(HERE / worker), str(job_path)], program, times[-1])
    if program.name == "Mitsuba" and output_text:
        print(f"  {output_text.strip()}", flush=True)
    return _read_frames(output, setting)


def _run(command, program, seconds):
    """Runs the command and returns its standard output."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds + TIMEOUT_MARGIN, check=False)
    except subprocess.TimeoutExpired as error:
        raise Problem(f"{program.label} did not terminate: {' '.join(command)}") from error
    if done.returncode != 0:
        errors = done.stderr.strip()[-2000:]
        raise Problem(f"{program.label} exited with code {done.returncode}: {' '.join(command)}\n{errors}")
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
    """A separate render for each time: the command line stores no intermediate images."""
    image, statistics = setting.directory / "frame.exr", setting.directory / "frame.json"
    command = [str(setting.metrolight), "render", str(setting.directory / "scene.xml")]
    command += ["--integrator", program.integrator, "--time", f"{seconds}", "--seed", str(seed)]
    command += ["--threads", str(setting.threads), "--quiet", "-o", str(image), "--stats", str(statistics)]
    _run(command, program, seconds)
    values = json.loads(statistics.read_text(encoding="utf-8"))
    samples = values.get("samples", values.get("mutations", 0))
    return Frame(values["render_seconds"], samples / (setting.width * setting.height), read_exr(image))


def read_exr(path):
    # Mitsuba's reader deadlocks on a machine with one core unless it has at least two threads.
    dr.set_thread_count(max(2, os.cpu_count() or 1))
    mi.set_variant("scalar_rgb")
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return np.array(bitmap)
