from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.report import Report, report
from compoundkin.view.report.report_data import Alert, FormulaBlock, Paragraph, StepBlock, TableBlock
from compoundkin.view.report.structure_sections import equation_count
from tests import catalog
from tests.view.report.support import four_bar


def table(made: Report, key: str, index: int = 0) -> TableBlock:
    section = made.section(key)
    assert section is not None
    return [block for block in section.blocks if isinstance(block, TableBlock)][index]


def column(found: TableBlock, name: str) -> list[object]:
    k = [c.name for c in found.columns].index(name)
    return [row[k] for row in found.rows]


def texts(made: Report, key: str) -> str:
    section = made.section(key)
    assert section is not None
    return "\n".join(b.text for b in section.blocks if isinstance(b, Paragraph | FormulaBlock | Alert))


# --- structure ------------------------------------------------------------------------------------------


def test_the_structure_of_the_six_bar(six_bar: ck.results.Motion) -> None:
    made = report(six_bar.structure)
    links = table(made, "links")
    assert column(links, "link") == ["frame", "crank", "plate", "rocker", "bar", "block"]
    assert column(links, "kind") == ["ternary", "binary", "ternary", "binary", "binary", "binary"]
    pairs = table(made, "pairs")
    assert column(pairs, "driven by") == ["crank", "", "", "", "", "", ""]
    assert column(pairs, "joins")[-1] == "bar - block"
    assert "= 3 (6 - 1) - 2 * 7 = 1" in texts(made, "mobility")
    assert "L = p - n + 1 = 7 - 6 + 1 = 2" in texts(made, "loops")
    assert "unknowns:  5 link angles + 1 displacement = 6" in texts(made, "loops")
    assert "equations: 4 for loops (x and y) + 1 auxiliary + 1 for drivers = 6" in texts(made, "loops")
    assert made.section("outputs") is None
    assert made.outcome.solvable


def test_each_group_says_what_it_uses_and_yields(six_bar: ck.results.Motion) -> None:
    section = report(six_bar).section("groups")
    assert section is not None
    steps = [block for block in section.blocks if isinstance(block, StepBlock)]
    assert [step.title for step in steps] == [
        "0  The frame and its driven links", "1  RRR dyad: plate and rocker", "2  RPR dyad: bar and block",
    ]  # fmt: skip
    facts = [dict(step.facts) for step in steps]
    assert facts[0]["yields"] == "frame, crank; points E, B, F, D"
    assert facts[1]["uses"] == "D on crank; B on frame"
    assert facts[1]["yields"] == "plate, rocker; points A, C"
    assert facts[1]["mode"].startswith("+1, nearest to the drawing (outer pin, inner pin")
    assert facts[2]["uses"] == "F on frame; C on plate"
    assert facts[2]["yields"] == "bar, block; point G"


@catalog.each(catalog.CHOSEN)
def test_equations_equal_unknowns_where_the_drivers_determine_the_motion(name: str) -> None:
    structure = catalog.structure(name)
    count, mobility = equation_count(structure), structure.mobility
    # as many too many as there are redundant ones, where it moves although it is overconstrained
    redundant = mobility.drivers - mobility.freedoms if ck.decompose(load(name)).relaxation else 0
    assert count.equations == count.unknowns + redundant


def test_equations_differ_from_unknowns_as_mobility_does_from_drivers() -> None:
    for drives in ((), (ck.drive("crank"), ck.drive("rocker"))):
        structure = ck.decompose(four_bar(4.0, *drives))
        count = equation_count(structure)
        assert count.unknowns - count.equations == structure.mobility.freedoms - structure.mobility.drivers


def test_a_mode_by_sign_and_by_default_says_so() -> None:
    by_sign = (ck.mode(1, "rocker"),), "+1, chosen by sign ("
    for items, told in (((), "-1, taken by default (the other one; "), by_sign):
        section = report(ck.solve(four_bar(4.0, ck.drive("crank"), *items))).section("groups")
        assert section is not None
        assert dict(section.blocks[-1].facts)["mode"].startswith(told)  # type: ignore[union-attr]


def test_a_multiple_pin_is_said_to_be_one() -> None:
    made = report(catalog.structure("pantograph"))
    assert "C joins AC, DC and tracer: a multiple pin of 3 links, counted as 2 pairs." in texts(made, "pairs")


