"""What a user asks of centres: places, directions, words, status, and the errors."""

from __future__ import annotations

import cmath
import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.centres import Status, instant_centres
from compoundkin.files import load
from tests import catalog
from tests.analysis.centres.chains import chains, mechanism
from tests.analysis.centres.twists import disagreement, loop_twists, solved_twists

EXACT = 1e-9
FOUR_BAR = (
    ck.link("frame", A=(0, 0), D=(4, 0)),
    ck.link("crank", A=(0, 0), B=(1, 0)),
    ck.link("coupler", B=(0, 0), C=(3.5, 0)),
    ck.link("rocker", D=(0, 0), C=(3, 0)),
    ck.drive("crank"),
)
FIVE_BAR = (
    ck.link("frame", "A", "E"),
    ck.link("left", "A", "B"),
    ck.link("long", "B", "C"),
    ck.link("short", "C", "D"),
    ck.link("right", "D", "E"),
    ck.drive("left", speed=2.0),
    ck.drive("right", speed=-0.5),
    ck.drawn(A=(0, 0), B=(-0.5, 1), C=(1, 2.5), D=(2.6, 1.1), E=(2, 0)),
)
HOME = {"left": cmath.phase(-0.5 + 1j), "right": cmath.phase(0.6 + 1.1j)}


def four_bar(values: object = None, **words: object) -> ck.results.Motion:
    return ck.solve(ck.Mechanism("Four-bar", *FOUR_BAR), {"crank": ck.deg(60) if values is None else values}, **words)  # type: ignore[arg-type]


def triple_rocker() -> ck.Mechanism:
    return ck.Mechanism(
        "Triple rocker", ck.link("frame", A=(0, 0), D=(7, 0)), ck.link("crank", A=(0, 0), B=(4, 0)),
        ck.link("coupler", B=(0, 0), C=(5, 0)), ck.link("rocker", D=(0, 0), C=(3, 0)), ck.drive("crank"),
    )  # fmt: skip


def test_a_centre_by_its_links_in_either_order() -> None:
    centres = instant_centres(four_bar())
    one, other = centres["coupler", "frame"], centres["frame", "coupler"]
    assert one.point == other.point
    assert one.links == ("coupler", "frame")
    assert len(centres) == len(list(centres)) == 6


def test_shapes_are_those_of_the_motion() -> None:
    designs = ck.Mechanism("m", *FOUR_BAR).replace(ck.link("rocker", D=(0, 0), C=([[3.0], [3.1]], [[0.0], [0.0]])))
    centre = instant_centres(ck.solve(designs, {"crank": ck.deg([10, 20, 30])}))["crank", "rocker"]
    assert centre.point.shape == centre.status.shape == centre.conditioning.shape == (2, 3)
    assert centre.homogeneous.shape == (2, 3, 3)
    pin = instant_centres(ck.solve(designs, {"crank": ck.deg([10, 20, 30])}))["frame", "crank"]
    assert pin.point.tolist() == [[0j] * 3] * 2


def test_the_textbook_construction() -> None:
    motion = four_bar()
    centres = instant_centres(motion)
    b, c, d = (complex(motion.points[k].position) for k in "BCD")
    # the centre of coupler and frame, from the lines AB and DC
    t, _ = np.linalg.solve([[b.real, (d - c).real], [b.imag, (d - c).imag]], [d.real, d.imag])
    assert abs(centres["coupler", "frame"].point - t * b) < 1e-12
    # that of crank and rocker, where the coupler's line cuts the frame's
    assert abs(centres["crank", "rocker"].point - (b - (c - b) * b.imag / (c - b).imag)) < 1e-12
    assert [str(step) for step in centres.derivation()] == [
        "(frame crank): pin A",
        "(frame rocker): pin D",
        "(crank coupler): pin B",
        "(coupler rocker): pin C",
        "(frame coupler): line (frame crank)(crank coupler) x line (frame rocker)(rocker coupler)",
        "(crank rocker): line (crank frame)(frame rocker) x line (crank coupler)(coupler rocker)",
    ]


def test_rates_are_inversely_as_the_distances_of_the_centres() -> None:
    motion = four_bar(speed=3.0)
    centres = instant_centres(motion)
    common = complex(centres["crank", "rocker"].point)
    ratio = (common - 0).real / (common - 4).real
    assert abs(float(centres.velocities.angular_velocity("rocker")) - 3.0 * ratio) < 1e-12
    point = motion.points["C"]
    found = centres.velocities.at("coupler", np.asarray(point.position))
    assert abs(complex(found) - complex(point.velocity)) < 1e-12


