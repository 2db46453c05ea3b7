"""Closed forms of the bases, lumped mass and FLIP: dispersion, stability, energy loss.

A mode k on uniformly placed points, `n` a cell, has two means over the points of a cell: K of the
squared discrete gradient and mu, the filter from the grid to the points and back. The grid steps
obey omega_h^2 = c^2 K mu, see docs/verification.md. The corner-averaged functions have the same K
and mu as hats on points at rest whose boxes tile the bar, and so has uGIMP.
"""

from __future__ import annotations

import numpy as np

BASES = ("linear", "cpdi", "ugimp", "quadratic", "cubic")


def tent(distance: np.ndarray) -> np.ndarray:
    """Return the linear function at a distance in cells."""
    return np.maximum(0.0, 1.0 - np.abs(distance))


def box(distance: np.ndarray, half: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the linear function averaged over a box, and its slope.

    Parameters
    ----------
    distance : np.ndarray
        Distance of the point from the node, in cells.
    half : float
        Half width of the box, in cells, above 0; 1/2 makes the quadratic B-spline.
    """

    def area(d: np.ndarray) -> np.ndarray:  # of the hat below d
        outside = 0.5 * tent(d) ** 2
        return np.where(d < 0.0, outside, 1.0 - outside)

    before, behind = np.clip(distance - half, -1, 1), np.clip(distance + half, -1, 1)
    value = (area(behind) - area(before)) / (2.0 * half)
    return value, (tent(behind) - tent(before)) / (2.0 * half)


def cubic(distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the cubic B-spline at a distance in cells, and its slope."""
    size, sign = np.abs(distance), np.sign(distance)
    rest = np.maximum(0.0, 2.0 - size)
    value = np.where(size < 1.0, 2.0 / 3.0 - size**2 + size**3 / 2.0, rest**3 / 6.0)
    slope = np.where(size < 1.0, -2.0 * size + 1.5 * size**2, -(rest**2) / 2.0)
    return value, sign * slope


def node_functions(basis: str, distance: np.ndarray, n: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the function of a node and its slope at points, far from walls.

    On a node line the slope of linear functions is that of the cell above.

    Parameters
    ----------
    basis : str
        A mapping of the matrix: linear, cpdi, ugimp, quadratic or cubic.
    distance : np.ndarray
        Position of the points less that of the node, in cells.
    n : float
        Points per cell: their boxes are 1/n wide. The corner averages are means of two hats a
        quarter of that before and behind the point, and their difference as slope.
    """
    distance = np.asarray(distance, dtype=float)
    if basis == "linear":
        inside = (distance >= -1.0) & (distance < 1.0)
        return tent(distance), np.where(inside, np.where(distance < 0.0, 1.0, -1.0), 0.0)
    if basis == "cpdi":
        quarter = 0.25 / n
        before, behind = tent(distance - quarter), tent(distance + quarter)
        return 0.5 * (before + behind), (behind - before) / (2.0 * quarter)
    if basis == "cubic":
        return cubic(distance)
    return box(distance, {"ugimp": 0.5 / n, "quadratic": 0.5}[basis])


def grid_functions(
    basis: str, places: np.ndarray, cells: int, n: float, periodic: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return the functions of all nodes of a grid and their slopes at points: (points, nodes).

    Between walls a node behind a wall has the value v(-1) = 2 v(0) - v(1), so that its function
    adds to those of two nodes. With seams the last node is the first.

    Parameters
    ----------
    basis : str
        A mapping of the matrix; corner averages reach no farther than the walls.
    places : np.ndarray
        Positions in cells, within the grid. (points,)
    cells : int
        Cells of the grid.
    n : float
        Points per cell.
    periodic : bool
        Whether the grid repeats.
    """
    margin = 3
    nodes = np.arange(-margin, cells + margin + 1)
    # A point on the upper wall belongs to the cell below.
    inside = places if periodic else np.minimum(places, cells * (1.0 - np.finfo(float).eps))
    result = []
    for full in node_functions(basis, inside[:, None] - nodes, n):
        kept = full[:, margin : margin + cells + 1].copy()
        below, above = full[:, :margin], full[:, margin + cells + 1 :]
        if periodic:
            kept = kept[:, :cells]
            for node, column in zip(nodes, full.T, strict=True):
                if not 0 <= node < cells:
                    kept[:, node % cells] += column
        else:
            kept[:, 0] += 2.0 * below[:, -1]
            kept[:, 1] -= below[:, -1]
            kept[:, -1] += 2.0 * above[:, 0]
            kept[:, -2] -= above[:, 0]
        result.append(kept)
    return result[0], result[1]


def point_offsets(n: int, shift: float = 0.0) -> np.ndarray:
    """Return the places of n points in a cell, in cells."""
    return (np.arange(n) + 0.5) / n + shift


def near_nodes(places: np.ndarray) -> np.ndarray:
    """Return the numbers of the nodes that points may reach, as a column for each point."""
    return np.floor(places)[:, None] + np.arange(-2, 4)


def cell_symbols(
    kh: float, n: int, shift: float = 0.0, basis: str = "linear"
) -> tuple[np.ndarray, np.ndarray]:
    """Return S = sum N_i e^(ik(x_i - x)) and h D = h sum N_i' e^(ik(x_i - x)) of a cell's points.

    Parameters
    ----------
    kh : float
        Wave number times cell size.
    n : int
        Points per cell.
    shift : float
        Offset of the points from the symmetric places, in cells.
    basis : str
        A mapping of the matrix.
    """
    places = point_offsets(n, shift)
    distance = places[:, None] - near_nodes(places)
    values, slopes = node_functions(basis, distance, n)
    phases = np.exp(-1j * kh * distance)
    return np.sum(values * phases, axis=1), np.sum(slopes * phases, axis=1)


def symbols(kh: float, n: int, shift: float = 0.0, basis: str = "linear") -> tuple[float, float]:
    """Return K h^2 and mu of a mode: the means of `cell_symbols` squared."""
    s, d = cell_symbols(kh, n, shift, basis)
    return float(np.mean(np.abs(d) ** 2)), float(np.mean(np.abs(s) ** 2))


def amplification(kh: float, n: int, cfl: float, basis: str = "linear") -> np.ndarray:
    """Return the two eigenvalues of a USL step of FLIP for a mode.

    V is the amplitude of the velocity on the grid, f = dt times that of the acceleration. The
    points receive f and map it back, filtered by mu; the stress changes by the gradient of V + f:
    V' = V + mu f, f' = f - z (V + f) with z = c^2 K dt^2.
    """
    k2, mu = symbols(kh, n, basis=basis)
    z = cfl**2 * k2
    return np.linalg.eigvals(np.array([[1.0, mu], [-z, 1.0 - z]]))


def frequency_ratio(kh: float, n: int, cfl: float, basis: str = "linear") -> float:
    """Return omega_h/omega of the scheme with its time steps."""
    return float(np.max(np.angle(amplification(kh, n, cfl, basis)))) / (cfl * kh)


def series(n: int, shift: float = 0.0, basis: str = "linear") -> tuple[float, float]:
    """Return kappa and a of omega_h/omega = 1 - kappa (kh)^2 and 1 - mu = a (kh)^2.

    With the moments m_j = sum N_i (x_i - x)^j and d_j = h sum N_i' (x_i - x)^j in cells, of which
    m_0 = d_1 = 1 and m_1 = d_0 = 0, the expansions of |S|^2 and |D|^2 in kh give
    a = mean m_2 and kappa = (a + mean d_3/3 - mean d_2^2/4)/2.
    """
    places = point_offsets(n, shift)
    distance = places[:, None] - near_nodes(places)
    values, slopes = node_functions(basis, distance, n)
    second = np.sum(values * distance**2, axis=1)
    d2, d3 = (np.sum(slopes * (-distance) ** j, axis=1) for j in (2, 3))
    a = float(np.mean(second))
    return 0.5 * (a + float(np.mean(d3)) / 3.0 - float(np.mean(d2**2)) / 4.0), a


def stress_constant(n: int, shift: float = 0.0, basis: str = "linear") -> float:
    """Return b of the error b kh, relative to its amplitude, of the stress of a wave at points.

    D = ik(1 + ikh d_2/2 + ...), so that b is the root mean square of d_2/2: 0 for splines, the mean
    distance from the middle of a cell, sqrt((1 - 1/n^2)/12), for linear functions.
    """
    places = point_offsets(n, shift)
    distance = places[:, None] - near_nodes(places)
    d2 = np.sum(node_functions(basis, distance, n)[1] * distance**2, axis=1)
    return 0.5 * float(np.sqrt(np.mean(d2**2)))


def dispersion_constant(n: int, basis: str = "linear") -> float:
    """Return kappa of omega_h/omega = 1 - kappa (kh)^2 for symmetric points.

    Linear functions and averages of them: 1/8 + 1/(24 n^2); quadratic: 1/4 + 1/(24 n^2) for even n
    and 1/4 - 1/(12 n^2) for odd n, of which one point lies where two pieces meet; cubic: 1/3.
    """
    if basis == "cubic":
        return 1.0 / 3.0
    if basis == "quadratic":
        return 1.0 / 4.0 + (1.0 / 24.0 if n % 2 == 0 else -1.0 / 12.0) / n**2
    return 1.0 / 8.0 + 1.0 / (24.0 * n**2)


def filter_constant(n: int, basis: str = "linear") -> float:
    """Return a of 1 - mu = a (kh)^2 for symmetric points.

    Linear functions and averages of them: 1/6 + 1/(12 n^2); quadratic: 1/4; cubic: 1/3.
    """
    if basis in ("quadratic", "cubic"):
        return {"quadratic": 1.0 / 4.0, "cubic": 1.0 / 3.0}[basis]
    return 1.0 / 6.0 + 1.0 / (12.0 * n**2)


def stability_limit(n: int, shift: float = 0.0, basis: str = "linear") -> float:
    """Return the largest stable Courant number of USL in one dimension.

    z = c^2 K dt^2 <= 4/(2 - mu) for every mode.
    """
    limits = []
    for kh in np.linspace(1e-3, np.pi, 2000):
        k2, mu = symbols(kh, n, shift, basis)
        if k2 > 0.0:
            limits.append(np.sqrt(4.0 / ((2.0 - mu) * k2)))
    return float(min(limits))


def crossing_noise(n: int, stretch: float, basis: str = "linear") -> tuple[float, float]:
    """Return the largest and the mean nodal force of a uniform stress over stress and area.

    Points lie F h/n apart, F the stretch, and a cell holds n/F of their spacings, e more or less
    than a whole number. The force at a node is F/n times the second difference, with the step e, of
    a saw tooth that jumps at the points, smoothed over the boxes that make the function of a hat:
    none, 1/F of a spacing (uGIMP), half of that (cpdi), a cell once or twice (splines). Each box
    makes T' = (T(x + b/2) - T(x - b/2))/b, where whole spacings of b do not count. Splines of
    degree p give F/n (e F/n)^(p-1) times the derivative of the spline, e wide instead of h, whose
    largest value is 1, 1, 2/3 and whose square has the integral 2, 1, 2/3.

    Parameters
    ----------
    n : int
        Points per cell before the stretch.
    stretch : float
        F; so close to 1 that the patterns of neighbouring points do not meet.
    basis : str
        A mapping of the matrix.
    """
    f = stretch
    e = abs(n / f - round(n / f))
    if basis == "cpdi":
        b = 0.5 / f
        if e > min(b, 1 - b):
            raise ValueError("the kinks of the smoothed saw tooth meet: choose a smaller strain")
        return f / n * e / b, f / n * e / b * float(np.sqrt(4 * e / 3))
    if basis == "ugimp":
        b = abs(1.0 - 1.0 / f)
        return f / n * b * f, f / n * b * f * float(np.sqrt(2 * e - b))
    degree, peak, square = {
        "linear": (1, 1.0, 2.0),
        "quadratic": (2, 1.0, 1.0),
        "cubic": (3, 2.0 / 3.0, 2.0 / 3.0),
    }[basis]
    scale = f / n * (e * f / n) ** (degree - 1)
    return scale * peak, scale * float(np.sqrt(square * e))


def energy_loss_per_period(kh: float, n: int, cfl: float, basis: str = "linear") -> float:
    """Return the relative loss of energy in a period: 2 pi a CFL (kh)^3."""
    return 2.0 * np.pi * filter_constant(n, basis) * cfl * kh**3