def test_a_structure_that_cannot_be_solved_is_reported_with_remedies() -> None:
    made = report(ck.decompose(four_bar()))
    assert not made.outcome.solvable
    faults = made.section("faults")
    assert faults is not None
    alert = next(block for block in faults.blocks if isinstance(block, Alert))
    assert "left with 1 freedom" in alert.text
    assert "add a driver on one of: crank on frame (pin A)" in alert.remedy
    assert "There is 1 equation too few" in texts(made, "loops")
    assert made.section("links") is not None
    assert "There is no driver." in texts(made, "drivers")


def test_a_structure_held_by_too_much_keeps_its_good_part() -> None:
    made = report(ck.decompose(four_bar(4.0, ck.drive("crank"), ck.drive("rocker"))))
    assert "too many" in texts(made, "faults")
    assert "There is 1 equation too many" in texts(made, "loops")


# --- motion ---------------------------------------------------------------------------------------------


def test_the_outputs_are_the_motion_in_degrees_every_third_pose(six_bar: ck.results.Motion) -> None:
    found = table(report(six_bar), "outputs")
    assert len(found.rows) == 25
    poses = slice(None, None, 3)
    np.testing.assert_allclose(column(found, "crank"), np.arange(0, 361, 15), atol=1e-12)
    np.testing.assert_array_equal(column(found, "G.velocity.x"), six_bar.points["G"].velocity[poses].real)
    np.testing.assert_array_equal(column(found, "G.velocity.y"), six_bar.points["G"].velocity[poses].imag)
    np.testing.assert_allclose(column(found, "bar.angle"), np.rad2deg(six_bar.links["bar"].angle[poses]), rtol=1e-15)
    units = {c.name: c.unit for c in found.columns}
    assert (units["crank"], units["G.velocity.x"], units["bar.angle"]) == ("deg", "mm/s", "deg")


def test_the_last_pose_is_in_the_table_whatever_the_step(six_bar: ck.results.Motion) -> None:
    motion = ck.solve(six_bar.mechanism, {"crank": ck.deg(range(50))})
    rows = column(table(report(motion), "outputs"), "crank")
    assert rows[-1] == pytest.approx(49.0)
    assert len(rows) <= 26
    assert "Every 3rd of 50 poses" in texts(report(motion), "outputs")


def test_extremes_are_those_between_the_poses_too(six_bar: ck.results.Motion) -> None:
    """G stands still where its bar turns back, twice: the first place is told. A fine motion comes near to it."""
    found = table(report(six_bar), "outputs", 1)
    rows = {row[0]: row for row in found.rows}
    fine = ck.solve(six_bar.mechanism, {"crank": ck.deg(np.arange(0.0, 360.0, 0.02))})
    speed = np.abs(fine.points["G"].velocity)
    still = np.flatnonzero(speed < 1e-3 * speed.max())
    first = still[: np.flatnonzero(np.diff(still) > 1)[0] + 1]
    assert rows["|G.velocity|"][2:] == (
        0.0, pytest.approx(0.02 * first[speed[first].argmin()], abs=0.02), pytest.approx(speed.max(), rel=1e-7),
        pytest.approx(0.02 * speed.argmax(), abs=0.02),
    )  # fmt: skip
    angle = np.rad2deg(fine.links["bar"].angle)
    assert rows["bar.angle"][4] == pytest.approx(angle.max(), rel=1e-8)


def test_extremes_of_several_pieces_are_told_of_each() -> None:
    """The rate grows without limit towards a limit position: there it has no greatest value."""
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(catalog.mechanism("triple-rocker"), {"driver": ck.deg(np.arange(-200.0, 400.0, 5.0))})
    found = table(report(motion, ["rocker.angular_velocity"]), "outputs", 1)
    assert [c.name for c in found.columns][2] == "between"
    assert [row[2] for row in found.rows] == ["-88.9768 and 88.9768", "271.023 and 395"]
    assert found.rows[0][3] == found.rows[0][5] == "without limit"


def test_an_output_that_does_not_change_has_no_extremes() -> None:
    made = report(catalog.motion("oldham-coupling"), ["output.angular_velocity"])
    assert table(made, "outputs", 1).rows[0][2:] == (pytest.approx(5.0), "always", pytest.approx(5.0), "always")


def test_outputs_may_be_named(six_bar: ck.results.Motion) -> None:
    found = table(report(six_bar, ["A.speed", "slot"]), "outputs")
    assert [c.name for c in found.columns] == ["crank", "A.speed", "slot"]
    with pytest.raises(ck.errors.UnknownName, match=r"A\.speed"):
        report(six_bar, ["A.sped"])


