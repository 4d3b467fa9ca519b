"""Coulomb friction: against the reference, closed forms of textbooks, and all equations solved at once by SciPy."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import root
from scipy.optimize._numdiff import approx_derivative

import compoundkin as ck
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.coulomb_friction import NONE, ONE, SEVERAL, FrictionInfluence, solve_coulomb
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.reactions.reverse_pass import reverse_pass, reverse_passes
from tests.support import drawn_values, random_sketch, reference, well_conditioned

SI = {"length": "m", "mass": "kg", "force": "N"}
CASE = reference("friction_slider_crank_and_wedge", "forces")


def slider_crank(*items: Any, sizes: Mapping[str, float], factor: float = 1.0) -> ck.Mechanism:
    """The slider-crank of the reference, its coefficients times a factor."""
    pins = [ck.friction(k, factor * sizes["mu_pin"], radius=sizes["pin_radius"]) for k in "OAB"]
    return ck.Mechanism(
        "slider-crank",
        ck.link("frame", O=0),
        ck.link("crank", O=0, A=sizes["r"]),
        ck.link("rod", A=0, B=sizes["l"]),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O", name="guide"),
        ck.drive("crank"),
        ck.friction("guide", factor * sizes["mu_guide"]),
        *pins,
        *items,
        units=SI,
    )


def test_slider_crank_of_the_reference() -> None:
    rows, sizes = CASE["expected"]["rows"], CASE["dimensions"]
    pushes = np.array([row["load_force_x"] for row in rows], dtype=complex)
    load = ck.force("piston", pushes, at="B")
    motion = ck.solve(slider_crank(load, sizes=sizes), {"crank": np.deg2rad([row["crank_deg"] for row in rows])})
    forces = ck.force_analysis(motion)

    def agrees(found: Any, expected: Any, scale: float) -> None:
        assert np.max(np.abs(np.asarray(found) - expected)) < 1e-13 * scale

    agrees(forces.drives["crank"].effort, [row["driver"] for row in rows], 100.0)
    agrees(forces.frictionless.drives["crank"].effort, [row["driver_without_friction"] for row in rows], 100.0)
    agrees(forces.pairs["A"].on("rod").force, [complex(*row["rod_from_crank"]) for row in rows], 2000.0)
    guide = forces.pairs["guide"].on("piston")
    agrees(guide.force.imag, [row["guide"]["normal"] for row in rows], 2000.0)
    agrees(guide.moment, [row["guide"]["moment"] for row in rows], 100.0)
    agrees(-forces.friction.power, [row["power_lost_at_speed_1"] for row in rows], 100.0)
    agrees(forces.efficiency.at_poses, [row["efficiency"] for row in rows], 1.0)
    agrees(np.abs(forces.pairs["guide"].friction), 0.1 * np.abs(guide.force.imag), 2000.0)
    # the same loads with the crank turned back are the other row of each angle
    agrees(forces.drives["crank"].backward[::2], -forces.drives["crank"].effort[1::2], 100.0)
    assert ck.verify(forces).passed
    for link in ("crank", "rod", "piston"):
        assert np.max(np.abs(forces.on(link).force)) < 1e-11
        assert np.max(np.abs(forces.on(link).moment_about("O"))) < 1e-12


def analysed(motion: Any, wedged: bool) -> Any:
    """The forces of a motion, which is wedged or not."""
    if not wedged:
        return ck.force_analysis(motion)
    with pytest.warns(ck.errors.WedgedPoses, match="wedged in .*; forces are NaN there"):
        return ck.force_analysis(motion)


def wedge(tangent: Any, floor: float, slope: float, wall: float, load: float = -1000.0) -> ck.Mechanism:
    """A wedge driven along the floor under a ram in a wall."""
    return ck.Mechanism(
        "wedge",
        ck.link("frame", O=0),
        ck.link("wedge", P=0),
        ck.link("ram", Q=0),
        ck.slide("wedge", on="frame", at="P", through="O", name="floor"),
        ck.slide("ram", on="frame", at="Q", through="O", angle=np.pi / 2, turn=np.pi / 2, name="wall"),
        ck.slot("ram", on="wedge", at="Q", through="P", angle=-np.arctan(tangent), name="slope"),
        ck.drive("wedge", on="frame"),
        ck.force("ram", (0.0, load), at="Q"),
        ck.friction("floor", floor),
        ck.friction("slope", slope),
        ck.friction("wall", wall),
        units=SI,
    )


def test_wedge_of_the_reference() -> None:
    expected = CASE["expected"]["wedge"]
    mu, tangent = expected["friction"], np.tan(np.deg2rad(expected["angle_deg"]))
    motion = ck.solve(wedge(tangent, mu, mu, mu), {"wedge": [1.0, 2.0]}, speed=np.array([1.0, -1.0]))
    forces = ck.force_analysis(motion)
    held = forces.drives["wedge"]
    up, down = expected["force_to_raise"], expected["force_to_hold_while_lowering"]
    assert held.effort == pytest.approx([up, down], rel=1e-13)
    assert held.backward == pytest.approx([down, up], rel=1e-12)
    assert forces.frictionless.drives["wedge"].effort == pytest.approx(expected["without_friction"], rel=1e-13)
    assert forces.efficiency.at_poses[0] == pytest.approx(expected["efficiency_raising"], rel=1e-13)
    assert forces.efficiency.backward[1] == pytest.approx(expected["efficiency_raising"], rel=1e-12)
    at_rest = ck.force_analysis(ck.solve(wedge(tangent, mu, mu, mu), {"wedge": [1.0]}, speed=0.0))
    low, high = at_rest.drives["wedge"].interval
    assert (low[0], high[0]) == pytest.approx((down, up), rel=1e-13)
    assert at_rest.friction.at_rest.all()


def test_wedge_locks_itself_and_is_wedged() -> None:
    """Self-locking begins at tan(angle / 2); nothing raises it where angle + 2 friction angles pass a right angle."""
    angle, begins = np.deg2rad(15.0), CASE["expected"]["wedge"]["self_locking_from_friction_coefficient"]
    for mu, locks in ((begins * (1.0 - 1e-9), False), (begins * (1.0 + 1e-9), True)):
        forces = ck.force_analysis(ck.solve(wedge(np.tan(angle), mu, mu, mu), {"wedge": [1.0]}))
        assert bool(forces.efficiency.self_locking[0]) is locks
        assert (forces.efficiency.backward[0] <= 0.0) == locks
    for speed in (1.0, -1.0):
        wedged = np.tan((np.pi / 2 - angle) / 2)
        for mu, stuck in ((0.999 * wedged, False), (1.001 * wedged, True)):
            motion = ck.solve(wedge(np.tan(angle), mu, mu, mu), {"wedge": [1.0]}, speed=speed)
            forces = analysed(motion, stuck)
            told = forces.friction.wedged
            assert bool(told) == np.isnan(forces.drives["wedge"].effort[0]) == stuck
            if told:
                assert "wedge at 1" in str(told[0])
                assert ("no forces" if speed > 0.0 else "more than one") in told[0].reason


def test_power_screw_of_shigley() -> None:
    """R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, example 8-1.

    Its thread is developed at the mean diameter of 30 mm, the collar of 40 mm a floor: raising takes
    15.94 + 10.24 N m, lowering -0.466 + 10.24, the efficiency is 0.311.
    """
    screw = wedge(8.0 / (np.pi * 30.0), 0.08 * 40.0 / 30.0, 0.08, 0.0, load=-6400.0)
    forces = ck.force_analysis(ck.solve(screw, {"wedge": [1.0, 2.0]}, speed=np.array([1.0, -1.0])))
    torque = forces.drives["wedge"].effort * np.array([1.0, -1.0]) * 0.030 / 2.0
    assert torque == pytest.approx([26.18, 9.77], abs=0.005)
    assert forces.efficiency.at_poses[0] == pytest.approx(0.311, abs=0.0005)
    # it takes work to lower: the load alone does not
    assert forces.efficiency.self_locking.all()


def test_block_on_an_incline() -> None:
    """Any holding effort within weight times sin(angle) -+ mu cos(angle); it stays by itself where tan(angle) <= mu."""
    mu, angles = 0.3, np.deg2rad(np.linspace(1.0, 80.0, 200))[:, None]
    incline = ck.Mechanism(
        "incline",
        ck.link("frame", O=0),
        ck.link("block", P=0),
        ck.slide("block", on="frame", at="P", through="O", angle=angles, turn=0.0, name="plane"),
        ck.drive("block", on="frame"),
        ck.mass("block", 2.0),
        ck.gravity(0.0, -10.0),
        ck.friction("plane", mu, length=0.2),
        units=SI,
    )
    forces = ck.force_analysis(ck.solve(incline, {"block": [1.0]}, speed=0.0), inertia=False)
    low, high = forces.drives["block"].interval
    assert low == pytest.approx(20.0 * (np.sin(angles) - mu * np.cos(angles)), abs=1e-13)
    assert high == pytest.approx(20.0 * (np.sin(angles) + mu * np.cos(angles)), abs=1e-13)
    assert np.array_equal(forces.efficiency.self_locking, np.tan(angles) <= mu)
    sliding = ck.force_analysis(ck.solve(incline, {"block": [1.0]}), inertia=False)
    assert np.array_equal(sliding.efficiency.self_locking, np.tan(angles) <= mu)
    assert sliding.drives["block"].effort == pytest.approx(high, rel=1e-13)


@pytest.mark.parametrize(("offset", "stuck"), [(0.9, False), (1.9999, False), (2.0001, True), (5.0, True)])
def test_drawer_that_jams(offset: float, stuck: bool) -> None:
    """A guide of length 1 pushed beside it jams at 2 mu offset > 1: at 2 with mu 0.25, the 2:1 rule of plain bearings.

    Source: igus, drylin R design tips, and PBC Linear, Cantilevered Loads and the 2:1 Ratio: binding beyond 2:1,
    by a coefficient of 0.25. In closed form the push is load / (1 - 2 mu offset / length).
    """
    drawer = ck.Mechanism(
        "drawer",
        ck.link("frame", O=0, R=(0.0, offset)),
        ck.link("hand", H=0),
        ck.link("drawer", P=0, Q=(0.0, offset)),
        ck.slide("hand", on="frame", at="H", through="R", name="arm"),
        ck.slide("drawer", on="frame", at="P", through="O", name="guide"),
        ck.slot("drawer", on="hand", at="Q", through="H", angle=np.pi / 2, name="grip"),
        ck.drive("hand", on="frame"),
        ck.force("drawer", (-10.0, 0.0), at="P"),
        ck.friction("guide", 0.25, length=1.0),
        units=SI,
    )
    forces = analysed(ck.solve(drawer, {"hand": [0.5, 1.0, 1.5]}), stuck)
    push = forces.drives["hand"].effort
    if stuck:
        assert np.isnan(push).all()
        (told,) = forces.friction.wedged
        assert (told.pair, told.stretch.first, told.stretch.last, told.stretch.values) == ("guide", 0, 2, (0.5, 1.5))
        assert "no forces" in str(told)
        assert forces.frictionless.drives["hand"].effort == pytest.approx(10.0)
    else:
        assert push == pytest.approx(10.0 / (1.0 - 0.5 * offset), rel=1e-9)
        assert not forces.friction.wedged
    # pulled by its load it may follow, or jam: two sets of forces
    back = analysed(ck.solve(drawer, {"hand": [0.5]}, speed=-1.0), stuck).friction.wedged
    assert ["more than one" in one.reason for one in back] == [True] * stuck


def named(motion: Any) -> Any:
    """The forces of a motion that may be wedged, which is looked at by name."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.WedgedPoses)
        return ck.force_analysis(motion)


