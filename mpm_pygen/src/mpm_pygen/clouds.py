"""The points or nodes of one body in one frame, with their fields and what follows from those."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mpm_pygen.errors import PygenError
from mpm_pygen.shape import FloatArray

_COMPONENT = re.compile(r"(.+)\.([a-z]+)")


def _deviator(tensor: FloatArray) -> FloatArray:
    """Take a third of the trace away."""
    third = np.trace(tensor, axis1=1, axis2=2) / 3.0
    return np.asarray(tensor - third[:, None, None] * np.eye(3), dtype=np.float64)


def _norm(tensor: FloatArray) -> FloatArray:
    """Give the square root of the sum of squares."""
    return np.asarray(np.sqrt(np.sum(tensor**2, axis=(1, 2))), dtype=np.float64)


def _rate(gradient: FloatArray) -> FloatArray:
    """Give the symmetric part."""
    return np.asarray(0.5 * (gradient + np.swapaxes(gradient, 1, 2)))


def _principal(tensor: FloatArray) -> FloatArray:
    """Give the eigenvalues of the symmetric part, the smallest first."""
    return np.asarray(np.linalg.eigvalsh(_rate(tensor)), dtype=np.float64)


#: Fields that follow from another one: its name, and how.
DERIVED: dict[str, tuple[str, Callable[[FloatArray], FloatArray]]] = {
    "speed": ("velocity", lambda v: np.sqrt(np.sum(v**2, axis=1))),
    "pressure": ("cauchy_stress", lambda t: -np.trace(t, axis1=1, axis2=2) / 3.0),
    "mises": ("cauchy_stress", lambda t: np.sqrt(1.5) * _norm(_deviator(t))),
    "tau_bar": ("cauchy_stress", lambda t: np.sqrt(0.5) * _norm(_deviator(t))),
    "max_stress": ("cauchy_stress", lambda t: _principal(t)[:, 2]),
    "min_stress": ("cauchy_stress", lambda t: _principal(t)[:, 0]),
    "gamma_dot": ("velocity_gradient", lambda g: np.sqrt(2.0) * _norm(_deviator(_rate(g)))),
    "divergence": ("velocity_gradient", lambda g: np.trace(g, axis1=1, axis2=2)),
    "vorticity": ("velocity_gradient", lambda g: g[:, 1, 0] - g[:, 0, 1]),
}
UNITS = {
    "speed": "m/s",
    "velocity": "m/s",
    "displacement": "m",
    "pressure": "Pa",
    "cauchy_stress": "Pa",
    "mises": "Pa",
    "tau_bar": "Pa",
    "max_stress": "Pa",
    "min_stress": "Pa",
    "density": "kg/m³",
    "gamma_dot": "1/s",
    "velocity_gradient": "1/s",
    "divergence": "1/s",
    "vorticity": "1/s",
    "mass": "kg",
    "momentum": "kg m/s",
    "temperature": "K",
}


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points, or nodes, with fields.

    Parameters
    ----------
    position : FloatArray
        `(n, 3)`; directions that the TYPE does not have are 0.
    fields : Mapping[str, FloatArray]
        By name: `(n,)`, `(n, 3)`, or `(n, 3, 3)`.
    cell_size : int
        Nodes of a cell of the grid: 2, 4, 8; 1 for points; 0 when the file does not tell.
    """

    position: FloatArray
    fields: Mapping[str, FloatArray]
    cell_size: int = 0

    def __len__(self) -> int:
        """Count the points."""
        return len(self.position)

    def __getitem__(self, name: str) -> FloatArray:
        """Give a field, a component like `velocity.x` or `cauchy_stress.xy`, or one of `DERIVED`.

        Components are `x`, `y`, `z`, which are r, z, theta in TYPE 4; of tensors `xx`, `xy`, ...
        """
        if name in self.fields:
            return self.fields[name]
        if name in DERIVED and DERIVED[name][0] in self.fields:
            source, function = DERIVED[name]
            return np.asarray(function(self.fields[source]))
        match = _COMPONENT.fullmatch(name)
        if match and match[1] in self.fields:
            values = self.fields[match[1]]
            place = tuple("xyz".find(letter) for letter in match[2])
            if len(place) == values.ndim - 1 and min(place) >= 0:
                return np.asarray(np.moveaxis(values, 0, -1)[place], dtype=np.float64)
        raise PygenError(f"there is no field {name!r}; there are {', '.join(self.names)}")

    @property
    def names(self) -> list[str]:
        """Names of the fields, those that follow from others included."""
        derived = [name for name, (source, _) in DERIVED.items() if source in self.fields]
        return [*self.fields, *(name for name in derived if name not in self.fields)]

    def scalar(self, name: str) -> FloatArray:
        """Give a field as one number a point: magnitudes of vectors and tensors.

        Parameters
        ----------
        name : str
            As in brackets.
        """
        values = self[name]
        if values.ndim == 1:
            return values
        return np.asarray(np.sqrt(np.sum(values.reshape(len(values), -1) ** 2, axis=1)))

    @property
    def active(self) -> NDArray[np.bool_]:
        """Tell which points take part; all when the file does not tell."""
        if "active" in self.fields:
            return np.asarray(self.fields["active"] != 0.0)
        return np.ones(len(self), dtype=bool)


def label(name: str) -> str:
    """Name a field for an axis, with its unit where that is known.

    Parameters
    ----------
    name : str
        As in the brackets of a `Cloud`.
    """
    unit = UNITS.get(name) or UNITS.get(name.split(".")[0])
    text = name.replace("_", " ")
    return f"{text} ({unit})" if unit else text