def test_without_named_outputs_tracers_and_links_are_shown() -> None:
    found = table(report(ck.solve(four_bar(4.0, ck.drive("crank")))), "outputs")
    assert [c.name for c in found.columns] == ["crank", "P.position.x", "P.position.y", "coupler.angle", "rocker.angle"]


def test_outputs_beyond_the_order_are_left_out(six_bar: ck.results.Motion) -> None:
    found = table(report(ck.solve(six_bar.mechanism, order=0)), "outputs")
    assert [c.name for c in found.columns] == ["crank", "G.position.x", "G.position.y", "bar.angle"]


def test_several_drivers_number_the_poses() -> None:
    motion = catalog.motion("excavator-arm")
    found = table(report(motion), "outputs")
    assert [c.name for c in found.columns][:4] == ["pose", "boom-cylinder", "stick-cylinder", "bucket-cylinder"]
    np.testing.assert_array_equal(column(found, "pose"), np.arange(21))
    np.testing.assert_array_equal(column(found, "boom-cylinder"), motion.drives["boom-cylinder"].value)


def test_a_driver_held_still_is_said_and_no_column() -> None:
    values = {"boom-cylinder": 2.65, "stick-cylinder": np.linspace(2.6, 3.3, 8), "bucket-cylinder": 2.0}
    made = report(ck.solve(load("excavator-arm"), values))
    assert "boom-cylinder = 2.65 m and bucket-cylinder = 2 m" in texts(made, "outputs")
    assert table(made, "outputs").columns[0].name == "stick-cylinder"


def test_a_single_pose(six_bar: ck.results.Motion) -> None:
    made = report(ck.solve(six_bar.mechanism, {"crank": ck.deg(35)}))
    assert len(table(made, "outputs").rows) == 1
    assert "The pose is assembled" in texts(made, "about")
    assert made.outcome.poses == 1


def test_what_cannot_be_assembled_is_explained(broken: ck.results.Motion) -> None:
    made = report(broken)
    assert (made.outcome.poses, made.outcome.assembled) == (73, 24)
    assert made.outcome.passed
    told = texts(made, "gaps")
    assert "49 of 73 poses cannot be assembled." in told
    assert "Between crank 56.1036448 and 303.896355°, the RRR group of coupler and rocker does not close" in told
    assert "> |BC| + |CD| = 3 + 3" in told
    # law of cosines: |BD| = 6 at the interval's ends
    assert np.rad2deg(np.arccos((1 + 6.5**2 - 36) / (2 * 6.5))) == pytest.approx(56.1036448, abs=1e-7)
    rocker = column(table(made, "outputs"), "rocker.angle")
    assert [value is None for value in rocker] == [not ok for ok in broken.assembled[::3]]


def test_a_motion_with_no_assembled_pose_fails_no_check_but_has_none(broken: ck.results.Motion) -> None:
    with pytest.warns(ck.errors.UnassembledPoses):
        made = report(ck.solve(broken.mechanism, {"crank": ck.deg([170, 180])}))
    assert (made.outcome.assembled, made.outcome.passed) == (0, False)
    assert "0 of 2 poses assembled; nothing could be checked." in texts(made, "about")
    assert "nothing to check" in texts(made, "checks")
    assert "In the whole motion, crank 170 to 180°" in texts(made, "gaps")


@pytest.mark.parametrize(
    ("degrees", "told"),
    [
        ([0, 30, 60, 90], "From crank 56.1036448° to the end, 90°"),
        ([90, 60, 30, 0], "From the start, crank 90°, to 56.1036448°"),
    ],
)
def test_a_gap_that_reaches_an_end_of_the_motion(broken: ck.results.Motion, degrees: list[float], told: str) -> None:
    with pytest.warns(ck.errors.UnassembledPoses):
        made = report(ck.solve(broken.mechanism, {"crank": ck.deg(degrees)}))
    assert told in texts(made, "gaps")