# --- all equations at once ----------------------------------------------------------------------------------


def rubbed(rng: np.random.Generator, kinds: tuple[str, ...], driver: str) -> ck.Mechanism | None:
    """A random mechanism with masses, weights, loads and friction in every pair, or None."""
    plain = random_sketch(rng, kinds, driver).mechanism()
    if not well_conditioned(plain, 30.0, 0.1):
        return None
    pairs = ck.decompose(plain).pairs
    items: list[Any] = [ck.gravity(0.3, -9.81)]
    for name in plain.links:
        if name != "frame":
            items.append(ck.mass(name, rng.uniform(0.1, 2.0), at=tuple(rng.normal(size=2)), inertia=20.0))
            items.append(ck.force(name, tuple(rng.normal(size=2) * 20.0), at=plain.links[name].letters[0]))
    for pair in pairs:
        if pair.free_is_angle:
            items.append(ck.friction(pair.name, rng.uniform(0.0, 0.15), radius=rng.uniform(0.02, 0.2)))
        else:
            long = {"length": rng.uniform(2.0, 4.0)} if rng.random() < 0.5 else {}
            items.append(ck.friction(pair.name, rng.uniform(0.0, 0.08), **long))
    return ck.Mechanism("rubbed", *plain.items, *items, units=SI)


