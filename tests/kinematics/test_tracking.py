"""Groups without a closed form: the configuration is chosen, tracked, and lost exactly at its limit positions."""

from __future__ import annotations

import warnings
from time import process_time
from typing import Any

import numpy as np
import pytest
from scipy.optimize import fsolve

import compoundkin as ck
from compoundkin.kinematics import Motion
from tests.support import differences, reference

JOINTS = {
    k: complex(*v) for k, v in reference("circ_stephenson_iii_triad_input", "circuits")["dimensions"]["joints"].items()
}
LINKS = {"AB": "AB", "BCE": "BCE", "CD": "DC", "EF": "EF", "FG": "GF"}


def stephenson(driver: str = "FG", drawn: bool = True) -> ck.Mechanism:
    """By coordinates in axes parallel to the drawing's, so that an angle is the turn from the drawn pose."""
    links = [ck.link("frame", **{k: JOINTS[k] for k in "ADG"})]
    links += [ck.link(name, **{k: JOINTS[k] - JOINTS[on[0]] for k in on}) for name, on in LINKS.items()]
    return ck.Mechanism("Stephenson III", *links, ck.drive(driver), *([ck.drawn(**JOINTS)] if drawn else []))


def placed(turns: dict[str, float]) -> dict[str, complex]:
    """The joints when every link is turned from its drawn direction."""
    u = {name: np.exp(1j * turns[name]) for name in LINKS}
    at = {k: JOINTS[k] for k in "ADG"}
    at["B"] = at["A"] + u["AB"] * (JOINTS["B"] - JOINTS["A"])
    at["C"] = at["B"] + u["BCE"] * (JOINTS["C"] - JOINTS["B"])
    at["E"] = at["B"] + u["BCE"] * (JOINTS["E"] - JOINTS["B"])
    at["F"] = at["G"] + u["FG"] * (JOINTS["F"] - JOINTS["G"])
    return {k: complex(v) for k, v in at.items()}


def quietly(*args: Any, **words: Any) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(*args, **words)


def keeps_its_lengths(motion: Motion, mechanism: ck.Mechanism) -> bool:
    """Closure without any of the package's equations: the distances on every link."""
    good = motion.assembled
    for name, letters in mechanism.pins.items():
        for link in letters:
            there = motion.links[link].at(mechanism.geometry.points[link][name]).position
            if (
                np.max(np.abs(there - motion.points[name].position)[good], initial=0.0)
                > 1e-10 * mechanism.geometry.size
            ):
                return False
    return bool(np.isnan(motion.points[name].position[~good]).all())


def test_it_is_a_class_iii_group() -> None:
    (group,) = ck.decompose(stephenson()).groups
    assert (group.class_, group.order) == (3, 3)
    motion = ck.solve(stephenson(), {"FG": 0.0}, order=0)
    assert max(abs(complex(motion.points[k].position) - p) for k, p in JOINTS.items()) < 1e-11


def test_full_turns_of_the_circuit_without_turning_points() -> None:
    """Two turns forth: closure, continuity, derivatives, and the same pose after each turn."""
    entry = reference("circ_stephenson_iii_triad_input", "circuits")
    whole = next(c for c in entry["expected"]["circuits"] if c["n_turning_points"] == 0)
    turns = whole["one_configuration"]
    angles = turns["FG"] + np.linspace(0, 4 * np.pi, 1441)
    mechanism = stephenson(drawn=False)
    motion = ck.solve(mechanism, {"FG": angles}, hint=placed(turns), order=3)
    assert np.all(motion.assembled)
    assert keeps_its_lengths(motion, mechanism)
    for name in LINKS:
        angle = motion.links[name].angle
        assert abs(np.angle(np.exp(1j * (angle[0] - turns[name])))) < 1e-9
        assert np.max(np.abs(np.diff(angle))) < 0.1
        assert np.allclose(np.exp(1j * angle[720]), np.exp(1j * angle[0]), atol=1e-9)
        assert np.allclose(np.exp(1j * angle[1440]), np.exp(1j * angle[0]), atol=1e-9)
    step = angles[1] - angles[0]
    for start in (100, 500, 1000):
        for k, expected in enumerate(differences(motion.points["E"].position[start : start + 9], step), start=1):
            assert abs(motion.points["E"].derivative(k)[start + 4] - expected) < 1e-3 * (1 + abs(expected))


