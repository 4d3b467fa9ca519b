"""What objects print: their names and numbers in a line, never their arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.cam_analysis import cam_analysis
from compoundkin.analysis.centres import instant_centres
from compoundkin.analysis.checks import verify
from compoundkin.analysis.coupler import centrodes, inflection_circle, path_curvature, pole, stationary_curvature
from compoundkin.analysis.mechanical_advantage import mechanical_advantage
from compoundkin.base.display import short_repr
from compoundkin.model.elements import drawn, drive, link
from compoundkin.model.laws import time_table
from compoundkin.structure import decompose
from compoundkin.synthesis.alternatives import alternatives
from compoundkin.synthesis.chains import assur_group, chains, structure_name
from tests import catalog

MADE: dict[str, Callable[[], Any]] = {
    "link": lambda: link("bar", **{letter: (k, 0) for k, letter in enumerate("ABCDEFGHI")}),
    "drive": lambda: drive("crank", values=np.linspace(0.0, 6.0, 720)),
    "drawn": lambda: drawn(**{letter: (k, 0) for k, letter in enumerate("ABCDEFGHI")}),
    "law": lambda: time_table(np.arange(400.0), np.arange(400.0)),
    "group": lambda: catalog.structure("six-bar").groups[0],
    "centres": lambda: instant_centres(catalog.motion("crank-rocker")),
    "centre": lambda: instant_centres(catalog.motion("crank-rocker"))["frame", "coupler"],
    "check": lambda: verify(catalog.motion("crank-rocker")),
    "velocity check": lambda: instant_centres(catalog.motion("crank-rocker")).velocity_check(),
    "alternative": lambda: alternatives(catalog.structure("six-bar"))[0],
    "chain": lambda: chains(10)[100],
    "group of the atlas": lambda: assur_group("triad"),
    "chain name": lambda: structure_name(catalog.structure("stephenson-iii")),
    "pole": lambda: pole(catalog.motion("crank-rocker"), "coupler"),
    "centrodes": lambda: centrodes(catalog.motion("crank-rocker"), "coupler"),
    "circle": lambda: inflection_circle(catalog.motion("crank-rocker"), "coupler"),
    "curvature": lambda: path_curvature(catalog.motion("crank-rocker"), "coupler", "B"),
    "cubic": lambda: stationary_curvature(ck.solve(catalog.mechanism("crank-rocker"), order=3), "coupler"),
    "advantage": lambda: mechanical_advantage(catalog.motion("crank-rocker"), "crank", "rocker"),
    "cam": lambda: cam_analysis(catalog.motion("disc-cam-roller-program"), "follower/cam"),
}


@pytest.mark.parametrize("what", MADE)
def test_a_repr_is_short_and_holds_no_array(what: str) -> None:
    printed = repr(MADE[what]())
    assert len(printed) < 500
    assert "array([" not in printed
    assert "object at" not in printed


def test_what_it_prints_is_useful() -> None:
    assert repr(MADE["group"]()) == "Group('RRR': plate, rocker on crank, frame)"
    assert repr(MADE["check"]()).endswith("passed)")
    assert repr(chains(4)[0]) == "Chain(4 links, 4 pairs, mobility 1, 'C]')"
    assert repr(MADE["drive"]()).startswith("Drive(name='crank', link='crank'")


def test_a_check_that_fails_names_what_failed() -> None:
    from compoundkin.analysis.checks import Check, Finding

    assert (
        repr(Check((Finding("closure", 1.0, 1e-9, "A", ()),), 3, 0)) == "Check(1 findings at 3 poses, failed: closure)"
    )


def test_long_tuples_and_mappings_are_counted() -> None:
    assert short_repr(tuple(range(9))) == "9 values"
    assert short_repr({str(k): k for k in range(9)}) == "9 entries"
    assert short_repr({"a": np.zeros(3)}) == "{a: array (3,)}"


def test_a_group_of_many_links_prints_some() -> None:
    names = [f"k{k}" for k in range(12)]
    bars = [link(n, **{f"P{k}": (k, 0), f"P{k + 1}": (k + 1, 0.3)}) for k, n in enumerate(names)]
    frame = link("frame", P0=(0, 0), P12=(12, 0))
    chain = decompose(ck.Mechanism("Loop", frame, *bars))
    assert len(repr(chain.groups)) < 200