def test_designs_are_reported_one_at_a_time(sweep: ck.results.Motion) -> None:
    first, second = report(sweep), report(sweep, design=1)
    assert "Shown is design 0 of 2" in texts(first, "about")
    assert first.section("gaps") is None
    assert second.section("gaps") is not None
    counts = [(made.outcome.poses, made.outcome.assembled) for made in (first, second)]
    assert counts == [(73, int(np.count_nonzero(row))) for row in sweep.assembled]
    assert column(table(first, "links"), "points, in the link's own frame")[0] == "A (0, 0)  D (4, 0)"
    assert column(table(second, "links"), "points, in the link's own frame")[0] == "A (0, 0)  D (6.5, 0)"
    np.testing.assert_allclose(
        column(table(second, "outputs"), "rocker.angle")[:3], np.rad2deg(sweep.links["rocker"].angle[1, [0, 3, 6]])
    )
    for design in (-1, 2):
        with pytest.raises(ck.errors.InvalidInput, match="0 to 1"):
            report(sweep, design=design)


def test_the_driver_range_is_that_of_the_motion(six_bar: ck.results.Motion) -> None:
    motion = ck.solve(six_bar.mechanism, {"crank": ck.deg([10, 20, 40])}, speed=3.0, acceleration=-2.0)
    row = table(report(motion), "drivers").rows[0]
    assert row[:2] == ("crank", "crank on frame, E")
    assert row[2:] == (pytest.approx(10.0), pytest.approx(40.0), 3, 3.0, pytest.approx(90 / np.pi), -2.0)


def test_slides_and_pins_driven_have_tables_of_their_own() -> None:
    made = report(catalog.structure("hydraulic-crane"))
    assert table(made, "drivers").columns[2].unit == "m"
    assert table(made, "drivers").columns[5].unit == "m/s"


# --- published numbers ----------------------------------------------------------------------------------


def test_the_published_numbers_of_the_six_bar(six_bar: ck.results.Motion) -> None:
    made = report(six_bar)
    found = table(made, "published")
    assert len(found.rows) == made.outcome.published == len(six_bar.mechanism.expectations)
    assert all(column(found, ""))
    assert len(found.selected_rows) == len({e.quantity for e in six_bar.mechanism.expectations})


def test_a_wrong_published_number_fails_and_is_shown(six_bar: ck.results.Motion) -> None:
    wrong = six_bar.mechanism.replace(ck.expect("A.jerk", (1, 2), 1e-6, crank=ck.deg(20.0)))
    made = report(ck.solve(wrong))
    assert not made.outcome.passed
    assert made.outcome.published - made.outcome.published_passed == 1
    assert "1 of 56 published numbers NOT reproduced" in texts(made, "about")
    row = table(made, "published").selected_rows[-1]
    assert (row[0], row[-1]) == ("A.jerk", False)
    assert row[1] == (pytest.approx(20.0),)


def test_published_angles_count_regardless_of_turns() -> None:
    angle = float(ck.solve(four_bar(4.0, ck.drive("crank")), {"crank": 0.5}).links["rocker"].angle)
    for turns in (-1, 0, 2):
        expected = ck.expect("rocker.angle", angle + turns * 2 * np.pi, 1e-9, crank=0.5)
        made = report(ck.solve(four_bar(4.0, ck.drive("crank"), expected)))
        assert made.outcome.passed
        assert table(made, "published").rows[0][2] == pytest.approx(np.rad2deg(angle) + 360.0 * turns)


def test_published_at_given_rates() -> None:
    crank = ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank", speed=1.0)
    at = {"crank": 0.0, "crank.speed": 3.0, "crank.acceleration": 5.0}
    expected = ck.expect("B.velocity", 6j, 1e-12, **at), ck.expect("B.acceleration", -18 + 10j, 1e-12, **at)
    made = report(ck.solve(ck.Mechanism("m", *crank, *expected)))
    assert made.outcome.passed
    assert table(made, "published").columns[1].name == "at crank, crank.speed, crank.acceleration"
    assert table(made, "published").rows[0][1] == (0.0, 3.0, 5.0)


def test_a_published_number_where_nothing_assembles_fails(broken: ck.results.Motion) -> None:
    expected = ck.expect("rocker.angle", 1.0, 10.0, crank=np.pi)
    made = report(ck.solve(four_bar(6.5, ck.drive("crank"), expected), {"crank": 0.0}))
    assert not made.outcome.passed
    shown = pytest.approx(np.rad2deg(1.0)), pytest.approx(np.rad2deg(10.0))
    assert table(made, "published").rows[0][2:] == (None, shown[0], None, shown[1], False)


