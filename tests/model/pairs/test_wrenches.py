"""The unit wrenches of every kind: they do no work in any motion that the pair permits, and act where they should."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import null_space

import compoundkin as ck
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.wrenches import Wrench
from compoundkin.model.pairs import KINDS, Pair
from compoundkin.model.pairs.belt import Belt
from compoundkin.model.pairs.cam import Cam
from compoundkin.model.pairs.contract import Ends, as_transmitting_pair, as_turn_counting
from compoundkin.model.pairs.gear import Gear
from compoundkin.model.pairs.rack import Rack
from compoundkin.model.pairs.rolling import RollingOnCircle
from tests.support import ends_at, random_pose, sample

SEEDS = st.integers(0, 2**32 - 1)
PIN = sample(KINDS["R"])
every_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=[kind.code for kind in KINDS.values()])


def closed(kind: type[Pair], rng: np.random.Generator, **words: Any) -> tuple[Pair, Ends, tuple[Pose, ...]]:
    """A pair closed at random poses; at fixed ones where it counts turns."""
    pair = sample(kind) if not words else kind("one", "two", **words)  # type: ignore[call-arg]
    if as_turn_counting(pair):
        ends = pair.generic(rng)
        return pair, ends, (FIXED,) * len(ends)
    poses = tuple(random_pose(rng, 0, ()) for _ in pair.members)
    return pair, ends_at(pair, rng, poses), poses


def permitted(pair: Pair, ends: Ends, poses: tuple[Pose, ...]) -> np.ndarray:
    """Motions of all members, in columns, that keep the pair closed, and wheels in mesh: their axes are held."""
    rows = pair.jacobian(ends, poses)[: pair.held]
    if len(poses) == 3:
        for k in range(2):
            axis = poses[k].at(ends[k].point).c[0]
            sides = tuple(poses[j].inverse().carry(ends[0]._replace(point=axis)) for j in (2, k))
            pin = PIN.jacobian(sides, (poses[2], poses[k]))[:2]
            held = np.zeros((2, 9))
            held[:, 6:9], held[:, 3 * k : 3 * k + 3] = pin[:, :3], pin[:, 3:]
            rows = np.vstack([rows, held])
    if isinstance(pair, Rack):
        rows = np.vstack([rows, np.array(pair.rows(ends, poses)[0])])
    return null_space(np.asarray(rows, dtype=float))


def forces_of(wrench: Wrench, poses: tuple[Pose, ...]) -> np.ndarray:
    """Generalised forces on the first member and on the second; nothing on a carrier."""
    own = []
    for side, pose in zip((-wrench, wrench), poses[:2], strict=True):
        own.append([side.force.real, side.force.imag, side.about(pose.z.c[0])])
    return np.array([*np.ravel(own), *[0.0] * 3 * (len(poses) - 2)])


@every_kind
@settings(max_examples=12)
@given(seed=SEEDS)
def test_no_unit_wrench_works_in_a_permitted_motion(kind: type[Pair], seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair, ends, poses = closed(kind, rng)
    motions, units = permitted(pair, ends, poses), pair.wrenches(ends, poses)
    assert len(units) == pair.held + 1
    for unit in units[: pair.held]:
        assert np.max(np.abs(forces_of(unit, poses) @ motions)) < 1e-9 * max(1.0, np.abs(forces_of(unit, poses)).max())
    if len(poses) == 2:  # the last one's power is the rate of the coordinate
        effort, row = forces_of(units[-1], poses), np.asarray(pair.jacobian(ends, poses)[-1], dtype=float)
        assert np.allclose(effort @ motions, row @ motions, atol=1e-8 * max(1.0, np.abs(row).max()))
    partner = as_transmitting_pair(pair)
    for amount, tension in ((3.0, None), (-2.0, 5.0)) if partner else ():
        assert partner is not None
        beside = forces_of(partner.accompanying(ends, poses, amount, tension), poses)
        assert np.max(np.abs(beside)) > 0.1
        assert np.max(np.abs(beside @ motions)) < 1e-9 * np.abs(beside).max()
        whole = units[0].times(amount) + partner.accompanying(ends, poses, amount, tension)
        assert abs(partner.transmitted(ends, poses, whole) - amount) < 1e-10


@pytest.mark.parametrize(
    "kind", [k for k in KINDS.values() if k not in (Gear, Belt, RollingOnCircle)], ids=lambda k: k.code
)
@settings(max_examples=5)
@given(seed=SEEDS)
def test_unit_wrenches_are_the_rows_of_the_jacobian(kind: type[Pair], seed: int) -> None:
    pair, ends, poses = closed(kind, np.random.default_rng(seed))
    for said, found in zip(pair.wrenches(ends, poses), Pair.wrenches(pair, ends, poses), strict=True):
        scale = max(1.0, abs(complex(found.force)), abs(float(found.moment)))
        assert abs(said.force - found.force) < 1e-10 * scale
        assert abs(said.moment - found.moment) < 1e-10 * scale


@given(seed=SEEDS)
@settings(max_examples=12)
def test_a_roller_is_pressed_through_its_middle_at_the_profile(seed: int) -> None:
    pair, ends, poses = closed(Cam, np.random.default_rng(seed))
    assert isinstance(pair, Cam)
    force = pair.wrenches(ends, poses)[0]
    middle = poses[1].at(ends[1].point).c[0]
    assert abs(force.about(middle)) < 1e-10
    assert abs(force.about(pair.touch(ends, poses).place.c[0])) < 1e-10
    assert abs((middle - pair.touch(ends, poses).place.c[0]) - pair.radius * force.force) < 1e-10


@pytest.mark.parametrize("internal", [False, True])
def test_teeth_press_at_the_pitch_point_and_apart(internal: bool) -> None:
    """Wheels of 1 and 3: by hand. A ring is drawn to the pinion in it, the pinion to the ring's middle."""
    first, second, radii = 0j, (2j if internal else 4j), (1.0, 3.0)
    pair = Gear("one", "two", carrier="arm", radii=radii, internal=internal, pressure_angle=0.3)
    sizes = pair.sizes
    ends = (*(FIXED.carry(ck_end(p, s)) for p, s in zip((first, second), sizes, strict=True)), ck_end(0j, 0.0))
    poses = (FIXED,) * 3
    place = -1j if internal else 1j
    unit = pair.wrenches(ends, poses)[0]
    assert abs(unit.about(place)) < 1e-15
    assert abs(unit.force - -1.0) < 1e-15
    for amount in (-7.0, 7.0):
        beside = pair.accompanying(ends, poses, amount)
        away = second - place if internal else place - first
        assert abs(beside.force - away / abs(away) * 7.0 * np.tan(0.3) * (-1.0 if internal else 1.0)) < 1e-14
        assert abs(beside.about(first)) < 1e-15


