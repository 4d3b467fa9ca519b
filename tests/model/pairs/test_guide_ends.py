"""Slots, guides and arcs with ends: beyond them there is no pose, and the end is named."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import document as doc
from compoundkin.files.json_schema import schema
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.model.elements import Drawn
from compoundkin.model.fields import Item
from compoundkin.view.sketch.shapes import Polyline, leaves

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")

# Gaps are found to this.
FOUND = 1e-9


def geneva() -> ck.Mechanism:
    return ck.load("geneva-wheel")


def slider_crank(*more: Item, reach: Any = (2.5, 3.8), drive: Item | None = None) -> ck.Mechanism:
    """Crank 1, rod 3, the guide through the crank's pivot."""
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", A=0),
        ck.link("crank", A=0, B=1),
        ck.link("rod", B=0, C=3),
        ck.link("piston", C=0),
        ck.slide("piston", on="frame", through="A", reach=reach),
        drive or ck.drive("crank"),
        *more,
    )


def crank_at(x: float) -> float:
    """The crank angle at which the piston is at x, by the cosine rule."""
    return math.acos((1 + x * x - 9) / (2 * x))


def four_bar_on_arc(reach: Any) -> ck.Mechanism:
    """A rocker of 3 about D = (4, 0), as a slot that its end C runs in."""
    return ck.Mechanism(
        "Arc",
        ck.link("frame", A=0, D=(4, 0), E=(5.5, 1.5 * math.sqrt(3)), F=(2.5, 1.5 * math.sqrt(3))),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=4),
        ck.arc("coupler", on="frame", at="C", centre_at="D", radius=3, reach=reach),
        ck.drive("crank"),
        ck.drawn(A=0, B=(1, 0), C=(4, 2.6)),
    )


# --- the Geneva wheel of the issue ------------------------------------------------------------------------


def test_the_geneva_wheel_is_not_wrong_outside_engagement() -> None:
    motion = ck.solve(geneva(), {"crank": ck.deg(270)})
    assert not motion.assembled
    assert np.isnan(motion.links["wheel"].angle)
    (gap,) = ck.gaps(motion)
    assert (gap.pair, gap.group, gap.links) == ("slot", "", ("wheel", "crank"))
    # |A - C| with C at 100 and the crank pointing down
    assert gap.reason == f"A at {math.hypot(100, 70.71067811865476):.6g} is beyond the end of slot, E at 70.7107"


def test_the_geneva_wheel_engages_from_minus_45_to_45_degrees() -> None:
    motion = ck.solve(geneva(), {"crank": ck.deg(np.arange(0, 721, 5))})
    found = ck.gaps(motion)
    edges = [(gap.begin["crank"], gap.end["crank"]) for gap in found]
    np.testing.assert_allclose(edges, ck.deg([(45, 315), (405, 675)]), atol=FOUND)
    # both ends of the range are the same pose, and the mode is kept beyond the gaps
    np.testing.assert_allclose(motion.points["E"].position[-1], motion.points["E"].position[0], atol=1e-12)
    np.testing.assert_allclose(motion.links["wheel"].angle[[-4]], motion.links["wheel"].angle[[72 - 3]], atol=1e-12)


def test_the_geneva_wheel_is_assembled_at_the_end_itself() -> None:
    assert ck.solve(geneva(), {"crank": ck.deg([-45, 45])}).assembled.all()
    assert not ck.solve(geneva(), {"crank": ck.deg([-45.0001, 45.0001])}).assembled.any()


def test_the_geneva_wheel_has_one_circuit_between_the_ends_of_its_slot() -> None:
    found = ck.circuits(geneva())
    (branch,) = found.branches
    assert found.consistent
    np.testing.assert_allclose([branch.low, branch.high], ck.deg([-45, 45]), atol=FOUND)
    assert branch.open_ends == ("an end of slot",) * 2
    assert not found.circuits[0].closed


def test_a_configuration_beyond_an_end_is_none() -> None:
    found = ck.configurations(geneva(), {"crank": ck.deg([10, 100])})
    assert found.real.tolist() == [[True], [False]]
    with pytest.raises(ck.errors.NotAssembled, match=r"nearest value is crank = 45 degrees"):
        ck.configurations(geneva(), {"crank": ck.deg(100)})