def test_pin_and_infinity() -> None:
    motion = catalog.motion("scotch-yoke")
    centres = instant_centres(motion)
    slides = [centres[c] for c in centres if centres[c].how.startswith("prismatic pair")]
    assert len(slides) == 2
    for centre in slides:
        assert centre.at_infinity.all()
        assert np.isinf(centre.point).all()
        assert (centre.conditioning == 1.0).all()
        assert np.allclose(np.abs(centre.direction), 1.0)
        assert (centre.homogeneous[..., 2] == 0.0).all()
    pin = centres["frame", "crank"]
    assert pin.how.startswith("pin ")
    assert np.isnan(pin.direction).all()


def test_parallel_lines_cross_at_infinity() -> None:
    parallelogram = ck.solve(load("parallelogram"), {"crank": ck.deg([30.0, 75.0])})
    centre = instant_centres(parallelogram)["frame", "coupler"]
    assert centre.at_infinity.all()
    direction = centre.direction * np.exp(-1j * ck.deg(np.array([30.0, 75.0])))
    assert np.allclose(direction.imag, 0.0, atol=1e-12)


def test_poses_that_are_not_assembled() -> None:
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(triple_rocker(), {"crank": ck.deg(np.arange(0.0, 361.0, 5.0))})
    centres = instant_centres(motion)
    assert 0 < motion.assembled.sum() < motion.assembled.size
    for couple in centres:
        centre = centres[couple]
        assert (centre.found == motion.assembled).all()
        assert np.isnan(centre.point[~motion.assembled]).all()
    at = int(np.flatnonzero(~motion.assembled)[0])
    assert centres["frame", "crank"].how_at(at) == "not assembled"


def test_other_lines_where_those_of_the_derivation_coincide() -> None:
    """A shaper's crank upright: pins, guide and pivot in one line, but for what hangs on the lever's end."""
    motion = ck.solve(load("crank-shaper"), {"crank": ck.deg([37.0, 90.0])})
    centres = instant_centres(motion)
    texts = {couple: (centres[couple].how, centres[couple].how_at(1)) for couple in centres}
    changed = {couple for couple, (how, at) in texts.items() if how != at}
    # with the crank's and the lever's pivots square to the ram's guide, the slider's lines coincide at every pose
    assert changed == {("crank", "rod"), ("crank", "slider")}
    assert [couple for couple in centres if centres[couple].how_at(0) != texts[couple][0]] == [("crank", "slider")]
    assert centres["crank", "rod"].how_at(1) == "rates carried by the other centres"
    assert all(centres[couple].found.all() for couple in centres)
    twists = loop_twists(centres)[0]
    assert max(float(v.max()) for v in disagreement(centres, twists).values()) < EXACT


def test_several_drivers_give_centres_for_their_rates() -> None:
    five_bar = ck.Mechanism("Five-bar", *FIVE_BAR)
    motion = ck.solve(five_bar, HOME)
    centres = instant_centres(motion)
    assert centres["left", "right"].how.startswith("rates of the drivers left, right")
    # omega_left / omega_right = -4: the common centre divides AE inside as 1 to 4
    assert abs(complex(centres["left", "right"].point) - 0.4) < 1e-12
    assert centres["left", "short"].how.startswith("line ")
    assert centres.velocity_check().worst < EXACT
    slower = instant_centres(ck.solve(five_bar, HOME, speed={"left": 1.0, "right": 1.0}))["left", "right"]
    assert slower.at_infinity


def test_several_drivers_at_rest() -> None:
    five_bar = ck.Mechanism("Five-bar", *FIVE_BAR)
    centres = instant_centres(ck.solve(five_bar, HOME, speed={"left": 0.0, "right": 0.0}))
    assert centres["left", "right"].status == Status.AT_REST
    assert np.isnan(centres["left", "right"].point)
    assert centres["left", "right"].how_at() == "at rest"
    assert centres["left", "long"].status == Status.FOUND


def test_one_driver_at_rest_changes_no_centre() -> None:
    moving, still = instant_centres(four_bar()), instant_centres(four_bar(speed=0.0))
    for couple in moving:
        assert moving[couple].point == still[couple].point
    assert still.velocity_check().worst == 0.0