def by_all_equations(motion: Any) -> tuple[Any, Any]:
    """The drivers' efforts and the sizes of frictions at the one pose: all equations of all links, by SciPy's root.

    Unknown are x, y forces of pins, normal forces and moments of slides, efforts; Newton and Euler about the mass
    centres, by plain geometry.
    """
    mechanism, links = motion.mechanism, [name for name in motion.mechanism.links if name != "frame"]
    driven = {step.pair.name: step.drive.link for step in motion.structure.driven.values()}
    pairs = list(motion.structure.pairs)
    centre = {k: complex(motion.links[k].at(mechanism.masses[k].at).position[0]) for k in links}
    pushes = {load.link: load.force for load in mechanism.loads.values()}
    world = {k: complex(point.position[0]) for k, point in motion.points.items()}

    def acting(x: Any) -> tuple[dict[str, list[tuple[complex, complex, float]]], list[float]]:
        on: dict[str, list[tuple[complex, complex, float]]] = {name: [] for name in mechanism.links}
        sizes, k = [], 0
        for pair in pairs:
            one, other = pair.members
            rub, at = mechanism.frictions[pair.name], world[pair.letters[0]]
            rate = motion.pairs[pair.name].rate[0]
            rate = rate if abs(rate) > 1e-9 else 0.0
            if pair.free_is_angle:
                force, moment = complex(x[k], x[k + 1]), 0.0
                size = -np.sign(rate) * rub.coefficient * rub.radius * abs(force)
                moment += size
            else:
                _, through, toward = pair.letters
                along = (world[toward] - world[through]) / abs(world[toward] - world[through])
                force, moment = 1j * along * x[k], x[k + 1]
                if rub.length is None:
                    pressed = abs(x[k])
                else:
                    ends = np.linalg.solve([[1.0, 1.0], [rub.length / 2, -rub.length / 2]], x[k : k + 2])
                    pressed = np.sum(np.abs(ends))
                size = -np.sign(rate) * rub.coefficient * pressed
                force += along * size
            k += 2
            if pair.name in driven:
                effort = x[k] * (1.0 if driven[pair.name] == other else -1.0)
                force, moment = (force, moment + effort) if pair.free_is_angle else (force + along * effort, moment)
                k += 1
            sizes.append(size)
            on[other].append((at, force, moment))
            on[one].append((at, -force, -moment))
        return on, sizes

    def balance(x: Any) -> Any:
        on, _ = acting(x)
        rows = []
        for name in links:
            mass = mechanism.masses[name]
            everything = [*on[name], (world[mechanism.links[name].letters[0]], pushes[name], 0.0)]
            total = sum(force for _, force, _ in everything) + mass.mass * (0.3 - 9.81j)
            total -= mass.mass * complex(motion.links[name].at(mass.at).acceleration[0])
            turn = sum((np.conj(at - centre[name]) * force).imag + moment for at, force, moment in everything)
            rows += [total.real, total.imag, turn - mass.inertia * motion.links[name].angular_acceleration[0]]
        return np.array(rows)

    # linear but for friction: start where there is none
    found = root(balance, np.zeros(2 * len(pairs) + len(driven)), tol=1e-13)
    x = found.x
    for _ in range(3):
        x = x - np.linalg.solve(approx_derivative(balance, x), balance(x))
    _, sizes = acting(x)
    at_driver = 2 * next(k for k, pair in enumerate(pairs) if pair.name in driven) + 2
    return x[at_driver], (np.array(sizes), np.max(np.abs(balance(x))))