def test_the_report_names_the_end() -> None:
    motion = ck.solve(geneva(), {"crank": ck.deg(np.arange(0, 361, 5))})
    text = " ".join(ck.report(motion).text().split())
    assert "Between crank 45 and 315°, A at 170.711 is beyond the end of slot, E at 70.7107." in text


# --- slides ----------------------------------------------------------------------------------------------


def test_a_piston_has_gaps_at_the_ends_of_its_guide() -> None:
    found = ck.gaps(ck.solve(slider_crank()))
    edges = [(gap.begin["crank"], gap.end["crank"]) for gap in found]
    near, far = crank_at(3.8), crank_at(2.5)
    expected = [(0.0, near), (far, 2 * np.pi - far), (2 * np.pi - near, 2 * np.pi)]
    np.testing.assert_allclose(edges, expected, atol=FOUND)
    assert found[0].reason.startswith("C at 3.9")
    assert "beyond the end of piston/frame, 3.8" in found[0].reason
    assert found[1].reason == "C at 2 is before the beginning of piston/frame, 2.5"


def test_a_guide_as_long_as_the_stroke_is_no_limit() -> None:
    """At both dead points the piston is at an end itself."""
    mechanism = slider_crank(reach=(2, 4))
    assert ck.solve(mechanism).assembled.all()
    assert ck.circuits(mechanism).circuits[0].closed


def test_circuits_are_cut_at_both_ends() -> None:
    found = ck.circuits(slider_crank())
    spans = sorted((branch.low, branch.high) for branch in found.branches)
    near, far = crank_at(3.8), crank_at(2.5)
    np.testing.assert_allclose(spans, [(-far, -near), (near, far)], atol=FOUND)
    assert found.consistent
    assert len(found.circuits) == 2


def test_an_open_end_is_no_end() -> None:
    found = ck.gaps(ck.solve(slider_crank(reach=(None, 3.8))))
    assert [gap.reason.split(" is ")[1] for gap in found] == ["beyond the end of piston/frame, 3.8"] * 2


@pytest.mark.parametrize("values", [np.linspace(2, 4, 21), np.array([2.4, 3.9])])
def test_a_driver_does_not_go_beyond_its_own_ends(values: np.ndarray) -> None:
    mechanism = slider_crank(drive=ck.drive("piston", values=values))
    motion = ck.solve(mechanism)
    np.testing.assert_array_equal(motion.assembled, (values > 2.5 - 1e-9) & (values < 3.8 + 1e-9))
    edges = [one for gap in ck.gaps(motion) for one in (gap.begin["piston"], gap.end["piston"])]
    if len(values) > 2:
        np.testing.assert_allclose(edges, [2, 2.5, 3.8, 4], atol=FOUND)
    low, high = ck.circuits(mechanism).branches[0].low, ck.circuits(mechanism).branches[0].high
    np.testing.assert_allclose([low, high], [2.5, 3.8], atol=FOUND)


def test_a_driver_between_moving_links_has_ends() -> None:
    crane = ck.load("hydraulic-crane")
    ram = next(pair for pair in crane.written_pairs if pair.name == "ram")
    drive = crane.drives[0]
    least, most = float(np.min(drive.values)), float(np.max(drive.values))
    stroke = (least + 0.1, most - 0.2)
    ends = ck.slide(ram.link, on=ram.on, at=ram.at, through=ram.through, name="ram", reach=stroke)  # type: ignore[attr-defined]
    found = ck.gaps(ck.solve(crane.replace(ends)))
    edges = sorted(one for gap in found for one in (gap.begin[drive.name], gap.end[drive.name]))
    np.testing.assert_allclose(edges, [least, stroke[0], stroke[1], most], atol=FOUND)
    assert {gap.pair for gap in found} == {"ram"}


def test_designs_have_ends_of_their_own() -> None:
    reach = (2.0, np.array([[3.8], [4.0], [3.5]]))
    motion = ck.solve(slider_crank(reach=reach))
    assert motion.assembled.shape == (3, 73)
    for row, end in zip(motion.assembled, (3.8, 4.0, 3.5), strict=True):
        np.testing.assert_array_equal(row, ck.solve(slider_crank(reach=(2.0, end))).assembled)


