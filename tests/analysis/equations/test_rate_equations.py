"""Velocity and acceleration equations: their solutions are those of the groups; symbols and numbers as published."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.equations.reduced_system import pose_values
from compoundkin.files import load
from compoundkin.model.pairs.loop_terms import Unknown
from tests import catalog
from tests.scaled import scaled

# Rates of both ways agree to this part of the fastest one, times what the matrix makes of rounding.
CLOSE = 1e-10
# Where the matrix is worse than this the angles themselves have lost digits.
WELL = 1e3


def rates(motion: ck.results.Motion, unknown: Unknown, order: int) -> np.ndarray | None:
    """The rate of an unknown as the groups gave it: of angles, and of slides along their guides."""
    if unknown.kind == "angle":
        link = motion.links[unknown.owner]
        return (link.angular_velocity, link.angular_acceleration)[order - 1]
    pair = next((pair for pair in motion.structure.pairs if pair.name == unknown.owner), None)
    return motion.pairs[unknown.owner].derivative(order) if pair is not None and pair.code == "P" else None


@catalog.each(catalog.THIRD)
def test_solutions_are_the_rates_that_the_groups_give(name: str) -> None:
    motion = catalog.motion(name)
    equations = ck.loop_equations(motion.structure, order=2)
    size = motion.size
    for rated in equations.rates:
        found = rated.at(motion)
        good = motion.assembled & motion.regular.reshape(motion.shape) & (found.condition < WELL)
        assert good.mean() > 0.9 * motion.assembled.mean()
        shown = [(own, rates(motion, own, rated.order)) for own in found.unknowns]
        given = [np.abs(drive.rate) / (1.0 if drive.is_angle else size) for drive in motion.drives.values()]
        pure = [np.abs(v) / (size if own.is_length else 1.0) for own, v in shown if v is not None]
        scale = np.maximum.reduce([*np.broadcast_arrays(*pure, *[g**rated.order for g in given])])
        for own, value in shown:
            if value is not None:
                gap = np.abs(found.rate(own.key) - value) / (size if own.is_length else 1.0)
                assert np.max(np.where(good, gap / scale, 0.0)) < CLOSE, own.key
    if len(equations.velocity.rows) == len(equations.velocity.unknowns):
        assert equations.velocity.at(motion).determinant.shape == motion.shape


def test_the_slider_crank_has_the_equations_of_the_textbook() -> None:
    """R. L. Norton, Design of Machinery, sections 6.7 and 7.3: terms with w^2 toward the centres, none of Coriolis."""
    found = ck.loop_equations(load("slider-crank"), order=2)
    assert found.velocity.matrix is not found.acceleration.matrix
    assert found.velocity.matrix.text == found.acceleration.matrix.text == "[ -AB sin(rod)  -1 ]\n[  AB cos(rod)   0 ]"
    assert found.velocity.rows == (
        "-AB rod' sin(rod) - s'(stroke) = OA crank' sin(crank)",
        "AB rod' cos(rod) = -OA crank' cos(crank)",
    )
    right = [row.text for (row,) in found.acceleration.right_side.entries]
    assert right == [
        "OA crank'' sin(crank) + OA crank'^2 cos(crank) + AB rod'^2 cos(rod)",
        "-OA crank'' cos(crank) + OA crank'^2 sin(crank) + AB rod'^2 sin(rod)",
    ]
    assert found.velocity.matrix.latex == (
        r"\begin{bmatrix} -\overline{\text{AB}}\,\sin \theta_{\text{rod}} & -1 \\ "
        r"\overline{\text{AB}}\,\cos \theta_{\text{rod}} & 0 \end{bmatrix}"
    )


def test_a_moving_guide_adds_the_coriolis_term() -> None:
    found = ck.loop_equations(load("oscillating-guide"), order=2)
    assert found.velocity.rows[0] == "s(slot) lever' sin(lever) - s'(slot) cos(lever) = CA crank' sin(crank)"
    assert found.acceleration.right_side.entries[0][0].text.endswith(
        "- s(slot) lever'^2 cos(lever) - 2 s'(slot) lever' sin(lever)"
    )


@pytest.mark.parametrize(
    ("name", "rows"),
    [
        ("planetary-train", ("-0.277778 planet' = 0.722222 arm'", "0.625 planet' + sun' = 1.625 arm'")),
        ("hand-pump", None),
        ("double-parallelogram-lift", ("-middle' + upper' = q'(upper)",)),
    ],
)
def test_gears_and_drivers_between_links_keep_rows(name: str, rows: tuple[str, ...] | None) -> None:
    found = ck.loop_equations(load(name), order=1)
    if rows is None:  # the plunger does not turn: its driver plainly gives the lever
        assert [own.key for own in found.system.given] == ["lever"]
        assert [own.key for own in found.velocity.unknowns] == ["swing", "s(barrel)"]
    else:
        assert found.velocity.rows[-len(rows) :] == rows


def test_numbers_of_norton() -> None:
    """R. L. Norton, Design of Machinery, examples 4-1, 6-7 and 7-1: a = 40, b = 120, c = 80, d = 100, 40 deg."""
    mechanism = load("four-bar-norton")
    equations = ck.loop_equations(mechanism, order=2)
    motion = ck.solve(mechanism, {"crank": ck.deg(40.0)}, speed=25.0, acceleration=15.0)
    three, four = ck.deg(20.298), ck.deg(57.325)
    book = np.array([[-120 * np.sin(three), 80 * np.sin(four)], [120 * np.cos(three), -80 * np.cos(four)]])
    first, second = equations.velocity.at(motion), equations.acceleration.at(motion)
    assert np.allclose(first.matrix, book, atol=2e-3)
    assert np.array_equal(first.matrix, second.matrix)
    assert first.determinant == pytest.approx(120 * 80 * np.sin(three - four), rel=1e-4)
    assert np.allclose(first.solution, [-4.121, 6.998], atol=1e-3)
    assert np.allclose(second.solution, [296.089, 470.134], atol=2e-3)
    # 6-7 and 7-1 in the book's own quotients
    two = ck.deg(40.0)
    omega = (
        40 * 25 * np.array([np.sin(four - two) / 120, np.sin(two - three) / 80]) / np.sin([three - four, four - three])
    )
    assert np.allclose(first.solution, omega, atol=2e-3)


def test_numbers_of_nikravesh() -> None:
    """P. E. Nikravesh, AME 352 notes, slider-crank at 65 deg and 1.6 rad/s: -0.344, -0.211; 1.125, -0.035."""
    mechanism = load("slider-crank")
    motion = ck.solve(mechanism, {"crank": ck.deg(65.0)}, speed=1.6)
    equations = ck.loop_equations(mechanism, order=2)
    first, second = equations.velocity.at(motion), equations.acceleration.at(motion)
    three = ck.deg(335.27)
    assert np.allclose(first.matrix, [[-0.26 * np.sin(three), -1.0], [0.26 * np.cos(three), 0.0]], atol=5e-5)
    assert np.allclose(first.right_side, 0.12 * 1.6 * np.array([np.sin(ck.deg(65)), -np.cos(ck.deg(65))]), rtol=1e-12)
    assert np.allclose(first.solution, [-0.344, -0.211], atol=5e-4)
    assert np.allclose(second.solution, [1.125, -0.035], atol=6e-4)


def test_a_limit_position_is_singular() -> None:
    bars = ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=3), ck.link("rod", B=0, C=2), ck.link("arm", C=0, D=2.5)
    mechanism = ck.Mechanism("m", *bars, ck.drive("crank"))
    limit = np.arccos((3**2 + 4**2 - 4.5**2) / 24)  # rod and arm in line
    motion = ck.solve(mechanism, {"crank": [0.5, limit * (1 - 1e-16)]})
    found = ck.loop_equations(mechanism, order=1).velocity.at(motion)
    assert found.singular.tolist() == [False, True]
    assert np.isnan(found.solution[1]).all()
    assert found.condition[1] > 1e6
    parallel = ck.loop_equations(load("parallelogram"), order=2).acceleration.at(catalog.motion("parallelogram"))
    assert parallel.singular[0]


def test_arrays_have_the_shape_of_designs_and_poses() -> None:
    rod = np.array([[5.0], [5.5], [6.0]])
    bars = (ck.link("frame", A=0, D=5.5), ck.link("crank", A=0, B=2), ck.link("rod", B=0, C=rod),
            ck.link("arm", D=0, C=4))  # fmt: skip
    mechanism = ck.Mechanism("m", *bars, ck.drive("crank"))
    motion = ck.solve(mechanism, {"crank": np.linspace(0, 6, 7)}, order=2)
    found = ck.loop_equations(mechanism, order=2).acceleration.at(motion)
    assert (found.matrix.shape, found.right_side.shape, found.condition.shape) == ((3, 7, 2, 2), (3, 7, 2), (3, 7))
    assert np.allclose(found.rate("arm"), motion.links["arm"].angular_acceleration, rtol=1e-11)


def test_what_is_not_assembled_is_nan() -> None:
    bars = ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=3), ck.link("rod", B=0, C=2), ck.link("arm", C=0, D=2.5)
    mechanism = ck.Mechanism("m", *bars, ck.drive("crank"))
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(mechanism, {"crank": [0.5, 3.0]})
    found = ck.loop_equations(mechanism, order=1).velocity.at(motion)
    assert np.isfinite(found.solution[0]).all()
    assert np.isnan(found.solution[1]).all()
    assert not found.singular[1]


def test_symbols_and_numbers_are_the_same() -> None:
    """Every entry is the difference quotient of its row."""
    for name in ("oscillating-flat-follower", "disc-cam-roller-program", "rack-and-pinion-steering", "rolling-wheel"):
        motion = catalog.motion(name)
        found = ck.loop_equations(motion.structure, order=1)
        values = {key: np.ravel(np.broadcast_to(v, motion.shape))[3] for key, v in pose_values(motion).items()}
        matrix = found.velocity.matrix.at(values)
        for j, own in enumerate(found.velocity.unknowns):
            step = 1e-6 * (motion.size if own.is_length else 1.0)
            ends = [{**values, own.key: values[own.key] + way * step} for way in (1, -1)]
            for k, row in enumerate(found.system.rows):
                quotient = (row.at(ends[0]) - row.at(ends[1])) / (2 * step)
                assert matrix[k, j] == pytest.approx(quotient, rel=1e-6, abs=1e-6 * np.abs(matrix[k]).max()), own.key


def test_orders_that_are_none() -> None:
    mechanism = load("slider-crank")
    for order in (3, -1, True):
        with pytest.raises(ck.errors.InvalidInput, match="order"):
            ck.loop_equations(mechanism, order=order)
    with pytest.raises(ck.errors.InvalidInput, match="order=2"):
        _ = ck.loop_equations(mechanism, order=1).acceleration
    with pytest.raises(ck.errors.InvalidInput, match="solved to order 1"):
        ck.loop_equations(mechanism, order=2).acceleration.at(ck.solve(mechanism, order=1))
    with pytest.raises(ck.errors.UnknownName, match="rod"):
        ck.loop_equations(mechanism, order=1).velocity.at(ck.solve(mechanism)).rate("rot")


def test_nothing_unknown_is_no_matrix() -> None:
    crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
    motion = ck.solve(crank, {"crank": [0.0, 1.0]})
    found = ck.loop_equations(crank, order=2).acceleration.at(motion)
    assert (found.matrix.shape, found.solution.shape) == ((2, 0, 0), (2, 0))
    assert not found.singular.any()


def test_values_stand_for_a_motion() -> None:
    mechanism = load("slider-crank")
    motion = ck.solve(mechanism, {"crank": [0.3, 0.9]}, speed=2.0, acceleration=1.0)
    equations = ck.loop_equations(mechanism, order=2).acceleration
    values = {**pose_values(motion), "crank'": 2.0, "crank''": 1.0}
    assert np.array_equal(equations.at(values).solution, equations.at(motion).solution)
    with pytest.raises(ck.errors.InvalidInput, match="crank''"):
        equations.at({key: value for key, value in values.items() if key != "crank''"})
    with pytest.raises(ck.errors.InvalidInput, match="no number"):
        equations.at({**values, "rod": "x"})
    assert np.isnan(equations.at({**values, "rod": np.inf}).solution).all()
    with pytest.raises(ck.errors.InvalidInput, match=r"do not broadcast: .*rod \(3,\)"):
        equations.at({**values, "rod": [1.0, 2.0, 3.0]})
    with pytest.raises(ck.errors.InvalidInput, match="rod has none"):
        equations.matrix.at({"crank": 1.0})
    for wrong in (None, "x", [1.0], mechanism):
        with pytest.raises(ck.errors.InvalidInput, match="no motion or table by name"):
            equations.at(wrong)


def test_the_motion_is_one_of_the_same_mechanism() -> None:
    """A motion whose links have the same names gave numbers of neither mechanism."""
    equations = ck.loop_equations(load("four-bar-norton"), order=1).velocity
    for name in ("crank-rocker", "slider-crank"):
        with pytest.raises(ck.errors.InvalidInput, match="another mechanism"):
            equations.at(ck.solve(load(name)))
    assert equations.at(ck.solve(load("four-bar-norton"))).solution.shape == (73, 2)


@pytest.mark.parametrize("name", ["groove-cam-plate", "slider-crank-offset"])
def test_conditions_do_not_depend_on_the_unit(name: str) -> None:
    """Along a profile through points the parameter is a length: in other units all poses were singular."""
    found = []
    for factor in (1.0, 1e-9, 1e9):
        mechanism = scaled(load(name), factor)
        found.append(ck.loop_equations(mechanism, order=1).velocity.at(ck.solve(mechanism)))
        assert not found[-1].singular.any()
    assert np.allclose(found[1].condition, found[0].condition, rtol=1e-6)
    assert np.allclose(found[2].condition, found[0].condition, rtol=1e-6)