def test_random_mechanisms_by_all_equations_at_once() -> None:
    rng, count = np.random.default_rng(12), 0
    every = [("RRR",), ("RRP",), ("RPR",), ("PRP",), ("RPP",), ("RRR", "RRP"), ("RPR", "RRR")]
    while count < 14:
        kinds, driver = every[count % 7], "RP"[count % 2]
        mechanism = rubbed(rng, kinds, driver)
        if mechanism is None:
            continue
        values = {name: [value] for name, value in drawn_values(mechanism).items()}
        motion = ck.solve(mechanism, values, speed=1.3)
        forces = named(motion)
        effort, (sizes, residual) = by_all_equations(motion)
        if forces.friction.wedged or residual > 1e-9:
            continue
        scale = np.max(np.abs(sizes)) + abs(effort)
        ((_, held),) = forces.drives.items()
        assert held.effort[0] == pytest.approx(effort, abs=1e-11 * scale)
        found = [forces.pairs[pair.name].friction[0] for pair in motion.structure.pairs]
        assert np.max(np.abs(found - sizes)) < 1e-11 * scale
        count += 1


# --- laws that hold everywhere ------------------------------------------------------------------------------


def loaded(plain: ck.Mechanism, size: float, coefficient: float, rng: np.random.Generator) -> ck.Mechanism:
    """A mechanism with masses, weights and friction in all pairs that rub."""
    items: list[Any] = [ck.gravity(0.0, -9.81)]
    for name in plain.links:
        if name != "frame":
            place = tuple(rng.normal(size=2) * 0.1 * size)
            items.append(ck.mass(name, rng.uniform(0.5, 2.0), at=place, inertia=0.3 * size**2))
    used = ck.decompose(plain).pairs
    for pair in (pair for pair in used if "friction" in pair.takes):
        is_pin = pair.free_is_angle and pair.is_simple
        items.append(ck.friction(pair.name, coefficient, **({"radius": 0.02 * size} if is_pin else {})))
    return ck.Mechanism(plain.title, *plain.items, *items, units=SI)


