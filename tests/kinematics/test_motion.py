"""`solve` and `Motion`: drivers of every sort, arrays, blocks, modes, unassembled poses."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import compoundkin as ck
from compoundkin.base.arrays import unwrapped
from compoundkin.kinematics import Motion, Vectors, solution
from tests.support import KINDS_OF_DYAD, differences, drawn_values, random_sketch, well_conditioned


def four_bar(crank: Any = 1.0, coupler: Any = 3.0, rocker: Any = 3.0, frame: Any = 4.0, *more: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(frame, 0)),
        ck.link("crank", A=(0, 0), B=(crank, 0)),
        ck.link("coupler", B=(0, 0), C=(coupler, 0), P=(1, 1)),
        ck.link("rocker", D=(0, 0), C=(rocker, 0)),
        ck.drive("crank"),
        *more,
    )


def quietly(*args: Any, **words: Any) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.UnassembledPoses)
        return ck.solve(*args, **words)


def jib() -> ck.Mechanism:
    """A jib about O lifted by a cylinder from D to E: a driven slide between two moving links."""
    return ck.Mechanism(
        "Crane",
        ck.link("frame", O=(0, 0), D=(0.8, -0.9)),
        ck.link("jib", O=(0, 0), E=(1.8, -0.1), T=(5, 0)),
        ck.link("cylinder", D=(0, 0)),
        ck.link("rod", E=(0, 0)),
        ck.slide("rod", on="cylinder", at="E", through="D", name="ram"),
        ck.drive("rod", on="cylinder"),
    )


def test_cylinder_between_moving_links() -> None:
    """Against the law of cosines in the triangle O D E, and its derivatives by differences."""
    reach = np.linspace(1.3, 2.3, 41)
    speed = 0.05
    motion = ck.solve(jib(), {"rod": reach}, speed=speed, order=3, hint={"E": (1.7, 0.6)})
    base, arm = abs(0.8 - 0.9j), abs(1.8 - 0.1j)

    def angle(length: Any) -> Any:
        at_o = np.arccos((base**2 + arm**2 - length**2) / (2 * base * arm))
        return at_o + np.angle(0.8 - 0.9j) - np.angle(1.8 - 0.1j)

    found = motion.links["jib"]
    assert np.all(motion.assembled)
    assert np.allclose(found.angle, angle(reach), atol=1e-12)
    step = 1e-3
    sampled = angle(reach[:, None] + speed * step * np.arange(-4, 5))
    for rate, expected in zip(
        (found.angular_velocity, found.angular_acceleration, found.angular_jerk),
        differences(sampled, step),
        strict=True,
    ):
        assert np.allclose(rate, expected, atol=1e-5)
    assert np.allclose(np.abs(motion.points["E"].position - (0.8 - 0.9j)), reach, atol=1e-14)
    assert np.allclose(motion.pairs["ram"].value, reach, atol=1e-14)
    assert np.allclose(motion.pairs["ram"].rate, speed, atol=1e-14)
    assert np.allclose(motion.pairs["ram"].third, 0, atol=1e-12)


def excavator() -> ck.Mechanism:
    """Boom, stick and bucket, each moved by a cylinder: three drivers, two of them between moving links only."""
    return ck.Mechanism(
        "Excavator",
        ck.link("frame", "O", "A"),
        ck.link("boom", "O", "B", "C", "S"),
        ck.link("stick", "S", "D", "E", "K"),
        ck.link("bucket", "K", "F", "T"),
        *[ck.link(f"cylinder {k}", **{low: 0}) for k, low in zip("123", "ACE", strict=True)],
        *[ck.link(f"rod {k}", **{high: 0}) for k, high in zip("123", "BDF", strict=True)],
        *[
            ck.slide(f"rod {k}", on=f"cylinder {k}", at=high, through=low, name=f"ram {k}")
            for k, low, high in (("1", "A", "B"), ("2", "C", "D"), ("3", "E", "F"))
        ],
        *[ck.drive(f"rod {k}", on=f"cylinder {k}", name=f"ram {k}") for k in "123"],
        ck.drawn(O=0, A=1 - 0.5j, B=2.5 + 1.6j, C=2.6 + 2.4j, S=5 + 2j, D=4.9 + 2.9j),
        ck.drawn(E=5.6 + 2.2j, K=6.2 - 0.7j, F=6.9 - 0.2j, T=5.6 - 1.8j),
    )  # fmt: skip


def test_excavator_with_three_cylinders() -> None:
    mechanism = excavator()
    sketch = mechanism.sketch
    drawn = [abs(sketch[a] - sketch[b]) for a, b in ("AB", "CD", "EF")]
    time = np.linspace(-1, 1, 21)
    rates = (0.2, -0.15, 0.1)
    values = {f"ram {k}": d + r * time for k, d, r in zip("123", drawn, rates, strict=True)}
    speeds = {f"ram {k}": r for k, r in zip("123", rates, strict=True)}
    motion = ck.solve(mechanism, values, speed=speeds)
    assert np.all(motion.assembled)
    at_home = {name: complex(point.position[10]) for name, point in motion.points.items()}
    assert max(abs(at_home[k] - sketch[k]) for k in sketch) < 1e-12
    for name, (a, b) in zip(values, ("AB", "CD", "EF"), strict=True):
        assert np.allclose(np.abs(motion.points[a].position - motion.points[b].position), values[name], atol=1e-12)
    # the tip, by three triangles solved one after another with scalar root finding
    for k in (0, 7, 20):
        boom = turned(sketch["A"], sketch["O"], sketch["B"], values["ram 1"][k])
        c, s, d, e, kk, f, t = ((sketch[n] - 0) * boom for n in "CSDEKFT")
        stick = turned(c, s, d, values["ram 2"][k])
        e, kk, f, t = (s + (p - s) * stick for p in (e, kk, f, t))
        bucket = turned(e, kk, f, values["ram 3"][k])
        assert abs(motion.points["T"].position[k] - (kk + (t - kk) * bucket)) < 1e-10
    step = time[1] - time[0]
    for k, expected in enumerate(differences(motion.points["T"].position[6:15], step)[:2], start=1):
        assert abs(motion.points["T"].derivative(k)[10] - expected) < 1e-4


def turned(fixed: complex, pivot: complex, end: complex, length: float) -> complex:
    """The small rotation about a pivot that brings an end to a distance from a fixed point."""

    def gap(angle: float) -> float:
        return abs(pivot + (end - pivot) * np.exp(1j * angle) - fixed) - length

    return complex(np.exp(1j * brentq(gap, -0.4, 0.4, xtol=1e-14)))


def test_a_drive_seen_from_the_other_link() -> None:
    """Driving the frame on the crank is driving the crank backward; a slide's displacement is the same."""
    angles = ck.deg(np.arange(0, 361, 10))
    one = ck.solve(four_bar(), {"crank": angles}, speed=2.0, acceleration=0.5, order=3, modes={"rocker": 1})
    mechanism = four_bar()
    items = [*mechanism.items[:-1], ck.drive("frame", on="crank", name="back"), ck.mode(1, "rocker")]
    other = ck.solve(ck.Mechanism("m", *items), {"back": -angles}, speed=-2.0, acceleration=-0.5, order=3)
    for letter in "BCP":
        for k in range(4):
            assert np.allclose(one.points[letter].derivative(k), other.points[letter].derivative(k), atol=1e-12)
    assert np.allclose(other.drives["back"].value, -angles)
    reach = np.linspace(1.3, 2.3, 5)
    plain = ck.solve(jib(), {"rod": reach})
    items = [*jib().items[:-1], ck.drive("cylinder", on="rod", name="back")]
    turned_round = ck.solve(ck.Mechanism("m", *items), {"back": reach})
    assert np.allclose(plain.points["T"].velocity, turned_round.points["T"].velocity, atol=1e-12)


