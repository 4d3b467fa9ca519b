"""All configurations of whole mechanisms: every one closes, none is missing, names choose them."""

from __future__ import annotations

import itertools
import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from tests.configurations.mechanisms import four_bar, random_triad
from tests.support import drawn_values, random_sketch

NAMED = [
    "six-bar",
    "class-iii-six-bar",
    "stephenson-ii",
    "jansen-leg",
    "scissor-lift",
    "five-bar",
    "whitworth-turning-guide",
]


@pytest.mark.parametrize("name", NAMED)
def test_every_configuration_closes_and_is_another_one(name: str) -> None:
    mechanism = load(name)
    found = ck.configurations(mechanism)
    geometry = mechanism.geometry
    points = {letter: found.points(letter) for letter in mechanism.carriers}
    for placed in geometry.points.values():
        letters = list(placed)
        for a, b in itertools.pairwise(letters):
            gap = np.abs(points[a] - points[b])[found.real]
            assert gap == pytest.approx(np.full(gap.shape, abs(placed[a] - placed[b])), abs=1e-9 * geometry.size)
    angles = np.stack([np.exp(1j * found.angle(link)) for link in mechanism.links], axis=-1)
    apart = np.abs(angles[..., :, None, :] - angles[..., None, :, :]).max(axis=-1)
    apart[..., np.arange(len(found)), np.arange(len(found))] = np.inf
    assert np.nanmin(apart) > 1e-6
    assert found.certified
    assert np.all(found.real_count <= found.possible)


@pytest.mark.parametrize("name", NAMED)
def test_a_motion_may_start_from_each_by_itself_and_by_name(name: str) -> None:
    mechanism = load(name)
    values = {
        drive.name: float(np.ravel(0.7 if drive.values is None else drive.values)[0]) for drive in mechanism.drives
    }
    for one in ck.configurations(mechanism, values):
        for modes in (one, one.name):
            motion = ck.solve(mechanism, values, modes=modes)
            for letter, place in one.points.items():
                assert complex(motion.points[letter].position) == pytest.approx(place, abs=1e-9 * motion.size)


def test_the_motion_keeps_to_the_circuit_it_started_on() -> None:
    mechanism = load("class-iii-six-bar")
    found = ck.circuits(mechanism)
    pin = next(letter for letter, links in mechanism.pins.items() if "plate" in links)
    for one in ck.configurations(mechanism, {"crank": 0.4}):
        motion = ck.solve(mechanism, {"crank": 0.4 + np.linspace(0.0, 3.0, 40)}, modes=one)
        last = {"crank": 3.4}
        ends = [found.at(other).circuit for other in ck.configurations(mechanism, last)
                if abs(other.points[pin] - motion.points[pin].position[-1]) < 1e-8]  # fmt: skip
        assert ends == [found.at(one).circuit]


def test_over_designs_and_poses_at_once() -> None:
    frames = np.array([[4.0], [6.5]])
    mechanism = four_bar(1.0, 3.0, 3.0, frames)
    values = np.linspace(0.0, 2 * np.pi, 25)
    found = ck.configurations(mechanism, {"crank": values})
    assert found.shape == (2, 25)
    gap = np.abs(frames - np.exp(1j * values))
    assert np.array_equal(found.real_count, np.where(gap <= 6.0, 2, 0))
    rockers = np.abs(found.points("C") - frames[..., None])
    assert rockers[found.real] == pytest.approx(np.full(found.real.sum(), 3.0))
    assert np.isnan(rockers[~found.real]).all()
    one = found.pick(1, at=(1, 3))
    assert one.points["C"] == pytest.approx(found.points("C")[1, 3, 1])
    with pytest.raises(ck.errors.NotAssembled):
        found.pick(1, at=(1, 12))


def test_where_nothing_can_be_assembled_the_nearest_value_is_named() -> None:
    with pytest.raises(ck.errors.NotAssembled) as error:
        ck.configurations(four_bar(4.0, 5.0, 3.0, 7.0), {"crank": 3.0})
    assert f"crank = {np.degrees(np.arccos((16 + 49 - 64) / 56)):.6g} degrees" in str(error.value)


@pytest.mark.parametrize(
    ("modes", "text"),
    [
        ("RRR(couplr)+", "RRR(coupler)"),
        ("RRR(coupler)", "RRR(coupler)"),
        ({"coupler": 2}, "assembly mode"),
    ],
)
def test_names_that_are_none(modes: object, text: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=text.replace("(", r"\(").replace(")", r"\)")):
        ck.solve(four_bar(1.0, 3.0, 3.0, 4.0), modes=modes)  # type: ignore[arg-type]


def test_a_configuration_of_another_mechanism_is_refused() -> None:
    one = ck.configurations(load("six-bar"), {"crank": 1.0}).pick(0)
    with pytest.raises(ck.errors.InvalidInput, match="another mechanism"):
        ck.solve(four_bar(1.0, 3.0, 3.0, 4.0), modes=one)
    with pytest.raises(ck.errors.InvalidInput, match="another mechanism"):
        ck.circuits(four_bar(1.0, 3.0, 3.0, 4.0)).at(one)


@pytest.mark.parametrize("seed", range(6))
def test_a_group_is_assembled_in_the_configuration_nearest_to_a_rough_drawing(seed: int) -> None:
    """Of all configurations that whose points lie nearest to the drawn ones, whatever Newton would have found."""
    rng = np.random.default_rng(seed)
    mechanism = random_triad(rng).mechanism()
    value = drawn_values(mechanism)["link0"]
    exact = ck.configurations(mechanism, {"link0": value})
    for one in exact:
        hint = {k: p + complex(*rng.normal(0.0, 1e-3, 2)) for k, p in one.points.items()}
        with warnings.catch_warnings(action="ignore", category=ck.errors.UnassembledPoses):
            motion = ck.solve(mechanism, {"link0": np.array([value])}, hint=hint)
        gaps = [max(abs(other.points[k] - motion.points[k].position[0]) for k in hint) for other in exact]
        assert gaps.index(min(gaps)) == [other.name for other in exact].index(one.name)
        assert min(gaps) < 1e-8


def test_names_are_the_same_in_every_run_and_do_not_hold_unrelated_links() -> None:
    sketch = random_sketch(np.random.default_rng(3), ("RRR", "RPR", "RRP"), multiple=0.0)
    names = [ck.configurations(sketch.renamed(new).mechanism(), {"link0": 0.1}).names for new in ({}, {}, {"b0": "q"})]
    assert names[0] == names[1] == names[2]
