"""The section Performance of reports, the same from text to JSON."""

from __future__ import annotations

import compoundkin as ck
from compoundkin.view.report import report
from compoundkin.view.report.report_data import Alert, Paragraph, TableBlock
from tests import catalog


def test_it_tells_strokes_dead_points_and_types() -> None:
    section = catalog.report_of("crank-shaper").section("performance")
    assert section is not None
    strokes, dead, ranges, loops = (block for block in section.blocks if isinstance(block, TableBlock))
    assert [row[0] for row in strokes.rows] == ["ram.value", "lever.angle"]
    assert len(dead.rows) == 4
    assert {"rod.transmission_angle", "slot.coriolis.length", "ram.velocity_ratio"} <= {row[0] for row in ranges.rows}
    assert loops.rows[0][1] == "inverted slider-crank, oscillating guide"


def test_poor_transmission_is_warned_of_only_for_outputs_that_somebody_named() -> None:
    motion = catalog.motion("four-bar-norton")
    assert any(isinstance(block, Alert) for block in report(motion).section("performance").blocks)  # type: ignore[union-attr]
    unnamed = ck.Mechanism("m", *(ck.link(one.name, **motion.mechanism.geometry.points[one.name])
                                  for one in motion.mechanism.links.values()), ck.drive("crank"))  # fmt: skip
    section = report(ck.solve(unnamed, {"crank": motion.drives["crank"].value})).section("performance")
    assert section is not None
    assert not any(isinstance(block, Alert) for block in section.blocks)


def test_straight_lines_and_dwells_are_told_in_words() -> None:
    texts = {name: " ".join(b.text for b in catalog.report_of(name).section("performance").blocks  # type: ignore[union-attr]
                            if isinstance(b, Paragraph)) for name in ("hoecken-straight-line", "watt-ii")}  # fmt: skip
    assert "P describes a closed curve" in texts["hoecken-straight-line"]
    assert "straight within" in texts["hoecken-straight-line"]
    assert "FG.angle dwells at" in texts["watt-ii"]


def test_every_number_of_the_section_is_one_and_what_does_not_change_is_so_always() -> None:
    """Where derivatives of a parallelogram are known less well, and where paths are straight."""
    for name in ("pantograph", "parallelogram", "geneva-wheel"):
        section = catalog.report_of(name).section("performance")
        assert section is not None
        text = " ".join(block.text for block in section.blocks if isinstance(block, Paragraph))
        assert "nan" not in text
        assert "inf " not in text
        rows = {row[0]: row for block in section.blocks if isinstance(block, TableBlock) for row in block.rows}
        if name == "parallelogram":
            assert rows["P.acceleration.length"][3] == rows["follower.velocity_ratio"][5] == "always"
        if name == "geneva-wheel":
            assert rows["|wheel.advantage|"][4] == "no limit"