@pytest.mark.parametrize(
    "name",
    ["scotch-yoke", "crank-shaper", "geneva-wheel", "flat-faced-follower", "groove-cam-plate", "windscreen-wiper"],
)
def test_powers_of_shipped_mechanisms(name: str) -> None:
    """Friction takes power only, as Coulomb's law has it; all powers add up to nothing."""
    plain = ck.load(name)
    forces = named(ck.solve(loaded(plain, ck.solve(plain).size, 0.05, np.random.default_rng(3))))
    good = np.isfinite(forces.friction.power)
    assert np.mean(good) > 0.7
    rounding = 1e-12 * np.max(np.abs(forces.power.kinetic_rate[good]))
    assert np.max(np.abs(forces.power.sum[good])) < rounding
    assert np.max(np.abs(forces.friction.power - forces.power.friction)[good]) < rounding
    for pair in forces.friction.pairs.values():
        assert np.all(pair.power[good] <= rounding)
        # the press times coefficient and radius, its wrench against the motion
        found = forces.pairs[pair.name]
        if pair.is_moment:
            radius = forces.motion.mechanism.frictions[pair.name].radius
            assert np.abs(pair.friction[good]) == pytest.approx(0.05 * radius * np.abs(found.force[good]), rel=1e-9)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.6))
def test_friction_takes_power(seed: int, coefficient: float) -> None:
    """At every pose that is not wedged, whatever the mechanism and its coefficient."""
    rng = np.random.default_rng(seed)
    plain = random_sketch(rng, [rng.choice(["RRR", "RRP", "RPR", "PRP", "RPP"])], rng.choice(["R", "P"])).mechanism()
    if not well_conditioned(plain, 30.0, 0.1):
        return
    values = {name: value + np.linspace(-0.1, 0.1, 7) for name, value in drawn_values(plain).items()}
    forces = named(ck.solve(loaded(plain, 3.0, coefficient, rng), values, speed=rng.normal()))
    good = ~np.isnan(forces.friction.power)
    powers = forces.power
    largest = np.max(np.abs([powers.kinetic_rate, powers.gravity, *powers.drives.values()]), axis=0, initial=0.0)[good]
    assert np.all(forces.friction.power[good] <= 1e-14 * largest)
    assert np.all(np.abs(powers.sum[good]) <= 1e-10 * largest)
    # wedged poses are named, the others have forces
    wedged = sum(one.stretch.last - one.stretch.first + 1 for one in forces.friction.wedged)
    assert wedged == np.count_nonzero(~good)


