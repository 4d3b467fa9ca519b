"""`report` and `page`: everything there is to say of a mechanism, a motion, a study, a tolerance analysis."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from math import prod
from typing import TYPE_CHECKING, TypeAlias

from compoundkin.base.arguments import check_design, checked
from compoundkin.base.errors import InvalidInput, Problem, UnassembledPoses
from compoundkin.base.linear import one_thread
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.one_design import motion_of_design, shape_of
from compoundkin.model.mechanism import Mechanism, mechanism_of_design
from compoundkin.structure import Structure, decompose
from compoundkin.view.report.groups_section import drivers_section, solving_section
from compoundkin.view.report.report_data import Outcome, Subject
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.structure_sections import about_section, counted_sections, faults_section

if TYPE_CHECKING:
    from compoundkin.analysis.comparison import MechanismComparison
    from compoundkin.studies.optimisation.optimum import Optimum
    from compoundkin.studies.study_result import StudyResult
    from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
    from compoundkin.view.page import Page

# written as texts: what studies take is not loaded for the report of a mechanism
Studied: TypeAlias = "StudyResult | ToleranceAnalysis | Optimum | MechanismComparison"
Reported: TypeAlias = "Mechanism | Structure | Motion | Studied"


@checked
@one_thread
def report(what: Reported, outputs: Sequence[str] = (), design: int = 0) -> Report:
    """Report a motion, a structure before it is solved, a mechanism or a study.

    A mechanism is solved over its drivers' own ranges first; of one that has none, or that is not determined, its
    structure is reported, faults included. `outputs` are quantities such as "G.velocity"; without any, those that the
    mechanism names. Of a motion with several designs one is reported, by its index in the order of the motion's axes
    before the last: what is reported and checked is that design by itself, however many there are.

    Of a study the rows with the least and the greatest values of `outputs` are listed, of a tolerance analysis those
    outputs are reported, and of an optimum its page plots them. A comparison of two mechanisms is reported as a whole.

    Raises UnknownName for an output the mechanism does not have, InvalidInput for a design it does not have.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.structure import decompose
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> [section.key for section in report(decompose(crank)).sections]
    ['about', 'links', 'pairs', 'mobility', 'chain', 'loops', 'groups', 'drivers']
    >>> print(report(crank).text().splitlines()[0])
    Crank
    """
    if not isinstance(what, Mechanism | Structure | Motion):
        if design:
            raise InvalidInput(Problem("design", "a study is reported as a whole", "report the motion of that design"))
        from compoundkin.view.report.study_reports import whole_study_report

        return whole_study_report(what, outputs)
    subject, among = _report_subject(what, design)
    if isinstance(subject, Structure):
        return _structure_report(subject)
    # what a motion takes is not loaded for the report of a structure
    from compoundkin.view.report.motion_report import report_of_motion

    return report_of_motion(subject, outputs, _design_sentence(design, among))


@checked
@one_thread
def page(what: Reported, outputs: Sequence[str] = (), design: int = 0) -> Page:
    """Return the report as a page with the moving sketch. The arguments are those of `report`.

    Raises UnknownName for an output the mechanism does not have, InvalidInput for a design it does not have.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> page(crank).html.splitlines()[0]
    '<!DOCTYPE html>'
    """
    return report(what, outputs, design).page()


def _report_subject(what: Mechanism | Subject, design: int) -> tuple[Subject, int]:
    """Return what is reported, a design of a motion by itself, and how many there are."""
    if isinstance(what, Mechanism):
        return _solved_design(what, design)
    if isinstance(what, Structure):
        return what, 0
    check_design(design, what.inputs.designs)
    return motion_of_design(what, design), what.inputs.designs


def _design_sentence(design: int, among: int) -> str:
    text = f"Shown is design {design} of {among:,} (counted from 0); the checks are of it alone."
    return text if among > 1 else ""


def _solved_design(mechanism: Mechanism, design: int) -> tuple[Subject, int]:
    """Solve one design over the drivers' own ranges; return also how many there are.

    Of what has faults or no ranges it is the structure.
    """
    structure = decompose(mechanism)
    if structure.faults:
        return structure, 0
    try:
        shape = shape_of(structure)
    except InvalidInput:
        return structure, 0
    among = prod(shape[:-1])
    check_design(design, among)
    if among > 1:
        structure = decompose(mechanism_of_design(mechanism, shape, design))
    with warnings.catch_warnings():
        # the report says what cannot be assembled
        warnings.simplefilter("ignore", UnassembledPoses)
        try:
            return solve(structure), among
        except InvalidInput:
            return structure, 0


def _structure_report(structure: Structure) -> Report:
    """Report a structure before it is solved, one with faults included."""
    outcome = Outcome(not structure.faults)
    about = about_section(structure)
    faults = [faults_section(structure)] if structure.faults else []
    solving = solving_section(structure, None), drivers_section(structure, None)
    sections = about, *counted_sections(structure), *faults, *solving
    return Report(structure.mechanism.title, sections, outcome, structure)
