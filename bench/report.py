"""Tables of what was measured."""

from __future__ import annotations

from typing import Any

from bench.scenes import SCENE

Row = dict[str, Any]

#: Targets per point and step at 250,000 points on one thread, on a machine whose bare kernel needs
#: `KERNEL`. [ns]
TARGETS = {
    "3d-linear": 60.0,
    "3d-cpdi": 125.0,
    "3d-ugimp": 125.0,
    "3d-quadratic": 125.0,
    "3d-cubic": 350.0,
    "plane-linear": 25.0,
    "1d-linear": 12.0,
}
#: Time of the bare kernel to which the targets belong. [ns]
KERNEL = 60.0
#: Points of the rows to which the targets belong.
TARGET_POINTS = range(200_000, 300_000)

HEADER = (
    f"{'scene':20}{'points':>9}{'thr':>4}{'ns/point/step':>14}  {'(min .. max)':17}"
    f"{'set-up s':>9}{'B/point':>8}{'stated':>7}{'frames':>8}"
    f"{'binary':>8}"
)


def line(row: Row) -> str:
    """Return a row of the table."""
    cost = row["ns_per_point_and_step"]
    scatter = f"({cost['min']:.1f} .. {cost['max']:.1f})"
    return (
        f"{row['scene']:20}{row['points']:>9}{row['threads']:>4}{cost['median']:>14.1f}  "
        f"{scatter:17}{row['set_up_s']:>9.2f}{row['bytes_per_point']:>8.0f}"
        f"{row['stated_bytes_per_point']:>7.0f}{100 * row['frames_share']:>7.1f}%"
        f"{100 * row['binary_share']:>7.1f}%"
    )


def phase_line(row: Row) -> str:
    """Return the shares of the phases."""
    shares = (f"{name} {100 * share:.0f} %" for name, share in row["phases"].items())
    return "    " + ", ".join(shares)


def key(row: Row) -> tuple[str, int, int]:
    """Return what makes rows of two runs comparable."""
    return row["scene"], row["points"], row["threads"]


def targets(rows: list[Row], reference: dict[str, float]) -> list[str]:
    """Compare the rows with the targets, scaled by the bare kernel."""
    kernel = reference["kernel_ns"]
    roofline = reference["bytes_per_point"] / reference["triad_gb_per_s"]
    lines = [
        f"bare kernel {kernel:.1f} ns, triad {reference['triad_gb_per_s']:.1f} GB/s: "
        f"{reference['bytes_per_point']:.0f} bytes take {roofline:.1f} ns",
        f"parts of the kernel: P2G {reference['p2g_ns']:.1f}, nodes {reference['nodes_ns']:.1f}, "
        f"G2P with motion and stress {reference['g2p_ns']:.1f} ns",
        f"{'scene':20}{'ns':>8}{'target':>8}{'kernel':>8}{'scaled':>8}{'of it':>7}{'/kernel':>9}"
        f"{'/roofline':>11}",
    ]
    for row in filter(has_target, rows):
        cost, target = row["ns_per_point_and_step"]["median"], TARGETS[row["scene"]]
        beside = row.get("kernel_ns", {"median": kernel})["median"]
        ratio = row.get("kernels", {"median": cost / kernel})["median"]
        lines.append(
            f"{row['scene']:20}{cost:>8.1f}{target:>8.0f}{beside:>8.1f}"
            f"{target * beside / KERNEL:>8.1f}{ratio * KERNEL / target:>7.2f}{ratio:>9.2f}"
            f"{cost / roofline:>11.1f}"
        )
    return lines


def has_target(row: Row) -> bool:
    """Return whether a row is one of those that the targets are for."""
    return belongs(row["scene"], row["points"], row["threads"])


def belongs(scene: str, points: int, threads: int) -> bool:
    """Return whether a measurement is one of those that the targets are for."""
    return scene in TARGETS and threads == 1 and points in TARGET_POINTS


def speedups(rows: list[Row]) -> list[str]:
    """Time on one thread over that on several."""
    single = {key(row)[:2]: row for row in rows if row["threads"] == 1}
    lines = []
    for row in rows:
        if row["threads"] == 1 or key(row)[:2] not in single:
            continue
        one = single[key(row)[:2]]["ns_per_point_and_step"]["median"]
        many = row["ns_per_point_and_step"]["median"]
        lines.append(
            f"{row['scene']:20}{row['points']:>9}: {row['threads']} threads {one / many:.2f} "
            f"times as fast as one"
        )
    return lines


def materials(rows: list[Row]) -> list[str]:
    """Time with each material over that with the elastic one, in the same motion."""
    elastic = {key(row)[1:]: row for row in rows if row["scene"] == "3d-elastic"}
    lines = []
    for row in rows:
        scene = SCENE.get(row["scene"])
        if scene is None or not scene.sheared or key(row)[1:] not in elastic:
            continue
        base = elastic[key(row)[1:]]["ns_per_point_and_step"]["median"]
        cost = row["ns_per_point_and_step"]["median"]
        share = row["phases"].get("material", 0.0)
        lines.append(
            f"{row['scene']:20}{row['points']:>9}{row['threads']:>4}{cost / base:>7.2f} times the "
            f"elastic one, material {share * cost:.1f} ns"
        )
    return lines


def comparison(rows: list[Row], earlier: list[Row]) -> list[str]:
    """Time of each row over that of an earlier run."""
    before = {key(row): row for row in earlier}
    lines = [f"{'scene':20}{'points':>9}{'thr':>4}{'before':>9}{'now':>9}{'ratio':>7}"]
    for row in rows:
        if key(row) not in before:
            continue
        old = before[key(row)]["ns_per_point_and_step"]["median"]
        new = row["ns_per_point_and_step"]["median"]
        lines.append(
            f"{row['scene']:20}{row['points']:>9}{row['threads']:>4}{old:>9.1f}{new:>9.1f}"
            f"{new / old:>7.2f}"
        )
    return lines


def document(page: str, lines: list[str]) -> str:
    """Put a table between the marks of a page."""
    head, rest = page.split("<!-- measured -->\n", 1)
    _, tail = rest.split("<!-- end -->", 1)
    table = "\n".join(lines)
    return f"{head}<!-- measured -->\n```\n{table}\n```\n<!-- end -->{tail}"