def test_drivers_on_each_other() -> None:
    """A two-link arm: the second motor sits on the first link."""
    mechanism = ck.Mechanism(
        "Arm",
        ck.link("frame", A=0),
        ck.link("upper", A=0, B=2),
        ck.link("fore", B=0, C=1),
        ck.drive("fore", on="upper", name="elbow"),
        ck.drive("upper", name="shoulder"),
    )
    a, b = np.linspace(0, 1, 5), np.linspace(0.3, 2, 5)
    motion = ck.solve(mechanism, {"shoulder": a, "elbow": b}, speed={"shoulder": 1.0, "elbow": -2.0})
    assert np.allclose(motion.points["C"].position, 2 * np.exp(1j * a) + np.exp(1j * (a + b)))
    assert np.allclose(motion.points["C"].velocity, 2j * np.exp(1j * a) - 1j * np.exp(1j * (a + b)))
    assert np.allclose(motion.links["fore"].angular_velocity, -1)
    acceleration = -2 * np.exp(1j * a) - np.exp(1j * (a + b))
    assert np.allclose(motion.points["C"].acceleration, acceleration)


def test_a_grid_of_two_drivers() -> None:
    mechanism = ck.Mechanism(
        "Five-bar",
        ck.link("frame", A=0, E=3),
        ck.link("left", A=0, B=1),
        ck.link("one", B=0, C=2.5),
        ck.link("two", D=0, C=2.5),
        ck.link("right", E=0, D=1),
        ck.drive("left"),
        ck.drive("right"),
    )
    left, right = ck.deg(np.arange(0, 360, 30)), ck.deg(np.arange(0, 360, 45))
    motion = ck.solve(mechanism, {"left": left[:, None], "right": right})
    assert motion.shape == (12, 8)
    for i in (0, 5, 11):
        for j in (0, 3, 7):
            one = ck.solve(mechanism, {"left": left[i], "right": right[j]})
            assert abs(complex(one.points["C"].position) - motion.points["C"].position[i, j]) < 1e-14
            assert one.shape == ()


