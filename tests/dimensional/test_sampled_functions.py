"""Sampled functions: outputs of random linkages are found again, over a turn, a part of it and with gaps; dwells."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.dimensional import sampled_functions
from compoundkin.dimensional.sampled_functions import FunctionChain, WantedFunction, function_chains, nearest_outputs
from compoundkin.errors import InvalidInput

TURN = np.deg2rad(np.arange(0.0, 360.0, 5.0))


@pytest.fixture(autouse=True)
def _small_atlas(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    few = tuple(function_chains()[k] for k in (0, 1, 3, 4, 8))
    monkeypatch.setattr(sampled_functions, "function_chains", lambda links: few[: 2 if links == 4 else None])
    sampled_functions.chain_outputs.cache_clear()
    monkeypatch.setattr(sampled_functions, "DESIGNS", 6_000)
    monkeypatch.setattr(sampled_functions, "GIVEN", 3)
    monkeypatch.setattr(sampled_functions, "ROUNDS", 1)
    yield
    sampled_functions.chain_outputs.cache_clear()


def planted(chain: FunctionChain, seed: int) -> np.ndarray:
    """The output of a random linkage of a chain over TURN, that the atlas does not hold."""
    designs = chain.designs(np.random.default_rng(1000 + seed).random((4096, len(chain.numbers))))
    values, clear = chain.values(designs, TURN)
    clear = (
        clear & chain.is_drawn(designs, values) & (np.abs(values[:, 0] - values[:, -1]) < 0.5 * np.ptp(values, axis=1))
    )
    clear &= np.abs(np.diff(values, axis=1)).max(axis=1) < 0.2 * np.ptp(values, axis=1)
    return np.asarray(values[clear][0])


def missed(answer: ck.results.Answer, inputs: np.ndarray, outputs: np.ndarray) -> float:
    """By how much the best answer misses pairs, from its best zero, solved anew."""
    best = answer[0]
    motion = ck.solve(best.mechanism, {best.driver: best.values[0] + inputs - inputs[0]})
    (name,) = best.candidate.outputs
    own = np.ravel(ck.quantity(motion, name).values)
    own = np.unwrap(own) if name.endswith("angle") else own
    return float(np.ptp(own - outputs)) / 2.0


@pytest.mark.parametrize(("number", "part"), [(0, "whole"), (1, "part"), (3, "gap")])
def test_the_output_of_a_random_linkage_is_found_again(number: int, part: str) -> None:
    chain = function_chains()[number]
    outputs = planted(chain, number) * (40.0 if not chain.is_angle else 1.0)
    taken = {"whole": slice(None), "part": slice(10, 50), "gap": np.r_[0:20, 35:60]}[part]
    pairs = np.stack([TURN, outputs], axis=-1)[taken]
    linkage = "four-bar" if chain.is_angle else "slider-crank"
    answer = ck.synthesise(ck.tasks.function(pairs, linkage=linkage, links=4 if number < 2 else 6))
    best = answer[0]
    assert best.turns
    assert best.error < 0.01 * np.ptp(outputs)
    assert missed(answer, *pairs.T) == pytest.approx(best.error, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("linkage", ["four-bar", pytest.param("slider-crank", marks=pytest.mark.full)])
def test_a_swing_with_two_dwells_is_within_a_degree_or_two(linkage: str) -> None:
    """A rise of 120 degrees by a cycloid, a dwell of 60, a return, a dwell; a transmission angle of 25 degrees."""
    s = np.rad2deg(TURN) % 180.0 / 120.0
    rise = np.where(s < 1.0, s - np.sin(2 * np.pi * s) / (2 * np.pi), 1.0)
    stroke = np.deg2rad(30.0) if linkage == "four-bar" else 50.0
    outputs = stroke * np.where(np.rad2deg(TURN) < 180.0, rise, 1.0 - rise)
    task = ck.tasks.function(np.stack([TURN, outputs], axis=-1), linkage=linkage, links=6)
    answer = ck.synthesise(task, transmission=ck.deg(25))
    assert answer[0].error < 0.12 * stroke
    assert missed(answer, TURN, outputs) == pytest.approx(answer[0].error, rel=1e-3)
    assert all(one.transmission >= ck.deg(25) for one in answer)


@pytest.mark.parametrize("is_angle", [True, False])
def test_the_nearest_outputs_are_those_of_plain_sums(is_angle: bool) -> None:
    rng = np.random.default_rng(3)
    curves = [np.cumsum(rng.standard_normal((5, 3)), axis=0) for _ in range(2)]
    at = np.arange(64) * (2 * np.pi / 64)
    values = sum(np.cos(k * at[None] + curves[0][:, [k]]) * curves[1][:, [k]] for k in range(3))
    wanted_at = rng.random(64) < 0.7
    g = 2.0 + np.cos(at) - 0.5 * np.sin(2 * at)
    wanted = WantedFunction(at, g, False, g, wanted_at.astype(float))
    for mirrored in (False, True):
        own = values[:, (-np.arange(64)) % 64] * (-1.0 if mirrored and is_angle else 1.0) if mirrored else values
        least, start, _ = nearest_outputs(values, wanted, is_angle, mirrored)
        for k, f in enumerate(own):
            plain = []
            for s in range(64):
                rolled = np.roll(f, -s)[wanted_at]
                columns = [np.ones(len(rolled))] if is_angle else [np.ones(len(rolled)), rolled]
                right = g[wanted_at] - (rolled if is_angle else 0.0)
                x, *_ = np.linalg.lstsq(np.array(columns).T, right, rcond=None)
                plain.append(float(np.sum((right - np.array(columns).T @ x) ** 2)))
            assert least[k] == pytest.approx(min(plain), rel=1e-6)
            assert start[k] == int(np.argmin(plain))


@pytest.mark.parametrize("chain", function_chains()[::3], ids=lambda chain: chain.title)
def test_slopes_are_differences(chain: FunctionChain) -> None:
    designs = chain.designs(np.random.default_rng(2).random((4096, len(chain.numbers))))
    design = designs[chain.values(designs, TURN)[1]][:2]
    _, by, by_crank, _ = chain.value_slopes(design, TURN)
    for k in range(len(chain.numbers)):
        step = np.zeros(len(chain.numbers))
        step[k] = 1e-6
        plain = (chain.values(design + step, TURN)[0] - chain.values(design - step, TURN)[0]) / 2e-6
        np.testing.assert_allclose(by[k], plain, atol=1e-5 * (1 + np.abs(plain).max()))
    plain = (chain.values(design, TURN + 1e-6)[0] - chain.values(design, TURN - 1e-6)[0]) / 2e-6
    np.testing.assert_allclose(by_crank, plain, atol=1e-5 * (1 + np.abs(plain).max()))


@pytest.mark.parametrize(
    ("pairs", "how", "words"),
    [
        (np.stack([TURN, np.cos(TURN)], -1), {"links": 5}, "take 4 or 6"),
        (np.stack([TURN, np.cos(TURN)], -1), {"links": 6, "linkage": "inverted"}, "no swinging guide"),
        (np.stack([TURN, np.cos(TURN)], -1)[:5], {"links": 6}, "no samples of a function"),
        (np.stack([TURN, 0 * TURN], -1), {"links": 6}, "does not move"),
        (np.stack([TURN, 1 + 1e-16 * TURN], -1), {"links": 6}, "does not move"),
        (np.stack([TURN, 20 * np.cos(TURN)], -1), {"links": 6}, "swings by 2291.83 degrees.*angles are radians"),
        (np.stack([TURN, np.cos(TURN)], -1)[[*range(9), 3]], {"links": 6}, "are equal; leave one out$"),
        (np.stack([2 * TURN, np.cos(TURN)], -1), {"links": 6}, "beyond a turn"),
        (np.stack([np.linspace(0, 2 * np.pi, 30), np.linspace(0, 1, 30)], -1), {"links": 6}, "after a turn"),
    ],
)
def test_what_is_no_sampled_function_is_said(pairs: np.ndarray, how: dict[str, object], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        ck.tasks.function(pairs, **how)


def test_a_file_has_them_too(tmp_path: Path) -> None:
    """The end of a turn may be among the samples; angles are degrees."""
    rows = [[float(x), 20.0 * float(np.sin(np.deg2rad(x)))] for x in range(0, 361, 10)]
    task = tmp_path / "task.toml"
    task.write_text(f'format = 1\ntask = "function"\nlinks = 4\npairs = {rows}\n')
    result = CliRunner().invoke(cli, ["synthesise", str(task)])
    assert result.exit_code == 0, result.output
    assert "Four-bar" in result.output


def test_a_law_that_ends_where_it_began_but_for_rounding_is_said() -> None:
    """Scaled by the difference of its ends, 2e-16, it was a function of 4e15 radians."""
    around = (0.0, 2 * np.pi)
    with pytest.raises(InvalidInput, match="the same at both ends"):
        ck.tasks.function(np.sin, between=around, inputs=around, outputs=(0, 1), links=6)


def test_even_samples_farther_apart_than_gaps_are_a_whole_turn() -> None:
    """Eleven of a turn are 33 degrees apart; a gap of a function that is sampled so is wider."""
    around = np.arange(11) * (2 * np.pi / 11)
    wanted = WantedFunction.of(ck.tasks.function(np.stack([around, np.sin(around)], -1), links=4))
    assert wanted.is_whole
    assert wanted.wanted.all()
    wanted = WantedFunction.of(ck.tasks.function(np.stack([around, np.sin(around)], -1)[:9], links=4))
    assert not wanted.is_whole
    assert not wanted.wanted.all()


def test_very_many_pairs_are_a_function_like_fewer() -> None:
    """Comparisons of each with each took 150 GB of memory."""
    many = np.linspace(0.0, 2 * np.pi, 100_001)
    wanted = WantedFunction.of(ck.tasks.function(np.stack([many, np.sin(many)], -1), links=4))
    assert len(wanted.inputs) <= sampled_functions.MOST_PAIRS
    assert wanted.is_whole
    np.testing.assert_allclose(wanted.outputs, np.sin(wanted.inputs), atol=1e-12)
