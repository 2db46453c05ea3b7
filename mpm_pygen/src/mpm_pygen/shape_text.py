"""Shapes from text, for the command line: `block((0, 0), (1, 1)) - circle((0.5, 0.5), 0.2)`."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.expressions import FUNCTIONS, evaluate, parse
from mpm_pygen.mesh import read_mesh
from mpm_pygen.polygons import Polygon, naca, slope, wedge
from mpm_pygen.shape import Shape
from mpm_pygen.shapes import Block, Circle, Cylinder, HalfCircle, Pipe, Ring, Sphere
from mpm_pygen.solids import Extrusion, Revolution, column, rotated_block, wheel

#: What an expression may call.
MAKERS: dict[str, Callable[..., Shape]] = {
    "block": Block,
    "circle": Circle,
    "half_circle": HalfCircle,
    "cylinder": Cylinder,
    "sphere": Sphere,
    "ring": Ring,
    "pipe": Pipe,
    "polygon": Polygon,
    "rotated_block": rotated_block,
    "column": column,
    "wheel": wheel,
    "slope": slope,
    "wedge": wedge,
    "naca": naca,
    "extrusion": Extrusion,
    "revolution": Revolution,
    "mesh": read_mesh,
}
METHODS = ("translated", "rotated", "scaled", "mirrored")


def read_shape(text: str) -> Shape:
    """Make the shape that an expression names.

    Parameters
    ----------
    text : str
        Calls of the names of `MAKERS` with numbers, tuples and text, their methods `translated`,
        `rotated`, `scaled` and `mirrored`, and the operators `|` (union), `-` (difference) and
        `&` (intersection).
    """
    shape = _value(text, parse(text))
    if not isinstance(shape, Shape):
        raise PygenError(f"{text!r} is no shape")
    return shape


def _value(text: str, node: ast.expr) -> Any:
    """Evaluate a node: a shape, a number, text or a tuple."""
    match node:
        case ast.Constant(value=str() as word):
            return word
        case ast.Constant(value=int() as number):
            # Counts and axes are whole numbers.
            return number
        case ast.Tuple(elts=items) | ast.List(elts=items):
            return tuple(_value(text, item) for item in items)
        case ast.BinOp(left=left, op=ast.BitOr() | ast.BitAnd() as op, right=right):
            first, second = _shape(text, left), _shape(text, right)
            return first | second if isinstance(op, ast.BitOr) else first & second
        case ast.BinOp(left=left, op=ast.Sub(), right=right) if _makes_shape(left):
            return _shape(text, left) - _shape(text, right)
        case ast.Call(func=ast.Name(id=name)) if name in MAKERS:
            return _call(text, MAKERS[name], node)
        case ast.Call(func=ast.Attribute(value=owner, attr=name)) if name in METHODS:
            return _call(text, getattr(_shape(text, owner), name), node)
        case ast.Call(func=ast.Name(id=name)) if name not in FUNCTIONS:
            raise PygenError(f"unknown shape {name!r} in {text!r}; there are {', '.join(MAKERS)}")
        case ast.Call(func=ast.Attribute(attr=name)):
            raise PygenError(f"unknown method {name!r} in {text!r}; there are {', '.join(METHODS)}")
        case _:
            # A number, possibly with arithmetic.
            return float(evaluate(ast.unparse(node), {"pi": np.array(math.pi)}))


def _call(text: str, make: Callable[..., Any], node: ast.Call) -> Any:
    """Call with the arguments of a node."""
    arguments = [_value(text, argument) for argument in node.args]
    named = {word.arg: _value(text, word.value) for word in node.keywords if word.arg}
    try:
        return make(*arguments, **named)
    except PygenError:
        raise
    except (TypeError, ValueError, AttributeError) as error:
        raise PygenError(f"{ast.unparse(node)!r} does not fit: {error}") from None


def _makes_shape(node: ast.expr) -> bool:
    """Tell whether a node is a shape, and not a number."""
    match node:
        case ast.Call(func=ast.Name(id=name)):
            return name not in FUNCTIONS
        case ast.Call(func=ast.Attribute()):
            return True
        case ast.BinOp(left=left):
            return _makes_shape(left)
        case _:
            return False


def _shape(text: str, node: ast.expr) -> Shape:
    """Evaluate a node that has to be a shape."""
    shape = _value(text, node)
    if not isinstance(shape, Shape):
        raise PygenError(f"{ast.unparse(node)!r} is no shape in {text!r}")
    return shape
