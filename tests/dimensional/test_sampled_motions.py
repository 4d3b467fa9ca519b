"""Sampled motions: the course of a random four-bar's coupler is found again, closed and open; others are followed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional import sampled_motions
from compoundkin.dimensional.curve_chains import curve_chains, turn
from compoundkin.dimensional.curve_conditions import BETWEEN, keeps_transmission
from compoundkin.dimensional.sampled_motions import SAMPLES, WantedMotion, _begun, _courses, nearest_courses
from compoundkin.dimensional.tasks import extent
from compoundkin.errors import InvalidInput


@pytest.fixture(autouse=True)
def _small_atlas(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for name, value in {"DESIGNS": 3_000, "GIVEN": 2, "STARTED": 6, "BEST": 6, "ROUNDS": 0}.items():
        monkeypatch.setattr(sampled_motions, name, value)
    yield
    _courses.cache_clear()


def planted(seed: int, poses: slice = slice(None)) -> np.ndarray:
    """Poses of the coupler of a random four-bar that the atlas does not hold, mirrored, turned and moved."""
    chain = curve_chains(4)[0]
    designs = chain.designs(np.random.default_rng(50 + seed).random((4096, len(chain.numbers))))
    z, u, clear = sampled_motions._poses(chain, designs, turn(120))
    z, u = np.conj(z[clear][0]), np.conj(u[clear][0])
    z = 30.0 * np.exp(0.7j) * z + 100 - 40j
    u = u * np.exp(0.7j) * np.exp(1.9j)
    return np.stack([z.real, z.imag, np.angle(u)], axis=-1)[poses]


def missed(one: ck.results.SolvedLinkage, poses: np.ndarray) -> float:
    """The greatest distance of poses from a course that is solved anew, angles by the extent of the places."""
    values = np.linspace(one.values[0], one.values[0] + 2 * np.pi, 3000)
    motion = ck.solve(one.mechanism, {one.driver: values}, order=0)
    z, angle = np.ravel(motion.links["plate"].origin.position), np.ravel(motion.links["plate"].angle)
    far = extent(poses[:, 0] + 1j * poses[:, 1])
    return float(max(
        np.hypot(np.abs(z - complex(x, y)), far * np.abs(np.angle(np.exp(1j * (angle - a))))).min() for x, y, a in poses
    ))  # fmt: skip


@pytest.mark.parametrize("part", [slice(None), slice(10, 60)], ids=["closed", "open"])
def test_the_motion_of_a_random_coupler_is_found_again(part: slice) -> None:
    poses = planted(1, part)
    task = ck.tasks.poses("plate", poses, links=4)
    assert task.closed == (part.start is None)
    best = ck.synthesise(task)[0]
    size = extent(poses[:, 0] + 1j * poses[:, 1])
    assert best.turns
    assert best.error < 0.01 * size
    assert missed(best, poses) == pytest.approx(best.error, abs=0.005 * size)
    # the body's own coordinates: its origin is the point that is led
    assert complex(best.mechanism.geometry.points["plate"]["P"]) == 0.0


def test_a_transmission_angle_is_kept_by_what_is_searched() -> None:
    s = np.linspace(0.0, 1.0, 24)
    lid = np.stack([40 * s, 30 * np.sin(np.pi * s / 2) ** 2, np.deg2rad(80) * s], axis=-1)
    answer = ck.synthesise(ck.tasks.poses("plate", lid, links=4), transmission=ck.deg(20))
    assert len(answer)
    for one in answer:
        assert one.transmission >= ck.deg(20)
        assert one.error < 0.1 * extent(lid[:, 0] + 1j * lid[:, 1])
        assert missed(one, lid) == pytest.approx(one.error, rel=0.1, abs=0.05)


@pytest.mark.parametrize("closed", [True, False])
def test_the_nearest_courses_are_those_of_plain_sums(closed: bool) -> None:
    rng = np.random.default_rng(3)
    at = turn(SAMPLES)
    z = np.exp(1j * at) + (rng.standard_normal((3, 1)) + 1j * rng.standard_normal((3, 1))) * np.exp(2j * at) / 4
    u = np.exp(1j * np.cumsum(rng.standard_normal((3, SAMPLES)), axis=1) / 4)
    poses = planted(2, slice(None) if closed else slice(0, 50))
    course = WantedMotion.of(ck.tasks.poses("plate", poses, links=4))
    found, how = nearest_courses(z, u, course)
    for k in range(3):
        start, long, sense = how[k]
        plain = []
        for s in range(SAMPLES) if closed else [start]:
            for way in (1, -1) if closed else [sense]:
                own, turned = (np.roll(one[k], -s)[:long] for one in (z, u))
                samples = np.linspace(0, SAMPLES - 1, long)
                places, vectors = (np.interp(samples, np.arange(SAMPLES), one)[::way] for one in course[:2])
                own, places = own - own.mean(), places - places.mean()
                like = np.abs(np.vdot(own, places)) / np.linalg.norm(own) / np.linalg.norm(places)
                plain.append(2 - 2 * like + course.weight**2 * (2 - 2 * np.abs(np.vdot(turned, vectors)) / long))
        assert found[k] == pytest.approx(min(plain), rel=1e-6)


@pytest.mark.parametrize("part", [slice(None), slice(10, 60)], ids=["closed", "open"])
def test_slopes_are_differences(part: slice) -> None:
    """Of residuals to given neighbours: a step so small that no pose has another nearest sample."""
    course = WantedMotion.of(ck.tasks.poses("plate", planted(3, part), links=4))
    one = next(iter(_begun(_courses(4, 3_000)[0], course)))
    _, _, by_w, by_v, _ = one._laid(one.x, one._angles(one.x, 40))
    for k in range(one.x.shape[1]):
        if course.closed and k in (one.x.shape[1] - 7, one.x.shape[1] - 6):
            continue  # a whole turn begins anywhere
        step = np.zeros(one.x.shape[1])
        step[k] = 1e-6
        ahead, behind = (one._laid(x, one._angles(x, 40)) for x in (one.x + step, one.x - step))
        for own, other, slope in ((ahead[0], behind[0], by_w[k]), (ahead[1], behind[1], by_v[k])):
            plain = (own - other) / 2e-6
            np.testing.assert_allclose(slope, plain, atol=1e-5 * (1 + np.abs(plain).max()))


@pytest.mark.parametrize(
    ("poses", "how", "words"),
    [
        (planted(1), {"links": 8}, "take 4 or 6"),
        (planted(1)[:5], {"links": 6}, "too few for a course"),
        (np.repeat(planted(1)[:1], 20, axis=0), {"links": 6}, "too few for a course"),
        (planted(1), {"links": 6, "velocities": {0: (1, 0, 1)}}, "a course has its own"),
    ],
)
def test_what_is_no_course_is_said(poses: np.ndarray, how: dict[str, object], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        ck.tasks.poses("plate", poses, **how)


def test_the_transmission_angle_of_a_geared_five_bar_is_that_of_its_dyad() -> None:
    chain = next(one for one in curve_chains(6) if "five-bar" in one.title)
    designs = chain.designs(np.random.default_rng(7).random((512, len(chain.numbers))))
    designs = designs[chain.curves(designs, 64)[1]][:8]
    (dyad,) = (one for one in ck.decompose(chain.mechanism).groups if len(one.links) == 2)
    program = ck.compile(chain.mechanism, f"{dyad.links[0]}.transmission_index", free=list(chain.dimensions(designs)))
    found = program(turn(64), chain.dimensions(designs))[f"{dyad.links[0]}.transmission_index"]
    kept = keeps_transmission(chain, designs, 0.4)
    assert 0 < kept.sum() < len(kept)
    np.testing.assert_array_equal(kept, found.min(axis=1) >= np.sin(0.4 + BETWEEN))
