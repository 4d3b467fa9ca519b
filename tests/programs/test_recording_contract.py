"""Every way of solving a group and every kind of pair is recorded, and equals `solve`, from the day it arrives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.kinematics.curve.change_points import NEAR
from compoundkin.kinematics.groups import SOLVERS
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import owner_of, quantity
from compoundkin.model.attributes import (
    CORIOLIS,
    PRESSURE_ANGLE,
    TRANSMISSION_ANGLE,
    TRANSMISSION_INDEX,
    VELOCITY_RATIO,
)
from compoundkin.model.pairs import KINDS
from compoundkin.programs.backends import runner_of
from compoundkin.programs.graph.flat_program import BY_BOTH, FlatProgram, flat_program
from compoundkin.programs.graph.operation_graph import DRIVE, SEED
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism, Recording, record_mechanism
from compoundkin.programs.recording.recorded_motion import output_of, record_outputs
from compoundkin.programs.solved_designs import seed_values
from tests.catalog import NAMES, motion

EXACT = 1e-12
POINTS = ("position", "velocity", "acceleration")
LINKS = ("angle", "angular_velocity", "angular_acceleration")
FIGURES = (TRANSMISSION_ANGLE, TRANSMISSION_INDEX, VELOCITY_RATIO, CORIOLIS, PRESSURE_ANGLE)


def on_arc() -> ck.Mechanism:
    """A four-bar whose rocker is a slot about D."""
    return ck.Mechanism(
        "Arc",
        ck.link("frame", A=0, D=(4, 0)),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=4, P=(1, 2)),
        ck.arc("coupler", on="frame", at="C", centre_at="D", radius=3),
        ck.drive("crank"),
        ck.drawn(A=0, B=(1, 0), C=(4, 2.6)),
    )


def on_turntable() -> ck.Mechanism:
    """A wheel on a circle that turns, and two drivers, one on the other's link."""
    return ck.Mechanism(
        "Turntable",
        ck.link("frame", O=0),
        ck.link("table", O=0, T=(5, 0)),
        ck.link("wheel", C=0, P=(1, 0)),
        ck.roll_around("wheel", on="table", centre_at="O", at="C", circle=3, radius=1.5),
        ck.drive("table", values=np.linspace(0, 19.5, 9)),
        ck.drive("wheel", on="table", values=np.linspace(0, -12, 9)),
    )


def motions() -> Iterator[Motion]:
    yield from (motion(name) for name in NAMES)
    yield ck.solve(on_arc(), speed=2.0)
    yield ck.solve(on_turntable(), speed={"table": 2, "wheel": 1})


def recording_of(found: Motion) -> RecordedMechanism:
    """A motion's mechanism recorded; signs that change on the way are seeds."""
    signs = {s.index: found.sign(s.index, 0) for s in found.solving_order.solvers
             if not s.is_numbered and s.index not in found.change_points}  # fmt: skip
    return record_mechanism(Recording(found.solving_order, signs))


def numbers_of(flat: FlatProgram, found: Motion) -> Iterator[Number]:
    """What a program is given at every pose of a motion."""
    wanted = [given for k in flat.inputs if (given := flat.graph.nodes[k].given)]
    seeds = seed_values([one for one in wanted if one.kind == SEED], found)
    for one in wanted:
        own = found.inputs.drives[one.name][int(one.part)] if one.kind == DRIVE else seeds[one]
        yield np.broadcast_to(np.asarray(own, float), found.failed.shape)


def values_of(mechanism: RecordedMechanism, found: Motion, names: list[str]) -> list[Number]:
    """What a program finds: the outputs of these names, then which group failed, and the least margin."""
    limits, outputs = RecordedLimits(mechanism), record_outputs(mechanism, [output_of(found, n) for n in names])
    nodes = [one.part(k) for one in (*outputs, limits.failed, limits.certain) for k in (0, 1)]
    graph, shape = mechanism.graph, found.failed.shape
    flat = flat_program(graph, nodes, {node.given: BY_BOTH for node in graph.nodes if node.given})
    arrays = [np.empty(flat.shape(node, *shape)) for node in flat.outputs]
    runner_of(flat, "numpy")(list(numbers_of(flat, found)), arrays, shape)
    whole = (x + 1j * y if np.any(y != 0.0) else x for x, y in zip(arrays[::2], arrays[1::2], strict=True))
    return [np.broadcast_to(each, shape) for each in whole]


