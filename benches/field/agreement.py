"""Checks that all programs render the same image, on the scene cornell, whose light is easy to sample."""

import numpy as np

from problem import Problem
from programs import render

SCENE = "cornell"
TILES = 4
SEEDS = range(500, 504)

# Relative differences that two correct programs may have in addition to noise, in the mean of the image and of a tile:
# they terminate paths differently and reconstruct the borders of the image differently.
TOLERANCE_OF_MEAN, TOLERANCE_OF_TILE = 0.005, 0.02
STANDARD_ERRORS = 5

# Rec. 709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def check(programs, setting, seconds):
    """Renders four seeds with each program and prints how the means of the image and of its tiles compare with those of
    the first program. A difference above the tolerance plus five standard errors of four seeds is a `Problem`."""
    measured = {program.label: _measure(program, setting, seconds) for program in programs}
    first = programs[0].label
    print(f"{'program':32} {'mean':>8} {'against ' + first:>24} {'worst tile':>12}")
    wrong = []
    for label, (means, tiles) in measured.items():
        mean_off, mean_allowed = _compare(means, measured[first][0], TOLERANCE_OF_MEAN)
        tile_off, tile_allowed = _compare(tiles, measured[first][1], TOLERANCE_OF_TILE)
        worst = np.argmax(np.abs(tile_off) / tile_allowed)
        print(
            f"{label:32} {means.mean():8.5f} {mean_off:+11.2%} (+- {mean_allowed:.2%})"
            f" {tile_off.flat[worst]:+8.2%} (+- {tile_allowed.flat[worst]:.2%})",
            flush=True,
        )
        if abs(mean_off) > mean_allowed or abs(tile_off.flat[worst]) > tile_allowed.flat[worst]:
            wrong.append(label)
    if wrong:
        raise Problem(f"{', '.join(wrong)}: the image of {SCENE} differs from that of {first}")


def _measure(program, setting, seconds):
    """Mean luminance of the image and of its tiles, for each seed."""
    means, tiles = [], []
    for seed in SEEDS:
        luminance = render(program, setting, seed, [seconds])[-1].image @ LUMINANCE
        means.append(luminance.mean())
        rows = np.array_split(luminance, TILES, axis=0)
        tiles.append([[tile.mean() for tile in np.array_split(row, TILES, axis=1)] for row in rows])
    return np.array(means), np.array(tiles)


def _compare(values, expected, tolerance):
    """Relative difference of the means over the seeds, and the largest that is accepted. Four seeds can agree by chance:
    the variance of a tile is taken to be at least the mean over all tiles."""
    truth = expected.mean(axis=0)
    variance = (values.var(axis=0, ddof=1) + expected.var(axis=0, ddof=1)) / len(SEEDS) / truth**2
    difference = values.mean(axis=0) / truth - 1
    return difference, tolerance + STANDARD_ERRORS * np.sqrt(np.maximum(variance, variance.mean()))
