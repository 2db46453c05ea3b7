"""Dry sand for the granular cases: material, bodies that start under their own weight."""

from __future__ import annotations

import math
from dataclasses import dataclass

from harness.scene import Body, pressure_wave_modulus, shear_modulus
from harness.scheme import Scheme

GRAVITY = 9.81
#: Density of the body, from which grains touch, and of the grains themselves: 60 % are filled.
DENSITY, GRAIN_DENSITY = 1500.0, 2500.0
POISSON = 0.3


@dataclass(frozen=True)
class Sand:
    """Grains of Sand_SachithLocal; the friction is that of glass beads (Jop et al. 2006)."""

    #: Modulus of pressure waves, diameter of the grains.
    modulus: float
    diameter: float
    mu_s: float = 0.3819
    mu_2: float = 0.6435
    i_0: float = 0.279

    @classmethod
    def under(cls, depth: float, stiffness: float, diameter: float, **law: float) -> Sand:
        """Return sand whose modulus is `stiffness` times the weight of a column, rho g depth."""
        return cls(stiffness * DENSITY * GRAVITY * depth, diameter, **law)

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus."""
        return self.modulus / pressure_wave_modulus(1.0, POISSON)

    @property
    def wave_speed(self) -> float:
        """Speed of pressure waves."""
        return math.sqrt(self.modulus / DENSITY)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus."""
        return shear_modulus(self.youngs_modulus, POISSON)

    def material(self) -> str:
        """Return the lines of config."""
        return (
            'material-class = "Sand_SachithLocal"\n'
            f"    material-props = {{E = {self.youngs_modulus!r}, nu = {POISSON!r}, "
            f"d = {self.diameter!r}, mu_s = {self.mu_s!r}, rho_s = {GRAIN_DENSITY!r}, "
            f"rho_c = {DENSITY!r}, mu_2 = {self.mu_2!r}, I_0 = {self.i_0!r}}}"
        )


@dataclass
class RestingBody(Body):
    """A body that starts with the pressure of its own weight."""

    #: Distance of the free surface above the highest points.
    surface: float = 0.0

    def section(self, scheme: Scheme) -> str:
        """Return the section of the config."""
        resting = (
            'class = "HydrostaticBody"\n'
            f"    properties = {{{GRAVITY!r}, {DENSITY!r}, surface = {self.surface!r}}}"
        )
        return super().section(scheme).replace('class = "DefaultBody"', resting, 1)