def test_designs_and_motion_broadcast_as_each_solved_alone() -> None:
    cranks, couplers = np.array([0.8, 1.0, 1.2]), np.array([2.9, 3.1])
    angles = ck.deg(np.arange(0, 361, 30))
    mechanism = four_bar(cranks[:, None, None], couplers[:, None])
    motion = ck.solve(mechanism, {"crank": angles}, speed=3.0, order=3)
    assert motion.shape == (3, 2, 13)
    assert motion.assembled.shape == (3, 2, 13)
    for i, crank in enumerate(cranks):
        for j, coupler in enumerate(couplers):
            alone = ck.solve(four_bar(crank, coupler), {"crank": angles}, speed=3.0, order=3)
            for k in range(4):
                found = motion.points["P"].derivative(k)[i, j]
                assert np.allclose(found, alone.points["P"].derivative(k), rtol=1e-12, atol=1e-10)
            assert np.allclose(motion.links["rocker"].angle[i, j], alone.links["rocker"].angle, atol=1e-12)
            assert np.allclose(motion.pairs["C"].value[i, j], alone.pairs["C"].value, atol=1e-12)


def test_dimensions_and_rates_may_change_along_the_motion() -> None:
    """A dimension along the last axis pairs with the driver's values; so do speeds."""
    angles = ck.deg(np.arange(0, 50, 10.0))
    lengths = np.linspace(2.8, 3.2, 5)
    speeds = np.linspace(1, 2, 5)
    motion = ck.solve(four_bar(coupler=lengths), {"crank": angles}, speed=speeds)
    for k in range(5):
        alone = ck.solve(four_bar(coupler=lengths[k]), {"crank": angles[k]}, speed=speeds[k])
        assert abs(complex(alone.points["C"].velocity) - motion.points["C"].velocity[k]) < 1e-12