def errors(found: Motion) -> Iterator[str]:
    """What is not as solved: positions, velocities, accelerations and turning, away from limits."""
    mechanism = recording_of(found)
    names = [f"{letter}.{word}" for word in POINTS for letter in found.mechanism.carriers]
    names += [f"{link}.{word}" for word in LINKS for link in found.mechanism.links]
    *values, failed, margin = values_of(mechanism, found, names)
    if not np.array_equal(failed.real, found.failed):
        yield f"{found.mechanism.title}: other poses are assembled"
    far = (found.failed == 0) & (margin.real >= NEAR)
    solved = [quantity(found, name).values.reshape(found.failed.shape) for name in names]
    scales: dict[str, float] = {}
    for name, value in zip(names, solved, strict=True):
        word = name.rpartition(".")[2]
        scales[word] = max(scales.get(word, 0.0), float(np.max(np.abs(value[far]), initial=0.0)))
    # what turns evenly has accelerations of rounding alone, beside the square of its speed
    scales[LINKS[2]] = max(scales[LINKS[2]], scales[LINKS[1]] ** 2)
    for name, own, value in zip(names, values, solved, strict=True):
        shown = output_of(found, name).continuous(np.where(found.failed == 0, own, np.nan))
        off = float(np.max(np.abs(shown - value)[far], initial=0.0))
        if not off <= EXACT * scales[name.rpartition(".")[2]]:
            yield f"{found.mechanism.title}: {name} is off by {off:.1e}"


@pytest.mark.full
def test_every_shipped_mechanism_and_kind_is_recorded_and_equals_solve() -> None:
    every = list(motions())
    assert not [error for found in every for error in errors(found)]
    ways = {type(solver) for found in every for solver in found.solving_order.solvers}
    kinds = {type(pair) for found in every for pair in found.solving_order.pairs.values()}
    assert not [way.__name__ for way in SOLVERS if way not in ways]
    assert not [kind.__name__ for kind in KINDS.values() if kind not in kinds]


@pytest.mark.parametrize("name", ["six-bar", "whitworth-quick-return", "disc-cam-roller-program", "geared-five-bar"])
def test_figures_that_only_some_have_are_those_of_solve(name: str) -> None:
    found = ck.solve(motion(name).mechanism, speed=1.5)
    owners = [owner_of(found, kind, owner) for kind in ("links", "pairs") for owner in getattr(found, kind)]
    names = [f"{one.name}.{word}" for one in owners for word in one.words if word in FIGURES]
    assert {name.rpartition(".")[2] for name in names} >= set(FIGURES[:3])
    path = ck.compile(found.mechanism, names)
    values = path(speed=1.5)
    for name in names:
        # beside a pole a ratio is as large as it is inexact
        np.testing.assert_allclose(values[name], quantity(found, name).values, rtol=1e-9, atol=1e-11, err_msg=name)


@pytest.mark.parametrize("name", ["conjugate-cams", "groove-cam-plate", "geared-coupler", "class-iii-six-bar"])
def test_positions_alone_need_no_rates(name: str) -> None:
    mechanism = ck.load(name)
    outputs = [f"{link}.angle" for link in mechanism.links if link != "frame"]
    found, motion = ck.compile(mechanism, outputs, backend="numpy")(), ck.solve(mechanism, order=0)
    for output in outputs:
        assert np.allclose(found[output], ck.quantity(motion, output).values, rtol=0, atol=1e-12)


def test_what_no_program_tells_is_refused_by_name() -> None:
    four_bar = motion("four-bar-norton")
    for name, told in (("B.x.stroke", "figure of a whole motion"), ("coupler.angle.x", "no vector"),
                       ("B.velosity", "did you mean 'B.velocity'"), ("six", "no point, link, pair or driver"),
                       ("crank.transmission_angle", "a driver moves it")):  # fmt: skip
        with pytest.raises(ck.errors.CompoundkinError, match=told):
            output_of(four_bar, name)
    with pytest.raises(ck.errors.InvalidInput, match="closed form"):
        output_of(motion("3-rrr"), "platform.transmission_index")