def test_little_friction_is_proportional() -> None:
    sizes = CASE["dimensions"]
    load, angles = ck.force("piston", (2000.0, 0.0), at="B"), np.linspace(0.1, 6.1, 50)

    def effort(factor: float) -> Any:
        motion = ck.solve(slider_crank(load, sizes=sizes, factor=factor), {"crank": angles})
        return ck.force_analysis(motion).drives["crank"].effort

    none = effort(0.0)
    slopes = [(effort(factor) - none) / factor for factor in (1e-3, 1e-4)]
    assert np.max(np.abs(slopes[1] - slopes[0])) < 2e-3 * np.max(np.abs(slopes[0]))
    assert np.max(np.abs(none - ck.force_analysis(ck.solve(slider_crank(load, sizes=sizes), {"crank": angles}))
                         .frictionless.drives["crank"].effort)) < 1e-11  # fmt: skip


def test_friction_that_equilibrium_leaves_open() -> None:
    """What presses in a third crank and its like is open: so is their friction, and the torque with it."""
    plain = ck.load("parallelogram-third-crank")
    load, angles = ck.force("coupler", (-20.0, -100.0), at="B"), {"crank": np.deg2rad([50.0, 120.0])}

    def forces(*frictions: Any) -> Any:
        return ck.force_analysis(ck.solve(ck.Mechanism("m", *plain.items, load, *frictions, units=SI), angles))

    rubbed = forces(ck.friction("A", 0.1, radius=0.01))
    assert rubbed.friction.undetermined == ("A",)
    assert "does not determine the normal force in A" in rubbed.friction.remarks[0]
    for value in (rubbed.drives["crank"].effort, rubbed.pairs["A"].friction, rubbed.pairs["B"].force):
        assert np.isnan(value).all()
    none = forces().drives["crank"].effort
    assert rubbed.frictionless.drives["crank"].effort == pytest.approx(none)
    # under the assumption that says which part is free, all is told; friction takes work
    assumed = rubbed.assuming_freed
    assert np.all(assumed.drives["crank"].effort > none)
    assert np.all(assumed.pairs["A"].friction_power < 0.0)


def test_multiple_pins_and_sides() -> None:
    """The letter of a multiple pin is friction in each of its pairs; what one link feels the other feels too."""
    plain = ck.load("toggle-press")
    (letter,) = (letter for letter, links in plain.pins.items() if len(links) == 3)
    items = ck.friction(letter, 0.1, radius=0.02), ck.force("slider", (-1e4, 0.0), at="D")
    mechanism = ck.Mechanism("m", *plain.items, *items, units=SI)
    forces = ck.force_analysis(ck.solve(mechanism, {"crank": np.deg2rad([45.0, 100.0])}))
    names = [pair.name for pair in forces.friction.pairs.values()]
    assert len(names) == 2
    assert all(name.startswith(f"{letter}(") for name in names)
    for name in names:
        found, (one, other) = forces.pairs[name], forces.pairs[name].pair.members
        assert np.array_equal(found.on(one).friction, -found.on(other).friction)
        assert np.abs(found.friction) == pytest.approx(0.1 * 0.02 * np.abs(found.force))
    assert np.max(np.abs(forces.power.sum)) < 1e-13 * np.max(np.abs(forces.power.drives["crank"]))


def counted(influence: FrictionInfluence, signs: Any, solutions: Any) -> None:
    """As many solutions are told as there are."""
    expected = np.select([solutions == 0, solutions == 1], [NONE, ONE], SEVERAL)
    assert {NONE, ONE, SEVERAL} == set(expected)
    assert np.array_equal(solve_coulomb(influence, signs).state, expected)


