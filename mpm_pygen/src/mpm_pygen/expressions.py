"""Numbers and shapes from text, without handing the text to Python's own evaluation."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.shape import FloatArray

#: Functions that an expression may call, with the number of their arguments.
FUNCTIONS: dict[str, tuple[int, Callable[..., FloatArray]]] = {
    "abs": (1, np.abs),
    "sqrt": (1, np.sqrt),
    "exp": (1, np.exp),
    "log": (1, np.log),
    "sin": (1, np.sin),
    "cos": (1, np.cos),
    "tan": (1, np.tan),
    "asin": (1, np.arcsin),
    "acos": (1, np.arccos),
    "atan": (1, np.arctan),
    "atan2": (2, np.arctan2),
    "sinh": (1, np.sinh),
    "cosh": (1, np.cosh),
    "tanh": (1, np.tanh),
    "hypot": (2, np.hypot),
    "min": (2, np.minimum),
    "max": (2, np.maximum),
    "where": (3, np.where),
}
CONSTANTS = {"pi": math.pi, "e": math.e}

_OPERATORS: dict[type[ast.AST], Callable[..., FloatArray]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.Mod: np.mod,
    ast.USub: np.negative,
    ast.UAdd: np.positive,
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.And: np.logical_and,
    ast.Or: np.logical_or,
}

#: Longer text is no expression, and deep trees would exhaust the stack.
LONGEST = 2000


def evaluate(text: str, variables: Mapping[str, FloatArray]) -> FloatArray:
    """Evaluate an expression for all points at once.

    Parameters
    ----------
    text : str
        Numbers, the variables, `pi` and `e`; `+ - * / % **` and parentheses; comparisons, `and`,
        `or`, `a if condition else b`; the functions of `FUNCTIONS`. `^` is not a power.
    variables : Mapping[str, FloatArray]
        By name, all of one shape.

    Returns
    -------
    FloatArray
        Of the shape of the variables.
    """
    shape = np.shape(next(iter(variables.values())))
    with np.errstate(all="ignore"):
        value = _value(text, parse(text), variables)
    return np.broadcast_to(np.asarray(value, dtype=float), shape).copy()


def parse(text: str) -> ast.expr:
    """Parse an expression into a tree.

    Parameters
    ----------
    text : str
        One expression.
    """
    if len(text) > LONGEST:
        raise PygenError(f"an expression has at most {LONGEST} characters, not {len(text)}")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise PygenError(f"{text!r} is no expression") from None


def _value(text: str, node: ast.expr, variables: Mapping[str, FloatArray]) -> FloatArray:
    """Evaluate a node."""

    def inner(child: ast.expr) -> FloatArray:
        return _value(text, child, variables)

    match node:
        case ast.Constant(value=bool() | int() | float() as number):
            # A float, so that powers of large numbers overflow instead of filling the memory.
            return np.array(number, dtype=float)
        case ast.Name(id=name) if name in variables:
            return variables[name]
        case ast.Name(id=name) if name in CONSTANTS:
            return np.array(CONSTANTS[name])
        case ast.Name(id=name):
            known = ", ".join([*variables, *CONSTANTS])
            raise PygenError(f"unknown name {name!r} in {text!r}; there are {known}")
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](inner(left), inner(right))
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](inner(operand))
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](inner(left), inner(right))
        case ast.BoolOp(op=op, values=[first, *others]):
            result = inner(first)
            for other in others:
                result = _OPERATORS[type(op)](result, inner(other))
            return result
        case ast.IfExp(test=test, body=body, orelse=orelse):
            return np.where(inner(test), inner(body), inner(orelse))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            if name not in FUNCTIONS:
                known = ", ".join(FUNCTIONS)
                raise PygenError(f"unknown function {name!r} in {text!r}; there are {known}")
            count, function = FUNCTIONS[name]
            if len(arguments) != count:
                raise PygenError(f"{name} takes {count} arguments in {text!r}")
            return function(*map(inner, arguments))
        case _:
            raise PygenError(f"{ast.unparse(node)!r} has no place in the expression {text!r}")