def ck_end(point: complex, measure: float) -> Any:
    return sample(Gear).generic(np.random.default_rng(0))[0]._replace(point=point, measure=measure)


@pytest.mark.parametrize("crossed", [False, True])
def test_strands_run_along_the_tangents_of_the_pulleys(crossed: bool) -> None:
    """Radii 2 and 1, axes 5 apart along x: moments are radius times pull, and both strands pull the second back."""
    pair = Belt("one", "two", carrier="frame", radii=(2.0, 1.0), crossed=crossed)
    ends = (ck_end(0j, 2.0), ck_end(5 + 0j, 1.0 if crossed else -1.0), ck_end(0j, 0.0))
    poses = (FIXED,) * 3
    upper, lower = pair.strands(ends, poses)
    sine = (3.0 if crossed else 1.0) / 5.0
    assert abs(upper.force.real + np.sqrt(1 - sine**2)) < 1e-15
    assert upper.force.imag == pytest.approx(sine)
    assert lower.force == pytest.approx(np.conj(upper.force))
    assert [upper.about(0j), lower.about(0j)] == pytest.approx([2.0, -2.0])
    assert [upper.about(5 + 0j), lower.about(5 + 0j)] == pytest.approx([-1.0, 1.0] if crossed else [1.0, -1.0])
    assert pair.pulls(6.0, 10.0) == (13.0, 7.0)
    assert pair.pulls(np.array([6.0, -4.0]))[1].tolist() == [0.0, 4.0]


def test_strands_of_pulleys_given_by_teeth_alone_are_not_known() -> None:
    pair = Belt("one", "two", teeth=(20, 40), name="chain")
    ends = (ck_end(0j, 20.0), ck_end(5 + 0j, -40.0), ck_end(0j, 0.0))
    with pytest.raises(ck.errors.InvalidMechanism, match=r"belts\.chain\.radii"):
        pair.wrenches(ends, (FIXED,) * 3)
    known = Belt("one", "two", teeth=(20, 40), radii=(1.0, 2.0))
    assert known.strands(ends, (FIXED,) * 3)[0].about(5 + 0j) == pytest.approx(2.0)


@pytest.mark.parametrize("angle", [-0.1, np.pi / 2, np.nan, np.array([0.3, 0.4])])
def test_pressure_angles_that_are_none(angle: Any) -> None:
    for pair in (
        ck.rack("bar", "wheel", through="Q", at="C", radius=1.0, pressure_angle=angle),
        ck.gear("one", "two", carrier="frame", teeth=(20, 40), pressure_angle=angle),
    ):
        links = {"bar": ("Q",), "wheel": ("C",), "one": ("A",), "two": ("B",), "frame": ("A", "B")}
        assert any(problem.where == "x.pressure_angle" for problem in pair.problems(links, "x"))
