"""Texts of the shipped mechanisms, run in every language, against `solve`."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.programs.compiled_path import CompiledPath, compile
from compoundkin.programs.recording.recorded_motion import output_of
from compoundkin.programs.solved_designs import seed_values
from compoundkin.programs.sources import LANGUAGES
from compoundkin.programs.sources.written_program import WrittenProgram
from tests.catalog import mechanism, motion
from tests.programs.languages import run

POSES = 12
# Every kind of pair and group that texts have, several drivers, drivers on moving links, counted turns, ends of guides.
WRITTEN = (
    "andrews-squeezer", "atkinson-engine", "belt-coupled-cranks", "cardan-gear-straight-line", "dixon-mechanism",
    "disc-cam-offset-roller", "excavator-arm", "ferguson-paradox", "five-bar", "geared-coupler", "geared-five-bar",
    "geared-press", "geneva-wheel", "hydraulic-digger", "jansen-leg", "jaw-crusher", "marghitu-r-rtr-rrt",
    "oldham-coupling", "oscillating-cylinder", "planetary-train", "rack-and-pinion-steering", "rapson-slide",
    "rolling-wheel", "scotch-yoke", "six-bar", "slider-crank-driven-by-piston", "stephenson-iii", "sun-and-planet",
    "watt-i", "whitworth-turning-guide", "windscreen-wiper",
    # without a closed form
    "3-rrr", "class-iii-six-bar", "differential", "stephenson-ii-driven-at-binary",
)  # fmt: skip
# Mechanisms whose texts are refused, with a word of the reason.
REFUSED = {
    "parallelogram": "change point", "parallelogram-third-crank": "change point", "roberts-cognates": "change point",
    "flat-faced-follower": "profile",
}  # fmt: skip


class Case(NamedTuple):
    """A mechanism as a program, its arguments at some poses; what `solve` finds there, and how large its kind is."""

    program: WrittenProgram
    poses: Number
    assembled: Number
    expected: list[Number]
    sizes: list[float]


@cache
def path_of(name: str) -> CompiledPath:
    """A mechanism compiled for the outputs of its file, and for a link's angle."""
    names = []
    for output in (*mechanism(name).outputs, list(mechanism(name).links)[-1]):
        try:
            names.append(output_of(motion(name), output).name)
        except ck.errors.InvalidInput:
            continue  # figures of whole motions, forces
    return compile(mechanism(name), list(dict.fromkeys(names)))


@cache
def case(name: str) -> Case:
    path, found = path_of(name), motion(name)
    program = path.written(f"m_{name}")
    count = found.shape[-1]
    chosen = np.unique(np.linspace(0, count - 1, POSES).astype(int))

    def at(values: Number) -> Number:
        return np.broadcast_to(np.ravel(values), (count,))[chosen]

    rows = []
    for one in (argument.given for argument in program.arguments):
        if one.kind == "drive":
            drive = found.drives[one.name]
            rows.append(at((drive.value, drive.rate, drive.second)[int(one.part)]))
        else:
            if one.part == "side":
                rows.append(np.zeros(len(chosen)))
                continue
            state = seed_values([one], found)[one][0]
            rows.append(at(np.append(state[0], state[:-1])))  # of the pose before
    wanted = [one for output in path.programs.outputs for one in ck.quantity(found, output.name).components]
    pace = max(np.max(np.abs(drive.rate)) / found.solving_order.unit(name) for name, drive in found.drives.items())
    sizes = [pace**one.order * (found.size if one.dimension == "length" else 1.0) for one in wanted]
    return Case(program, np.array(rows), at(found.assembled), [at(one.values) for one in wanted], sizes)


@pytest.mark.parametrize("language", LANGUAGES)
def test_texts_are_equal_to_what_is_solved(language: str, tmp_path: Path) -> None:
    """Within 1e-12 of the largest of each kind, or of what the driver's pace makes of the mechanism's size."""
    every = [case(name) for name in WRITTEN]
    programs, poses = [one.program for one in every], [one.poses for one in every]
    for one, found in zip(every, run(language, programs, poses, tmp_path), strict=True):
        name = one.program.name
        assert np.array_equal(found[0] != 0.0, one.assembled), name
        for result, values, wanted, size in zip(one.program.results, found[1:], one.expected, one.sizes, strict=False):
            alike = [
                other for other, r in zip(one.expected, one.program.results, strict=False) if r.unit == result.unit
            ]
            known = np.isfinite(wanted)
            assert np.all(np.isfinite(values) <= one.assembled), name
            largest = max(size, *(np.max(np.abs(other[np.isfinite(other)]), initial=0.0) for other in alike))
            off = values - wanted
            if result.unit == "rad":
                off = (off + np.pi) % (2.0 * np.pi) - np.pi  # of pi and -pi either is told
            assert np.all(np.abs(off)[known] <= 1e-12 * largest), (name, result.name)


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_text_can_follow_is_refused_by_name(name: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=REFUSED[name]):
        path_of(name).source("c")


def test_between_change_points_it_is_written(tmp_path: Path) -> None:
    """A parallelogram's follower turns with its crank."""
    values = np.linspace(0.2, 2.9, 7)
    path = compile(mechanism("parallelogram"), "follower.angle", values=values)
    (found,) = run("python", [path.written()], [values[None, :]], tmp_path)
    assert found[1] == pytest.approx(values, abs=1e-12)


