"""Expressions: values, and what they must not do."""

from __future__ import annotations

import numpy as np
import pytest

from mpm_pygen import Block, Circle, PygenError, Sphere, Union, read_shape
from mpm_pygen.expressions import evaluate

X = {"x": np.array([0.25, 0.5, 2.0]), "y": np.array([1.0, -1.0, 3.0])}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("3", [3, 3, 3]),
        (" -x + 2*y ", [1.75, -2.5, 4.0]),
        ("x**2 % 1", [0.0625, 0.25, 0.0]),
        ("1 if x < 1 and y > 0 else 0", [1, 0, 0]),
        ("where(x >= 0.5 or y > 2, x, y)", [1.0, 0.5, 2.0]),
        ("max(x, y) - min(x, y)", [0.75, 1.5, 1.0]),
        ("sqrt(hypot(3*x, 4*x)/5/x)", [1, 1, 1]),
        ("log(exp(x))", [0.25, 0.5, 2.0]),
        ("cos(pi) + atan2(0*x, abs(y))", [-1, -1, -1]),
    ],
)
def test_values(text: str, values: list[float]) -> None:
    """As mathematics has it."""
    found = evaluate(text, X)
    assert found.shape == (3,)
    assert np.allclose(found, values, rtol=4 * np.finfo(float).eps, atol=0.0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x +",
        "z",
        "x = 1",
        "__import__('os')",
        "x.__class__",
        "(lambda: 1)()",
        "[x for x in y]",
        "open('a')",
        "'text'",
        "sqrt(x, y)",
        "sin(x=1)",
        "0 < x < 1",
        "not x",
        "x ^ 2",
        "x[0]",
        "f'{x}'",
        "1j",
        "(" * 500 + "1" + ")" * 500,
        "1" + "+1" * 2000,
    ],
)
def test_all_else_is_refused(text: str) -> None:
    """Attributes, calls, text, chains, deep trees."""
    with pytest.raises(PygenError):
        evaluate(text, X)


def test_huge_powers_overflow_at_once() -> None:
    """Numbers are floats: no integer of a billion digits."""
    assert np.isinf(evaluate("9**9**9**9 + 0*x", X)).all()


def test_shapes_from_text() -> None:
    """Calls, operators, methods, arithmetic in numbers; what is inside tells."""
    x = np.random.default_rng(2).uniform(-1.0, 2.0, (3000, 2))
    shape = read_shape(
        "block((0, 0), (1, 2 - 0.5)) - circle((0.5, 1/2), radius=sqrt(0.04)) "
        "| ring((0, 0), 0.25, 0.5).translated(-0.4, 0).rotated(90)"
    )
    in_block = np.all((x >= 0.0) & (x <= [1.0, 1.5]), axis=1)
    distance = np.hypot(x[:, 0], x[:, 1] + 0.4)
    expected = in_block & (np.sum((x - 0.5) ** 2, axis=1) > 0.04)
    expected |= (distance >= 0.25) & (distance <= 0.5)
    assert (shape.contains(x) == expected).all()
    assert isinstance(shape, Union)
    assert read_shape("sphere((0, 0, 0), 1)") == Sphere((0, 0, 0), 1)
    assert read_shape("block((-1,), (1,))") == Block((-1.0,), (1.0,))
    assert read_shape("polygon([(0, 0), (1, 0), (0, 1)])").measure == 0.5
    assert read_shape("naca('0012', 1)").measure > 0.0
    assert read_shape("circle((1 - 0.5, 0), 0.2)") == Circle((0.5, 0.0), 0.2)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("3", "no shape"),
        ("cone((0, 0), 1)", "unknown shape 'cone'"),
        ("circle((0, 0), 1).grown(2)", "unknown method 'grown'"),
        ("circle((0, 0))", "does not fit"),
        ("circle((0, 0), -1)", "above 0"),
        ("circle((0, 0), x)", "unknown name 'x'"),
        ("circle((0, 0), 1) + circle((1, 1), 1)", "no place|unknown"),
        ("circle((0, 0), 1) - 3", "no shape"),
        ("circle((0, 0), 1).__class__", "no place"),
        ("circle('a', 1)", "coordinates|fit"),
    ],
)
def test_texts_that_are_no_shapes(text: str, words: str) -> None:
    """Each says what is wrong."""
    with pytest.raises(PygenError, match=words):
        read_shape(text)
