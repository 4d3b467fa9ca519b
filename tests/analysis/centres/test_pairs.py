"""The contract of `Pair.centre`, for every kind; and centres of links joined by pairs that give a line only."""

from __future__ import annotations

import numpy as np
import pytest

from compoundkin.analysis.centres.circle_diagram import Diagram, DrivenCentre, Primary
from compoundkin.analysis.centres.derivation import derive
from compoundkin.analysis.centres.evaluation import Evaluation
from compoundkin.analysis.centres.homogeneous import dot, sine_between
from compoundkin.analysis.centres.known_centres import null_twists
from compoundkin.model.pairs import KINDS, Pair
from compoundkin.model.pairs.contract import Line, Point
from tests.support import random_pose, sample

POSES = 50


@pytest.mark.parametrize("kind", KINDS.values(), ids=[kind.code for kind in KINDS.values()])
def test_the_pair_allows_the_motion_about_its_centre(kind: type[Pair]) -> None:
    """A twist of the second member about the centre breaks nothing; a point has the free coordinate's rate."""
    rng = np.random.default_rng(3)
    pair, carrier = sample(kind), random_pose(rng, 0, ())
    world = pair.generic(rng)
    ends = tuple(carrier.inverse().carry(end) for end in world)
    centre = pair.centre(ends, (carrier, carrier))  # type: ignore[arg-type]
    if len(ends) > 2:  # with a carrier: tests/model/pairs/test_contract.py
        return
    matrix = pair.jacobian(ends, (carrier, carrier))  # type: ignore[arg-type]
    for x, y, w in _twists(centre):
        velocity = 1j * (w * complex(carrier.z.c[0]) - (x + 1j * y))
        rates = matrix @ [0.0, 0.0, 0.0, velocity.real, velocity.imag, w]
        assert np.allclose(rates[: pair.held], 0.0, atol=1e-12)
        if isinstance(centre, Point):
            assert np.allclose(rates[pair.held :], 1.0)


def _twists(centre: Point | Line) -> list[tuple[float, float, float]]:
    if isinstance(centre, Point):
        return [tuple(float(v) for v in centre)]  # type: ignore[list-item]
    a, b, c = (float(v) for v in centre)
    return [(-b, a, 0.0), (-a * c, -b * c, a * a + b * b)]


def units(diagram: Diagram) -> list[np.ndarray]:
    rng = np.random.default_rng(4)
    vectors = rng.standard_normal((len(diagram.primaries), 3, POSES))
    for vector, primary in zip(vectors, diagram.primaries, strict=True):
        if primary.kind == "ideal":
            vector[2] = 0.0
    return [v / np.sqrt((v * v).sum(axis=0)) for v in vectors]


def confirmed(diagram: Diagram) -> Evaluation:
    places = units(diagram)
    found = Evaluation(derive(diagram), places, [np.ones(1)] * len(diagram.drives))
    found.run(None)
    twists, gap = null_twists(diagram, places, [np.ones(1)] * len(diagram.drives))
    for (i, j), point in found.points.items():
        firm = (gap > 1e-3) & (found.spread[i, j] < 1e4)
        assert firm.mean() > 0.6
        assert np.max(sine_between(point, twists[j] - twists[i]), where=firm, initial=0.0) < 1e-9
    return found


def test_pin_in_slot() -> None:
    """A crank whose pin runs in the slot of a lever: their centre is on the slot's normal and on the frame's line."""
    diagram = Diagram(
        ("frame", "crank", "lever"),
        (
            Primary("pin O", "O", (0, 1), "point"),
            Primary("pin Q", "Q", (0, 2), "point"),
            Primary("slot", "slot", (1, 2), "line"),
        ),
        (DrivenCentre("crank", 0, 1, 0, 1),),
    )
    step = derive(diagram).steps[-1]
    assert step.text == "line (slot) x line (crank frame)(frame lever)"
    assert step.lines == (("(slot)",), ("(crank frame)", "(frame lever)"))
    found = confirmed(diagram)
    assert np.abs(dot(found.points[1, 2], units(diagram)[2])).max() < 1e-12


def test_two_slots_between_two_links() -> None:
    """The centre of a plate that two pins of the frame guide in its slots is where their normals cross."""
    diagram = Diagram(
        ("frame", "plate"),
        (Primary("slot a", "a", (0, 1), "line"), Primary("slot b", "b", (0, 1), "line")),
        (),
    )
    with pytest.raises(Exception, match="too few drivers"):
        derive(diagram)
    driven = Diagram(
        ("frame", "plate", "crank"),
        (*diagram.primaries, Primary("pin A", "A", (0, 2), "point"), Primary("slot c", "c", (1, 2), "line")),
        (DrivenCentre("crank", 0, 2, 2, 1),),
    )
    assert derive(driven).steps[1].text == "line (slot a) x line (slot b)"
    confirmed(driven)


def test_three_links_on_one_pin_give_one_line_only() -> None:
    """Lines that coincide for the graph's own reasons are never crossed with each other."""
    names = ("frame", "crank", "one", "two", "left", "right")
    pins = [("A", (0, 1)), ("B", (1, 2, 3)), ("C", (2, 4)), ("D", (0, 4)), ("E", (3, 5)), ("F", (0, 5))]
    primaries = tuple(Primary(f"pin {letter}", letter, links, "point") for letter, links in pins)
    diagram = Diagram(names, primaries, (DrivenCentre("crank", 0, 1, 0, 1),))
    steps = derive(diagram).steps
    assert len(steps) == 15
    assert [step.kind for step in steps].count("primary") == 8
    confirmed(diagram)


def test_a_driver_between_two_links_of_a_multiple_pin() -> None:
    names = ("frame", "crank", "one", "two", "left", "right")
    pins = [("A", (0, 1)), ("B", (1, 2, 3)), ("C", (2, 4)), ("D", (0, 4)), ("E", (3, 5)), ("F", (0, 5))]
    primaries = tuple(Primary(f"pin {letter}", letter, links, "point") for letter, links in pins)
    confirmed(Diagram(names, primaries, (DrivenCentre("elbow", 2, 3, 1, 1),)))
