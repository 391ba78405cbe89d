"""The truth that images are measured against: long renders of several seeds, none of them a measured one."""

import json
from dataclasses import asdict, dataclass

import numpy as np

from errors import relative, summarise
from problem import Problem
from programs import read_exr, render

# Seeds of references; measured ones are smaller.
FIRST_SEED = 1000
RENDERS = 4


@dataclass(frozen=True)
class Reference:
    """`made_by` is a program's label; `error` is the relMSE that the image itself is expected to have,
    without the worst 0.1% of its pixels, NaN if it is not known."""

    image: np.ndarray
    made_by: str
    error: float


def find_or_make(name, directory, candidates, setting, seconds):
    """The reference `name` of `directory`, an image NAME.npy or NAME.exr of the right size; made by the best of
    the candidates, and kept there, if there is none."""
    image, about = directory / f"{name}.npy", directory / f"{name}.json"
    other = directory / f"{name}.exr"
    if image.exists() or other.exists():
        pixels = np.load(image) if image.exists() else read_exr(other)
        if pixels.shape != (setting.height, setting.width, 3):
            raise Problem(f"the reference {name} in {directory} has another size than the scene: {pixels.shape}")
        known = {"made_by": "given", "error": float("nan")}
        if about.exists():
            known = json.loads(about.read_text(encoding="utf-8"))
        return Reference(pixels, known["made_by"], known["error"])
    reference = make(candidates, setting, seconds)
    directory.mkdir(parents=True, exist_ok=True)
    np.save(image, reference.image)
    described = asdict(reference)
    del described["image"]
    about.write_text(json.dumps(described), encoding="utf-8")
    return reference


def make(candidates, setting, seconds):
    """Each candidate renders for `seconds` in all, and the one whose renders agree best with one another, in all
    pixels, makes the reference: methods without bias, so that what differs between seeds is all their error."""
    best, least = None, np.inf
    for program in candidates:
        seeds = range(FIRST_SEED, FIRST_SEED + RENDERS)
        images = np.array([render(program, setting, seed, [seconds / RENDERS])[-1].image for seed in seeds])
        mean = images.mean(axis=0, dtype=float)
        variance_of_mean = images.var(axis=0, ddof=1, dtype=float) / RENDERS
        error = summarise(relative(variance_of_mean, mean))
        print(
            f"  by {program.label}: mean {mean.mean():.5g}, own relMSE {error.relmse:.2g},"
            f" {error.trimmed_tenth:.2g} without the worst 0.1%",
            flush=True,
        )
        if error.relmse < least:
            best, least = Reference(mean.astype(np.float32), program.label, error.trimmed_tenth), error.relmse
    return best