def test_an_unknown_published_quantity_is_named_with_its_place() -> None:
    expected = ck.expect("rocker.angle", 1.0, 1.0), ck.expect("rocker.angel", 1.0, 1.0)
    with pytest.raises(ck.errors.UnknownName, match=r"expected\[1\]\.quantity: .* did you mean 'rocker.angle'"):
        report(ck.solve(four_bar(4.0, ck.drive("crank"), *expected)))


# --- what is many -----------------------------------------------------------------------------------------


def test_a_mechanism_in_two_pieces_says_so() -> None:
    loose = [ck.link(f"bar-{k}", **{a: 0.0, b: 1.0}) for k, (a, b) in enumerate(("XY", "YZ", "ZX"))]
    made = report(ck.decompose(four_bar(4.0, *loose, ck.drive("crank"))))
    assert "The links fall into separate pieces, so that there are 2 loops." in texts(made, "loops")
    assert not made.outcome.solvable


def test_of_many_loops_only_the_first_are_listed() -> None:
    couplers = [ck.link(f"coupler-{k}", **{f"B{k}": 0.0, f"B{k + 1}": 5.0}) for k in range(25)]
    rockers = [ck.link(f"rocker-{k}", **{f"D{k}": 0.0, f"B{k + 1}": 3.0}) for k in range(25)]
    frame = ck.link("frame", A=0.0, **{f"D{k}": 4.0 + k for k in range(25)})
    crank = ck.link("crank", A=0.0, B0=1.0), ck.drive("crank")
    made = report(ck.decompose(ck.Mechanism("Chain", frame, *crank, *couplers, *rockers)))
    assert len(table(made, "loops").rows) == 20
    assert "... and 5 more." in texts(made, "loops")


def test_of_many_gaps_only_the_first_are_listed(broken: ck.results.Motion) -> None:
    turns = ck.deg(np.arange(0.0, 360.0 * 12, 15.0))
    with pytest.warns(ck.errors.UnassembledPoses):
        made = report(ck.solve(broken.mechanism, {"crank": turns}))
    assert "... and 2 gaps more." in texts(made, "gaps")
    section = made.section("gaps")
    assert section is not None
    assert sum(isinstance(block, Alert) for block in section.blocks) == 10


def test_change_points_are_counted() -> None:
    section = report(catalog.motion("parallelogram")).section("groups")
    assert section is not None
    assert "it changes at 3 change points" in dict(section.blocks[-1].facts)["mode"]  # type: ignore[union-attr]


def test_limit_poses_are_said_to_be_checked_in_position_only() -> None:
    with_limit = ck.solve(four_bar(6.0, ck.drive("crank")), {"crank": ck.deg([0.0, 10.0])})
    stretched = ck.Mechanism(
        "Stretched",
        ck.link("frame", A=(0, 0), D=(7, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank"),
    )
    assert "limit pose" not in texts(report(with_limit), "checks")
    made = report(ck.solve(stretched, {"crank": 0.0}))
    assert "At 1 limit pose there are no rates, and only the position is checked." in texts(made, "checks")


def test_a_published_number_of_a_group_that_has_no_pose_fails() -> None:
    mechanism = load("class-iii-six-bar")
    far = mechanism.replace(ck.link("crank", O=(0, 0), A3=(200, 0)), ck.expect("plate.angle", 1.0, 1.0, crank=0.0))
    with pytest.raises(ck.errors.NotAssembled):
        ck.solve(far)
    from compoundkin.view.report.verification_sections import comparisons

    found = comparisons(ck.decompose(far))
    assert found
    assert not any(one.passed for one in found)


# --- what is reported -----------------------------------------------------------------------------------


def test_a_mechanism_is_reported_as_its_motion_or_as_its_structure() -> None:
    mechanism = load("crank-rocker")
    assert report(mechanism).text() == report(ck.solve(mechanism)).text()
    undriven = four_bar()
    assert report(undriven).json() == report(ck.decompose(undriven)).json()
    press = ck.slide("block", on="frame", through="O", turn=0.0)
    without_range = ck.Mechanism("Press", ck.link("frame", O=0), ck.link("block", P=0), press, ck.drive("block"))
    assert report(without_range).section("outputs") is None
    with pytest.raises(ck.errors.InvalidInput, match="is no mechanism or structure or motion"):
        report("six-bar")


def test_a_report_is_the_same_whatever_it_is_about_for_its_page() -> None:
    made = report(ck.solve(load("crank-rocker")))
    assert made == Report(made.title, made.sections, made.outcome)
    assert repr(made).startswith("Report('")
