"""Configurations are followed along the drivers' path: poses, however they are asked for, are read off it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.kinematics.groups.group_equations import GroupEquations
from tests.support import examples

HARD = Path(__file__).parents[1] / "reference" / "hard"
CURVES = ("class-iii-six-bar", "stephenson-iii-floating-driver", "antiparallelogram", "parallelogram", "six-bar")


def whole(name: str) -> tuple[ck.Mechanism, str, np.ndarray, ck.results.Motion]:
    """A mechanism, its only driver, the values of its own motion, and that."""
    mechanism = ck.load(name)
    motion = ck.solve(mechanism, order=1)
    (driver,) = motion.drives
    return mechanism, driver, np.ravel(motion.drives[driver].value), motion


def hard_mechanism(name: str) -> ck.Mechanism:
    return ck.load(str(HARD / f"{name}.toml"))


def quietly(mechanism: ck.Mechanism, *words: object, **named: object) -> ck.results.Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        warnings.simplefilter("ignore", ck.errors.ChangePointWarning)
        return ck.solve(mechanism, *words, **named)


@pytest.mark.parametrize("name", CURVES)
@settings(max_examples=examples(12))
@given(data=st.data())
def test_a_pose_does_not_depend_on_the_others(name: str, data: st.DataObject) -> None:
    """Poses of one motion shuffled, repeated, left out: each is where it is among all, sorted and distinct."""
    mechanism, driver, values, motion = whole(name)
    index = np.array(data.draw(st.lists(st.integers(0, len(values) - 1), min_size=1, max_size=30)))
    # the first pose is that of all, from which the mode is taken where nothing is drawn
    index = np.concatenate([[0], index, [len(values) - 1]])
    again = quietly(mechanism, {driver: values[index]}, order=1)
    size = motion.size
    for letter in mechanism.carriers:
        one, other = motion.points[letter], again.points[letter]
        assert np.abs(np.broadcast_to(one.position, len(values))[index] - other.position).max() < 1e-9 * size


@pytest.mark.parametrize("name", CURVES[:2])
def test_windows_of_a_motion_agree(name: str) -> None:
    mechanism, driver, values, motion = whole(name)
    third = len(values) // 3
    for window in (slice(0, 2 * third), slice(third, len(values)), slice(third, 2 * third)):
        part = quietly(mechanism, {driver: values[window]}, order=0)
        for letter in mechanism.carriers:
            position = np.broadcast_to(motion.points[letter].position, len(values))[window]
            assert np.abs(part.points[letter].position - position).max() < 1e-9 * motion.size


@contextmanager
def counted(name: str) -> Iterator[list[int]]:
    """Counts the calls of Newton's method."""
    calls, own = [0], getattr(GroupEquations, name)

    def counting(*words: object, **named: object) -> object:
        calls[0] += 1
        return own(*words, **named)

    setattr(GroupEquations, name, counting)
    try:
        yield calls
    finally:
        setattr(GroupEquations, name, own)


@pytest.mark.parametrize("name", CURVES[:2])
def test_repeated_and_shuffled_values_cost_no_more(name: str) -> None:
    """Steps along the path are the same: once two hundred times as many, one for each rest and each return."""
    mechanism, driver, values, _ = whole(name)
    work = []
    for asked in (values, np.repeat(values, 2), np.random.default_rng(1).permutation(values)):
        with counted("newton") as calls:
            quietly(mechanism, {driver: asked}, order=0)
        work.append(calls[0])
    assert max(work) <= 1.5 * work[0], work


def test_three_drivers_that_rest_and_go_on() -> None:
    mechanism = ck.load("3-rrr")
    motion = ck.solve(mechanism, order=0)
    values = {name: np.broadcast_to(drive.value, motion.shape) for name, drive in motion.drives.items()}
    with counted("newton") as calls:
        ck.solve(mechanism, values, order=0)
    once = calls[0]
    with counted("newton") as calls:
        again = ck.solve(mechanism, {name: np.repeat(value, 3) for name, value in values.items()}, order=0)
    assert calls[0] <= 1.5 * once
    for letter in mechanism.carriers:
        position = np.broadcast_to(motion.points[letter].position, motion.shape)
        assert np.abs(again.points[letter].position[1::3] - position).max() < 1e-9 * motion.size