def test_more_poses_than_a_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gathered block by block as at once; also many designs of few poses, and some that do not close."""
    monkeypatch.setattr(solution, "WHOLE", 0)
    monkeypatch.setattr(solution, "BLOCK", 4096)
    angles = np.linspace(0, 20, 9001)
    whole = ck.solve(four_bar(), {"crank": angles}, order=3, modes={"rocker": 1})
    assert whole.shape == (9001,)
    for part in (slice(0, 10), slice(4090, 4100), slice(8190, 8196), slice(8995, 9001)):
        small = ck.solve(four_bar(), {"crank": angles[part]}, order=3, modes={"rocker": 1})
        for k in range(4):
            assert np.allclose(small.points["P"].derivative(k), whole.points["P"].derivative(k)[part], atol=1e-13)
        turns = small.links["rocker"].angle - whole.links["rocker"].angle[part]
        assert np.allclose(turns, 0, atol=1e-12)
    cranks = np.linspace(0.5, 3.0, 500)[:, None]
    large = quietly(four_bar(cranks), order=2)
    monkeypatch.setattr(solution, "BLOCK", 10**9)
    at_once = quietly(four_bar(cranks), order=2)
    assert large.shape == (500, 73)
    assert np.array_equal(large.assembled, at_once.assembled)
    assert 0.2 < large.assembled.mean() < 0.95
    for k in range(3):
        a, b = large.points["P"].derivative(k), at_once.points["P"].derivative(k)
        assert np.allclose(a, b, equal_nan=True, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_every_order(order: int) -> None:
    motion = ck.solve(four_bar(), {"crank": [0.1, 0.7]}, order=order)
    full = ck.solve(four_bar(), {"crank": [0.1, 0.7]}, order=3)
    point, names = motion.points["C"], ("position", "velocity", "acceleration", "jerk")
    rates = ("angle", "angular_velocity", "angular_acceleration", "angular_jerk")
    for k, (name, rate, pair) in enumerate(zip(names, rates, ("value", "rate", "second", "third"), strict=True)):
        if k <= order:
            assert np.allclose(getattr(point, name), getattr(full.points["C"], name))
            assert np.allclose(getattr(motion.links["coupler"], rate), getattr(full.links["coupler"], rate))
            assert np.allclose(getattr(motion.pairs["C"], pair), getattr(full.pairs["C"], pair))
        else:
            for thing, attribute in ((point, name), (motion.links["coupler"], rate), (motion.pairs["C"], pair)):
                with pytest.raises(ck.errors.InvalidInput, match=rf"{name}: .*order {order}.*order={k}"):
                    getattr(thing, attribute)
    for k in (4, -1):
        with pytest.raises(ck.errors.InvalidInput, match=f"derivative {k}"):
            point.derivative(k)


@pytest.mark.parametrize("order", [-1, 4, 1.5, True, "2", None])
def test_orders_that_are_none(order: object) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"order: .* is (not an order|no whole number)"):
        ck.solve(four_bar(), order=order)  # type: ignore[arg-type]


def test_angles_are_unwrapped_along_the_motion_only() -> None:
    angles = ck.deg(np.arange(0, 1081, 10))
    motion = ck.solve(four_bar(np.array([1.0, 0.9])[:, None]), {"crank": angles})
    crank = motion.links["crank"].angle
    assert np.allclose(crank, angles)
    assert np.allclose(motion.pairs["A"].value, angles)
    assert np.max(np.abs(np.diff(motion.links["rocker"].angle))) < 0.5
    assert np.max(np.abs(np.diff(motion.pairs["B"].value))) < 0.5
    assert np.all(np.abs(motion.links["rocker"].angle[:, 0]) <= np.pi)
    assert unwrapped(np.array(3.0)) == 3.0
    assert unwrapped(np.array([4.0])).tolist() == [4.0]
    gap = unwrapped(np.array([[3.0, np.nan, -3.0], [0.0, 1.0, 2.0]]))
    assert np.allclose(gap[0][[0, 2]], [3.0, 2 * np.pi - 3.0])
    assert gap[1].tolist() == [0.0, 1.0, 2.0]


def test_any_point_of_a_link() -> None:
    motion = ck.solve(four_bar(), {"crank": ck.deg(np.arange(0, 360, 30))}, order=3)
    coupler = motion.links["coupler"]
    for k in range(4):
        assert np.allclose(coupler.at((1, 1)).derivative(k), motion.points["P"].derivative(k))
        assert np.allclose(coupler.at(0).derivative(k), motion.points["B"].derivative(k))
        assert np.allclose(coupler.origin.derivative(k), motion.points["B"].derivative(k))
    several = coupler.at(np.linspace(0, 3, 12))
    assert several.position.shape == (12,)
    assert abs(several.position[11] - motion.points["C"].position[11]) < 1e-14
    assert np.allclose(motion.links["frame"].at((2, 1)).position, 2 + 1j)
    assert np.allclose(motion.links["frame"].at((2, 1)).velocity, 0)
    grid = ck.solve(four_bar(np.ones((2, 1, 1)), np.full((3, 1), 3.0)))
    spots = grid.links["coupler"].at(np.array([0.0, 3.0])[:, None, None]).position
    assert np.allclose(spots[0], grid.points["B"].position[0])
    assert np.allclose(spots[1], grid.points["C"].position[1])
    with pytest.raises(ck.errors.InvalidInput, match="does not broadcast"):
        coupler.at(np.zeros(5))
    with pytest.raises(ck.errors.InvalidMechanism, match="is not a point"):
        coupler.at("C")


def test_points_split_into_components() -> None:
    motion = ck.solve(four_bar(), {"crank": [0.0, np.pi / 2]}, speed=2.0)
    point = motion.points["B"]
    assert isinstance(point.velocity, Vectors)
    assert np.allclose(point.velocity.xy, [[0, 2], [-2, 0]])
    assert np.allclose(point.x, [1, 0])
    assert np.allclose(point.y, [0, 1])
    assert np.allclose(point.speed, 2)
    assert type(point.x) is np.ndarray
    assert point.position.xy.shape == (2, 2)
    alone = ck.solve(four_bar(), {"crank": 0.0})
    assert np.allclose(alone.points["B"].position.xy, [1, 0])


def test_what_a_motion_holds() -> None:
    mechanism = four_bar()
    motion = ck.solve(mechanism)
    assert motion.mechanism is mechanism
    assert motion.order == 2
    assert motion.shape == (73,)
    assert list(motion.points) == ["A", "D", "B", "C", "P"]
    assert list(motion.links) == ["frame", "crank", "coupler", "rocker"]
    assert set(motion.pairs) == set("ABCD")
    assert list(motion.drives) == ["crank"]
    assert len(motion.links) == 4
    assert "crank" in motion.links
    assert "nobody" not in motion.links
    assert np.allclose(motion.drives["crank"].value, ck.deg(np.arange(0, 361, 5)))
    assert motion.drives["crank"].is_angle
    assert motion.points["B"] is motion.points["B"]
    assert np.allclose(motion.points["A"].velocity, 0)
    assert np.allclose(motion.links["frame"].angular_acceleration, 0)
    for table, name, near in (
        (motion.points, "Q", "known: A"),
        (motion.links, "cranc", "crank"),
        (motion.drives, "crnk", "crank"),
    ):
        with pytest.raises(ck.errors.UnknownName, match=rf"{name}: there is no such .*{near}"):
            table[name]


def test_solving_a_structure_is_solving_its_mechanism() -> None:
    structure = ck.decompose(four_bar())
    assert np.array_equal(ck.solve(structure).points["P"].position, ck.solve(four_bar()).points["P"].position)


def test_relative_motion_in_the_pairs() -> None:
    motion = ck.solve(four_bar(), speed=1.5, order=3)
    for name, first, second in (("B", "crank", "coupler"), ("D", "frame", "rocker")):
        pair = motion.pairs[name]
        one, two = motion.links[first], motion.links[second]
        sign = 1 if motion.solving_order.pairs[name].members == (first, second) else -1
        assert np.allclose(pair.rate, sign * (two.angular_velocity - one.angular_velocity), atol=1e-12)
        assert np.allclose(pair.third, sign * (two.angular_jerk - one.angular_jerk), atol=1e-10)
        assert np.allclose(np.exp(1j * pair.value), np.exp(1j * sign * (two.angle - one.angle)))


# --- assembly modes ------------------------------------------------------------------------------------------


def above(motion: Motion) -> bool:
    return bool(np.all(motion.points["C"].y[..., 0] > 0))


def test_modes_by_default_sign_hint_and_drawing() -> None:
    angles = {"crank": [0.3, 0.4]}
    assert not above(ck.solve(four_bar(), angles, modes={"coupler": 1}))
    assert above(ck.solve(four_bar(), angles, modes={"coupler": -1}))
    assert above(ck.solve(four_bar(), angles, modes={"rocker": -1}))
    assert above(ck.solve(four_bar(), angles))
    for y in (2.0, -2.0):
        assert above(ck.solve(four_bar(), angles, hint={"C": (3, y)})) == (y > 0)
        drawn = four_bar(1.0, 3.0, 3.0, 4.0, ck.drawn(C=(3, y)))
        assert above(ck.solve(drawn, angles)) == (y > 0)
        # a hint goes before the drawing, a sign before both
        assert above(ck.solve(drawn, angles, hint={"C": (3, -y)})) == (y < 0)
        assert above(ck.solve(drawn, angles, modes={"coupler": -1}))
        assert above(ck.solve(drawn, angles, modes={"coupler": -1}, hint={"C": (3, -2)}))
    written = four_bar(1.0, 3.0, 3.0, 4.0, ck.mode(-1, "coupler"), ck.drawn(C=(3, -2)))
    assert above(ck.solve(written, angles))
    assert not above(ck.solve(written, angles, modes={"coupler": 1}))


def test_a_drawing_chooses_for_every_design() -> None:
    cranks = np.linspace(0.5, 1.0, 4)[:, None]
    up = ck.solve(four_bar(cranks, 3.0, 3.0, 4.0, ck.drawn(C=(3, 2))), {"crank": ck.deg(np.arange(0, 361, 5))})
    assert above(up)
    mixed = ck.drawn(C=(np.array([3.0, 3.0, 3.0, 3.0])[:, None], np.array([2.0, -2.0, 2.0, -2.0])[:, None]))
    motion = ck.solve(four_bar(cranks, 3.0, 3.0, 4.0, mixed), {"crank": [0.3]})
    assert (motion.points["C"].y[:, 0] > 0).tolist() == [True, False, True, False]


def test_the_mode_is_chosen_at_the_drawn_pose_wherever_the_motion_starts() -> None:
    """The drawing shows the crank at 90 degrees; the motion runs over a full turn from elsewhere."""
    sketch = {"B": 1j, "C": 3 + 2.7j}
    base = ck.solve(four_bar(1.0, abs(sketch["C"] - 1j), abs(sketch["C"] - 4)), {"crank": np.pi / 2}, hint=sketch)
    assert abs(complex(base.points["C"].position) - sketch["C"]) < 1e-12
    mechanism = ck.Mechanism(
        "m",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", "B", "C"),
        ck.link("rocker", "D", "C"),
        ck.drive("crank"),
        ck.drawn(D=4, **sketch),
    )
    for start in (0, 90, 200, -170):
        motion = ck.solve(mechanism, {"crank": ck.deg(np.arange(start, start + 361, 5))})
        assert np.all(motion.points["C"].y > 0)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ({"modes": {"copler": 1}}, "copler: there is no such link"),
        ({"modes": {"coupler": 0}}, r"modes\.coupler: .*\+1 or -1"),
        ({"hint": {"Z": 0}}, r"hint\.Z: there is no point 'Z'"),
        ({"hint": {"C": "up"}}, r"hint\.C: 'up' is not a point"),
    ],
)
def test_modes_and_hints_that_fit_nothing(words: dict[str, Any], text: str) -> None:
    with pytest.raises(ck.errors.CompoundkinError, match=text):
        ck.solve(four_bar(), **words)


# --- what cannot be assembled -----------------------------------------------------------------------------


def test_poses_that_do_not_close_are_masked_and_warned_of() -> None:
    """Crank 4, coupler 5, rocker 3, frame 7: the crank turns 88.98 degrees to either side."""
    mechanism = four_bar(4.0, 5.0, 3.0, 7.0)
    angles = ck.deg(np.arange(-180, 181, 1.0))
    with pytest.warns(ck.errors.UnassembledPoses, match="poses cannot be assembled.*gaps"):
        motion = ck.solve(mechanism, {"crank": angles})
    limit = np.arccos((16 + 49 - 64) / 56)
    assert np.array_equal(motion.assembled, np.abs(angles) <= limit)
    assert motion.assembled.dtype == bool
    for k in range(3):
        assert np.array_equal(np.isnan(motion.points["C"].derivative(k)), ~motion.assembled)
    assert np.array_equal(np.isnan(motion.links["coupler"].angle), ~motion.assembled)
    held = motion.points["C"].position[motion.assembled]
    assert np.allclose(np.abs(held - 7), 3)
    assert np.allclose(np.abs(held - 4 * np.exp(1j * angles[motion.assembled])), 5)


def test_no_random_mechanism_ever_has_a_pose_that_does_not_close() -> None:
    """Far from the drawn pose: every point of an assembled pose keeps its distances on every link."""
    count = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        sketch = random_sketch(rng, rng.choice(KINDS_OF_DYAD, 3))
        mechanism = sketch.mechanism()
        start = drawn_values(mechanism)["link0"]
        motion = quietly(mechanism, {"link0": start + np.linspace(0, 2 * np.pi, 73)}, order=1)
        good = motion.assembled
        count += int(good.sum())
        for name, letters in sketch.links.items():
            for letter in letters:
                there = motion.links[name].at(mechanism.geometry.points[name][letter]).position
                gap = np.abs(there - motion.points[letter].position)[good]
                assert np.max(gap, initial=0.0) < 1e-9
        for words, pair in zip(sketch.slides, mechanism.written_pairs, strict=True):
            ends = pair.ends(mechanism.geometry)
            poses = tuple(motion.poses[m] for m in pair.members)
            for closure in pair.closure(ends, poses):  # type: ignore[arg-type]
                # lengths may grow without bound where guides are nearly parallel
                far = 1 + np.abs(motion.points[words["at"]].position[good])
                assert np.max(np.abs(np.ravel(closure.c[0] * np.ones(73))[good]) / far, initial=0.0) < 1e-9
    assert count > 500


def test_a_group_that_rests_on_an_unassembled_one_is_unassembled() -> None:
    base = four_bar(4.0, 5.0, 3.0, 7.0)
    items = [*base.items, ck.link("more", C=0, E=9), ck.link("still more", E=0, D=9)]
    motion = quietly(ck.Mechanism("m", *items), {"crank": ck.deg([0, 120])})
    assert motion.assembled.tolist() == [True, False]
    assert np.isnan(motion.points["E"].position).tolist() == [False, True]


def test_limit_positions_are_positions() -> None:
    """Stretched: the position is there, its rates are not finite."""
    motion = ck.solve(four_bar(1.0, 2.0, 1.0, 4.0), {"crank": 0.0})
    assert bool(motion.assembled)
    assert abs(complex(motion.points["C"].position) - 3) < 1e-12
    assert not np.isfinite(complex(motion.points["C"].velocity))
    assert motion.regular.tolist() == [[False]]
    assert ck.solve(four_bar()).regular.all()


def test_nothing_to_assemble_at_all() -> None:
    motion = quietly(four_bar(1.0, 1.0, 1.0, 9.0))
    assert not motion.assembled.any()


def test_a_rhombus_folded_on_itself_has_no_direction_there() -> None:
    """Plain numbers and arrays alike: masked, not a crash and not a made-up direction."""
    rhombus = four_bar(1.0, 1.0, 1.0, 1.0)
    motion = quietly(rhombus, {"crank": [0.0, 1.0, 2 * np.pi]})
    assert motion.assembled.tolist() == [False, True, False]
    assert not quietly(rhombus, {"crank": 0.0}).assembled


# --- a mechanism without drivers, with faults ----------------------------------------------------------------


def test_a_truss_is_solved_without_a_driver() -> None:
    truss = ck.Mechanism("Truss", ck.link("frame", A=0, B=4), ck.link("a", A=0, C=3), ck.link("b", B=0, C=3))
    motion = ck.solve(truss)
    assert motion.shape == ()
    assert abs(abs(complex(motion.points["C"].position)) - 3) < 1e-14


def test_over_and_under_constrained_mechanisms_are_refused() -> None:
    loose = ck.Mechanism("m", *[i for i in four_bar().items if type(i).__name__ != "Drive"])
    with pytest.raises(ck.errors.NotDetermined, match="cannot be solved"):
        ck.solve(loose)
    tight = ck.Mechanism("m", *four_bar().items, ck.drive("rocker"))
    with pytest.raises(ck.errors.NotDetermined, match="cannot be solved"):
        ck.solve(tight)


def test_well_conditioned_knows_a_limit_position() -> None:
    """The helper the other tests choose their mechanisms by."""
    drawn = {"A": 0j, "D": 4 + 0j, "B": 1 + 0j, "C": 3 + 0.001j}
    links = [ck.link(n, *ls) for n, ls in (("frame", "AD"), ("crank", "AB"), ("coupler", "BC"), ("rocker", "DC"))]
    near_limit = ck.Mechanism("m", *links, ck.drive("crank"), ck.drawn(**drawn))
    assert not well_conditioned(near_limit, 15.0, 0.03)
    regular = ck.Mechanism("m", *links, ck.drive("crank"), ck.drawn(**{**drawn, "C": 3 + 3j}))
    assert well_conditioned(regular, 15.0, 0.03)