def boundary(values: np.ndarray, assembled: np.ndarray) -> float:
    """The driver value where a run of assembled poses, from the first on, ends."""
    assert assembled[0]
    end = int(np.argmin(assembled))
    assert end > 0
    assert not assembled[end:].any()
    return float(values[end - 1] + values[end]) / 2


ENTRY = reference("circ_stephenson_iii_triad_input", "circuits")
TURNING = [t for c in ENTRY["expected"]["circuits"] for t in c["turning_configurations"]]
# The side of each turning value on which the two configurations that meet there exist.
SIDES = (-1.0, 1.0, -1.0, 1.0, -1.0, 1.0)


@pytest.mark.parametrize(
    ("turns", "side"), list(zip(TURNING, SIDES, strict=True)), ids=[f"{t['FG']:.4f}" for t in TURNING]
)
def test_the_tracked_configuration_ends_at_the_turning_value(turns: dict[str, float], side: float) -> None:
    """From a thousandth of a radian on one side of it; samples 1e-8 apart around the limit itself."""
    away = turns["FG"] + side * np.geomspace(1e-3, 1e-6, 20)
    values = np.concatenate([away, turns["FG"] + side * np.linspace(5e-8, -5e-8, 11)])
    motion = quietly(stephenson(drawn=False), {"FG": values}, hint=placed(turns), order=0)
    assert max(abs(motion.points[k].position[0] - placed(turns)[k]) for k in "BCE") < 1.0
    assert abs(boundary(values, motion.assembled) - turns["FG"]) < 1e-8
    assert keeps_its_lengths(motion, stephenson(drawn=False))


def test_a_hint_from_which_newton_does_not_get_anywhere() -> None:
    """Beyond a turning value nothing is near the hint; another configuration is there and is found."""
    turns, side = TURNING[0], -SIDES[0]
    motion = quietly(stephenson(drawn=False), {"FG": turns["FG"] + side * 1e-2}, hint=placed(turns), order=0)
    assert motion.assembled
    assert keeps_its_lengths(motion, stephenson(drawn=False))


def test_gaps_name_the_limits_of_the_circuit() -> None:
    """From a configuration between two turning values, forth and back: `gaps` finds both to 1e-8."""
    circuit = next(c for c in ENTRY["expected"]["circuits"] if c["n_turning_points"])
    turns = circuit["one_configuration"]
    limits = np.array(circuit["input_turning_values"])
    values = turns["FG"] + np.linspace(0, 2 * np.pi, 181)
    forth = quietly(stephenson(drawn=False), {"FG": values}, hint=placed(turns))
    back = quietly(stephenson(drawn=False), {"FG": turns["FG"] - (values - turns["FG"])}, hint=placed(turns))
    for motion in (forth, back):
        (gap,) = ck.gaps(motion)
        begin = np.angle(np.exp(1j * gap.begin["FG"]))
        assert np.min(np.abs(limits - begin)) < 1e-8
        assert "limit" in gap.reason


def test_driven_at_the_first_crank_the_limits_are_those_published() -> None:
    """The same six-bar as two dyads: limits at -58.899 and 41.305 degrees, where the second one cannot follow."""
    entry = reference("circ_pmks_stephenson_iii", "circuits")
    limits = np.deg2rad(entry["expected"]["reference_circuit_turning_input_deg"])
    for limit in limits:
        values = np.concatenate([np.linspace(0, limit * 0.999, 30), limit * (1 + np.linspace(-5e-8, 5e-8, 11))])
        motion = quietly(stephenson("AB"), {"AB": values}, order=0)
        assert abs(boundary(values, motion.assembled) - limit) < 1e-8


@pytest.mark.parametrize("start", [0, 25, 50])
def test_the_drawing_may_show_any_pose_of_the_motion(start: int) -> None:
    """The motion through the drawn pose is one and the same, wherever along it the drawing is."""
    values = np.linspace(-0.6, 0.6, 51)
    motion = ck.solve(stephenson(), {"FG": values})
    drawing = {k: complex(motion.points[k].position[start]) for k in JOINTS}
    again = ck.solve(stephenson(drawn=False).replace(ck.drawn(**drawing)), {"FG": values})
    assert np.allclose(again.points["E"].position, motion.points["E"].position, atol=1e-9)
    assert np.allclose(again.points["E"].acceleration, motion.points["E"].acceleration, atol=1e-6)