def test_a_drawn_pose_beside_the_drivers_way_is_gone_to_and_back() -> None:
    """Two drivers move on a curve; the drawing shows them beside it: it is the same motion as from a pose on it."""
    mechanism = ck.load("3-rrr")
    motion = ck.solve(mechanism, order=0)
    begin = {name: float(np.ravel(drive.value)[0]) for name, drive in motion.drives.items()}
    t = np.linspace(0.0, 1.0, 15)
    bend = dict(zip(begin, (0.1 * np.sin(3.0 * t), 0.1 * t**2, -0.05 * t), strict=True))
    values = {name: begin[name] + 0.02 + bend[name] for name in begin}
    one = ck.solve(mechanism, values, order=0)
    first = {letter: complex(np.ravel(one.points[letter].position)[0]) for letter in mechanism.carriers}
    other = ck.solve(mechanism, values, order=0, hint=first)
    for letter in mechanism.carriers:
        assert np.abs(one.points[letter].position - other.points[letter].position).max() < 1e-9 * motion.size
    assert ck.verify(one).passed


def tongs(stages: int, open_: float = 1.2) -> ck.Mechanism:
    """Lazy tongs of crossed arms of length 2, on a roller in a level guide."""
    high = np.sqrt(4.0 - open_**2)
    items: list[object] = [ck.link("frame", P0=0), ck.link("roller", Q0=0)]
    drawn = {}
    for k in range(stages + 1):
        drawn |= {f"P{k}": 1j * high * k, f"Q{k}": open_ + 1j * high * k}
    for k in range(stages):
        items.append(ck.link(f"a{k}", **{f"P{k}": 0, f"M{k}": 1, f"Q{k + 1}": 2}))
        items.append(ck.link(f"b{k}", **{f"Q{k}": 0, f"M{k}": 1, f"P{k + 1}": 2}))
        drawn[f"M{k}"] = open_ / 2.0 + 1j * high * (k + 0.5)
    guide = ck.slide("roller", on="frame", at="Q0", through="P0", angle=0, name="guide")
    return ck.Mechanism("tongs", *items, guide, ck.drive("roller", on="frame", pair="guide"), ck.drawn(**drawn))


@pytest.mark.parametrize(
    ("poses", "stages"),
    [(7, 2), (7, 5), (7, 20), *(pytest.param(count, 20, marks=pytest.mark.full) for count in (60, 61))],
)
def test_lazy_tongs_pass_their_closed_pose(poses: int, stages: int) -> None:
    """All stages fold there at once, each on pins of the one before; none may fold down behind it."""
    values = np.linspace(1.5, -1.5, poses)
    motion = quietly(tongs(stages), {"roller": values}, order=1)
    assert np.count_nonzero(~motion.assembled) == poses % 2
    top = motion.points[f"P{stages}"].position
    exact = 1j * stages * np.sqrt(4.0 - values**2)
    assert np.abs((top - exact)[motion.assembled]).max() < 1e-12 * stages
    assert ck.verify(motion).passed


def test_the_two_stages_of_a_scissor() -> None:
    mechanism = hard_mechanism("scissor-two-stages")
    for poses in (60, 61):
        motion = quietly(mechanism, {"roller": np.linspace(1.5, -1.5, poses)})
        assert abs(motion.points["M1"].position[-1] - (-0.75 + 1.5j * np.sqrt(4.0 - 1.5**2))) < 1e-12
        assert ck.verify(motion).passed


