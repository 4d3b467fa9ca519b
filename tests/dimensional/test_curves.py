"""Curves that are drawn: the atlas of coupler curves, descriptors, refinement, and files that curves are read from."""

from __future__ import annotations

import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from matplotlib.path import Path as Path_

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.dimensional import atlas_designs, curve_fitting, defects
from compoundkin.dimensional import coupler_atlas as atlases
from compoundkin.dimensional.coupler_atlas import CouplerAtlas, coupler_atlas
from compoundkin.dimensional.curve_chains import CurveChain, Laying, curve_chains, turn
from compoundkin.dimensional.curve_conditions import CurveConditions, LaidDesigns, UnlaidDesigns
from compoundkin.dimensional.curve_likeness import coefficients, likeness, mean_distance, resampled
from compoundkin.dimensional.task_words import read_task
from compoundkin.dimensional.tasks import Conditions, extent
from compoundkin.errors import InvalidInput
from compoundkin.files.curve_files import read_curve
from compoundkin.synthesis.chains.mechanism_names import structure_name
from tests.dimensional.test_path_generation import planted_curve

EGG = np.exp(1j * np.linspace(0, 2 * np.pi, 60, endpoint=False))
EGG = 2 * EGG + 0.7 / EGG + 0.3 * EGG**2 + 5 + 3j


@pytest.fixture(autouse=True)
def _small_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curve_fitting, "DESIGNS", 4_000)
    monkeypatch.setattr(curve_fitting, "STARTED", 24)
    monkeypatch.setattr(curve_fitting, "GIVEN", 3)
    monkeypatch.setattr(curve_fitting, "ROUNDS", 0)


@cache
def four_bars_for_the_egg() -> Any:
    """What is found without conditions, for all that is compared with it."""
    return ck.synthesise(ck.tasks.curve(EGG, links=4))


def plain_distance(curve: np.ndarray, target: np.ndarray) -> float:
    """The mean nearest distance both ways, in the target's RMS radius: every pair of many places."""

    def even(z: np.ndarray) -> np.ndarray:
        z = np.append(z, z[:1])
        s = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
        at = np.arange(3000) / 3000 * s[-1]
        return np.interp(at, s, z.real) + 1j * np.interp(at, s, z.imag)

    one, two = even(curve), even(target)
    gaps = np.abs(one[:, None] - two)
    radius = np.sqrt(np.mean(np.abs(two - two.mean()) ** 2))
    return float((gaps.min(axis=0).mean() + gaps.min(axis=1).mean()) / radius)


def test_the_distance_of_curves_is_that_of_every_pair() -> None:
    circle = np.exp(1j * np.linspace(0, 2 * np.pi, 400, endpoint=False))
    assert mean_distance(EGG * 1.1, EGG) == pytest.approx(plain_distance(EGG * 1.1, EGG), rel=0.01)
    # circles about one centre are their radii's difference apart, counted both ways
    assert mean_distance(3 * circle + 1, 2 * circle + 1) == pytest.approx(1.0, rel=1e-4)


@pytest.mark.parametrize("k", [0, 7, 31])
def test_likeness_knows_no_turn_size_start_sense_or_mirror(k: int) -> None:
    own = np.roll(resampled(EGG[None], 64)[0], k) * 3.7 * np.exp(0.4j) + 9
    wanted = coefficients(EGG[None])[0][0]
    for curve, is_mirrored in ((own, False), (own[::-1], False), (np.conj(own), True), (np.conj(own)[::-1], True)):
        found, mirrored = likeness(coefficients(curve[None])[0], wanted)
        assert found[0] == pytest.approx(1.0, abs=5e-3)
        # an egg is its own mirror image but for its tilt, which is none here
        assert mirrored[0] in (is_mirrored, False, True)
    skew = EGG + 0.5j * np.exp(3j * np.angle(EGG - EGG.mean()))
    for curve, is_mirrored in ((skew, False), (np.conj(skew), True)):
        _, mirrored = likeness(coefficients(curve[None])[0], coefficients(skew[None])[0][0])
        assert mirrored[0] == is_mirrored


def test_an_atlas_is_made_again_bitwise_and_its_designs_turn_fully() -> None:
    made = coupler_atlas(6, 2400, 3)
    atlases._atlas.cache_clear()
    again = coupler_atlas(6, 2400, 3)
    assert len(made) == 2400
    for part, other in zip(made.parts, again.parts, strict=True):
        np.testing.assert_array_equal(part.designs(), other.designs())
        np.testing.assert_array_equal(part.descriptors, other.descriptors)
    for part in made.parts:
        chain, designs, descriptors = part.chain, part.designs(), part.descriptors
        motion = solved(chain, designs[7], 360)
        assert motion.assembled.all(), chain.title
        curve = np.ravel(motion.points["P"].position)
        assert likeness(descriptors[[7]], coefficients(curve[None])[0][0])[0][0] > 0.99


def solved(chain: CurveChain, design: np.ndarray, poses: int) -> Any:
    dimensions = {name: value[0, 0] for name, value in chain.dimensions(np.array(design[None], float)).items()}
    turn = np.arange(poses) * (2 * np.pi / poses)
    return ck.solve(chain.program.mechanism(dimensions), {"crank": turn}, modes=chain.program.modes, order=0)


def test_the_nearest_are_those_of_a_search_through_all(monkeypatch: pytest.MonkeyPatch) -> None:
    made = coupler_atlas(6, 6_000)
    wanted = coefficients(EGG[None])[0][0]
    monkeypatch.setattr(atlases, "COMPARED", 16)
    for part in made.parts:
        descriptors = part.descriptors
        best = next(atlases._different(part, atlases.SoughtCurve(EGG, True), 16))
        assert best.at[0] == likeness(descriptors, wanted)[0].argmax()
        ranked = np.concatenate([block.likeness for block in atlases._likely(descriptors, EGG)])
        np.testing.assert_allclose(ranked, np.sort(likeness(descriptors, wanted)[0])[::-1], atol=2e-5)
    found = made.near(EGG, 30)
    assert [one.apart for one in found] == sorted(one.apart for one in found)
    assert len({one.chain.title for one in found}) > 3


