"""The raw results, one row per image, in a CSV file to which rows are appended while the experiment runs."""

import csv
from dataclasses import asdict, dataclass, fields

from problem import Problem


@dataclass(frozen=True)
class Row:
    """`budget` is the nominal time of an image and `seconds` the actual time; `samples` are per pixel. The errors are
    those of errors.py; `mean` is the mean over pixels and channels, in the scene's unit of radiance."""

    scene: str
    program: str
    integrator: str
    sampler: str
    seed: int
    threads: int
    budget: float
    seconds: float
    samples: float
    relmse: float
    relmse_trimmed_tenth: float
    relmse_trimmed_two: float
    mean: float
    reference_mean: float
    reference: str
    reference_error: float

    @property
    def label(self):
        return " ".join(filter(None, [self.program, self.integrator, self.sampler]))


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        kinds = {field.name: field.type for field in fields(Row)}
        return [Row(**{name: kinds[name](value) for name, value in line.items()}) for line in csv.DictReader(file)]


def finished(rows, budgets):
    """The renders that are complete, as (scene, program, seed). All images must have been measured at `budgets`."""
    wrong = {row.budget for row in rows} - set(budgets)
    if wrong:
        raise Problem(f"the file has images after {sorted(wrong)} s, but this run measures them after {budgets} s")
    return {(row.scene, row.label, row.seed) for row in rows}


def start(path):
    """Writes an empty table."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerow(field.name for field in fields(Row))


def append(path, rows):
    with open(path, "a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Row)])
        writer.writerows(asdict(row) for row in rows)
