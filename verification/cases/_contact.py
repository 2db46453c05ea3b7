"""What the contact cases share: sums over bodies, contact forces, a lumped model of contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from harness.case import Output
from harness.frames import Frame
from harness.scene import Body

Array = npt.NDArray[np.float64]

#: Share of a cell between a point and the corners at which the averaged functions are evaluated.
CORNER = 0.25


@dataclass
class State:
    """Sums over one body at a frame; in TYPE 4 per radian."""

    time: float
    mass: float
    #: (3,)
    momentum: Array
    centre: Array
    kinetic: float
    strain: float

    @property
    def velocity(self) -> Array:
        """Velocity of the centre of mass."""
        return self.momentum / self.mass


def strain_energy(body: Body, frame: Frame) -> float:
    """Return the sum of V sigma : C^-1 : sigma / 2."""
    stress, nu = frame["cauchy_stress"], body.poisson
    trace = np.trace(stress, axis1=1, axis2=2)
    density = (1 + nu) * np.sum(stress**2, axis=(1, 2)) - nu * trace**2
    return float(np.sum(frame["volume"] * density)) / (2 * body.youngs_modulus)


def sums(out: Output, body: int, frame: Frame) -> State:
    """Return the sums over one body."""
    points = out.scene.bodies[body]
    mass = points.points.total_mass
    velocity = frame["velocity"]
    return State(
        frame.time,
        float(np.sum(mass)),
        mass @ velocity,
        mass @ frame.x / np.sum(mass),
        0.5 * float(np.sum(mass * np.sum(velocity**2, axis=1))),
        strain_energy(points, frame),
    )


def histories(out: Output) -> list[list[State]]:
    """Return the sums of every body at all frames: first index body, second frame."""
    return [[sums(out, b, f) for f in out.points(b)] for b in range(len(out.scene.bodies))]


def contact_force(nodes: Frame, first: str, second: str) -> Array:
    """Return the contact force on the first body at all nodes, (n, 3)."""
    return nodes[f"contact_force_by_{second}_on_{first}"]


def contact_normal(nodes: Frame, first: str, second: str) -> Array:
    """Return the unit normals out of the first body, (n, 3); 0 where there is none."""
    return nodes[f"contact_normal_{first}_{second}"]


def reach(n: int, mapping: str) -> float:
    """Return how far from a node, in cells, a point still gives it mass."""
    return {
        "cpdi": 1.0 + CORNER / n,
        "ugimp": 1.0 + 0.5 / n,
        "quadratic": 1.5,
        "cubic": 2.0,
    }.get(mapping, 1.0)


def contact_gap(n: int, mapping: str, phase: float) -> float:
    """Return the gap between two edges, in cells, at which contact begins.

    Both edge points, half a spacing behind the edges, must reach one node. `phase` is the distance
    of the middle of the gap from the nearest node in cells, at most 1/2.
    """
    return 2.0 * reach(n, mapping) - 2.0 * phase - 1.0 / n


@dataclass
class Lumped:
    """Two equal bars that meet at a node, with the contact lumped into its edge points.

    Lengths are in cells, times in h/c, velocities in v = v_rel/2, stresses in rho c v. An edge
    point at x beyond its first reach has the weight w and the gradient G at the node. Each step
    takes its share of the node's velocity away, which acts as a dashpot of the stress w U/(n CFL),
    and its own stress S pushes with G S/n. The bar answers as a rod: stress = V - U, where V is
    the velocity that arrives with the wave reflected by the free end.

    With the implicit rule the node stands still, so that S grows by G U. With the explicit rule
    the node keeps dt f/m of the internal force: no strain remains and the dashpot acts alone.
    """

    n: int
    cfl: float
    #: v/c
    speed: float
    #: Cells along a bar.
    cells: int
    rule: str = "implicit"
    #: Distance of the middle of the gap from the nearest node: 0, 1/4 or 1/2.
    phase: float = 0.0
    #: cpdi or linear.
    mapping: str = "cpdi"

    def weights(self, x: float) -> tuple[float, float]:
        """Return the weight of all points and the gradient of the edge point at the node."""
        a = CORNER / self.n if self.mapping == "cpdi" else 0.0
        if x <= 0.0:
            return 0.0, 0.0
        distance = 1.0 + a - x + np.arange(3 * self.n) / self.n
        near = np.maximum(0.0, 1.0 - np.abs(distance - a))
        far = np.maximum(0.0, 1.0 - np.abs(distance + a))
        gradient = (near[0] - far[0]) / (2.0 * a) if a > 0.0 else float(near[0] > 0.0)
        return 0.5 * float(np.sum(near + far)), float(gradient)

    def collide(self, time: float = 0.0, step: float = 0.1) -> tuple[float, float]:
        """Return e after the collision, or at a time in h/c after its start, and the largest x.

        In the middle between two nodes (phase 1/2) two nodes act at the same time. Away from the
        node (1/4 and 1/2) the other body covers the node well, so that the velocity at the node
        relative to the edge is 2 U.
        """
        delay = round(2 * self.cells / step)
        ratio, nodes = (1.0, 1) if self.phase == 0.0 else (2.0, 1 if self.phase < 0.5 else 2)
        arriving = [1.0] * delay
        x, deepest, stress, impulse = 0.0, 0.0, 0.0, 0.0
        steps = round(time / step) if time > 0.0 else 12 * delay
        for k in range(steps):
            v = arriving[k]
            weight, gradient = self.weights(x)
            dashpot = weight / (self.n * self.cfl)
            spring = gradient * stress / self.n if self.rule == "implicit" else 0.0
            u = (v - nodes * spring) / (1.0 + nodes * ratio * dashpot)
            if u >= v:
                u = v
                if k > delay and time <= 0.0:
                    break
            elif self.rule == "implicit":
                stress += step * gradient * ratio * u
            x += step * self.speed * u
            deepest = max(deepest, x)
            impulse += step * (v - u)
            arriving.append(2.0 * u - v)
        return impulse / self.cells - 1.0, deepest