def test_how_many_solutions_a_pin_has() -> None:
    """A pin's friction that adds b to its force a: m = |a - b m|, a quadratic equation."""
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 2000)) + 1j * rng.normal(size=(2, 2000))
    square, linear, constant = 1.0 - np.abs(b) ** 2, 2.0 * (np.conj(a) * b).real, -(np.abs(a) ** 2)
    with np.errstate(invalid="ignore"):
        root_of = np.sqrt(linear**2 - 4.0 * square * constant)
    roots = [(-linear + sign * root_of) / (2.0 * square) for sign in (1.0, -1.0)]
    influence = FrictionInfluence(a[None], b[None, None], np.array([0]))
    counted(influence, np.ones((1, 2000)), np.sum(np.array(roots) >= 0.0, axis=0))


@pytest.mark.full
def test_how_many_solutions_contacts_have() -> None:
    """Forces in three contacts keep their signs: eight linear systems, whose solutions are right or not."""
    rng, size = np.random.default_rng(1), 600
    own, by = rng.normal(size=(3, size)), rng.normal(size=(3, 3, size)) * rng.uniform(0.0, 1.2, size)
    senses, count = rng.choice([1.0, -1.0], size=(3, size)), np.zeros(size, dtype=int)
    for signs in product((1.0, -1.0), repeat=3):
        matrix = np.eye(3) + by.transpose(2, 1, 0) * (senses.T * np.array(signs))[:, None]
        forces = np.linalg.solve(matrix, own.T[..., None])[..., 0]
        count += np.all(forces * np.array(signs) >= 0.0, axis=1)
    counted(FrictionInfluence(own + 0j, by + 0j, np.arange(3)), senses, count)


@pytest.mark.parametrize("torque", [12.0, -12.0])
def test_gears_whose_bearings_rub(torque: float) -> None:
    """Bearings carry F / cos(pressure angle) of the tooth force F, so that the losses part the gears as well.

    On the wheel F (r2 - lever) is its torque, on the pinion F (r1 + lever) is the driver's, where it drives; the lever
    is coefficient times radius of the bearing over the cosine. Driven by its load the wheel has the signs changed.
    """
    rough = (ck.friction(name, 0.1, radius=0.02) for name in ("O", "Q"))
    train = ck.Mechanism(
        "gears",
        ck.link("frame", O=0, Q=0.3),
        ck.link("pinion", O=0),
        ck.link("wheel", Q=0),
        ck.gear("pinion", "wheel", carrier="frame", radii=(0.1, 0.2), pressure_angle=np.deg2rad(25.0)),
        ck.drive("pinion"),
        ck.torque("wheel", torque),
        *rough,
        units=SI,
    )
    forces = ck.force_analysis(ck.solve(train, {"pinion": [0.0, 1.0]}))
    lever = 0.1 * 0.02 / np.cos(np.deg2rad(25.0)) * np.sign(torque)
    tooth = torque / (0.2 - lever)
    assert forces.drives["pinion"].effort == pytest.approx(tooth * (0.1 + lever), rel=1e-14)
    assert np.abs(forces.pairs["Q"].friction) == pytest.approx(0.002 * np.abs(forces.pairs["Q"].force), rel=1e-14)
    assert ck.verify(forces).passed
    held = ck.force_analysis(ck.solve(train, {"pinion": [0.0]}, speed=0.0)).drives["pinion"].interval
    back = torque / (0.2 + lever) * (0.1 - lever)
    assert held[0][0] == pytest.approx(min(back, forces.drives["pinion"].effort[0]), rel=1e-14)


def test_efficiency_of_a_whole_motion() -> None:
    """Work out over work in, by time or by the driver, from rest, and backward; there and back of one motion alike."""
    machine = slider_crank(ck.force("piston", (2000.0, 0.0), at="B"), sizes=CASE["dimensions"])
    angles, times = np.linspace(0.3, 2.9, 2001), np.linspace(0.0, 1.0, 2001)

    def over(values: Any, **rates: Any) -> Any:
        return ck.force_analysis(ck.solve(machine, {"crank": values}, **rates)).efficiency.over_motion

    steady = over(angles)
    # the load takes its force times the way; the driver gives its effort times the angle
    forces = ck.force_analysis(ck.solve(machine, {"crank": angles}))
    way, effort = forces.motion.points["B"].x, forces.drives["crank"].effort
    given = np.sum(0.5 * (effort[1:] + effort[:-1]) * np.diff(angles))
    assert steady == pytest.approx(2000.0 * (way[0] - way[-1]) / given, rel=1e-6)
    assert over(0.3 + 2.6 * times**2, speed=5.2 * times, acceleration=5.2) == pytest.approx(steady, rel=1e-4)
    backward = over(angles[::-1], speed=-1.0)
    assert over(angles, speed=np.array([[1.0], [-1.0]])) == pytest.approx([steady, backward], rel=1e-12)
    assert 0.8 < backward < steady


