"""Independently computed instant centres."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.centres import Centres, instant_centres
from tests.analysis.centres.chains import mechanism, name, solved
from tests.support import reference

EXACT = 1e-9
CHAINS = ("ic_single_flier_eightbar", "ic_watt_sixbar")


def entry_of(ident: str) -> dict[str, Any]:
    return reference(ident, "instant_centres")


def centres_of(ident: str) -> Centres:
    joints = entry_of(ident)["dimensions"]["joint_xy"]
    return instant_centres(solved(mechanism({joint: complex(*place) for joint, place in joints.items()})))


@pytest.mark.parametrize("ident", CHAINS)
def test_every_centre_of_the_chain(ident: str) -> None:
    centres = centres_of(ident)
    expected = entry_of(ident)["expected"]["instant_centres"]
    assert len(expected) == len(centres)
    for couple, place in expected.items():
        i, j = couple.split("-")
        found = complex(centres[name(i), name(j)].point)
        assert abs(found - complex(*place)) < EXACT * max(1.0, abs(complex(*place))), couple


@pytest.mark.parametrize("ident", CHAINS)
def test_angular_velocity_ratios(ident: str) -> None:
    velocities = centres_of(ident).velocities
    expected = entry_of(ident)["expected"]["angular_velocity_ratios_rel_to_link0_over_link_max"]
    fastest = next(k for k, ratio in expected.items() if abs(ratio) == 1.0)
    omega = {k: float(velocities.angular_velocity(name(k))) for k in expected}
    assert max(abs(omega[k] / omega[fastest] - ratio) for k, ratio in expected.items()) < EXACT


@pytest.mark.parametrize("ident", CHAINS)
def test_what_crossing_alone_gives(ident: str) -> None:
    closure = entry_of(ident)["expected"]["kennedy_direct_closure"]
    kinds = [step.kind for step in centres_of(ident).derivation()]
    direct = kinds.index("trial") if "trial" in kinds else len(kinds)
    assert direct == closure["known"]
    if "trial" in kinds:
        before = centres_of(ident).derivation()[:direct]
        asked = {frozenset(map(name, couple.split("-"))) for couple in closure["pairs"]}
        assert {frozenset(step.centre) for step in before} == asked


def test_slider_crank() -> None:
    entry = entry_of("ic_slider_crank")
    r, length, theta = (entry["dimensions"][k] for k in ("r", "l", "theta"))
    slider_crank = ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(r, 0)),
        ck.link("rod", A=(0, 0), B=(length, 0)),
        ck.link("slider", B=(0, 0)),
        ck.slide("slider", on="frame", at="B", through="O", angle=0),
        ck.drive("crank"),
        ck.drawn(A=ck.polar(r, theta), B=(6.0, 0.0)),
    )
    centres = instant_centres(ck.solve(slider_crank, {"crank": theta}))
    names = ("frame", "crank", "rod", "slider")
    for couple, place in entry["expected"].items():
        i, j = (int(k) for k in couple.split("-"))
        centre = centres[names[i], names[j]]
        if isinstance(place, str):
            assert centre.at_infinity
            assert np.isinf(centre.point)
            assert abs(complex(centre.direction).real) < EXACT
        else:
            assert not centre.at_infinity
            assert abs(complex(centre.point) - complex(*place)) < EXACT