def test_a_redundant_slide_has_ends() -> None:
    """A second guide of the piston holds what the first one holds: it is left out, but its ends stay."""
    mechanism = slider_crank(reach=None).replace(
        ck.link("frame", A=0, F=(0, 1)),
        ck.link("piston", C=0, D=(0, 1)),
        ck.slide("piston", on="frame", at="D", through="F", reach=(None, 3.8), name="upper"),
        ck.slide("piston", on="frame", at="C", through="A", turn=0.0, name="piston/frame"),
    )
    mechanism = mechanism.replace(title="Held twice")
    motion = ck.solve(mechanism)
    assert motion.structure.relaxation
    edges = [one for gap in ck.gaps(motion) for one in (gap.begin["crank"], gap.end["crank"])]
    near = crank_at(3.8)
    np.testing.assert_allclose(edges, [0, near, 2 * np.pi - near, 2 * np.pi], atol=FOUND)


# --- arcs ------------------------------------------------------------------------------------------------


def test_an_arc_is_cut_where_its_angle_says() -> None:
    motion = ck.solve(four_bar_on_arc((ck.deg(60), ck.deg(120))))
    free = ck.solve(four_bar_on_arc(None))
    angle = free.pairs["coupler/frame"].value
    np.testing.assert_array_equal(motion.assembled, (angle > ck.deg(60) - 1e-9) & (angle < ck.deg(120) + 1e-9))
    (gap,) = ck.gaps(motion)
    for crank, limit in ((gap.begin["crank"], 120), (gap.end["crank"], 120)):
        # the coupler just reaches the end of the arc from the crank's pin
        end = 4 + 3 * np.exp(1j * np.deg2rad(limit))
        assert abs(abs(end - np.exp(1j * crank)) - 4) < 1e-8
    assert "degrees is beyond the end of coupler/frame, 120 degrees" in gap.reason


def test_points_are_ends_as_well() -> None:
    by_angle = ck.solve(four_bar_on_arc((ck.deg(60), ck.deg(120))))
    by_point = ck.solve(four_bar_on_arc(("E", "F")))
    np.testing.assert_array_equal(by_angle.assembled, by_point.assembled)
    assert ck.gaps(by_point)[0].reason.endswith("coupler/frame, F at 120 degrees")


def test_an_arc_may_pass_half_a_turn() -> None:
    """From 150 degrees counterclockwise to -150: an arc of 60 degrees behind its centre."""
    m = ck.Mechanism(
        "Round",
        ck.link("frame", A=0),
        ck.link("arm", A=0),
        ck.link("crosshead", B=0),
        ck.arc("crosshead", on="frame", at="B", centre_at="A", radius=2, reach=(ck.deg(150), ck.deg(210))),
        ck.slide("crosshead", on="arm", at="B", through="A"),
        ck.drive("arm"),
    )
    motion = ck.solve(m, {"arm": ck.deg(np.arange(0, 361, 15))})
    assert np.flatnonzero(motion.assembled).tolist() == [10, 11, 12, 13, 14]


# --- what is written -------------------------------------------------------------------------------------


@pytest.mark.parametrize("reach", [(2.5, 3.8), (None, 3.8), (2.5, None), ("A", 3.8), (2, np.array([3.0, 3.5]))])
def test_ends_are_written_and_read(reach: Any) -> None:
    mechanism = slider_crank(reach=reach)
    assert loads(dumps(mechanism)) == mechanism
    assert loads(dumps(mechanism, "json"), "json") == mechanism


@pytest.mark.parametrize("reach", [(ck.deg(60), ck.deg(120)), ("E", "F"), (1.0, "F")])
def test_ends_of_arcs_are_written_in_degrees(reach: Any) -> None:
    mechanism = four_bar_on_arc(reach)
    assert loads(dumps(mechanism)) == mechanism
    if reach[1] == ck.deg(120):
        assert "reach = [60, 120]" in dumps(mechanism)


def test_the_schema_knows_ends() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    import tomllib

    checker = jsonschema.Draft202012Validator(schema())
    for mechanism in (slider_crank(reach=(None, 3.8)), slider_crank(reach=("A", 3.8)), four_bar_on_arc(("E", 2.0))):
        assert not list(checker.iter_errors(tomllib.loads(dumps(mechanism))))
    assert {key.name for key in doc.table_forms()[1].keys if key.kind == "reach"} == {"reach"}