@pytest.mark.parametrize("poses", [13, 73, 400])
def test_a_knife_edge_that_drives_its_cam_does_not_leap(poses: int) -> None:
    """Just before its limit the other contact lies beyond the cut of the angles: 0.33 instead of -0.07.

    As the cam turns on, the edge comes into it at the one and out of it at the other, behind the gap too.
    """
    mechanism = hard_mechanism("knife-edge-drives-cam")
    drawn = -332.530506657952
    values = np.linspace(drawn - 60.0, drawn + 60.0, poses)
    motion = quietly(mechanism, {"d0": values}, order=1)
    cam, good = motion.links["L1"], motion.assembled
    gaps = np.flatnonzero(np.diff(good.astype(int)))
    assert len(gaps) == 2
    # without a leap it turns the same way on and on
    assert (np.diff(cam.angle[gaps[1] + 1 :]) < 0.0).all()
    assert (np.diff(cam.angle[: gaps[0] + 1]) > 0.0).all()
    beside = quietly(mechanism, {"d0": drawn - np.array([0.0, 0.35, 1.0])}, order=0).links["L1"].angle
    assert beside == pytest.approx([-0.1225, -0.069, 0.108], abs=2e-3)
    (pair,) = (pair for pair in mechanism.written_pairs if pair.name == "c1")
    outline = pair.profile.curve.at(np.linspace(pair.profile.curve.low, pair.profile.curve.high, 4000)).c[0]
    for turned, winds in ((-1e-3, True), (1e-3, False)):
        arm = motion.points["P5"].position[good] - motion.points["P1"].position[good]
        edge = mechanism.links["L1"].points["P1"] + arm * np.exp(-1j * (cam.angle[good] + turned))
        seen = np.unwrap(np.angle(outline - edge[:, None]), axis=1)
        assert (np.abs(seen[:, -1] - seen[:, 0]) > np.pi).tolist() == [winds] * good.sum()


def parallelogram(beyond: float = 0.0) -> ck.Mechanism:
    return ck.Mechanism(
        "parallelogram",
        ck.link("frame", A=0, D=3),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=3.0 + beyond),
        ck.link("rocker", D=0, C=1),
        ck.drive("crank"),
        ck.drawn(A=0, D=3, B=1j, C=3 + 1j),
    )


def test_whoever_asks_to_goes_on_the_other_branch() -> None:
    """From 180 degrees on an antiparallelogram: its rocker turns by the rolling ellipses, and comes to -1/2 there."""
    values = ck.deg(np.arange(0.0, 361.0, 5.0))
    own = quietly(parallelogram(), {"crank": values})
    other = quietly(parallelogram(), {"crank": values}, branch={"rocker": np.pi})
    before = values < np.pi - 1e-9
    assert np.abs((other.links["rocker"].angle - own.links["rocker"].angle)[before]).max() < 1e-12
    behind = (values > np.pi + 1e-9) & (values < 2.0 * np.pi - 1e-9)
    pins, swapped = other.points, own.points["C"].position
    assert np.abs(np.abs(pins["C"].position - pins["B"].position) - 3.0).max() < 1e-12
    assert np.abs(pins["C"].position - swapped)[behind].min() > 0.05
    assert other.links["rocker"].angular_velocity[37] == pytest.approx(-0.5, abs=2e-3)
    assert ck.verify(other).passed
    assert ck.verify(own).passed


@pytest.mark.parametrize(
    ("branch", "told"),
    [
        ({"rocker": 1.0}, "57.2958 degrees is at no change point.*180 degrees"),
        ({"crank": 1.0}, "no change points"),
        ({"rod": 1.0}, "no such link"),
        ({"rocker": "half a turn"}, "no number"),
        ({"rocker": np.nan}, "not finite"),
    ],
)
def test_a_branch_that_is_none(branch: dict[str, object], told: str) -> None:
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        quietly(parallelogram(), {"crank": ck.deg(np.arange(0.0, 361.0, 5.0))}, branch=branch)