def test_links_that_never_move_relative_to_each_other() -> None:
    """A coupler made of three bars pinned in a triangle."""
    truss = ck.Mechanism(
        "Truss as coupler",
        ck.link("frame", "A", "D"), ck.link("crank", "A", "B"), ck.link("rocker", "D", "C"),
        ck.link("base", "B", "C"), ck.link("left", "B", "X"), ck.link("right", "C", "X"), ck.drive("crank"),
        ck.drawn(A=(0, 0), B=(0.2, 1), C=(3, 2.5), D=(4, 0), X=(1.5, 3)),
    )  # fmt: skip
    motion = ck.solve(truss, {"crank": cmath.phase(0.2 + 1j)})
    centres = instant_centres(motion)
    assert centres["left", "right"].status == Status.AT_REST
    assert centres["base", "left"].how == "at rest relative to each other"
    assert centres["frame", "left"].point == centres["frame", "base"].point == centres["frame", "right"].point
    assert centres.velocity_check().worst < EXACT
    assert centres.velocity_check().compared == 1.0


def test_a_limit_position_has_centres_but_no_velocities() -> None:
    """Coupler and rocker in line: the crank stands still whatever the others do."""
    limit = np.arccos((16.0 + 49.0 - 64.0) / 56.0)
    motion = ck.solve(triple_rocker(), {"crank": limit * (1.0 - 1e-15)})
    centres = instant_centres(motion)
    b = complex(motion.points["B"].position)
    assert abs(complex(centres["frame", "coupler"].point) - b) < 1e-6


def test_a_motion_without_velocities_has_centres() -> None:
    motion = four_bar(order=0)
    centres = instant_centres(motion)
    assert centres["coupler", "frame"].point == instant_centres(four_bar())["coupler", "frame"].point
    with pytest.raises(ck.errors.InvalidInput, match="solved to order 0"):
        centres.velocity_check()
    with pytest.raises(ck.errors.InvalidInput, match="solved to order 0"):
        solved_twists(motion, centres.scale)


def test_a_locked_mechanism_has_none() -> None:
    truss = ck.Mechanism("Truss", ck.link("frame", "A", "B"), ck.link("l", "A", "C"), ck.link("r", "B", "C"),
                         ck.drawn(A=(0, 0), B=(2, 0), C=(1, 1)))  # fmt: skip
    with pytest.raises(ck.errors.NotDetermined, match="locked"):
        instant_centres(ck.solve(truss))


def test_names_that_are_not_there() -> None:
    centres = instant_centres(four_bar(ck.deg([10, 20])))
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'coupler'"):
        centres["crank", "cupler"]
    with pytest.raises(ck.errors.InvalidInput, match="no centre relative to itself"):
        centres["crank", "crank"]
    with pytest.raises(ck.errors.InvalidInput, match="are not two links"):
        centres["crank"]  # type: ignore[index]
    for pose in ((2,), (-3,), (), (0, 0)):
        with pytest.raises(ck.errors.InvalidInput, match="not a pose"):
            centres["crank", "coupler"].how_at(*pose)
    assert centres["crank", "coupler"].how_at(-1) == "pin B"


@pytest.mark.parametrize("change", [(1e3, 0), (1e-3, 1), (1.0, 1e4 + 3e4j), (cmath.exp(2j), 0)])
def test_moved_turned_and_scaled(change: tuple[complex, complex]) -> None:
    rng = np.random.default_rng(8)
    joints = {f"{min(e)}-{max(e)}": complex(*rng.uniform(-1, 1, 2)) for e in sorted(chains(6)[0].edges)}
    factor, shift = change
    moved = {joint: factor * place + shift for joint, place in joints.items()}
    plain, other = (instant_centres(_at_home(drawn)) for drawn in (joints, moved))
    for couple in plain:
        expected = factor * complex(plain[couple].point) + shift
        scale = abs(factor) * max(1.0, abs(complex(plain[couple].point))) + 1e-3 * abs(shift)
        assert abs(complex(other[couple].point) - expected) < 1e-9 * scale


def _at_home(joints: dict[str, complex]) -> ck.results.Motion:
    drawn = mechanism(joints)
    from tests.support import drawn_values

    return ck.solve(drawn, drawn_values(drawn))


def test_many_poses_are_as_each_alone() -> None:
    """Across the borders of blocks, and where other lines are taken."""
    crank = np.linspace(0.0, 2.0 * np.pi, 4096 * 2 + 5)
    six_bar = load("crank-shaper")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        together = instant_centres(ck.solve(six_bar, {"crank": crank}))
    for at in (0, 2048, 4095, 4096, 8192, 8196):
        alone = instant_centres(ck.solve(six_bar, {"crank": crank[at]}))
        for couple in together:
            one, other = together[couple], alone[couple]
            assert np.allclose(np.abs(np.vdot(one.homogeneous[at], other.homogeneous)) ** 2,
                               np.vdot(one.homogeneous[at], one.homogeneous[at])
                               * np.vdot(other.homogeneous, other.homogeneous), rtol=1e-9)  # fmt: skip
            assert one.how_at(at) == other.how_at()
