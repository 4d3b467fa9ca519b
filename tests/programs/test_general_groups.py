"""Groups without a closed form in programs: marches and seeds at every pose, against `solve`."""

import warnings

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.programs import call_seeds
from compoundkin.programs.backends import BACK_ENDS
from compoundkin.programs.path_programs import PathPrograms

NAMES = (
    "3-rrr",
    "class-iii-six-bar",
    "stephenson-ii",
    "stephenson-ii-driven-at-binary",
    "stephenson-iii-driven-at-dyad",
    "stephenson-iii-floating-driver",
)
WORDS = ("position", "velocity", "acceleration")


def designs_of(mechanism, count, part):
    """Return some points of its links with their own places and others nearby."""
    random = np.random.default_rng(0)
    free = [(link, letter) for link, own in mechanism.geometry.points.items() for letter in own if link != "frame"][:4]
    moved = part * (random.random((len(free), count, 1)) + 1j * random.random((len(free), count, 1)))
    return {f"{link}.{letter}": mechanism.geometry.points[link][letter] * (1.0 + change)
            for (link, letter), change in zip(free, moved, strict=True)}  # fmt: skip


def course_of(mechanism, poses):
    """Return values of its drivers along its own motion, and their rates."""
    own = ck.solve(mechanism, order=0).inputs.drives
    at = np.linspace(0.0, 1.0, poses)
    values = {name: np.interp(at, np.linspace(0.0, 1.0, np.size(value[0])), np.ravel(value[0]))
              for name, value in own.items()}  # fmt: skip
    return values, {"speed": dict.fromkeys(values, 2.0), "acceleration": dict.fromkeys(values, 3.0)}


def agree(found, motion, letters, within=1e-12):
    """Hold positions and rates against those of a motion, by the largest of their kind."""
    np.testing.assert_array_equal(found.assembled, motion.assembled)
    for word in WORDS:
        expected = {letter: getattr(motion.points[letter], word) for letter in letters}
        scale = max(np.nanmax(np.abs(one)) for one in expected.values())
        for letter, one in expected.items():
            np.testing.assert_allclose(found[f"{letter}.{word}"], one, rtol=0.0, atol=within * scale)


@pytest.mark.parametrize("backend", BACK_ENDS)
@pytest.mark.parametrize("name", [*NAMES[:2], *(pytest.param(name, marks=pytest.mark.full) for name in NAMES[2::3])])
@pytest.mark.parametrize(("designs", "poses"), [(33, 41), (2, 4)], ids=["march", "few"])
def test_every_point_equals_solve(name, backend, designs, poses):
    if backend != "numpy":
        pytest.importorskip("llvmlite" if backend == "llvm" else backend)
    mechanism = ck.load(name)
    letters, dimensions = list(mechanism.carriers), designs_of(mechanism, designs, 0.01)
    path = ck.compile(
        mechanism, [f"{a}.{word}" for a in letters for word in WORDS], free=[*dimensions], backend=backend
    )
    values, rates = course_of(mechanism, poses)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = path(values, dimensions, **rates)
        motion = ck.solve(path.mechanism(dimensions), values, **rates)
    agree(found, motion, letters)


def test_slopes_of_a_march_are_differences_of_solve():
    mechanism = ck.load("class-iii-six-bar")
    dimensions, step = designs_of(mechanism, 33, 0.01), 1e-5
    path = ck.compile(mechanism, [f"B3.{word}" for word in WORDS], free=[*dimensions])
    values, rates = course_of(mechanism, 73)
    name = [*dimensions][-1]
    found = path.derivatives(values, dimensions, by=[f"{name}.y"], **rates)
    ends = [ck.solve(path.mechanism({**dimensions, name: dimensions[name] + k * step * 1j}), values, **rates)
            for k in (1, -1)]  # fmt: skip
    for word in WORDS:
        one, other = (getattr(motion.points["B3"], word) for motion in ends)
        slope = (one - other) / (2.0 * step)
        np.testing.assert_allclose(found[f"B3.{word}", f"{name}.y"], slope, rtol=0.0, atol=1e-7 * np.abs(slope).max())


@pytest.mark.parametrize("name", ["3-rrr", "class-iii-six-bar", "stephenson-iii-floating-driver"])
def test_one_pose_after_another_is_continued_from_the_drawing(name, monkeypatch):
    pytest.importorskip("llvmlite")
    mechanism = ck.load(name)
    letters, dimensions = list(mechanism.carriers), designs_of(mechanism, 1, 0.003)
    path = ck.compile(mechanism, [f"{a}.{word}" for a in letters for word in WORDS], free=[*dimensions])
    values, rates = course_of(mechanism, 2)
    own = {driver: float(np.ravel(value)[0]) for driver, value in values.items()}
    path(own, **rates)
    # nothing is solved any more
    monkeypatch.setattr(call_seeds, "_solved_seeds", None)
    monkeypatch.setattr(PathPrograms, "solve", lambda *_, **__: pytest.fail("a design is solved"))
    poses = [{driver: value + step for driver, value in own.items()} for step in (0.0, 0.04, -0.03)]
    found = [[path(pose, given, **rates) for given in (None, dimensions)] for pose in poses]
    monkeypatch.undo()
    for pose, pair in zip(poses, found, strict=True):
        for one, given in zip(pair, (None, dimensions), strict=True):
            agree(one, ck.solve(path.mechanism(given), pose, **rates), letters, 1e-11)