# --- all solutions of Coulomb's law -------------------------------------------------------------------------


def pins(rng: np.random.Generator, count: int, systems: int) -> tuple[FrictionInfluence, Any]:
    """Random systems of pins that feed on each other strongly, and the signs of their motions."""
    own, by = (rng.normal(size=(*size, systems, 2)) @ (1, 1j) for size in ((count,), (count, count)))
    return FrictionInfluence(own, by / np.sqrt(count), np.arange(count)), rng.choice([-1.0, 1.0], (count, systems))


def by_newton(own: Any, effect: Any, rng: np.random.Generator) -> int:
    """The number of solutions of m = |own + effect m| with m >= 0 that Newton's method finds from a thousand places."""
    m = 10.0 ** rng.uniform(-2.0, 2.0, (1000, len(own)))
    for _ in range(40):
        forces = own + m @ effect.T
        sizes = np.abs(forces)
        slopes = np.eye(len(own)) - (np.conj(forces / sizes)[..., None] * effect).real
        m = m - np.linalg.solve(slopes, (m - sizes)[..., None])[..., 0]
    gap = np.abs(m - np.abs(own + m @ effect.T)).max(axis=1)
    good = m[(gap < 1e-10 * m.max(axis=1)) & np.all(m >= 0.0, axis=1)]
    return len({tuple(row) for row in np.round(good, 6).tolist()})


@pytest.mark.parametrize("count", [2, pytest.param(4, marks=pytest.mark.full)])
def test_no_solution_of_coulombs_law_is_missed(count: int) -> None:
    """Newton's method from a thousand places each never knows of one more."""
    rng = np.random.default_rng({2: 33, 4: 43}[count])
    influence, signs = pins(rng, count, 60)
    state = solve_coulomb(influence, signs).state
    for k, found in enumerate(state.tolist()):
        known = by_newton(influence.own[:, k], -(signs[:, k, None] * influence.by[..., k]).T, rng)
        assert found == SEVERAL or known <= (found == ONE), (count, k)
    assert {NONE, ONE, SEVERAL} <= set(state.tolist())


@pytest.mark.parametrize(
    "name", ["jansen-leg", "class-iii-six-bar", "planetary-train", "disc-cam-roller-program", "toggle-press"]
)
def test_reactions_of_several_sets_of_loads_at_once(name: str) -> None:
    """They are those of each set alone."""
    motion, rng = ck.solve(ck.load(name)), np.random.default_rng(4)
    at = next(iter(loaded_blocks(motion)))
    links = [link for link in motion.mechanism.links if link != "frame"]
    shape = at.block.shape

    def drawn() -> dict[str, Wrench]:
        some = rng.choice(links, max(1, len(links) // 2), replace=False)
        return {str(link): Wrench(rng.normal(size=shape) @ np.eye(shape[1]) * (1 + 2j), rng.normal()) for link in some}

    sets = [drawn() for _ in range(4)]
    together = reverse_passes(motion.solving_order, at.block, sets)
    for loads, found in zip(sets, together, strict=True):
        alone = reverse_pass(motion.solving_order, at.block, loads)
        for pair, wrench in alone.pairs.items():
            for one, other in ((found.pairs[pair].force, wrench.force), (found.pairs[pair].moment, wrench.moment)):
                scale = np.nanmax(np.abs(other)) + 1.0
                assert np.nanmax(np.abs(np.broadcast_to(one - other, shape))) < 1e-9 * scale
                assert np.array_equal(np.isnan(np.broadcast_to(one, shape)), np.isnan(np.broadcast_to(other, shape)))
