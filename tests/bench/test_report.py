"""Tables and comparisons."""

from __future__ import annotations

from pathlib import Path

from bench.instructions import compare_counts, read_record, write_record
from bench.report import HEADER, comparison, document, line, materials, speedups, targets


def row(scene: str, threads: int, median: float, points: int = 250_000) -> dict:
    """Return a row of the suite."""
    return {
        "scene": scene,
        "points": points,
        "threads": threads,
        "ns_per_point_and_step": {"median": median, "min": 0.9 * median, "max": 1.1 * median},
        "set_up_s": 0.25,
        "bytes_per_point": 300.0,
        "stated_bytes_per_point": 172.0,
        "frames_share": 0.05,
        "binary_share": 0.01,
        "phases": {},
    }


def test_a_line_fits_its_header() -> None:
    """Columns end where those of the header do."""
    text = line(row("3d-linear", 1, 55.0))
    assert len(text) == len(HEADER)
    assert text.split()[:4] == ["3d-linear", "250000", "1", "55.0"]


def test_speedup_is_that_of_the_same_scene_and_size() -> None:
    """Rows without a partner on one thread are left out."""
    rows = [row("a", 1, 60.0), row("a", 2, 30.0), row("a", 2, 20.0, 10), row("b", 2, 20.0)]
    assert speedups(rows) == [
        f"{'a':20}{250_000:>9}: 2 threads 2.00 times as fast as one",
    ]


def test_materials_are_compared_with_the_elastic_one() -> None:
    """Only in scenes of the same motion, on the same threads."""
    rows = [row("3d-elastic", 1, 80.0), row("3d-sand", 1, 120.0), row("3d-sand", 2, 60.0)]
    rows += [row("3d-linear", 1, 70.0)]
    rows[1]["phases"] = {"material": 0.25}
    assert [text.split()[:4] for text in materials(rows)[1:]] == [
        ["3d-sand", "250000", "1", "1.50"]
    ]
    assert "material 30.0 ns" in materials(rows)[1]


def test_targets_scale_with_the_kernel() -> None:
    """A machine of half the speed may take twice as long."""
    reference = {"kernel_ns": 120.0, "triad_gb_per_s": 16.0, "bytes_per_point": 320.0}
    reference |= {"p2g_ns": 50.0, "nodes_ns": 10.0, "g2p_ns": 60.0}
    rows = [row("3d-linear", 1, 60.0), row("3d-linear", 2, 30.0), row("plane-contact", 1, 30.0)]
    head, _, _, *lines = targets(rows, reference)
    assert "320 bytes take 20.0 ns" in head
    assert [text.split() for text in lines] == [
        ["3d-linear", "60.0", "60", "120.0", "120.0", "0.50", "0.50", "3.0"]
    ]
    # What ran beside the measurements counts, where there is such.
    rows[0] |= {"kernel_ns": {"median": 90.0}, "kernels": {"median": 0.75}}
    assert targets(rows, reference)[-1].split() == [
        "3d-linear",
        "60.0",
        "60",
        "90.0",
        "90.0",
        "0.75",
        "0.75",
        "3.0",
    ]


def test_comparison_has_the_rows_of_both() -> None:
    """The ratio is that of the medians."""
    rows = comparison([row("a", 1, 30.0), row("b", 1, 1.0)], [row("a", 1, 60.0)])
    assert [text.split()[-3:] for text in rows[1:]] == [["60.0", "30.0", "0.50"]]


def test_counts_that_grow_are_named(tmp_path: Path) -> None:
    """A growth by less than a tenth passes, one by more and a missing record do not."""
    path = tmp_path / "record.json"
    write_record(path, {"a": 100.0, "b": 100.0}, "mpm3d 1", "the first")
    record = read_record(path)
    assert compare_counts({"a": 109.0, "b": 50.0}, record) == []
    grown = compare_counts({"a": 111.0, "c": 1.0}, record)
    assert [text.split(":")[0] for text in grown] == ["a", "c"]
    assert "the first" in path.read_text()


def test_a_page_takes_a_table_again_and_again() -> None:
    """What stood between the marks goes, the rest of the page stays."""
    page = "before\n<!-- measured -->\nold\n<!-- end -->\nafter\n"
    once = document(page, ["a", "b"])
    assert once == "before\n<!-- measured -->\n```\na\nb\n```\n<!-- end -->\nafter\n"
    assert document(once, ["a", "b"]) == once
