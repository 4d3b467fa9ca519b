"""What `solve` is asked for: values, rates and shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.kinematics.block import blocks, rates
from compoundkin.kinematics.driver_values import FULL_TURN, fit, inputs
from compoundkin.kinematics.solving_order import SolvingOrder


def arm(**words: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Arm",
        ck.link("frame", A=0),
        ck.link("upper", A=0, B=2),
        ck.link("fore", B=0, C=1),
        ck.drive("upper", **words),
        ck.drive("fore", on="upper", speed=3.0),
    )


def ram() -> ck.Mechanism:
    return ck.Mechanism(
        "Ram", ck.link("frame", O=0), ck.link("rod", P=0), ck.slide("rod", on="frame", through="O"), ck.drive("rod")
    )


def test_a_pin_without_values_makes_a_full_turn() -> None:
    motion = ck.solve(arm())
    assert np.allclose(motion.drives["upper"].value, FULL_TURN)
    assert len(FULL_TURN) == 73
    with pytest.raises(ValueError, match="read-only"):
        FULL_TURN[0] = 1


def test_a_slide_without_values_is_asked_for_them() -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"drives\.rod: it has no values.*'rod': lengths"):
        ck.solve(ram())


def test_values_and_rates_of_the_mechanism_and_of_the_call() -> None:
    own = ck.solve(arm(values=[0.1, 0.2], speed=2.0, acceleration=0.5, jerk=0.25), {"fore": 0.3}, order=3)
    assert np.allclose(own.drives["upper"].value, [0.1, 0.2])
    drive = own.drives["upper"]
    assert [float(np.ravel(v)[0]) for v in (drive.rate, drive.second, drive.third)] == [2.0, 0.5, 0.25]
    assert np.allclose(own.links["upper"].angular_jerk, 0.25)
    assert np.allclose(own.links["fore"].angular_velocity, 5.0)
    over = ck.solve(
        arm(values=[0.1], speed=2.0), {"upper": [1.0], "fore": 0}, speed={"upper": 7}, acceleration={"fore": 1}
    )
    assert np.allclose(over.drives["upper"].value, 1.0)
    assert np.allclose(over.links["upper"].angular_velocity, 7)
    assert np.allclose(over.links["fore"].angular_velocity, 10)
    assert np.allclose(over.links["fore"].angular_acceleration, 1)


def test_one_driver_takes_a_plain_number() -> None:
    motion = ck.solve(ram(), {"rod": [1, 2, 3]}, speed=0.5, acceleration=[1, 2, 3], jerk=4, order=3)
    assert np.allclose(motion.points["P"].velocity, 0.5)
    assert np.allclose(motion.points["P"].acceleration, [1, 2, 3])
    assert np.allclose(motion.points["P"].jerk, 4)
    for what in (range(3), (0, 1, 2), np.arange(3), [0.0, 1.0, 2.0]):
        assert ck.solve(ram(), {"rod": what}).points["P"].x.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("values", "words", "text"),
    [
        ({"uper": 1}, {}, r"values\.uper: there is no driver 'uper'; did you mean 'upper'"),
        ({}, {"speed": 3}, "speed: there are several drivers; give one for each by name"),
        ({}, {"speed": {"uper": 3}}, r"speed\.uper: there is no driver"),
        ({}, {"jerk": {"uper": 3}, "acceleration": {"x": 1}}, r"(?s)acceleration\.x.*jerk\.uper"),
        ({"upper": "all"}, {}, "upper: a text is no number"),
        ({"upper": [0, [1]]}, {}, "upper: .* is not a number"),
        ({"upper": [0, np.nan]}, {}, "upper: the value is empty or not finite"),
        ({"upper": []}, {}, "upper: the value is empty or not finite"),
        ({"upper": 1}, {"speed": {"upper": np.inf}}, "upper: the value is empty or not finite"),
        ({"upper": [1, 2], "fore": [1, 2, 3]}, {}, r"drives\.fore: shape \(3,\) does not broadcast with \(2,\)"),
        ({"upper": [1, 2]}, {"speed": {"fore": [1, 2, 3]}}, r"does not broadcast"),
    ],
)
def test_inputs_that_do_not_fit(values: dict[str, Any], words: dict[str, Any], text: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=text):
        ck.solve(arm(), {"fore": 0.0, **values}, **words)


def test_dimensions_that_do_not_fit_the_values() -> None:
    mechanism = ck.Mechanism("m", ck.link("frame", A=0), ck.link("b", A=([1, 2], 0), B=1), ck.drive("b"))
    with pytest.raises(ck.errors.InvalidInput, match="does not broadcast"):
        ck.solve(mechanism, {"b": [0, 1, 2]})


def test_everything_is_brought_into_designs_by_poses() -> None:
    to = fit((2, 3, 5))
    assert to(1.5) == 1.5
    assert to(np.float64(2.0)) == 2.0
    assert to(np.array(7)) == 7
    assert to(np.arange(5)).shape == (1, 5)
    assert to(np.arange(3)[:, None]).shape == (6, 1)
    assert to(np.arange(3)[:, None])[:, 0].tolist() == [0, 1, 2, 0, 1, 2]
    assert to(np.arange(2)[:, None, None])[:, 0].tolist() == [0, 0, 0, 1, 1, 1]
    assert to(np.zeros((2, 3, 5))).shape == (6, 5)
    assert fit(())(np.array(3.0)) == 3.0


def test_a_rectangle_of_the_inputs() -> None:
    solving_order = SolvingOrder(ck.decompose(arm()))
    given = inputs(solving_order, {"upper": np.arange(4.0), "fore": np.arange(3.0)[:, None]}, None, None, None)
    assert (given.designs, given.poses) == (3, 4)
    part = given.cut(slice(1, 3), slice(2, 4))
    assert part.drives["upper"][0].tolist() == [[2, 3]]
    assert part.drives["fore"][0].tolist() == [[1], [2]]
    assert part.drives["upper"][1] == 1.0


def test_blocks_cover_everything_once() -> None:
    for designs, poses, size in ((1, 1, 10), (7, 13, 10), (100, 3, 17), (3, 100, 17), (5, 5, 1), (4, 10, 40)):
        seen = np.zeros((designs, poses), dtype=int)
        for d, m in blocks(designs, poses, size):
            seen[d, m] += 1
            assert (d.stop - d.start) * (m.stop - m.start) <= size
        assert np.all(seen == 1)


def test_rates_are_taylor_coefficients() -> None:
    assert rates((1.0, 2.0, 6.0, 12.0), 3).c == (1.0, 2.0, 3.0, 2.0)
    assert rates((1.0, 2.0, 6.0, 12.0), 0).c == (1.0,)
    assert rates((1.0,), 2).c == (1.0, 0.0, 0.0)
