"""Input and output of the programs that run in a separate process.

This file does not use numpy: the allocator of pyluxcore is incompatible with it in one process.
"""

import json
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class Job:
    """One render. `times` are the seconds after which the image is stored, in ascending order; the last one ends the
    render. `engine` and `sampler` are LuxCore's names, empty for Mitsuba; `roulette` enables LuxCore's Russian
    roulette."""

    scene: str
    width: int
    height: int
    threads: int
    seed: int
    times: list
    output: str
    engine: str = ""
    sampler: str = ""
    roulette: bool = True

    def write(self, path):
        Path(path).write_text(json.dumps(asdict(self)), encoding="utf-8")


def read_job(path):
    return Job(**json.loads(Path(path).read_text(encoding="utf-8")))


class FrameWriter:
    """Writes frame i to `output/i.f32`, RGB in 32-bit floats with the top row first, and its time and number of samples
    to `output/frames.json`."""

    def __init__(self, output):
        self.directory = Path(output)
        self.directory.mkdir(parents=True, exist_ok=True)
        self.frames = []

    def add(self, seconds, samples, pixels):
        """Stores a frame. `pixels` are the bytes of the image after `seconds` of rendering, with `samples` samples per
        pixel."""
        (self.directory / f"{len(self.frames)}.f32").write_bytes(pixels)
        self.frames.append({"seconds": seconds, "samples": samples})

    def finish(self):
        (self.directory / "frames.json").write_text(json.dumps(self.frames), encoding="utf-8")
