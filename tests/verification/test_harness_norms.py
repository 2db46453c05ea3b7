"""Norms of scalars, vectors and tensors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from harness.norms import Errors, l1, l2, linf, magnitude

ROUND_OFF = 8 * np.finfo(float).eps


def test_magnitudes() -> None:
    """|v| of scalars, and the Frobenius norm of vectors and tensors."""
    assert magnitude(np.array([-2.0, 3.0])).tolist() == [2.0, 3.0]
    assert magnitude(np.array([[3.0, 4.0, 0.0]])).tolist() == [5.0]
    tensor = np.array([[[1.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -4.0]]])
    assert magnitude(tensor).tolist() == [5.0]


def test_weighted_norms() -> None:
    """Values 1 and -3 on volumes 3 and 1."""
    difference, volume = np.array([1.0, -3.0]), np.array([3.0, 1.0])
    assert l1(difference, volume) == pytest.approx(1.5, rel=ROUND_OFF)
    assert l2(difference, volume) == pytest.approx(math.sqrt(3.0), rel=ROUND_OFF)
    assert linf(difference, volume) == 3.0


def test_scale_of_the_volumes_does_not_matter() -> None:
    """Norms are means."""
    difference, volume = np.array([[1.0, 2.0, 2.0], [0.0, 0.0, 1.0]]), np.array([1.0, 2.0])
    for norm in (l1, l2, linf):
        assert norm(difference, volume) == pytest.approx(norm(difference, 1e-9 * volume), rel=1e-14)


def test_errors_keep_the_largest_of_the_frames() -> None:
    """The last frame counts only where it is asked for."""
    errors = Errors(np.ones(2))
    for scale in (1.0, 3.0, 2.0):
        errors.add("e_u", scale * np.array([1.0, -1.0]))
        errors.add("e_s", scale * np.array([0.0, 2.0]))
    measures = errors.measures(last=("e_s",))
    assert measures == pytest.approx(
        {
            "e_u_l1": 3.0,
            "e_u_l2": 3.0,
            "e_u_linf": 3.0,
            "e_s_l1": 2.0,
            "e_s_l2": math.sqrt(8.0),
            "e_s_linf": 4.0,
        },
        rel=ROUND_OFF,
    )
