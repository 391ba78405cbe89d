"""The Markdown table of the results."""

import math
import re
from statistics import fmean

from problem import Problem

MARK = re.compile(r"(<!-- field:begin -->\n).*?(<!-- field:end -->)", re.DOTALL)

# A larger relative difference of the mean indicates missing light or a different material; it is printed in bold.
BRIGHTNESS_TOLERANCE = 0.03

HEADER = [
    "scene",
    "program",
    "samples per pixel",
    "relMSE",
    "without the worst 0.1%",
    "without the worst 2%",
    "mean / reference",
    "seconds to equal error",
]


def in_order(values):
    return list(dict.fromkeys(values))


def final_rows(rows, scene, label):
    """The rows of one program in one scene after the whole time, one per seed."""
    own = [row for row in rows if row.scene == scene and row.label == label]
    last = max((row.budget for row in own), default=0)
    return [row for row in own if row.budget == last]


def mean_of(rows, name):
    return fmean(getattr(row, name) for row in rows)


def markdown(rows):
    """One table of all scenes, followed by the reference and the target of the last column for each scene."""
    lines = [f"| {' | '.join(HEADER)} |", f"|{' --- |' * len(HEADER)}"]
    references = []
    for scene in in_order(row.scene for row in rows):
        labels = in_order(row.label for row in rows if row.scene == scene)
        rival = best_rival(rows, scene)
        for label in labels:
            lines.append(f"| {' | '.join(_cells(rows, scene, label, rival))} |")
        references.append(_references(rows, scene, rival))
    return "\n".join([*lines, "", *references])


def best_rival(rows, scene):
    """The label of the program with the lowest final error among those other than Metrolight that are measured
    against the common reference."""
    shared = {row.reference for row in rows if row.scene == scene and row.program == "Metrolight"}
    others = in_order(
        row.label
        for row in rows
        if row.scene == scene and row.program != "Metrolight" and (row.reference in shared or not shared)
    )
    if not others:
        return None
    return min(others, key=lambda label: mean_of(final_rows(rows, scene, label), "relmse_trimmed_tenth"))


def _cells(rows, scene, label, rival):
    final = final_rows(rows, scene, label)
    errors = [
        f"{mean_of(final, name):.3g} ({min(values):.3g} to {max(values):.3g})"
        for name in ("relmse", "relmse_trimmed_tenth", "relmse_trimmed_two")
        for values in [[getattr(row, name) for row in final]]
    ]
    brightness = mean_of(final, "mean") / mean_of(final, "reference_mean")
    marked = f"{brightness:.3f}" if abs(brightness - 1) <= BRIGHTNESS_TOLERANCE else f"**{brightness:.3f}**"
    own_reference = "" if "LuxCore" not in final[0].reference else " *"
    time = "" if rival is None or own_reference else seconds_to_equal_error(rows, scene, label, rival)
    return [scene, label + own_reference, f"{mean_of(final, 'samples'):.3g}", *errors, marked, time]


def seconds_to_equal_error(rows, scene, label, rival):
    """The time at which the mean over seeds of the error without the worst 0.1% reaches the final error of `rival`,
    interpolated linearly between the measured times on logarithmic axes."""
    target = mean_of(final_rows(rows, scene, rival), "relmse_trimmed_tenth")
    curve = error_curve(rows, scene, label, "relmse_trimmed_tenth")
    if curve[0][1] <= target:
        return f"< {curve[0][0]:.3g}"
    for (t0, e0), (t1, e1) in zip(curve, curve[1:]):
        if e1 <= target:
            fraction = math.log(e0 / target) / math.log(e0 / e1)
            return f"{t0 * (t1 / t0) ** fraction:.3g}"
    return f"> {curve[-1][0]:.3g}"


def error_curve(rows, scene, label, name):
    """Pairs of mean seconds and mean error over the seeds, one per measured time."""
    own = [row for row in rows if row.scene == scene and row.label == label]
    budgets = sorted({row.budget for row in own})
    groups = [[row for row in own if row.budget == budget] for budget in budgets]
    return [(mean_of(group, "seconds"), mean_of(group, name)) for group in groups]


def _references(rows, scene, rival):
    made = {row.reference: row.reference_error for row in rows if row.scene == scene}.items()
    described = " and ".join(f"{label} (relMSE of the reference itself {error:.2g})" for label, error in made)
    compared = f"; equal error refers to {rival}" if rival else ""
    return f"- `{scene}`: reference by {described}{compared}."


def insert(document, text):
    """Writes `text` between the marks of a document."""
    old = document.read_text(encoding="utf-8")
    new, count = MARK.subn(lambda match: f"{match[1]}\n{text}\n\n{match[2]}", old)
    if count != 1:
        raise Problem(f"{document}: one pair of marks <!-- field:begin --> and <!-- field:end --> is required")
    document.write_text(new, encoding="utf-8")
