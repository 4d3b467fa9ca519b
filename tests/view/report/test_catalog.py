"""What holds for the report of every shipped mechanism; all asked of a report at once, for it takes long to make."""

from __future__ import annotations

import pytest

import compoundkin as ck
from compoundkin.structure import without_leads
from compoundkin.synthesis.chains import structure_name
from compoundkin.view.report import Report
from compoundkin.view.report.report_data import StepBlock
from tests import catalog
from tests.view.report.support import assert_fits, assert_well_formed, parsed


@pytest.mark.full
@catalog.each(sorted({*catalog.NAMES} - {*catalog.THIRD}))
def test_the_checks_of_a_motion(name: str) -> None:
    """Of those of which no whole report is made."""
    assert ck.verify(catalog.motion(name)).passed


@catalog.each(catalog.THIRD)
def test_the_report_of_a_motion(name: str) -> None:
    made = catalog.report_of(name)
    assert made.outcome.passed
    assert made.outcome.assembled == made.outcome.poses
    assert made.outcome.checks > 0
    assert_is_rendered(made)
    section = made.section("performance")
    assert section is not None
    assert section.blocks
    if name in catalog.THIRD[::4]:
        assert max(len(line) for line in made.text(100).splitlines()) <= 100


# every other one: the report of a motion has all sections of the structure's
@catalog.each(catalog.THIRD[::2])
def test_the_report_of_a_structure(name: str) -> None:
    made = catalog.structure_report(name)
    assert_is_rendered(made)
    if name in catalog.THIRD[2::4]:
        assert max(len(line) for line in made.text(100).splitlines()) <= 100
    assert sorted(points_yielded(made)) == sorted(catalog.mechanism(name).carriers)
    step = made.section("chain").blocks[0]  # type: ignore[union-attr]
    itself = without_leads(catalog.structure(name))
    assert step.title == structure_name(itself).title
    assert all(drive.link in dict(step.facts)["driven at"] for drive in itself.mechanism.drives)


def assert_is_rendered(made: Report) -> None:
    """As text, as Markdown and as JSON."""
    assert_fits(made)
    assert_well_formed(made)
    assert list(parsed(made)["sections"]) == [section.key for section in made.sections]


def points_yielded(made: Report) -> list[str]:
    """The points that its groups yield, one after another."""
    section = made.section("groups")
    assert section is not None
    facts = [dict(block.facts)["yields"] for block in section.blocks if isinstance(block, StepBlock)]
    return [p for fact in facts if ";" in fact for p in fact.partition("; ")[2].split(" ", 1)[1].split(", ")]
