"""Clearance of outlines as a constraint: its numbers are those of interference, its slopes those of differences."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.studies.goals.clearance_constraint import clearance
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.goal import DesignConstraint
from compoundkin.studies.responses import studied_path

BARE = ck.Mechanism(
    "Crank-rocker",
    ck.link("frame", A=(0, 0), D=(60, 0)),
    ck.link("crank", A=(0, 0), B=(25, 0)),
    ck.link("coupler", B=(0, 0), C=(55, 0), E=(30, 22)),
    ck.link("rocker", D=(0, 0), C=(45, 0)),
    ck.drive("crank"),
)
FULL = BARE.replace(
    ck.outline("crank", 6),
    ck.outline("rocker", 8),
    ck.outline("coupler", 6, layer=1),
    ck.outline("coupler", polygon=["E", (40, 30), (20, 30)], layer=1),
    ck.outline("frame", at=(30, 95), radius=4, layer=1),
    ck.outline("frame", polygon=["A", (-20, -40), (80, -40)], layer=0),
)
TURN = ck.deg(range(0, 360, 10))
FREE: dict[str, complex] = {"crank.B.x": 25.0, "coupler.B": 0.3 + 0.2j, "frame.D.x": 60.0, "coupler.E": 30 + 22j}


def trial(asked: DesignConstraint, dimensions: Mapping[str, Number]) -> DesignTrial:
    names = asked.outputs(ck.solve(FULL, TURN))
    studied, responses = studied_path(FULL, list(dimensions), names, TURN)
    return DesignTrial(studied.designs(dimensions), {one.name: one for one in responses}, np.empty((1, 0)))


def test_slopes_are_those_of_differences() -> None:
    asked, step = clearance(2.0), 1e-5
    names = [one for name in FREE for one in ((name,) if name.endswith(".x") else (f"{name}.x", f"{name}.y"))]
    # the mechanism as it stands, then each coordinate ahead and behind
    steps = step * np.concatenate([np.zeros((1, len(names))), np.eye(len(names)), -np.eye(len(names))])
    columns = dict(zip(names, steps.T, strict=True))
    dimensions = {name: value + columns.get(name, columns.get(f"{name}.x", 0.0) + 1j * columns.get(f"{name}.y", 0.0))
                  for name, value in FREE.items()}  # fmt: skip
    every = trial(asked, dimensions)
    assert list(every.coordinates) == names
    margins = asked.margins(every)
    differences = (margins[1 : 1 + len(names)] - margins[1 + len(names) :]) / (2.0 * step)
    assert np.abs(asked.slopes(every)[0] - differences.T).max() < 1e-6


def test_margins_are_those_of_interference() -> None:
    asked = clearance(1.5)
    own = {name: np.array([value]) for name, value in {**FREE, "coupler.B": 0j}.items()}
    margins = asked.margins(trial(asked, own))[0]
    told = {(one.one, one.other): one.clearance for one in ck.interference(ck.solve(FULL, TURN)).clearances}
    # between the poses it is less by what ten degrees may hide
    assert sorted(margins) == pytest.approx(sorted(value - 1.5 for value in told.values()), abs=0.3)
    assert (np.sort(margins) >= np.sort([value - 1.5 for value in told.values()]) - 1e-9).all()


def test_a_crank_is_made_as_long_as_a_stop_lets_it_be() -> None:
    """The longest crank that keeps 1 clear of a disc in its way: distance less radius, half width and the gap."""
    crank = ck.Mechanism("Crank", ck.link("frame", A=0), ck.link("crank", A=0, B=5), ck.drive("crank"))
    stopped = crank.replace(ck.outline("crank", 2), ck.outline("frame", at=(0, 12), radius=1))
    found = ck.optimise(
        stopped, {"crank.B.x": (3.0, 20.0)}, ck.goals.greatest("B.x.greatest"),
        ck.goals.clearance(1.0, "crank"), values=ck.deg(range(0, 361, 30)), starts=1,
    )  # fmt: skip
    assert complex(found.mechanism.links["crank"].points["B"]).real == pytest.approx(12.0 - 1.0 - 1.0 - 1.0, abs=1e-6)
    assert found.mechanism.outlines["crank"].width == 2.0
    least = ck.interference(ck.solve(found.mechanism)).least
    assert least is not None
    assert least.clearance == pytest.approx(1.0, abs=1e-6)


def test_what_cannot_be_asked_is_told() -> None:
    motion = ck.solve(FULL, TURN)
    with pytest.raises(ck.errors.InvalidInput, match="is no clearance"):
        clearance(-1.0)
    with pytest.raises(ck.errors.UnknownName, match="no outline of it is compared"):
        clearance(1.0, "crnk").outputs(motion)
    with pytest.raises(ck.errors.InvalidInput, match="no two links with outlines share a layer"):
        clearance(1.0).outputs(ck.solve(BARE, TURN))