@pytest.mark.parametrize("beyond", [1e-9, 1e-11, -1e-9])
@pytest.mark.parametrize("poses", [36, 73, 100])
def test_a_rounding_that_decides_is_told(beyond: float, poses: int) -> None:
    """The rods differ by rounding: the parallelogram turns back at its flat pose, at any grid, and says so."""
    with pytest.warns(ck.errors.NearChangePoint, match="crank = 180 degrees, coupler, rocker"):
        motion = ck.solve(parallelogram(beyond), {"crank": np.linspace(0.1, 6.2, poses)}, order=0)
    assert motion.links["rocker"].angle[-1] < np.pi


@pytest.mark.parametrize("beyond", [0.0, 1e-13, 1e-3])
def test_nothing_is_told_where_nothing_is_decided_by_rounding(beyond: float) -> None:
    motion = ck.solve(parallelogram(beyond), {"crank": np.linspace(0.1, 6.2, 73)}, order=0)
    assert (motion.links["rocker"].angle[-1] < np.pi) == (beyond > 1e-12)


def test_a_chain_of_general_groups_costs_as_much_as_its_groups() -> None:
    """Class III platforms, each on the one before: each step takes Newton a few times, whatever is before it."""
    for count in (1, 2, 4):
        with counted("newton") as calls:
            motion = quietly(platforms(count), order=0)
        assert motion.assembled.all()
        steps = sum(np.isfinite(path.s).sum() for path in motion.followed.curve.paths.values())
        assert calls[0] <= 4 * steps


def platforms(count: int) -> ck.Mechanism:
    """Plates on three legs each; the legs of the next one hang on a point of the plate before and on the frame."""
    b, c = 1.0 + 0.0j, 5.0 + 2.0j
    frame = {"A": 0j}
    items: list[object] = [ck.link("crank", "A", "B0")]
    drawn = {"A": 0j, "B0": b}
    for k in range(count):
        shift = 6.0 * k
        points = {f"K{k}": c + shift, f"L{k}": c + shift + 3.0, f"B{k + 1}": c + shift + 1.5 + 1.0j}
        ground = {f"Q{k}": c + shift + 3.0 - 4.0j, f"S{k}": c + shift - 1.0 + 5.0j}
        drawn |= points | ground
        frame |= ground
        items += [
            ck.link(f"plate{k}", *points),
            ck.link(f"leg{k}", f"B{k}", f"K{k}"),
            ck.link(f"second{k}", f"L{k}", f"Q{k}"),
            ck.link(f"third{k}", f"B{k + 1}", f"S{k}"),
        ]
    values = np.linspace(0.0, 0.15, 9)
    drawing = ck.drawn(**drawn)
    return ck.Mechanism("platforms", ck.link("frame", *frame), *items, drawing, ck.drive("crank", values=values))


def test_a_lift_with_both_drivers_over_more_than_half_a_turn() -> None:
    """It raised IndexError; both stages pass change points at once, and two of its arms are redundant."""
    mechanism = ck.load("double-parallelogram-lift")
    values = {drive.name: np.linspace(0.1, 5.0, 24) for drive in mechanism.drives}
    motion = quietly(mechanism, values)
    assert motion.assembled.all()
    assert np.abs(motion.links["head"].angle).max() < 1e-12
    assert ck.verify(motion).passed


@pytest.mark.parametrize("longer", [1.25, 2.0])
def test_a_drawing_of_shorter_arms_does_not_choose_modes_that_open_redundant_pairs(longer: float) -> None:
    """The drawing, that of the lift as it is, lies nearer to a crossed parallelogram: its third arm would not fit."""
    mechanism = ck.load("double-parallelogram-lift")
    arms = [ck.link(name, **{one: 0, other: 300.0 * longer}) for name, one, other in
            (("lower", "A", "D"), ("lower-2", "B", "E"), ("lower-3", "C", "F"))]  # fmt: skip
    motion = ck.solve(mechanism.replace(*arms))
    assert motion.assembled.all()
    assert np.abs(motion.links["head"].angle).max() < 1e-12
    assert "redundant" in motion.chosen_by.values()
