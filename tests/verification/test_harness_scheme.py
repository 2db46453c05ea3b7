"""Schemes: what the options of a row choose, and the sections that follow."""

from __future__ import annotations

import pytest
from harness.scheme import Scheme


def test_default_is_usl_with_flip() -> None:
    """No option, no label, no entry but the flags."""
    scheme = Scheme.of({"nu": "0.3"})
    assert scheme == Scheme()
    assert scheme.label == ""
    section = scheme.solver_section(averaged=True, implicit=False)
    assert section.splitlines()[2:4] == [
        '    class = "ExplicitUSL"',
        "    int-properties = {cpdi = 1, contact = 0}",
    ]


@pytest.mark.parametrize(
    ("options", "label", "entry"),
    [
        ({"solver": "MUSL"}, "MUSL", 'class = "ExplicitMUSL"'),
        ({"transfer": "PIC"}, "PIC", 'transfer = "PIC"'),
        ({"solver": "USF", "transfer": "XPIC", "xpic": "4"}, "USF XPIC(4)", "xpic_order = 4"),
        ({"flip": "0.95"}, "0.95 FLIP", "flip = 0.95"),
        ({"smoothing": "cells"}, "smoothed (cells)", '"USE_ZHANG_CELLS"'),
        ({"staggered": "yes"}, "staggered", "staggered = 1"),
    ],
)
def test_options_reach_label_and_section(options: dict[str, str], label: str, entry: str) -> None:
    """Each option shows in both."""
    scheme = Scheme.of(options)
    assert scheme.label == label
    assert entry in scheme.solver_section(averaged=False, implicit=True)


def test_objective_rate_belongs_to_the_material() -> None:
    """It is in the label, and not in the section of the solver."""
    scheme = Scheme.of({"rate": "hughes_winget"})
    assert scheme.label == "hughes-winget"
    assert "hughes" not in scheme.solver_section(averaged=False, implicit=True)


def test_domains_belong_to_the_points() -> None:
    """They replace the points' class, and the boxes of the mapping in names."""
    scheme = Scheme.of({"domains": "cpdi"})
    assert scheme.label == "cpdi domains"
    assert "point-int-props = {3}" in scheme.points_class
    assert scheme.functions("ugimp") == "cpdi domains"
    assert Scheme().functions("ugimp") == "ugimp"


@pytest.mark.parametrize(
    "options",
    [
        {"domains": "cpdi3"},
        {"solver": "RK4"},
        {"transfer": "GIC"},
        {"smoothing": "nodes"},
        {"rate": "truesdell"},
    ],
)
def test_what_the_program_lacks_is_refused(options: dict[str, str]) -> None:
    """The message has the value that is wrong."""
    with pytest.raises(ValueError, match=next(iter(options.values()))):
        Scheme.of(options)


def test_smoothing_has_a_solver_of_its_own() -> None:
    """It goes with USL and FLIP only."""
    with pytest.raises(ValueError, match="smoothing"):
        Scheme.of({"smoothing": "cells", "solver": "MUSL"})