GEARED = [chain for chain in curve_chains() if chain.plan.ratio]


@pytest.mark.parametrize("chain", [one for one in curve_chains() if one not in GEARED], ids=lambda chain: chain.title)
def test_chains_are_what_they_are_called(chain: CurveChain) -> None:
    own, plain = (text.split(",")[0].split(" with ")[0].lower() for text in
                  (chain.title, str(structure_name(ck.decompose(chain.mechanism)))))  # fmt: skip
    assert own == plain


@pytest.mark.parametrize("chain", GEARED, ids=lambda chain: f"{chain.title} {chain.plan.traced}")
def test_geared_five_bars_are_two_circles_that_meet(chain: CurveChain) -> None:
    """By the law of cosines in the triangle of both bars, the second crank turned by the ratio; closed in a turn."""
    designs = chain.designs(np.random.default_rng(4).random((4096, len(chain.numbers))))
    design = designs[chain.curves(designs, 64)[1]][3]
    d = {name: value[0, 0] for name, value in chain.dimensions(design[None]).items()}
    angles = turn(50)
    b = d["crank.B.x"] * np.exp(1j * angles)
    e = 2 + d["crank2.E0"] * np.exp(1j * chain.plan.ratio * angles)
    p, q, r = d["coupler.C.x"], d["bar.C.x"], np.abs(e - b)
    at_b = np.arccos((p**2 + r**2 - q**2) / (2 * p * r))
    z = chain.places(design[None], angles)[0][0]
    apart = []
    for side in (1, -1):
        c = b + p * np.exp(1j * (np.angle(e - b) + side * at_b))
        on, foot, length = (b, c - b, p) if chain.plan.traced == "coupler" else (e, c - e, q)
        apart.append(np.abs(on + d[f"{chain.plan.traced}.P"] * foot / length - z).max())
    assert min(apart) < 1e-12 < max(apart)
    laid = chain.linkage(design, Laying(2 * np.exp(1j), 3 + 1j, True), turn(12))
    motion = ck.solve(laid.mechanism("crank", laid.drivers["crank"]))
    assert np.allclose(np.ravel(motion.points["P"].position), laid.z[chain.plan.traced] + laid.u[chain.plan.traced]
                       * next(one for one in laid.links if one.name == chain.plan.traced).points["P"])  # fmt: skip
    assert ck.verify(motion).passed


@pytest.mark.parametrize("chain", curve_chains()[::5], ids=lambda chain: chain.title)
def test_slopes_are_differences(chain: CurveChain) -> None:
    designs = chain.designs(np.random.default_rng(2).random((4096, len(chain.numbers))))
    design = designs[chain.curves(designs, 32)[1]][:1]
    _, by, by_crank, _ = chain.slopes(design, turn(32))
    for k in range(len(chain.numbers)):
        step = np.zeros(len(chain.numbers))
        step[k] = 1e-6
        plain = (chain.curves(design + step, 32)[0] - chain.curves(design - step, 32)[0]) / 2e-6
        assert np.allclose(by[k], plain, atol=1e-5 * (1 + np.abs(plain).max()))
    assert by_crank.shape == (1, 32)


def test_a_planted_four_bar_is_traced() -> None:
    target = planted_curve(1)
    answer = ck.synthesise(ck.tasks.curve(target, links=4))
    assert len(answer) >= 1
    for one in answer:
        path = np.ravel(one.motion.points["P"].position)[:-1]
        radius = np.sqrt(np.mean(np.abs(target - target.mean()) ** 2))
        assert one.error == pytest.approx(plain_distance(path, target) * radius / 2, rel=0.1, abs=1e-3 * radius)
        assert one.turns
    assert [len(one.mechanism.links) for one in answer.front] == [4]
    assert answer[0].error < 0.01 * np.sqrt(np.mean(np.abs(target - target.mean()) ** 2))


@pytest.mark.full
def test_answers_do_not_depend_on_size_place_or_mirror(monkeypatch: pytest.MonkeyPatch) -> None:
    """Moved by 1e5 a curve is known to 1e-11; rounds of random moves would make other answers of that."""
    monkeypatch.setattr(curve_fitting, "ROUNDS", 1)
    monkeypatch.setattr(curve_fitting, "STARTED", 8)
    monkeypatch.setattr(curve_fitting, "GIVEN", 1)
    curves = EGG, 1e4 * np.exp(1j) * EGG + 1e5, EGG + 1e5j
    plain, moved, far = (ck.synthesise(ck.tasks.curve(z, links=4)) for z in curves)
    assert [one.error for one in moved] == pytest.approx([1e4 * one.error for one in plain], rel=1e-9)
    assert [one.error for one in far] == pytest.approx([one.error for one in plain], rel=1e-6)
    for one, other in zip(plain, moved, strict=True):
        assert other.mechanism.title == one.mechanism.title
        assert other.candidate.lengths == pytest.approx([1e4 * each for each in one.candidate.lengths], rel=1e-9)
    monkeypatch.setattr(curve_fitting, "ROUNDS", 0)
    plain, mirrored = (ck.synthesise(ck.tasks.curve(z, links=4)) for z in (EGG, np.conj(EGG)))
    assert mirrored[0].error == pytest.approx(plain[0].error, rel=1e-3)


@pytest.mark.full
def test_six_links_trace_better_than_four_which_are_given_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """And answers are of several kinds."""
    monkeypatch.setattr(curve_fitting, "GIVEN", 6)
    answer = ck.synthesise(ck.tasks.curve(EGG))
    titles = [one.title for one in answer.candidates]
    assert max(titles.count(title) for title in titles) <= curve_fitting.OF_A_KIND
    assert len(set(titles)) >= 3
    assert {"Four-bar", "Slider-crank"} & {one.candidate.title for one in answer}
    assert answer[0].candidate.title not in ("Four-bar", "Slider-crank")
    for one in answer:
        path = np.ravel(one.motion.points["P"].position)[:-1]
        assert mean_distance(path, EGG) * 2.0 < 0.3


