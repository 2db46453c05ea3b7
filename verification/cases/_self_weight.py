"""Columns in equilibrium under their own weight, and uniform states of stress made of them."""

from __future__ import annotations

import math

import numpy as np
from harness.scene import UP, pressure_wave_modulus, section
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Height of a column of which a scene has the lowest part only: the stress in it is uniform.
FAR = 1e9


def self_weight(
    t_stop: float,
    gravity: float,
    height: float,
    density: float,
    youngs_modulus: float,
    poisson: float,
    *,
    base: float = 0.0,
    t_ramp: float = 0.0,
    damping: float = 0.0,
    staggered: bool = False,
    exact_start: bool = True,
) -> str:
    """Return the section of a SelfWeightDriver."""
    return section(
        "SelfWeightDriver",
        {
            "t_stop": t_stop,
            "gravity": gravity,
            "height": height,
            "base": base,
            "density": density,
            "E": youngs_modulus,
            "nu": poisson,
            "t_ramp": t_ramp,
            "damping": damping,
        },
        {"staggered": int(staggered), "exact_start": int(exact_start)},
    )


def uniform_gravity(stretch: float, density: float, modulus: float) -> float:
    """Return the gravity by which the foot of a column of height FAR is stretched, below 1."""
    return -modulus * math.log(stretch) / (density * FAR)


def equilibrium(
    reference: Array, gravity: float, height: float, density: float, modulus: float
) -> tuple[Array, Array]:
    """Return heights and vertical stresses of points of a column with its base at 0."""
    a = density * gravity / modulus
    y = math.exp(-a * height) * np.expm1(a * reference) / a
    return y, -density * gravity * (height - reference)


def lateral_share(poisson: float) -> float:
    """Return the lateral over the vertical stress in uniaxial strain."""
    return poisson / (1.0 - poisson)


def sound(youngs_modulus: float, poisson: float, density: float) -> float:
    """Return the speed of pressure waves."""
    return math.sqrt(pressure_wave_modulus(youngs_modulus, poisson) / density)


def vertical(sim_type: int) -> int:
    """Return the direction of gravity."""
    return UP[sim_type]


def noise_law(mapping: str, n: int, stretch: float) -> float:
    """Return the largest nodal force of a uniform stress over stress and area.

    Linear functions: F/n. Corner averages count a point in part while the node line lies in the
    inner half of its first box: of the d = n |1/F - 1| spacings by which the number of points in a
    cell differs from n, a box of 1/(2 F) spacings is counted in full, a gap not at all.
    """
    step = n * abs(1.0 / stretch - 1.0)
    if mapping == "linear":
        return stretch / n
    box = 0.5 / stretch
    gap = 1.0 - box
    part = step % 1.0
    return stretch / n * (min(part, box) - max(0.0, part - gap)) / box
