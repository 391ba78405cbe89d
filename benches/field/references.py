"""The references: long renders with several seeds, none of which is used in the measurements."""

import json
from dataclasses import asdict, dataclass

import numpy as np

from errors import relative, summarise
from problem import Problem
from programs import read_exr, render

# Seeds of the references; those of the measurements are smaller.
FIRST_SEED = 1000
RENDERS = 4


@dataclass(frozen=True)
class Reference:
    """`made_by` is the label of a program; `error` is the expected relMSE of the reference itself, without the worst 0.1%
    of its pixels, or NaN if it is not known."""

    image: np.ndarray
    made_by: str
    error: float


def find_or_make(name, directory, candidates, setting, seconds):
    """Loads the reference `name` from `directory`, an image NAME.npy or NAME.exr of the right size. If there is none, the
    best of the candidates renders it, and it is stored there."""
    image, about = directory / f"{name}.npy", directory / f"{name}.json"
    other = directory / f"{name}.exr"
    if image.exists() or other.exists():
        pixels = np.load(image) if image.exists() else read_exr(other)
        if pixels.shape != (setting.height, setting.width, 3):
            raise Problem(f"the reference {name} in {directory} does not have the size of the scene: {pixels.shape}")
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
    """Each candidate renders for `seconds` in total. The reference is the mean image of the candidate whose renders differ
    least from one another over all pixels. The candidates are unbiased, so the differences between seeds are their
    whole error."""
    best, least = None, np.inf
    for program in candidates:
        seeds = range(FIRST_SEED, FIRST_SEED + RENDERS)
        images = np.array([render(program, setting, seed, [seconds / RENDERS])[-1].image for seed in seeds])
        mean = images.mean(axis=0, dtype=float)
        variance_of_mean = images.var(axis=0, ddof=1, dtype=float) / RENDERS
        error = summarise(relative(variance_of_mean, mean))
        print(
            f"  by {program.label}: mean {mean.mean():.5g}, relMSE of the reference itself {error.relmse:.2g},"
            f" {error.trimmed_tenth:.2g} without the worst 0.1%",
            flush=True,
        )
        if error.relmse < least:
            best, least = Reference(mean.astype(np.float32), program.label, error.trimmed_tenth), error.relmse
    return best