def test_designs_that_come_near_limits_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Found with LInK's letter F: at more poses than those of the atlas all matches of a chain came near a limit."""
    matches = coupler_atlas(4, 4_000).near(EGG, 8)
    plain = CurveChain.curves

    def none_is_clear(chain: CurveChain, designs: np.ndarray, poses: int) -> Any:
        z, clear = plain(chain, designs, poses)
        return z, clear & (chain is not matches[0].chain)

    monkeypatch.setattr(CurveChain, "curves", none_is_clear)
    assert all(one.chain is not matches[0].chain for one in curve_fitting.fitted(matches, EGG))


def test_a_sampled_turn_without_its_end_is_closed() -> None:
    """Its ends are a step apart; a stroke whose ends are farther from each other than its points is open."""
    assert ck.tasks.curve(EGG).closed
    assert not ck.tasks.curve(EGG[:-1]).closed
    assert not ck.tasks.curve(EGG[:-1], closed=False).closed


def test_an_open_curve_is_traced_by_a_part_of_the_turn() -> None:
    s = np.linspace(0, 1, 40)
    task = ck.tasks.curve(np.exp(2.0j * s) * (1 + 0.2 * s), links=4)
    assert not task.closed
    best = ck.synthesise(task)[0]
    assert best.turns
    stroke = np.linspace(best.values[0], best.values[-1], 200)
    assert 0.3 < abs(stroke[-1] - stroke[0]) < 2 * np.pi
    path = np.ravel(ck.solve(best.mechanism, {best.driver: stroke}).points["P"].position)
    apart = np.abs(path[:, None] - task.points)
    assert max(apart.min(axis=1).max(), apart.min(axis=0).max()) < 0.05
    # it is measured over that part, both ways
    assert best.error == pytest.approx((apart.min(axis=1).mean() + apart.min(axis=0).mean()) / 2, abs=0.01)
    whole = np.ravel(best.motion.points["P"].position)
    assert np.abs(whole[:, None] - task.points).min(axis=1).max() > 0.1  # the rest of the turn is free


@pytest.mark.parametrize("chain", curve_chains()[::9], ids=lambda chain: chain.title)
def test_a_chain_with_a_dyad_more_traces_what_it_traced(chain: CurveChain) -> None:
    rng = np.random.default_rng(5)
    designs = chain.designs(rng.random((2048, len(chain.numbers))))
    z, clear = chain.curves(designs, 32)
    larger = chain.grown(chain.carriers[0], 1) if chain.links < 8 else chain
    assert larger.parent is chain
    assert larger.links == chain.links + 2
    grown = chain.grown_designs(
        larger, np.repeat(designs[clear][:1], 512, axis=0), rng.random((512, len(larger.numbers)))
    )
    own, turning = larger.curves(grown, 32)
    assert turning.any()
    assert np.allclose(own[turning], z[clear][0], atol=1e-9)


def test_growth_is_promised_what_a_step_gives() -> None:
    """The gain of a first step by P's two coordinates, against that of all unknowns by differences of P."""
    chain = curve_chains()[0]
    target = curve_fitting.CurveTarget.of(EGG, True)
    matches = [match for match in coupler_atlas(4, 4_000).near(EGG, 8) if match.chain is chain]
    part = next(iter(curve_fitting._refined(curve_fitting._begun(matches, target))))
    one = part.some(part.cost.argmin(keepdims=True))
    larger = chain.grown("frame", 1)
    gains, designs = curve_fitting._promised(one, larger, np.random.default_rng(1).random((512, len(larger.numbers))))
    assert len(gains) == len(designs) > 3
    x = np.hstack([designs, np.repeat(one.x[:, len(chain.numbers) :], len(designs), axis=0)])
    grown = one.fresh(larger, one.target, np.repeat(one.mirrored, len(x)), x)
    r, j, _ = curve_fitting._residuals(grown, False)
    assert np.allclose((r**2).sum(axis=1), one.cost[0], rtol=1e-6)
    unknowns = [k for k in range(j.shape[2]) if np.abs(j[0, :, k]).max() > 1e-12]
    best = [
        float(one.cost[0] - np.linalg.lstsq(a[:, unknowns], b, rcond=None)[1].sum()) for a, b in zip(j, r, strict=True)
    ]
    bound = np.array(best) + 1e-9
    assert (gains <= bound).all()
    assert gains.max() > 0.5 * bound[gains.argmax()]


@pytest.mark.full
def test_rounds_lose_nothing_and_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    blot = EGG + 0.5j * np.exp(3j * np.angle(EGG - EGG.mean()))
    matches = coupler_atlas(4, 4_000).near(blot, 16)
    plain = curve_fitting.fitted(matches, blot, links=6)
    monkeypatch.setattr(curve_fitting, "ROUNDS", 1)
    grown = curve_fitting.fitted(matches, blot, links=6)
    best = {links: min(one.apart for one in grown if one.chain.links == links) for links in (4, 6)}
    assert best[4] <= plain[0].apart * 1.05  # squares are what is least
    assert best[6] < best[4]  # one grew, and gained
    again = curve_fitting.fitted(matches, blot, links=6)
    assert [one.apart for one in again] == [one.apart for one in grown]


