"""Likely slips are warned about or have a remedy; what cannot be meant is refused; copies, pickles, pictures."""

from __future__ import annotations

import copy
import pickle
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import dumps, loads
from tests.catalog import NAMES, each, mechanism, motion
from tests.support import FOUR_BAR

SIX_BAR = mechanism("six-bar")
# The ground link is longer than all others together.
NOT_ASSEMBLED = FOUR_BAR.replace("[4, 0]", "[100, 0]")


# --- degrees and radians ---


@pytest.mark.parametrize(
    "values", [range(0, 361, 5), np.arange(0, 361, 1), np.linspace(0, 360, 73), 35, [30, 60], [[0, 90], [0, 120]]]
)
def test_degrees_in_python_are_warned_about(values: Any) -> None:
    with pytest.warns(ck.errors.LikelySlip, match=r"'crank' is driven in radians.*compoundkin.deg\(values\)"):
        ck.solve(mechanism("crank-rocker"), values)


@pytest.mark.parametrize(
    "values",
    [0, 2, [0, 1, 2, 3, 4, 5, 6], ck.deg(range(0, 361, 5)), np.linspace(0, 20 * np.pi, 721), np.linspace(0, 100, 1001)],
)
def test_radians_in_python_are_not(values: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", ck.errors.LikelySlip)
        ck.solve(mechanism("crank-rocker"), values)


def test_lengths_of_slides_are_not_taken_for_degrees() -> None:
    frame, block = ck.link("frame", A=0, B=1), ck.link("block", C=0)
    slider = ck.Mechanism("m", frame, block, ck.slide("block", on="frame", through="A", toward="B"), ck.drive("block"))
    ck.solve(slider, range(0, 361, 5))


@pytest.mark.parametrize("values", ["{ from = 0, to = 6.283, step = 0.1 }", "[0, 1.57, 3.14]", '"0:6.28:0.1"'])
def test_radians_in_a_file_are_warned_about(values: str) -> None:
    with pytest.warns(ck.errors.LikelySlip, match="degrees look like radians; write degrees"):
        loads(f"{FOUR_BAR}values = {values}")


@pytest.mark.parametrize(
    "values", ["{ from = 0, to = 6, step = 0.1 }", "{ rad = [0, 1.57, 3.14] }", "[0, 30, 90]", "[0, 11]"]
)
def test_degrees_in_a_file_are_not(values: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", ck.errors.LikelySlip)
        loads(f"{FOUR_BAR}values = {values}")


def test_the_warning_is_given_at_the_line_of_the_user() -> None:
    with pytest.warns(ck.errors.LikelySlip) as caught:
        ck.solve(mechanism("crank-rocker"), 35)
    assert caught[0].filename == __file__


# --- letters, texts that say numbers, designs ---


def test_letters_that_differ_in_case_only_are_asked_about() -> None:
    slip = loads(FOUR_BAR.replace("{ D = [0, 0], C", "{ D = [0, 0], c"))
    assert {f.remedy.split("?")[0] for f in ck.decompose(slip).faults} == {"did you mean 'C' and 'c' to be one letter"}
    assert all(
        "did you mean" not in f.remedy for f in ck.decompose(loads(FOUR_BAR.replace(", C = [3", ", E = [3"))).faults
    )


@pytest.mark.parametrize(
    ("speed", "meant"),
    [("60 rpm", 2 * np.pi), ("60rpm", 2 * np.pi), ("90 deg", np.pi / 2), ("90 deg/s", np.pi / 2), ("-1.5 rad/s", -1.5)],
)
def test_rates_are_taken_as_text(speed: str, meant: float) -> None:
    assert loads(f'{FOUR_BAR}speed = "{speed}"').drives[0].speed == pytest.approx(meant, rel=1e-15)


def test_values_are_taken_as_text() -> None:
    values = loads(f'{FOUR_BAR}values = "0:360:5"').drives[0].values
    assert values is not None
    assert values.tolist() == ck.deg(range(0, 361, 5)).tolist()


def test_other_texts_are_refused_with_a_remedy() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"the text 'fast' is not a number; write 10 or "):
        loads(f'{FOUR_BAR}speed = "fast"')


@pytest.mark.parametrize("speed", ["60 rpm", "1.5 rad/s", "90 deg"])
def test_rates_of_angles_are_none_of_lengths(speed: str) -> None:
    slide = f'slides = [{{ link = "b", on = "frame", through = "A" }}]\ndrives = [{{ link = "b", speed = "{speed}" }}]'
    links = "[links]\nframe.points = { A = [0, 0] }\nb.points = { B = [0, 0] }"
    with pytest.raises(ck.errors.InvalidMechanism, match=f"the text '{speed}' is not a number; write lengths a second"):
        loads(f'format = 1\ntitle = "m"\n{slide}\n{links}')


def test_two_designs_read_as_one_point_are_warned_about() -> None:
    with pytest.warns(ck.errors.LikelySlip, match=r"x = 1, y = 1.2 of one design; two designs are written \(\[\[1.0\]"):
        ck.link("crank", A=0, B=[[1.0], [1.2]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert ck.link("crank", A=0, B=([[1.0], [1.2]], 0)).points["B"].shape == (2, 1)


# --- numbers that are none, texts that do not show ---


@pytest.mark.parametrize(
    ("values", "told"),
    [
        (np.array(["2026-01-01", "2026-01-02"], dtype="M8[D]"), "dates are no numbers"),
        (np.datetime64("2026-01-01"), "dates are no numbers"),
        (np.ma.array([1.0, 2.0], mask=[False, True]), "some of the numbers are masked"),
        (np.array([1 + 1j]), "complex numbers are no real ones"),
        ("0:360:5", "a text is no number"),
    ],
)
def test_driver_values_that_are_no_numbers_are_refused(values: Any, told: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=f"crank: {told}"):
        ck.solve(SIX_BAR, values)
    with pytest.raises(ck.errors.InvalidMechanism, match=told):
        ck.drive("crank", values=values)


@pytest.mark.parametrize("text", ["a\x1b[2Jb", "a\u202eb", "a\x00b", "a\x85b", "a\u2066b", "half \ud800"])
@pytest.mark.parametrize("word", ["title", "unit", "source", "description"])
def test_characters_that_do_not_show_are_refused(word: str, text: str) -> None:
    said = {"title": "m", word: text}
    with pytest.raises(ck.errors.CompoundkinError, match=rf"{word}: it holds .* U\+[0-9A-F]{{4}}"):
        ck.Mechanism(said.pop("title"), ck.link("frame", A=0), **said)
    written = FOUR_BAR.replace(
        'title = "Four-bar"', f'title = "x"\nsource = "{text.encode("unicode_escape").decode()}"'
    )
    if "\\x" not in written and "\\ud800" not in written:
        with pytest.raises(ck.errors.InvalidMechanism, match="source: it holds the control character"):
            loads(written)


def test_texts_of_all_languages_and_lines_are_taken() -> None:
    taken = ck.Mechanism(
        "Getriebe für 机构 \U0001f469\u200d\U0001f52c", ck.link("frame", A=0), description="a\n\tb\r\n"
    )
    assert loads(dumps(taken)) == taken


def test_errors_show_every_character() -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        loads(FOUR_BAR.replace('title = "Four-bar"', 'title = "x"\n"\\u001b[31m" = 1'))
    assert "\x1b" not in str(caught.value)
    assert "\\x1b[31m" in str(caught.value)


def test_half_a_surrogate_pair_reaches_no_page_and_no_picture() -> None:
    for call in (lambda: ck.plot(motion("six-bar"), "bar", title="\ud800"), lambda: SIX_BAR.replace(title="\ud800")):
        with pytest.raises(ck.errors.InvalidInput, match="half a surrogate pair"):
            call()


def test_a_key_with_20000_dots_is_refused_at_once() -> None:
    begun = time.process_time()
    for text in (f"a{'.a' * 20000} = 1", f"{FOUR_BAR}values{'.a' * 20000} = 1", f"a = {'[' * 20000}"):
        with pytest.raises(ck.errors.InvalidMechanism, match="nested too deeply"):
            loads(text)
    assert time.process_time() - begun < 2.0


@pytest.mark.parametrize("k", [0, 3, 11])
@pytest.mark.parametrize("closed", [True, False])
def test_an_outlier_among_the_points_of_a_profile_is_told(k: int, closed: bool) -> None:
    points = [(10 * np.cos(a), 10 * np.sin(a)) for a in np.linspace(0, 6, 12)]
    points[k] = (3e10, 0.0)
    found = list(ck.profiles.profile(points, closed=closed).problems("profile"))
    assert found


# --- wrong objects, each with its remedy ---

REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "decompose a name": (lambda: ck.decompose("six-bar"), r"'six-bar' is no mechanism; .*load\(\)"),  # type: ignore[arg-type]
    "decompose a number": (lambda: ck.decompose(3), "3 is no mechanism"),  # type: ignore[arg-type]
    "decompose a motion": (lambda: ck.decompose(motion("six-bar")), "take its .mechanism"),  # type: ignore[arg-type]
    "verify nothing": (lambda: ck.verify(None), r"None is no motion; solve\(\) gives one"),  # type: ignore[arg-type]
    "verify a mechanism": (lambda: ck.verify(SIX_BAR), r"is no motion; solve\(\) gives one"),  # type: ignore[arg-type]
    "centres of a mechanism": (lambda: ck.instant_centres(SIX_BAR), r"solve\(\) gives one"),  # type: ignore[arg-type]
    "gaps of a mechanism": (lambda: ck.gaps(SIX_BAR), r"solve\(\) gives one"),  # type: ignore[arg-type]
    "hint=1": (lambda: ck.solve(SIX_BAR, hint=1), "hint: 1 is no table by name"),  # type: ignore[arg-type]
    "hint=3": (lambda: ck.solve(SIX_BAR, hint=3), "hint: 3 is no table by name"),  # type: ignore[arg-type]
    "modes={1: 1}": (lambda: ck.solve(SIX_BAR, modes={1: 1}), "modes: {1: 1} is no table by name"),  # type: ignore[dict-item]
    "modes={3: 1}": (lambda: ck.solve(SIX_BAR, modes={3: 1}), "modes: {3: 1} is no table by name"),  # type: ignore[dict-item]
    "values by number": (lambda: ck.solve(SIX_BAR, {1: 1}), "there is no driver 1; known: crank"),
    "outputs=5": (lambda: SIX_BAR.replace(outputs=5), "outputs: 5 is no text or list of texts"),
    "unit=3": (lambda: SIX_BAR.replace(unit=3), "unit: 3 is no text"),
    "a driver by number": (lambda: ck.with_driver(SIX_BAR, 3), "link: 3 is no text"),  # type: ignore[arg-type]
    "a mechanism by number": (lambda: ck.load(3), "path: 3 is no text or path"),  # type: ignore[arg-type]
    "a link by number": (lambda: ck.link(3, A=0), "name: 3 is no text"),  # type: ignore[arg-type]
    "at='x'": (lambda: ck.draw(SIX_BAR, at="x"), "at.crank: 'x' is not a number"),
    "deg('x')": (lambda: ck.deg("x"), "angle: a text is no number"),
    "size of a plot": (lambda: ck.plot(motion("six-bar"), "bar", size=3), "size: 3 is no 2 values"),  # type: ignore[arg-type]
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_wrong_objects_have_a_remedy(case: str) -> None:
    call, told = REFUSED[case]
    with pytest.raises(ck.errors.InvalidInput, match=told):
        call()


# --- what needs no pose, and no freedom ---


def test_alternatives_below_mobility_zero_are_none() -> None:
    cognates = mechanism("roberts-cognates")
    assert ck.decompose(cognates).mobility.freedoms == -1
    assert ck.alternatives(cognates) == ()


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@pytest.mark.parametrize("kind", ["groups", "graph", "loops", "circle"])
def test_pictures_of_the_structure_need_no_pose(kind: str) -> None:
    still = loads(NOT_ASSEMBLED)
    for what in (still, ck.decompose(still), ck.solve(still)):
        assert ck.draw(what, kind=kind).svg.startswith("<svg")
    with pytest.raises(ck.errors.NotAssembled):
        ck.draw(still)
    assert "class II: RRR" in ck.draw(still, kind="groups").svg


# --- copies and pickles ---


def halved(t: Any) -> Any:
    return 0.5 * t


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@each(NAMES)
def test_mechanisms_and_motions_pickle_and_are_copied(name: str) -> None:
    was, moved = mechanism(name), motion(name)
    for other in (pickle.loads(pickle.dumps(was)), copy.deepcopy(was), copy.copy(was)):
        assert other == was
    point = next(iter(moved.points))
    for again in (pickle.loads(pickle.dumps(moved)), copy.deepcopy(moved)):
        np.testing.assert_array_equal(again.points[point].position, moved.points[point].position)
        assert repr(again) == repr(moved)


def test_findings_pickle() -> None:
    moved, bar = motion("crank-rocker"), mechanism("crank-rocker")
    found = [
        ck.decompose(bar), ck.verify(moved), ck.instant_centres(moved), ck.circuits(bar), ck.configurations(bar),
        ck.gaps(moved), ck.loop_equations(bar), ck.mobility_analysis(bar), ck.report(moved), ck.draw(moved),
        moved.table(), moved.points, moved.points["C"], moved.links["rocker"], moved.pairs, ck.alternatives(bar),
    ]  # fmt: skip
    for one in found:
        assert repr(pickle.loads(pickle.dumps(one))) == repr(one)
        assert repr(copy.deepcopy(one)) == repr(one)


def test_functions_that_cannot_be_pickled_are_named() -> None:
    driven = mechanism("crank-rocker").replace(ck.drive("crank", law=halved))
    assert pickle.loads(pickle.dumps(driven)) == driven
    for slip in (
        driven.replace(ck.drive("crank", law=lambda t: 0.5 * t)).drives[0],
        ck.profiles.formula(lambda t: np.exp(1j * t), 0.0, 6.0),
    ):
        assert copy.deepcopy(slip) is not None
        with pytest.raises(ck.errors.InvalidInput, match=r"the function '.*<lambda>' cannot be pickled; define it"):
            pickle.dumps(slip)


def test_errors_keep_their_problems_on_the_way_from_another_process() -> None:
    with pytest.raises(ck.errors.UnknownName) as caught:
        ck.load("sixbar")
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.problems, str(again)) == (caught.value.problems, str(caught.value))
