"""Whatever the public functions return says in a line or a few what it is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog
from tests.test_architecture import only_shrinks

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
LINES, CHARACTERS = 5, 600


def answers(name: str) -> Iterator[tuple[str, Any]]:
    """What the functions return for a mechanism, by their names."""
    mechanism, motion = catalog.mechanism(name), ck.solve(catalog.mechanism(name), order=3)
    link, driver = list(motion.links)[-1], next(iter(motion.drives))
    yield from {"Mechanism": mechanism, "solve": motion, "report": catalog.report_of(name)}.items()
    for word in ("decompose", "mobility_analysis", "loop_equations", "configurations", "circuits", "alternatives"):
        yield word, getattr(ck, word)(mechanism)
    for word in ("gaps", "verify", "instant_centres", "draw", "animate", "page", "characteristics"):
        yield word, getattr(ck, word)(motion)
    yield "plot", ck.plot(motion, f"{link}.angle")
    units = {"length": "mm", "mass": "kg", "force": "N"}
    weight = ck.mass(link, 0.1, at=mechanism.links[link].letters[0])
    weighed = mechanism.replace(weight, ck.gravity(0, -9.81), unit="", units=units)
    forces = ck.force_analysis(ck.solve(weighed))
    yield from {"force_analysis": forces, "on": forces.on(link), "shaking": forces.shaking, "pins": forces.pins}.items()
    yield "power", forces.power
    yield "quantity", ck.quantity(motion, f"{link}.angle")
    yield "table", motion.table()
    for word in ("pole", "centrodes", "canonical_frame", "inflection_circle", "stationary_curvature", "relative_link"):
        yield f"coupler.{word}", getattr(ck.figures, word)(motion, link)
    for word in ("path_curvature", "relative_point"):
        yield f"coupler.{word}", getattr(ck.figures, word)(motion, link, 0j)
    places = [ck.figures.link_position(motion, link, k) for k in range(3)]
    yield "coupler.pole_triangle", ck.figures.pole_triangle(*places)
    yield "dyads.rrr", ck.equations.rrr((0, 0), (6, 0), 5.0, [5.0, 4.0])
    yield "advantage", ck.figures.mechanical_advantage(motion, driver, driver)
    yield "equivalents", ck.figures.equivalent_linkage(motion)
    yield "chains", ck.chains.structure_name(ck.decompose(mechanism))
    for pair in ck.profiles.cam_pairs(motion):
        yield "cams", ck.figures.cam_analysis(motion, pair)


def is_ours(thing: Any) -> bool:
    """Arrays are NumPy's, also those with a member more."""
    return type(thing).__module__.startswith("compoundkin") and not isinstance(thing, np.ndarray)


def things(where: str, found: Any) -> Iterator[tuple[str, Any]]:
    """The objects of compoundkin in an answer: itself, or the first of many."""
    many = found.values() if isinstance(found, Mapping) else found if isinstance(found, tuple | list) else ()
    yield from ((f"{where}[{k}]", one) for k, one in enumerate(islice(many, 2)) if is_ours(one))
    if is_ours(found):
        yield where, found


def attributes(thing: Any) -> Iterator[tuple[str, Any]]:
    """What can be asked of an object without a call, but what it refuses."""
    for name in dir(thing):
        if not name.startswith("_"):
            try:
                found = getattr(thing, name)
            except ck.errors.CompoundkinError:
                continue
            if not callable(found):
                yield name, found


def problems(thing: Any) -> Iterator[str]:
    text = repr(thing)
    if type(thing).__name__.strip("_") not in text:
        yield "does not name itself"
    if "object at 0x" in text:
        yield "an address"
    if len(text) > CHARACTERS or len(text.splitlines()) > LINES:
        yield f"{len(text)} characters in {len(text.splitlines())} lines"


@pytest.mark.parametrize("name", ["six-bar", "disc-cam-offset-roller", "planetary-train"])
def test_what_is_returned_says_in_short_what_it_is(name: str) -> None:
    """And so does what can be asked of it."""
    first = [thing for where, found in answers(name) for thing in things(where, found)]
    second = [t for where, one in first for word, found in attributes(one) for t in things(f"{where}.{word}", found)]
    assert len(first) > 25
    assert len(second) > 80
    only_shrinks(f"{where}: {type(one).__name__}, {told}" for where, one in (*first, *second) for told in problems(one))


def test_names_are_in_what_is_said() -> None:
    motion = catalog.motion("six-bar")
    assert repr(motion.points["B"]) == "PointMotion(B: (73,) poses to order 2)"
    assert repr(motion.links["bar"]) == "LinkMotion(bar: (73,) poses to order 2)"
    assert repr(motion.drives["crank"]) == "PairMotion(angle: (73,) poses to order 2)"
    assert repr(motion.links) == "Named(link: frame, crank, plate, rocker, bar, block)"
    assert repr(ck.verify(motion)) == "Check(15 findings at 73 poses, passed)"
    equations = ck.loop_equations(motion.mechanism)
    assert repr(equations) == "LoopEquations('Six-bar of Example 3-4': 2 loops, 6 equations, 6 unknowns)"