def test_an_atlas_in_a_folder_is_opened_and_gives_the_same(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    plain, kept = coupler_atlas(4, 500, 2), coupler_atlas(4, 500, 2, tmp_path / "atlas")
    opened = coupler_atlas(4, 500, 2, tmp_path / "atlas")
    assert len(opened) == 500
    assert opened.parts[0].held is None
    for atlas in (kept, opened):
        for one, other in zip(atlas.near(EGG, 5), plain.near(EGG, 5), strict=True):
            np.testing.assert_array_equal(one.design, other.design)
            assert one.apart == other.apart
    with pytest.raises(InvalidInput, match="another atlas"):
        coupler_atlas(4, 600, 2, tmp_path / "atlas")


def test_near_takes_any_number_of_links_that_the_atlas_has() -> None:
    made = coupler_atlas(6, 900)
    assert made.links == (4, 5, 6)
    assert {one.links for one in made.near(EGG, 200, links=5)} == {4, 5}
    assert {one.links for one in made.near(EGG, 200, links=4)} == {4}


@pytest.mark.full
def test_an_atlas_that_was_killed_goes_on(tmp_path: Path) -> None:
    """SIGKILL in the middle of a file; the next call makes what is missing."""
    pytest.importorskip("pyarrow")
    place = tmp_path / "atlas"
    script = (
        "import os, signal\n"
        "from compoundkin.dimensional import atlas_designs\nfrom compoundkin.files import atomic as a\n"
        "write, left = a.write_atomically, [2]\n"
        "def killed(path, fill):\n"
        "    left[0] -= path.suffix == '.parquet'\n"
        "    kill = lambda file: (file.write(b'PAR'), os.kill(os.getpid(), signal.SIGKILL))\n"
        "    write(path, fill if left[0] else kill)\n"
        "a.write_atomically = killed\n"
        f"atlas_designs.parts_in_folder(atlas_designs.AtlasPlan(4, 600, 2), {str(place)!r})\n"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -signal.SIGKILL
    left, *names = sorted(one.name for one in place.iterdir())
    assert left.startswith(".001.parquet.")
    assert names == ["000.parquet", "atlas.json"]
    coupler_atlas(4, 600, 2, place)
    assert sorted(one.name for one in place.iterdir()) == ["000.parquet", "001.parquet", "atlas.json"]


def test_an_atlas_goes_on_where_it_was_ended(tmp_path: Path) -> None:
    """Chains that are there stay as they are; what killed writers left goes, and nothing else."""
    pytest.importorskip("pyarrow")
    plain = coupler_atlas(4, 600, 2)
    coupler_atlas(4, 600, 2, tmp_path)
    (tmp_path / "001.parquet").rename(tmp_path / ".001.parquet.0123456789ab.tmp")
    (tmp_path / ".mine.tmp").touch()
    before = (tmp_path / "000.parquet").stat().st_mtime_ns
    with pytest.raises(InvalidInput, match=r"1 of its 2 chains are missing; coupler_atlas\(4, 600, 2, .* goes on"):
        CouplerAtlas.open(tmp_path)
    with pytest.raises(InvalidInput, match="another atlas, of 4 links, 600 designs and seed 2"):
        coupler_atlas(4, 600, 3, tmp_path)
    made = coupler_atlas(4, 600, 2, tmp_path)
    assert (tmp_path / "000.parquet").stat().st_mtime_ns == before
    assert sorted(one.name for one in tmp_path.iterdir()) == [".mine.tmp", "000.parquet", "001.parquet", "atlas.json"]
    for one, two in zip(made.parts, plain.parts, strict=True):
        np.testing.assert_array_equal(one.designs(), two.designs())
        np.testing.assert_array_equal(one.descriptors, two.descriptors)


def test_chains_of_eight_links_go_on_from_those_of_six_that_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    six = curve_chains()[2]
    chains = (six, six.grown("frame", 1), six.grown("crank", 1))
    monkeypatch.setattr(atlas_designs, "curve_chains", lambda links: chains)
    plan = atlas_designs.AtlasPlan(8, 300, 1)
    whole = [drawn for _, _, drawn in atlas_designs._made(plan, {}, None)]
    kept = {chain.plan: atlas_designs.AtlasPart(chain, 100, one) for chain, one in zip(chains[:2], whole, strict=False)}
    ((k, chain, drawn),) = atlas_designs._made(plan, kept, None)
    assert (k, chain) == (2, chains[2])
    for one, two in zip(drawn, whole[2], strict=True):
        np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("tilt", [1.0, np.exp(0.7j)])
def test_what_is_not_laid_would_not_hold(tilt: complex) -> None:
    """Conditions are known to fail before a design is laid, where they fail by much: against all, laid."""
    blot = (EGG + 0.8j * np.exp(3j * np.angle(EGG - EGG.mean()))) * tilt
    sought = atlases.SoughtCurve(blot, True)
    asked = [
        {"region": [(-1, 1), (9, 9)]}, {"region": [(12, 12), (14, 20)]}, {"region": [(60, 0), (90, 40)]},
        {"size": 14.0}, {"size": 30.0, "region": [(-4, -4), (9, 9)]}, {"size": 60.0, "angle": 0.6},
    ]  # fmt: skip
    dropped = kept = 0
    for part in coupler_atlas(6, 3_000).parts[::3]:
        value, mirrored = likeness(part.descriptors, coefficients(blot[None])[0][0])
        ranked = atlases._Ranked(value, np.arange(len(value)), mirrored)
        designs, scale, place, _ = atlases._laid(part, ranked, sought)
        for one in asked:
            wanted = Conditions.of(one.get("region"), None, None, one.get("angle", 0.0), False, "accuracy")
            conditions = CurveConditions(wanted, one.get("size"))
            holds = conditions.held(LaidDesigns(part.chain, designs, scale, place, mirrored))
            found = atlases._held(part, ranked, sought._replace(conditions=conditions)).at
            np.testing.assert_array_equal(found, np.flatnonzero(holds))
            radius, middle = part.extents
            size = float(np.sqrt(np.mean(np.abs(sought.seen(64) - sought.seen(64).mean()) ** 2)))
            may = conditions.possible(
                UnlaidDesigns(part.chain, part.designs(), value, radius, middle, size, complex(sought.seen(64).mean()))
            )
            dropped, kept = dropped + int((~may).sum()), kept + int(holds.sum())
    assert kept > 100
    assert dropped > 3000


def test_folders_without_an_atlas_are_told(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    with pytest.raises(InvalidInput, match="there is no such folder"):
        CouplerAtlas.open(tmp_path / "none")
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(InvalidInput, match="it holds no atlas of coupler curves"):
        CouplerAtlas.open(tmp_path)
    with pytest.raises(InvalidInput, match=r"it has other files, such as mine\.txt"):
        coupler_atlas(4, 100, folder=tmp_path)
    (tmp_path / "atlas.json").write_text('{"format": 3, "links": 5}', encoding="utf-8")
    with pytest.raises(InvalidInput, match=r"atlas\.json: it cannot be read: it is damaged"):
        CouplerAtlas.open(tmp_path)


def test_an_atlas_is_the_same_made_on_other_workers(tmp_path: Path) -> None:
    """On an executor, whose answers come in any order; each chain's bits are those of this thread."""
    plain = coupler_atlas(4, 700, 5)
    with ThreadPoolExecutor(2) as pool:
        others = [coupler_atlas(4, 700, 5, on=pool), coupler_atlas(4, 700, 5, tmp_path / "atlas", on=pool)]
    for other in others:
        for one, two in zip(plain.parts, other.parts, strict=True):
            np.testing.assert_array_equal(one.designs(), two.designs())
            np.testing.assert_array_equal(one.descriptors, two.descriptors)
    with pytest.raises(InvalidInput, match="computes nothing"):
        coupler_atlas(4, 100, 1, on="cluster")
    closed = ThreadPoolExecutor(1)
    closed.shutdown()
    with pytest.raises(InvalidInput, match="takes no work"):
        coupler_atlas(4, 100, 1, on=closed)


@pytest.mark.full
def test_an_atlas_is_the_same_made_on_a_cluster() -> None:
    distributed = pytest.importorskip("distributed")
    plain = coupler_atlas(4, 3_000, 5)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        other = coupler_atlas(4, 3_000, 5, on=cluster.get_client())
    for one, two in zip(plain.parts, other.parts, strict=True):
        np.testing.assert_array_equal(one.designs(), two.designs())
        np.testing.assert_array_equal(one.descriptors, two.descriptors)


@pytest.mark.parametrize(("links", "count", "words"), [(5, 100, "take 4, 6 or 8"), (6, 3, "one of each chain: 30")])
def test_wrong_atlases_say_what_would_do(links: int, count: int, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        coupler_atlas(links, count)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"size": 0.0}, "size: lengths do not sum to 0"),
        ({"size": float("nan")}, "size"),
        ({"count": -3}, "count: -3 designs are too few"),
        ({"links": 3}, "links: 3 links are not in this atlas; it has those of 4"),
        ({"links": 6}, "links: 6 links are not in this atlas; it has those of 4"),
        ({"links": "4"}, "links"),
        ({"transmission": 2.0}, "transmission"),
    ],
)
def test_near_says_what_is_no_condition(how: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        coupler_atlas(4, 1000).near(EGG, **how)


@pytest.mark.full
def test_near_keeps_to_conditions_where_designs_lie() -> None:
    made = coupler_atlas(6, 6_000)
    found = made.near(EGG, 6, links=4, sliders=False, size=30.0, region=[(-3, -5), (13, 11)], transmission=0.3)
    assert 0 < len(found) <= 6
    for one in found:
        assert one.chain.title == "Four-bar"
        motion = ck.solve(one.mechanism)
        assert one.linkage.span <= 30.0
        assert all(-3 <= pivot.real <= 13 and -5 <= pivot.imag <= 11 for pivot in one.linkage.pivots)
        sides = [motion.points[name].position for name in "BCD"]
        across = np.angle((sides[0] - sides[1]) / (sides[2] - sides[1]))
        assert np.abs(np.sin(across)).min() >= np.sin(0.3) - 1e-6
        path = np.ravel(motion.points["P"].position)
        radius = np.sqrt(np.mean(np.abs(EGG - EGG.mean()) ** 2))
        assert plain_distance(path, EGG) < 4 * one.apart + 0.02, radius


def test_conditions_are_looked_at_in_all_designs() -> None:
    """Against a scan of every design by the plain mechanism: those that hold, each with no twin of its chain before."""
    made = coupler_atlas(4, 400)
    limits = {"size": 16.0, "region": [(-1, 1), (9, 9)], "transmission": 0.6}
    obstacle = np.array([9.5 - 9j, 30, 9.5 + 9j])
    found = made.near(EGG, 6, **limits, obstacles=[obstacle])
    wanted = coefficients(EGG[None])[0][0]
    held = []
    for part in made.parts:
        value, mirrored = likeness(part.descriptors, wanted)
        kept: list[int] = []
        for k in np.argsort(-value, kind="stable"):
            match = atlases._matches(part, atlases._Ranked(value[[k]], np.array([k]), mirrored[[k]]),
                                     atlases.SoughtCurve(EGG, True))[0]  # fmt: skip
            if not holds(match, limits, obstacle):
                continue
            own = part.descriptors[k]
            near = [likeness(part.descriptors[[j]], own)[0][0] for j in kept]
            if max(near, default=0.0) <= 1.0 - (atlases.TWINS * match.apart) ** 2 / 2.0:
                kept.append(int(k))
                held.append(match)
            if len(kept) == 6:
                break
    held.sort(key=lambda match: match.apart)
    assert len(held) > 1
    assert len(found) == min(6, len(held))
    for one, other in zip(found, held, strict=False):
        np.testing.assert_array_equal(one.design, other.design)
    assert any(match.apart < found[0].apart for match in made.near(EGG, 6))  # without conditions others are nearer


def holds(match: Any, limits: dict[str, Any], obstacle: np.ndarray) -> bool:
    """Whether a match keeps to conditions, by its mechanism solved at the atlas's poses."""
    (low, high), linkage = limits["region"], match.linkage
    if linkage.span > limits["size"]:
        return False
    if not all(low[0] < p.real < high[0] and low[1] < p.imag < high[1] for p in linkage.pivots):
        return False
    motion = ck.solve(match.mechanism)
    if defects.least_transmission(motion, between=False) < limits["transmission"]:
        return False
    shape = Path_(np.stack([obstacle.real, obstacle.imag], axis=-1))
    at = {letter: np.ravel(point.position) + np.zeros(65) for letter, point in motion.points.items()}
    return not any(meets_finely(at[a], at[b], shape)
                   for link in linkage.links for a, b in combinations(link.points, 2))  # fmt: skip


def meets_finely(a: np.ndarray, b: np.ndarray, shape: Path_) -> bool:
    """Whether any of many places along lines lies in a shape: the second way to see it."""
    line = (a[:, None] + np.linspace(0, 1, 2000) * (b - a)[:, None]).ravel()
    return bool(shape.contains_points(np.stack([line.real, line.imag], axis=-1)).any())


@pytest.mark.full
def test_obstacles_are_kept_clear_of() -> None:
    """The nearest linkage runs into it; what is given does not, of places along all links at many poses."""
    task, plain = ck.tasks.curve(EGG, links=4), four_bars_for_the_egg()
    pivot = plain[0].candidate.pivots[1]
    walls = [9.0 - 30j, 40 - 30j, 40 + 40j, 9.0 + 40j], [pivot - 1, pivot + 1, pivot + 1j]
    shapes = [Path_([(p.real, p.imag) for p in wall]) for wall in walls]

    def clear(one: Any) -> bool:
        at = {letter: np.ravel(point.position) + np.zeros(181) for letter, point in one.motion.points.items()}
        pairs = [pair for link in one.candidate.links if link.name != "frame" for pair in combinations(link.points, 2)]
        pivots = [(p.real, p.imag) for p in one.candidate.pivots]
        return not any(shape.contains_points(pivots).any() or any(meets_finely(at[a], at[b], shape) for a, b in pairs)
                       for shape in shapes)  # fmt: skip

    assert not clear(plain[0])
    answer = ck.synthesise(task, obstacles=walls)
    assert len(answer) >= 1
    assert all(clear(one) for one in answer)
    assert answer[0].error > plain[0].error
    assert set(answer.reasons) <= {"obstacle", "accuracy"}
    # where nothing is clear the answers say so, each with the link that is in the way
    everywhere = ck.synthesise(task, obstacles=[[-100 - 100j, 100 - 100j, 100 + 100j, -100 + 100j]])
    assert not len(everywhere)
    assert set(everywhere.reasons) == {"obstacle"}
    assert "is in obstacle 0" in everywhere.rejected[0].text
    with pytest.raises(InvalidInput, match=r"obstacles\[0\].*no area"):
        ck.synthesise(task, obstacles=[[0, 1, 2]])


ANGLES = np.sort(np.random.default_rng(1).uniform(0, 2 * np.pi, 20))


@pytest.mark.parametrize("sense", [1, -1])
def test_points_at_angles_are_reached_there(sense: int) -> None:
    """A planted four-bar with uneven angles; its curve alone would not tell when the point is where."""
    rng = np.random.default_rng(3)
    chain = curve_chains(4)[0]
    designs = chain.designs(rng.random((512, len(chain.numbers))))
    design = designs[chain.curves(designs, 64)[1]][2:3]
    points = 3 * np.exp(0.5j) * chain.places(design, sense * ANGLES + 0.7)[0][0] + 20
    answer = ck.synthesise(ck.tasks.curve(points, at=sense * ANGLES, closed=True, links=4))
    best = answer[0]
    assert "with timing" in answer.task.in_words
    assert np.allclose(best.values - best.values[0], sense * (ANGLES - ANGLES[0]), atol=1e-9)
    path = np.ravel(ck.solve(best.mechanism, {best.driver: best.values}).points["P"].position)
    assert best.error == pytest.approx(np.abs(path - points).mean(), abs=3e-6 * np.abs(points - points.mean()).mean())
    assert best.error < 0.01 * np.abs(points - points.mean()).mean()


def test_points_at_times_are_reached_by_an_even_turn() -> None:
    """A stroke drawn at uneven times, by a part of the turn that is found, in either sense; a closed one in a turn."""
    u = np.linspace(0, 1, 14) ** 1.5
    stroke = np.exp(2.0j * u) * (1 + 0.2 * u)
    answer = ck.synthesise(ck.tasks.curve(stroke, times=5 + 3 * u, links=4))
    best = answer[0]
    steps = np.diff(best.values) / np.diff(u)
    assert np.ptp(steps) < 1e-9 * abs(steps[0])
    path = np.ravel(ck.solve(best.mechanism, {best.driver: best.values}).points["P"].position)
    assert np.abs(path - stroke).max() < 0.03
    times = np.arange(60) / 60
    closed = ck.synthesise(ck.tasks.curve(EGG[:-1], times=times[:-1], links=4, closed=True))[0]
    assert abs(closed.values[-1] - closed.values[0]) == pytest.approx(2 * np.pi * 58 / 59)


@pytest.mark.parametrize(
    ("timing", "words"),
    [
        ({"at": np.arange(5.0)}, "5 numbers for 59 points"),
        ({"at": np.arange(59.0), "times": np.arange(59.0)}, "leave out at or times"),
        ({"at": np.arange(59.0)}, "more than a turn"),
        ({"times": np.arange(59.0)[::-1]}, r"times\[1\].*does not follow"),
        ({"at": np.append(np.arange(58) / 20, 1.0)}, r"at\[58\].*does not follow"),
        ({"times": np.append(np.arange(58.0), np.nan)}, "not finite"),
    ],
)
def test_wrong_timing_says_what_would_do(timing: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        ck.tasks.curve(EGG[:-1], **timing)


def test_conditions_hold_for_curves_too() -> None:
    answer = ck.synthesise(ck.tasks.curve(EGG, links=4), transmission=ck.deg(55))
    assert all(one.transmission >= ck.deg(55) - 1e-9 for one in answer)
    assert len(answer) >= 1
    plain = four_bars_for_the_egg()
    assert plain[0].transmission < ck.deg(55)  # it is the nearest, and would not do
    assert plain[0].error < answer[0].error


def test_a_region_is_kept_by_what_is_searched() -> None:
    """Answers lie within it, not only what is left of answers anywhere: the nearest of all have pivots outside."""
    anywhere = four_bars_for_the_egg()
    outside = [pivot for one in anywhere for pivot in one.candidate.pivots if pivot.imag < 3]
    assert outside
    answer = ck.synthesise(ck.tasks.curve(EGG, links=4), region=[(-20, 3), (30, 40)])
    assert len(answer) >= 1
    assert all(pivot.imag >= 3 for one in answer for pivot in one.candidate.pivots)


@pytest.mark.parametrize(
    ("points", "options", "words"),
    [
        (EGG[:5], {}, "too few for a curve"),
        (EGG, {"links": 5}, "take 4, 6 or 8"),
        ([1, 2, np.nan, 4, 5, 6, 7, 8, 9], {}, "not finite"),
        (np.ones(20), {}, "1 different point"),
        ([], {}, "0 different points"),
        (1e300 * EGG, {}, "extent of .* choose another unit"),
        (1e-60 * EGG, {}, "choose another unit"),
    ],
)
def test_wrong_curves_say_what_would_do(points: Any, options: Any, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        ck.tasks.curve(points, **options)


# --- files ------------------------------------------------------------------------------------------------------


def file_of(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "text",
    [
        "1,2\n3,4\n5,7\n",
        "x,y\n1,2\n3,4\n5,7\n",
        "t;x (mm);y (mm)\n0;1;2\n1;3;4\n2;5;7\n",
        "# by a tracker\nt\tx\ty\n0\t1\t2\n1\t3\t4\n2\t\t\n3\t5\t7\n",
        "1 2\n3 4\n5 7\n",
        "x;y\n1,0;2,0\n3,0;4,0\n5,0;7,0\n",
    ],
)
def test_tables_of_points(tmp_path: Path, text: str) -> None:
    assert read_curve(file_of(tmp_path, "c.csv", text)).tolist() == [1 + 2j, 3 + 4j, 5 + 7j]


def test_a_path_of_an_svg(tmp_path: Path) -> None:
    """Lines, arcs and cubics by what is known of them: y upward, a circle's radius, a parabola's height."""
    svg = '<svg xmlns="http://www.w3.org/2000/svg"><g transform="translate(10 0) scale(2)">{}</g></svg>'
    line = read_curve(file_of(tmp_path, "a.svg", svg.format('<path d="m1 1 l3 0 0 4z"/>')))
    assert np.allclose(line, [12 - 2j, 18 - 2j, 18 - 10j, 12 - 2j])
    circle = read_curve(file_of(tmp_path, "b.svg", svg.format('<path d="M5 0A5 5 0 0 1-5 0 5 5 0 01 5 0Z"/>')))
    assert np.allclose(np.abs(circle - 10), 10)
    assert np.allclose(circle[: len(circle) // 2].imag, -np.abs(circle[: len(circle) // 2].imag))
    quadratic = read_curve(file_of(tmp_path, "c.svg", svg.format('<path d="M0 0Q1 2 2 0T4 0"/>')))
    x, y = (quadratic.real - 10) / 2, -quadratic.imag / 2
    first = x <= 2
    assert np.allclose(y[first], (2 * x - x**2)[first])
    assert np.allclose(y[~first], ((x - 2) ** 2 - 2 * (x - 2))[~first])
    cubic = read_curve(file_of(tmp_path, "d.svg", svg.format('<path d="M0 0C0 1 1 1 1 0S2-1 2 0"/>')))
    assert np.isclose(cubic.imag.min(), -1.5)
    assert np.isclose(cubic.imag.max(), 1.5)
    straight = read_curve(file_of(tmp_path, "f.svg", svg.format('<path d="M0 0C0 1 1 1 1 0T2 0"/>')))
    assert np.allclose(straight[straight.real > 12].imag, 0)  # after a cubic a quadratic mirrors nothing
    polygon = read_curve(file_of(tmp_path, "e.svg", svg.format('<polygon points="0,0 1,0 1,1"/>')))
    assert np.allclose(polygon, [10, 12, 12 - 2j, 10])


def test_a_polyline_of_a_dxf(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    document.modelspace().add_lwpolyline([(0, 0), (3, 0), (3, 4)])
    document.modelspace().add_circle((1, 1), 0.2)
    document.saveas(tmp_path / "c.dxf")
    assert np.allclose(read_curve(tmp_path / "c.dxf"), [0, 3, 3 + 4j])


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("c.txt", "1,2", "give one of .csv, .svg, .dxf"),
        ("c.csv", "1,2,3\n4,5,6\n", "no heading says which are x and y"),
        ("c.csv", "x,y\n1,2\n3,four\n", "line 3"),
        ("c.csv", "", "there is no curve in it"),
        ("c.svg", "<svg", "it is no SVG"),
        ("c.svg", "<svg><path d='M0 0 L1'/></svg>", "has 1 numbers"),
        ("c.svg", "<svg><g transform='warp(3)'><path d='M0 0 L1 1'/></g></svg>", "warp"),
        ("c.svg", "<svg><path d='L1 1 2 2'/></svg>", "begins with L"),
        ("c.svg", "<svg><circle r='0'/></svg>", "there is no curve in it"),
        ("c.dxf", "no drawing", "it is no DXF drawing"),
    ],
)
def test_wrong_files_of_curves(tmp_path: Path, name: str, text: str, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        read_curve(file_of(tmp_path, name, text))


# --- the verb ---------------------------------------------------------------------------------------------------


def run(*args: str) -> Result:
    return CliRunner().invoke(cli, list(args), standalone_mode=True)


def test_the_verb_writes_mechanisms_and_a_picture(tmp_path: Path) -> None:
    table = file_of(tmp_path, "egg.csv", "".join(f"{z.real},{z.imag}\n" for z in EGG))
    found, picture = tmp_path / "found", tmp_path / "found.svg"
    result = run("trace", str(table), "--links", "4", "--save", str(found), "--picture", str(picture))
    assert result.exit_code == 0, result.output
    assert "a point along a closed curve of 60 points" in result.stdout
    assert picture.read_text(encoding="utf-8").startswith("<svg")
    path = np.ravel(ck.solve(ck.load(found / "1.toml")).points["P"].position)
    assert plain_distance(path, EGG) < 0.1


@pytest.mark.full
def test_the_verb_takes_times_angles_and_obstacles(tmp_path: Path) -> None:
    """Of a tracker's table with a lost point: its times, its crank in degrees, and a box that links keep out of."""
    t = np.linspace(0, 0.95, 20)
    crank = 360 * t + 20 * np.sin(2 * np.pi * t)
    places = np.interp(t, np.arange(60) / 60, EGG)
    rows = [f"{a},{b},{z.real},{z.imag}" for a, b, z in zip(t, crank, places, strict=True)]
    rows.insert(4, "0.17,60,,")
    table = file_of(tmp_path, "tracked.csv", "t (s),crank,x,y\n" + "\n".join(rows) + "\n")
    box = file_of(tmp_path, "box.svg", '<svg><polygon points="40,40 60,40 60,60 40,60"/></svg>')
    common = [str(table), "--links", "4", "--closed", "--format", "json"]
    for option in (["--times", "T"], ["--angles", "crank", "--obstacle", str(box)]):
        result = run("trace", *common, *option, "--save", str(tmp_path / option[1]))
        assert result.exit_code == 0, result.output
        assert "with timing" in result.stdout
        # the file does not say at which angle the first point is: of all that are tried one must do
        angles = np.deg2rad(crank) if option[0] == "--angles" else 2 * np.pi * t
        own = ck.load(tmp_path / option[1] / "1.toml")
        begins = np.linspace(0, 2 * np.pi, 720, endpoint=False)[:, None]
        senses = (1,) if option[0] == "--angles" else (1, -1)
        at = np.concatenate([(begins + sense * angles).ravel() for sense in senses])
        path = np.ravel(ck.solve(own, {"crank": at}, order=0).points["P"].position).reshape(-1, 20)
        wall = [[40 + 40j, 60 + 60j]] if option[2:] else None
        timing = {"times": t} if option[0] == "--times" else {"at": angles}
        said = ck.synthesise(ck.tasks.curve(places, **timing, closed=True, links=4), obstacles=wall)[0].error
        assert np.abs(path - places).mean(axis=1).min() == pytest.approx(said, rel=0.02)
        assert said < 0.1 * np.abs(places - places.mean()).mean()
    for wrong, words in (
        (["--times", "t", "--angles", "crank"], "leave out one"),
        (["--times", "u"], "its columns are t (s), crank, x, y"),
        (["--times", "t", "--obstacle", str(tmp_path / "none.svg")], "cannot be read"),
    ):
        result = run("trace", *common, *wrong)
        assert result.exit_code == 2
        assert words in result.output
    assert "only a table" in run("trace", str(box), "--times", "t").output


def test_the_verb_says_what_is_wrong_with_a_file(tmp_path: Path) -> None:
    result = run("trace", str(tmp_path / "none.csv"))
    assert result.exit_code == 2
    assert "cannot be read" in result.output


def test_a_curve_sampled_around_is_closed_a_stroke_is_open() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    eight = 40 * np.sin(turn) + 18j * np.sin(2 * turn)
    assert ck.tasks.curve(eight).closed
    assert not ck.tasks.curve(eight[:50]).closed
    assert not ck.tasks.curve(np.linspace(0, 1 + 1j, 30)).closed


def test_very_many_points_are_a_curve_like_fewer() -> None:
    """Distances of each from each took 150 GB of memory; the extent is that of some hundred places."""
    around = np.exp(1j * np.linspace(0.0, 2 * np.pi, 100_001))
    assert ck.tasks.curve(around).closed
    assert extent(2 * around) == pytest.approx(4.0, rel=1e-4)
    slant = np.exp(0.4j) * np.linspace(0.0, 3.0, 1001) + 7
    assert extent(slant) == pytest.approx(3.0, rel=1e-4)
    assert not ck.tasks.curve(slant).closed


def test_an_open_curve_takes_less_than_a_turn() -> None:
    with pytest.raises(InvalidInput, match="less than a turn"):
        ck.tasks.curve(EGG, at=np.linspace(0.0, 2 * np.pi, len(EGG)), closed=False)
    task = ck.tasks.curve(EGG, at=np.linspace(0.0, 6.28, len(EGG)), closed=False)
    sought = atlases.SoughtCurve(task.points, task.closed, task.timing)
    assert len(coupler_atlas(4, 1000).nearest(sought, 2)) == 2


@pytest.mark.parametrize(
    ("text", "long", "area"),
    [
        ("<rect x='1' y='2' width='3px' height='4'/>", 14.0, 12.0),
        ("<g transform='scale(2)'><circle cx='1' r='3'/></g>", 12 * np.pi, 36 * np.pi),
        ("<ellipse rx='2' ry='2'/>", 4 * np.pi, 4 * np.pi),
        ("<rect width='90' height='90'/><polygon points='0,0 3,0 3,4'/>", 12.0, 6.0),
    ],
)
def test_shapes_of_an_svg_are_curves(tmp_path: Path, text: str, long: float, area: float) -> None:
    """A triangle is long enough for a curve; a rectangle beside it is the paper."""
    path = tmp_path / "drawn.svg"
    path.write_text(f"<svg xmlns='http://www.w3.org/2000/svg'>{text}</svg>")
    found = read_curve(path, fewest=8)
    assert ck.tasks.curve(found).closed
    assert np.abs(np.diff(found)).sum() == pytest.approx(long, rel=0.01)
    assert abs(np.sum(np.conj(found) * np.roll(found, -1)).imag) / 2 == pytest.approx(area, rel=0.01)


def test_transmission_angles_of_files_and_options_are_told_in_degrees(tmp_path: Path) -> None:
    """They were told in radians, which nobody had written."""
    table = file_of(tmp_path, "c.csv", "".join(f"{p.real},{p.imag}\n" for p in EGG))
    result = CliRunner().invoke(cli, ["trace", str(table), "--transmission", "95"])
    assert "95 degrees are no transmission angle" in result.stderr
    document = {"format": 1, "task": "swing", "angle": 45, "conditions": {"transmission": 120}}
    with pytest.raises(InvalidInput, match=r"conditions\.transmission: 120 is no .*degrees, from 0 to 90"):
        read_task(document)
