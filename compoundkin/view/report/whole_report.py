"""`report` and `page`: everything there is to say about a mechanism, a structure or a motion."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, UnassembledPoses
from compoundkin.kinematics import Motion, solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose
from compoundkin.view.report.groups_section import drivers_section, solving_section
from compoundkin.view.report.report_data import Outcome
from compoundkin.view.report.report_forms import Report, Subject
from compoundkin.view.report.structure_sections import (
    about_section,
    counted_sections,
    faults_section,
    structure_in_short,
)

if TYPE_CHECKING:
    from compoundkin.view.page import Page


@checked
def report(what: Mechanism | Structure | Motion, outputs: Sequence[str] = (), design: int = 0) -> Report:
    """Report a motion, a structure before it is solved, or a mechanism.

    A mechanism is solved over its drivers' own ranges first; of one that has none, or that is not determined, its
    structure is reported, faults included. `outputs` are quantities such as "G.velocity"; without any, those that the
    mechanism names. Of a motion with several designs one is reported, by its index in the order of the motion's axes
    before the last; the checks cover all.

    Raises UnknownName for an output the mechanism does not have, InvalidInput for a design it does not have.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.structure import decompose
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> [section.key for section in report(decompose(crank)).sections]
    ['about', 'links', 'pairs', 'mobility', 'chain', 'loops', 'groups', 'drivers']
    >>> print(report(crank).text().splitlines()[0])
    Crank
    """
    subject = _solved(what) if isinstance(what, Mechanism) else what
    if isinstance(subject, Structure):
        return _of_structure(subject)
    # what a motion takes is not loaded for the report of a structure
    from compoundkin.view.report.motion_report import report_of_motion

    return report_of_motion(subject, outputs, design)


@checked
def page(what: Mechanism | Structure | Motion, outputs: Sequence[str] = (), design: int = 0) -> Page:
    """Return the report as a page with the moving sketch. The arguments are those of `report`.

    Raises UnknownName for an output the mechanism does not have, InvalidInput for a design it does not have.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> page(crank).html.splitlines()[0]
    '<!DOCTYPE html>'
    """
    return report(what, outputs, design).page()


def _solved(mechanism: Mechanism) -> Subject:
    """The motion over the drivers' own ranges; the structure of what has faults or no ranges."""
    structure = decompose(mechanism)
    if structure.faults:
        return structure
    with warnings.catch_warnings():
        # the report says what cannot be assembled
        warnings.simplefilter("ignore", UnassembledPoses)
        try:
            return solve(structure)
        except InvalidInput:
            return structure


def _of_structure(structure: Structure) -> Report:
    """Report a structure before it is solved, one with faults included."""
    outcome = Outcome(not structure.faults, 0, 0, 0, 0, 0, 0)
    about = about_section(structure, structure_in_short(structure))
    faults = [faults_section(structure)] if structure.faults else []
    solving = solving_section(structure, None), drivers_section(structure, None)
    sections = about, *counted_sections(structure), *faults, *solving
    return Report(structure.mechanism.title, sections, outcome, structure)