WRONG = [
    ((3.8, 2.5), "must end after it begins"),
    ((2.5, 2.5), "must end after it begins"),
    ((math.nan, 3.8), "nan is empty or not finite"),
    ((2.5, math.inf), "inf is empty or not finite"),
    ((2.5, 3j), "not a number"),
    ((None, None), "both ends are open"),
    (3.8, "3.8 is not two ends"),
    ((1, 2, 3), "is not two ends"),
    ("AB", "'AB' is not two ends"),
    ((2.5, "Q"), "link 'frame' has no point 'Q'"),
    (("A", "A"), "from 'A' to itself has no length"),
    (("A", -1.0), "from 'A' at 0 to -1"),
    ((2.5, "3.8 m"), "has no point '3.8 m'"),
]


@pytest.mark.parametrize(("reach", "what"), WRONG)
def test_a_wrong_reach_is_named(reach: Any, what: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"slides\[0\]\.reach") as error:
        slider_crank(reach=reach)
    assert what in str(error.value)


@pytest.mark.parametrize(
    ("reach", "what"),
    [
        ((0.1, None), "an arc needs both of its ends"),
        ((60, 120), "radians in Python"),
        ((2, 2), "must end after it begins"),
    ],
)
def test_a_wrong_reach_of_an_arc_is_named(reach: Any, what: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"arcs\[0\]\.reach") as error:
        four_bar_on_arc(reach)
    assert what in str(error.value)


@pytest.mark.parametrize("text", ["1.3", '["A"]', "[1, 2, 3]", "{ until = 3 }", "{}", "[true, 2]", '"0..1"'])
def test_a_wrong_reach_in_a_file_is_named(text: str) -> None:
    written = dumps(slider_crank()).replace("reach = [2.5, 3.8]", f"reach = {text}")
    with pytest.raises(ck.errors.InvalidMechanism, match=r"slides\[0\]\.reach"):
        loads(written)


def test_a_drawing_beyond_an_end_is_warned_about() -> None:
    items = [item for item in geneva().items if not isinstance(item, Drawn) and getattr(item, "name", "") != "crank"]
    a = 70.71067811865476 * np.exp(1j)
    crank, drawn = ck.link("crank", "O", "A"), ck.drawn(O=0, A=a)
    with pytest.warns(ck.errors.DrawnBeyondEnd, match=rf"as it is drawn, A at {abs(a - 100):.6g} is beyond the end of"):
        ck.solve(ck.Mechanism("Drawn", *items, crank, ck.drive("crank"), drawn))


def test_a_drawing_inside_is_not_warned_about() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ck.solve(geneva())


# --- pictures --------------------------------------------------------------------------------------------


def test_stops_are_drawn() -> None:
    """Two bars more than in the picture without ends; a piston that has ends is a block between them too."""

    def bars(reach: Any, name: str = "slider") -> int:
        mechanism = ck.Mechanism(
            "Slider-crank",
            ck.link("frame", A=0),
            ck.link("crank", A=0, B=1),
            ck.link("rod", B=0, C=3),
            ck.link(name, C=0),
            ck.slide(name, on="frame", through="A", reach=reach),
            ck.drive("crank"),
        )
        return sum(isinstance(shape, Polyline) for shape in leaves(ck.draw(mechanism, at={"crank": 1.0}).shapes))

    assert bars((1.9, 4.1)) == bars(None) + 2
    assert bars((None, 4.1)) == bars(None) + 1
    assert bars((1.9, 4.1), "piston") == bars((1.9, 4.1))


def test_an_arc_goes_counterclockwise_through_zero() -> None:
    """From 200 to 90 degrees is what 90 to 200 degrees leaves out."""

    def assembled(first: float, second: float) -> np.ndarray:
        on_arc = ck.Mechanism(
            "Rod on an arc",
            ck.link("frame", A=0, M=4),
            ck.link("crank", A=0, B=1),
            ck.link("rod", B=0, C=3),
            ck.arc("rod", on="frame", at="C", centre_at="M", radius=2, reach=(ck.deg(first), ck.deg(second))),
            ck.drive("crank"),
        )
        return np.asarray(ck.solve(on_arc).assembled)

    with warnings.catch_warnings(action="ignore", category=ck.errors.UnassembledPoses):
        assert np.array_equal(assembled(200, 90), ~assembled(90, 200))
        assert np.array_equal(assembled(200, 90), assembled(200, 450))
    with pytest.raises(ck.errors.InvalidMechanism, match="no length"):
        assembled(10, 10)
