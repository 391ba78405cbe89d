"""The error of an image against its reference: Metrolight's relMSE (src/metrics/relative_mse.rs)."""

from dataclasses import dataclass

import numpy as np

# Fraction of the squared mean of the reference that keeps the relative error of dark pixels finite.
FLOOR = 0.01

# One in this many pixels, the worst, is left out: 0.1% and 2%.
TENTH_OF_A_PERCENT, TWO_PERCENT = 1000, 50


@dataclass(frozen=True)
class Errors:
    """relMSE (dimensionless) of all pixels, and without the worst 0.1% and 2% of them."""

    relmse: float
    trimmed_tenth: float
    trimmed_two: float


def relative(squares, reference):
    """The contribution of each pixel to relMSE, given its squared errors: the mean over the channels of
    e^2 / (r^2 + 0.01 m^2), with r the reference and m its mean."""
    reference = reference.astype(float)
    scale = reference**2 + FLOOR * reference.mean() ** 2
    return (squares / scale).mean(axis=-1).ravel()


def summarise(pixels):
    """The errors of an image, given the contribution of each pixel to relMSE."""
    ordered = np.sort(pixels)

    def trimmed(pixels_per_outlier):
        return float(ordered[: len(ordered) - len(ordered) // pixels_per_outlier].mean())

    tenth, two = trimmed(TENTH_OF_A_PERCENT), trimmed(TWO_PERCENT)
    return Errors(float(ordered.mean()), tenth, two)


def measure(image, reference):
    return summarise(relative((image.astype(float) - reference) ** 2, reference))