@pytest.mark.parametrize("name", ["class-iii-six-bar", "geared-coupler"])
def test_a_text_marches_with_its_own_states(name: str) -> None:
    """Pose by pose, without being told anything but the driver's value; what it begins with is its own."""
    found, path = motion(name), path_of(name)
    program = path.written("one")
    names: dict[str, Any] = {}
    exec(LANGUAGES["python"].text(program), names)
    (driver,) = found.drives.values()
    state: dict[str, float] = {}
    wanted = [one for output in path.programs.outputs for one in ck.quantity(found, output.name).components]
    for pose in range(0, found.shape[-1] - 1):
        told = names["one"](float(driver.value[pose]), **state)
        state = {word: number for word, number in told.items() if word.startswith("state_")}
        assert told["assembled"]
        assert len(state) == len([one for one in program.arguments if one.name in told]) > 0
        for result, one in zip(program.results, wanted, strict=False):
            off = told[result.name] - one.values[pose]
            off = (off + np.pi) % (2.0 * np.pi) - np.pi if one.is_angle else off
            assert one.order or abs(off) < 1e-12 * max(found.size, 1.0)


def test_a_state_that_is_too_far_is_not_followed() -> None:
    path = path_of("class-iii-six-bar")
    names: dict[str, Any] = {}
    exec(path.source("python", "one"), names)
    own = float(motion("class-iii-six-bar").drives["crank"].value[0])
    assert names["one"](own)["assembled"]
    assert not names["one"](own, state_1_3=9.0)["assembled"]


def test_where_it_cannot_be_assembled_all_is_nan(tmp_path: Path) -> None:
    """Beyond the range of a rocker, and where the numbers given are none."""
    rocker = mechanism("double-rocker")
    given = np.array([*np.linspace(-3.0, 3.0, 61), np.nan, np.inf])
    path = compile(rocker, ["coupler.angle", "coupler.angular_velocity"])
    with pytest.warns(ck.errors.UnassembledPoses):
        assembled = ck.solve(rocker, given[:-2], speed=1.0).assembled
    assert 0 < np.count_nonzero(assembled) < 61
    for language in ("python", "javascript"):
        (found,) = run(language, [path.written()], [np.array([given, np.ones(63)])], tmp_path)
        assert np.array_equal(found[0] != 0.0, [*assembled, False, False])
        assert np.array_equal(np.isnan(found[1:]), np.broadcast_to(found[0] == 0.0, (2, 63)))


def test_free_dimensions_are_arguments_whose_own_numbers_stand_in_for_them(tmp_path: Path) -> None:
    path = compile(mechanism("six-bar"), ["G.position", "bar.angular_velocity"], free=["plate.C", "crank.D"])
    program = path.written()
    assert [one.name for one in program.arguments[2:]] == ["plate_C_x", "plate_C_y", "crank_D_x", "crank_D_y"]
    own = [one.own for one in program.arguments[2:]]
    assert own == [x for place in (12.287280664334878 + 8.60364654526569j, 14.0) for x in (place.real, place.imag)]
    crank = np.linspace(0.0, 6.0, 5)
    rows = np.array([crank, np.full(5, 3.0), np.full(5, 12.0), np.full(5, 9.0), np.full(5, 13.5), np.full(5, 0.5)])
    (found,) = run("python", [program], [rows], tmp_path)
    wanted = path(crank, {"plate.C": 12.0 + 9.0j, "crank.D": 13.5 + 0.5j}, speed=3.0)
    assert found[1] + 1j * found[2] == pytest.approx(wanted["G.position"], rel=1e-12)
    assert found[3] == pytest.approx(wanted["bar.angular_velocity"], rel=1e-12)


def test_numbers_of_pairs_are_arguments_too(tmp_path: Path) -> None:
    path = compile(
        mechanism("rack-driven-double-slider"), "B.position", free=["rack.radius", "block.offset", "slider.angle"]
    )
    program = path.written()
    told = [(one.name, one.unit) for one in program.arguments if one.given.kind == "dimension"]
    unit = mechanism("rack-driven-double-slider").unit or "length"
    assert told == [("rack_radius", unit), ("block_offset", unit), ("slider_angle", "rad")]
    own = [one.start for one in program.arguments]
    changed = [*own[:-3], own[-3] * 1.1, own[-2] + 0.01, own[-1] + 0.02]
    (found,) = run("python", [program], [np.array([own, changed]).T], tmp_path)
    names = ("rack.radius", "block.offset", "slider.angle")
    for column, values in ((0, own), (1, changed)):
        wanted = path([values[0]], dict(zip(names, values[-3:], strict=True)))["B.position"].ravel()[0]
        assert found[1, column] + 1j * found[2, column] == pytest.approx(wanted, rel=1e-12)


def test_a_text_is_of_one_mechanism() -> None:
    words = ck.link("frame", A=0), ck.link("crank", A=0, B=([[1.0], [2.0]], 0)), ck.drive("crank")
    with pytest.raises(ck.errors.InvalidInput, match="one number for each"):
        compile(ck.Mechanism("two", *words), "B", free="crank.B").source("c")


def test_an_unknown_language_is_told() -> None:
    with pytest.raises(ck.errors.UnknownName, match="python"):
        path_of("six-bar").source("pyton")


def test_the_comment_tells_of_modes_units_and_range() -> None:
    text = path_of("double-rocker").source("c", "rocker")
    told = " ".join(line.strip(" *") for line in text.partition("*/")[0].splitlines())
    assert f"{mechanism('double-rocker').title} " in told
    for words in ("rad  ", "Assembly modes, which it keeps: coupler", "poses that were tried", "NaN where it cannot"):
        assert words in told or words.strip() in told