def test_the_way_from_the_drawing_to_the_motion_is_tracked() -> None:
    """Values that begin far from the drawn pose: the same configuration as that of a motion from the drawing."""
    circuit = next(c for c in ENTRY["expected"]["circuits"] if not c["n_turning_points"])
    turns = circuit["one_configuration"]
    drawing = ck.drawn(**placed(turns))
    mechanism = stephenson(drawn=False).replace(drawing)
    long = ck.solve(mechanism, {"FG": turns["FG"] + np.linspace(0, 2.5, 101)}, order=1)
    short = ck.solve(mechanism, {"FG": turns["FG"] + np.linspace(2.0, 2.5, 21)}, order=1)
    assert np.allclose(short.points["E"].position, long.points["E"].position[80:], atol=1e-9)
    assert np.allclose(short.points["E"].velocity, long.points["E"].velocity[80:], atol=1e-8)


def test_forward_and_backward_and_one_by_one() -> None:
    values = np.linspace(-0.5, 0.7, 41)
    motion = ck.solve(stephenson(), {"FG": values}, order=3)
    reverse = ck.solve(stephenson(), {"FG": values[::-1]}, order=3)
    for k in range(4):
        assert np.allclose(
            reverse.points["C"].derivative(k)[::-1], motion.points["C"].derivative(k), rtol=1e-8, atol=1e-8
        )
    for index in (0, 20, 40):
        alone = ck.solve(stephenson(), {"FG": values[index]}, order=3)
        for k in range(4):
            found = complex(alone.points["C"].derivative(k))
            assert abs(found - motion.points["C"].derivative(k)[index]) < 1e-8 * (1 + abs(found))


def test_designs_of_a_group_without_closed_form() -> None:
    rng = np.random.default_rng(1)
    designs = 3
    change = {k: 0.2 * (rng.standard_normal((designs, 1)) + 1j * rng.standard_normal((designs, 1))) for k in "BCE"}
    values = np.linspace(0, 0.5, 21)

    def mechanism(pick: Any) -> ck.Mechanism:
        items = []
        for item in stephenson().items[:-2]:
            points = {k: p + pick(change[k]) if k in change else p for k, p in item.points.items()}
            items.append(ck.link(item.name, **(points if item.name in ("BCE",) else item.points)))
        return ck.Mechanism("m", *items, ck.drive("FG"), ck.drawn(**JOINTS))

    together = ck.solve(mechanism(lambda c: c), {"FG": values})
    assert together.shape == (designs, 21)
    for row in range(designs):
        alone = ck.solve(mechanism(lambda c, row=row: complex(c[row, 0])), {"FG": values})
        for k in range(3):
            assert np.allclose(together.points["E"].derivative(k)[row], alone.points["E"].derivative(k), atol=1e-7)


# --- other groups, against scipy ----------------------------------------------------------------------------


def followed(equations: Any, start: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """The plain way: `fsolve` at every pose from the pose before."""
    rows = []
    for values in inputs:
        start, _, _, message = fsolve(equations, start, args=(values,), xtol=1e-14, full_output=True)
        assert np.max(np.abs(equations(start, values))) < 1e-9, message
        rows.append(start)
    return np.array(rows)


def test_platform_with_three_driven_cranks() -> None:
    """A 3-RRR platform, against six loop equations."""
    ground = [0j, 6 + 0j, 3 + 5j]
    corners = [0j, 2 + 0j, 1 + 1.7j]
    cranks, rods = [1.2, 1.1, 1.3], [2.0, 2.1, 1.9]
    mechanism = ck.Mechanism(
        "3-RRR",
        ck.link("frame", **{f"A{k}": p for k, p in enumerate(ground)}),
        ck.link("platform", **{f"C{k}": p for k, p in enumerate(corners)}),
        *[ck.link(f"crank{k}", **{f"A{k}": 0, f"B{k}": cranks[k]}) for k in range(3)],
        *[ck.link(f"rod{k}", **{f"B{k}": 0, f"C{k}": rods[k]}) for k in range(3)],
        *[ck.drive(f"crank{k}") for k in range(3)],
    )
    (group,) = ck.decompose(mechanism).groups
    assert len(group.bodies) == 4
    time = np.linspace(0, 1, 41)
    inputs = np.stack([0.9 + 0.4 * time, 2.6 - 0.5 * time, -1.6 + 0.3 * time], axis=-1)

    def equations(x: np.ndarray, drive: np.ndarray) -> list[float]:
        gaps = [
            x[0] + 1j * x[1] + corners[k] * np.exp(1j * x[2]) - ground[k] - cranks[k] * np.exp(1j * drive[k])
            for k in range(3)
        ]
        return [abs(g) ** 2 - r**2 for g, r in zip(gaps, rods, strict=True)]

    start = followed(equations, np.array([2.0, 1.0, 0.2]), inputs[:1])
    expected = followed(equations, start[0], inputs)
    corner = {f"C{k}": complex(start[0][0], start[0][1]) + p * np.exp(1j * start[0][2]) for k, p in enumerate(corners)}
    values = {f"crank{k}": inputs[:, k] for k in range(3)}
    speeds = dict(zip(values, (0.4, -0.5, 0.3), strict=True))
    motion = ck.solve(mechanism, values, speed=speeds, hint=corner, order=3)
    assert np.all(motion.assembled)
    assert np.allclose(motion.points["C0"].position, expected[:, 0] + 1j * expected[:, 1], atol=1e-9)
    assert np.allclose(np.exp(1j * motion.links["platform"].angle), np.exp(1j * expected[:, 2]), atol=1e-9)
    for k, derivative in enumerate(differences(motion.points["C1"].position[16:25], time[1] - time[0]), start=1):
        assert abs(motion.points["C1"].derivative(k)[20] - derivative) < 1e-5 * (1 + abs(derivative))


def test_platform_on_three_cylinders() -> None:
    """A 3-RPR platform: each leg is a composite body of changing length."""
    ground, corners = [0j, 5 + 0j, 2 + 5j], [0j, 1.5 + 0j, 0.5 + 1.2j]
    mechanism = ck.Mechanism(
        "3-RPR",
        ck.link("frame", **{f"A{k}": p for k, p in enumerate(ground)}),
        ck.link("platform", **{f"C{k}": p for k, p in enumerate(corners)}),
        *[ck.link(f"cylinder{k}", **{f"A{k}": 0}) for k in range(3)],
        *[ck.link(f"rod{k}", **{f"C{k}": 0}) for k in range(3)],
        *[ck.slide(f"rod{k}", on=f"cylinder{k}", through=f"A{k}") for k in range(3)],
        *[ck.drive(f"rod{k}", on=f"cylinder{k}") for k in range(3)],
    )
    pose = lambda t: (1.6 + 0.3 * t + 1j * (1.2 + 0.2 * t), 0.3 * t)  # noqa: E731  a motion of the platform
    time = np.linspace(0.1, 1, 41)  # at -0.16 the three legs meet in a point
    z, angle = pose(time)
    reach = [np.abs(z + c * np.exp(1j * angle) - g) for c, g in zip(corners, ground, strict=True)]
    values = {f"rod{k}": r for k, r in enumerate(reach)}
    first = {f"C{k}": complex(z[0] + c * np.exp(1j * angle[0])) for k, c in enumerate(corners)}
    step = time[1] - time[0]
    rates = {k: differences(r[16:25], step) for k, r in values.items()}
    motion = ck.solve(mechanism, values, hint=first, order=0)
    assert np.all(motion.assembled)
    assert np.allclose(motion.points["C0"].position, z, atol=1e-9)
    assert np.allclose(motion.links["platform"].angle, angle, atol=1e-9)
    middle = ck.solve(
        mechanism,
        {k: v[20] for k, v in values.items()},
        speed={k: r[0] for k, r in rates.items()},
        acceleration={k: r[1] for k, r in rates.items()},
        jerk={k: r[2] for k, r in rates.items()},
        hint={f"C{k}": complex(z[20] + c * np.exp(1j * angle[20])) for k, c in enumerate(corners)},
        order=3,
    )
    assert abs(complex(middle.points["C0"].velocity) - (0.3 + 0.2j)) < 1e-7
    assert abs(complex(middle.points["C0"].acceleration)) < 1e-6
    assert abs(complex(middle.points["C0"].jerk)) < 1e-4
    assert abs(float(middle.links["platform"].angular_velocity) - 0.3) < 1e-7


def test_platform_with_a_leg_on_a_slide() -> None:
    """A class III group with a prismatic pair: a platform on two rods and a block on the frame."""
    u0, c0 = np.exp(0.1j), 2.5 + 3j
    e0, f0 = c0 + 2 * u0, c0 + (1 + 1.5j) * u0
    rod, rocker = abs(c0 - np.exp(1j)), abs(e0 - 6)
    guide = complex(np.exp(-1j * np.pi / 18))
    start = complex(f0 - 2.5 * guide)
    mechanism = ck.Mechanism(
        "Slide triad",
        ck.link("frame", A=0, D=(6, 0), G=start),
        ck.link("crank", A=0, B=1),
        ck.link("rod", B=0, C=rod),
        ck.link("platform", C=0, E=(2, 0), F=(1, 1.5)),
        ck.link("rocker", D=0, E=rocker),
        ck.link("block", F=0),
        ck.slide("block", on="frame", through="G", angle=ck.deg(-10)),
        ck.drive("crank"),
    )
    (group,) = ck.decompose(mechanism).groups
    assert {p.code for p in (*group.inner, *group.outer)} == {"R", "P"}

    def equations(x: np.ndarray, drive: float) -> list[float]:
        z, u = x[0] + 1j * x[1], np.exp(1j * x[2])
        f = z + u * (1 + 1.5j)
        return [
            abs(z - np.exp(1j * drive)) ** 2 - rod**2,
            abs(z + 2 * u - 6) ** 2 - rocker**2,
            (np.conj(guide) * (f - start)).imag,
        ]

    angles = np.linspace(1.0, 0.75, 41)
    expected = followed(equations, np.array([c0.real, c0.imag, 0.1]), angles)
    z, u = expected[:, 0] + 1j * expected[:, 1], np.exp(1j * expected[:, 2])
    hint = {"C": c0, "E": complex(e0), "F": complex(f0)}
    motion = ck.solve(mechanism, {"crank": angles}, hint=hint, order=3)
    assert np.all(motion.assembled)
    assert np.allclose(motion.points["C"].position, z, atol=1e-8)
    assert np.allclose(motion.points["F"].position, z + u * (1 + 1.5j), atol=1e-8)
    slide = motion.pairs["block/frame"]
    assert np.allclose(slide.value, (np.conj(guide) * (motion.points["F"].position - start)).real, atol=1e-10)
    assert np.allclose(motion.links["block"].angle, -np.pi / 18, atol=1e-10)
    for k, derivative in enumerate(differences(slide.value[16:25], angles[1] - angles[0]), start=1):
        assert abs((slide.rate, slide.second, slide.third)[k - 1][20] - derivative) < 1e-5 * (1 + abs(derivative))


def test_dyads_on_a_tracked_group() -> None:
    """A dyad that hangs on a class III group moves on with it."""
    sketch = {**JOINTS, "P": 30 + 45j}
    chain = ck.Mechanism(
        "m", *stephenson().items[:-1], ck.link("one", "E", "P"), ck.link("two", "P", "C"), ck.drawn(**sketch)
    )
    motion = ck.solve(chain, {"FG": np.linspace(0, 0.4, 11)}, order=3)
    assert np.allclose(
        np.abs(motion.points["P"].position - motion.points["E"].position), abs(sketch["P"] - sketch["E"])
    )
    assert np.allclose(
        np.abs(motion.points["P"].position - motion.points["C"].position), abs(sketch["P"] - sketch["C"])
    )
    # P, E and C keep their distances: they move as one body with BCE
    assert np.allclose(motion.links["one"].angular_jerk, motion.links["BCE"].angular_jerk, atol=1e-6)


def test_without_a_drawing_some_configuration_is_found() -> None:
    motion = quietly(stephenson(drawn=False), {"FG": np.linspace(0, 0.3, 7)})
    assert motion.assembled[0]
    assert keeps_its_lengths(motion, stephenson(drawn=False))
    again = quietly(stephenson(drawn=False), {"FG": np.linspace(0, 0.3, 7)})
    assert np.array_equal(again.points["E"].position, motion.points["E"].position, equal_nan=True)


def test_a_group_that_cannot_be_assembled_at_all() -> None:
    items = [i for i in stephenson(drawn=False).items if getattr(i, "name", "") != "EF"]
    short = ck.Mechanism("Too short", *items, ck.link("EF", E=0, F=0.5))
    with pytest.raises(ck.errors.NotAssembled, match="no assembled pose"):
        ck.solve(short, {"FG": 0.0})


@pytest.mark.full
def test_designs_drawn_at_angles_of_their_own_are_followed_like_each_by_itself() -> None:
    """Forty six-bars with limits of their own; ten took 9 s as all shared each step, or were not solved at all."""
    places = {"A": 0.6 + 0.2j, "B": -0.1 - 2.3j, "C": 0.4 - 2.1j, "D": 0.9 + 0.6j, "E": 0.8 + 0.8j, "F": 0.3 - 0.5j,
              "G": -0.3 + 1.5j}  # fmt: skip
    links = [ck.link("frame", "A", "D", "G"), ck.link("BCE", "B", "C", "E")]
    links += [ck.link(name, *name) for name in ("AB", "CD", "EF", "FG")]
    rng, count = np.random.default_rng(0), 40
    drawn = {k: p + 0.02 * (rng.standard_normal(count) + 1j * rng.standard_normal(count)) for k, p in places.items()}

    def motion(points: dict[str, Any]) -> Motion:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
            return ck.solve(ck.Mechanism("S", *links, ck.drive("FG"), ck.drawn(**points)), order=1)

    begin = process_time()
    together = motion({k: p[:, None] for k, p in drawn.items()})
    assert process_time() - begin < 10.0
    for design in (0, 17, 39):
        alone = motion({k: complex(p[design]) for k, p in drawn.items()})
        assert np.array_equal(alone.assembled, together.assembled[design])
        for k in range(2):
            both = alone.points["E"].derivative(k), together.points["E"].derivative(k)[design]
            assert np.allclose(*both, rtol=1e-7, atol=1e-9, equal_nan=True)


def turning_plate():
    """A plate that turns with the driver: two cranks about close pivots carry it, a third pulls it by a rod."""
    pivots = {"O": 0j, "H": 0.1 + 0.05j, "I": -0.1 - 0.1j}
    pins = {"E": 1 + 0j, "B": pivots["H"] + np.exp(0.9j), "C": pivots["I"] + 1.05 * np.exp(1.7j)}
    pins["A"] = pins["B"] + 0.15 * np.exp(0.5j)
    links = [ck.link("frame", *"OHI"), ck.link("plate", *"ABC"), ck.link("crank", "O", "E"), ck.link("rod", "E", "A")]
    links += [ck.link("one", "H", "B"), ck.link("two", "I", "C")]
    return ck.Mechanism("turning plate", *links, ck.drive("crank"), ck.drawn(**pivots, **pins))


@pytest.mark.parametrize("turned", [0.0, 1.0])
def test_a_motion_of_many_turns_is_followed_until_it_repeats_itself(turned, monkeypatch):
    mechanism = turning_plate() if turned else ck.load("class-iii-six-bar")
    turns = 2.0 * np.pi * np.array([0.0, -3.0, 2000.0])
    motion, once = ck.solve(mechanism, 0.3 + turns), ck.solve(mechanism, [0.3])
    (path,) = motion.followed.curve.paths.values()
    assert path.repeats.turns == 1
    assert path.s.size < 100
    np.testing.assert_allclose(np.abs(path.repeats.gone).max(), 2.0 * np.pi * turned)
    for letter in mechanism.carriers:
        np.testing.assert_allclose(
            motion.points[letter].velocity, once.points[letter].velocity[0], rtol=0.0, atol=1e-11 * once.size
        )
    # the same marched all along, which tells full turns of links too
    course = np.linspace(9.1, -20.3, 40)
    motion = ck.solve(mechanism, course)
    monkeypatch.setattr("compoundkin.kinematics.curve.group_paths.FEW_TURNS", np.inf)
    marched = ck.solve(mechanism, course)
    assert next(iter(marched.followed.curve.paths.values())).repeats is None
    for name in mechanism.links:
        np.testing.assert_allclose(motion.links[name].angle, marched.links[name].angle, rtol=0.0, atol=1e-12)
        own, other = (each.links[name].at(0.0).position for each in (motion, marched))
        np.testing.assert_allclose(own, other, rtol=0.0, atol=1e-12 * motion.size)


def test_a_zigzag_of_measured_drivers_is_followed():
    mechanism = ck.load("3-rrr")
    home = {name: float(np.ravel(values[0])[0]) for name, values in ck.solve(mechanism).inputs.drives.items()}
    noise = np.random.default_rng(0).normal(scale=1e-3, size=(3, 300))
    smooth = {name: start + 0.3 * np.linspace(-0.3, 0.7, 300) for name, start in home.items()}
    motion = ck.solve(mechanism, {name: values + noise[k] for k, (name, values) in enumerate(smooth.items())})
    assert motion.assembled.all()
    # it stays beside the motion without noise
    away = np.abs(motion.points["P"].position - ck.solve(mechanism, smooth).points["P"].position)
    assert 1e-4 * motion.size < away.max() < 1e-2 * motion.size
