"""What objects display in notebooks: pictures and tables as HTML, for light and dark pages alike."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import singledispatch
from typing import Any

from compoundkin.analysis.cam_analysis import CamAnalysis
from compoundkin.analysis.centres import Centres
from compoundkin.analysis.checks import Check
from compoundkin.analysis.comparison import MechanismComparison
from compoundkin.analysis.interference import Interference
from compoundkin.analysis.singularity import Singularities
from compoundkin.base.arrays import degrees
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.configurations.circuit_search import Circuits
from compoundkin.dimensional.cognates import Cognates
from compoundkin.dimensional.dyads import Dyads
from compoundkin.dimensional.synthesis import Answer
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.configuration import Configuration, Configurations
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose, roman
from compoundkin.structure.redundancy import MobilityAnalysis
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.study_result import StudyResult
from compoundkin.studies.tolerances.tolerance_analysis import ToleranceAnalysis
from compoundkin.view.page.html_blocks import plain_block, plain_figure, plain_sections, plain_table
from compoundkin.view.page.markup import safe
from compoundkin.view.page.viewer import framed_player
from compoundkin.view.report.centres_section import centre_blocks
from compoundkin.view.report.configurations_section import (
    circuits_report,
    configurations_section,
    singularities_section,
)
from compoundkin.view.report.forces_section import assumptions, drives_blocks, forces_report, reactions_blocks
from compoundkin.view.report.interference_section import blocks_of_designs
from compoundkin.view.report.outputs_section import cam_blocks
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import Alert, Block, Cell, Column, Paragraph, TableBlock
from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.simulation_report import simulation_report
from compoundkin.view.report.structure_sections import analysis_blocks, links_section
from compoundkin.view.report.synthesis_report import synthesis_report
from compoundkin.view.report.verification_sections import findings_table
from compoundkin.view.report.whole_report import report
from compoundkin.view.report.wording import counted, listed, sentence
from compoundkin.view.sketch import draw
from compoundkin.view.sketch.synthesis_pictures import cognates_picture, dyads_picture, synthesis_picture

# Pictures of more links take more than a second and are drawn on request only.
MOST_LINKS = 30
# Objects displayed as blocks of a report.
_BLOCKS: dict[type, Callable[[Any], Iterable[Block]]] = {
    Centres: centre_blocks,
    MobilityAnalysis: analysis_blocks,
    Interference: blocks_of_designs,
    CamAnalysis: lambda what: cam_blocks(Sample(what.motion), what),
    Singularities: lambda what: singularities_section(what).blocks,
}


def html_of(what: object) -> str | None:
    """Return the HTML of an object in a notebook; None where its text is better.

    It never raises, so that a cell that made an object without an error does not end with one.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> html_of(crank)[:7]
    '<figure'
    """
    try:
        return unguarded(what)
    except Exception:
        return None


def svg_of(what: Mechanism | Structure | Motion) -> str | None:
    """Return the picture of a mechanism, a structure or a motion; None where it would take long."""
    mechanism = what if isinstance(what, Mechanism) else what.mechanism
    if len(mechanism.links) > MOST_LINKS:
        return None
    try:
        return _picture_of(what)
    except CompoundkinError:
        return None


def _picture_of(what: Mechanism | Structure | Motion) -> str | None:
    if isinstance(what, Motion):
        return draw(what).svg
    return _structure_picture(what) if isinstance(what, Structure) else _mechanism_picture(what)


def _mechanism_picture(mechanism: Mechanism) -> str | None:
    """Return the sketch, or the graph of a mechanism without coordinates; None where a search would take seconds."""
    if mechanism.unplaced:
        return draw(mechanism, kind="graph").svg
    return None if decompose(mechanism).faults and not mechanism.sketch else draw(mechanism).svg


def _structure_picture(structure: Structure) -> str:
    """Return the groups, or the graph of a structure with faults."""
    return draw(structure, kind="graph" if structure.faults else "groups").svg


def unguarded(what: object) -> str:
    """Return what `html_of` gives, but raise errors; warnings on undefined numbers are ignored."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return "\n".join(_parts(what))


@singledispatch
def _parts(what: object) -> Iterator[str]:
    raise TypeError(f"{type(what).__name__} shows nothing of its own")


@_parts.register
def _(what: Mechanism) -> Iterator[str]:
    structure = decompose(what)
    pairs = " + ".join(f"{count.number} {count.code}" for count in structure.mobility.pairs)
    facts = [what.in_numbers, f"pairs {pairs}" if pairs else "no pairs"]
    facts.append(f"driven: {listed(drive.name for drive in what.drives)}" if what.drives else "no driver")
    facts += [f"lengths in {what.unit}"] if what.unit else []
    caption = f"<strong>{safe(what.title)}</strong>: {safe('; '.join(facts))}"
    if picture := what._repr_svg_():
        yield plain_figure(picture, caption)
    else:
        yield f"<p>{caption}</p>"
        yield from map(plain_block, links_section(structure).blocks)


@_parts.register
def _(what: Structure) -> Iterator[str]:
    mobility = f"{what.mobility.formula}; {what.mobility.verdict}"
    caption = f"<strong>{safe(what.mechanism.title)}</strong>: {safe(mobility)}"
    picture = what._repr_svg_()
    yield plain_figure(picture, caption) if picture else f"<p>{caption}</p>"
    yield from (plain_block(Alert(sentence(fault.text), fault.remedy)) for fault in what.faults)
    dropped = what.relaxation.dropped if what.relaxation else ()
    notes = [*(f"Passive: {one}." for one in what.passive), *(f"Left out: {one}." for one in dropped)]
    yield from (plain_block(Paragraph(text)) for text in notes)
    yield plain_table(_groups_table(what), "Groups in solving order")


def _groups_table(structure: Structure) -> TableBlock:
    """Return the frame with its driven links, then each group with its links and what it is attached to."""
    columns = (Column("no.", style="each"), Column("group"), Column("class"), Column("order", style="each"),
               Column("links"), Column("uses"))  # fmt: skip
    name = "frame and driver" if len(structure.ground.driven) == 1 else "frame and drivers"
    first = (0, name if structure.ground.driven else "frame", None, None, ", ".join(structure.ground.links), None)
    rows: list[tuple[Cell, ...]] = [first]
    for k, group in enumerate(structure.groups, start=1):
        rows.append((k, group.name, roman(group.class_), group.order, ", ".join(group.links), ", ".join(group.uses)))
    return TableBlock(columns, tuple(rows))


@_parts.register
def _(what: Motion) -> Iterator[str]:
    if len(what.mechanism.links) > MOST_LINKS or what.inputs.poses < 2:
        raise InvalidInput(Problem("motion", "it has one pose, or is too large to be shown unasked", "draw() it"))
    yield framed_player(what)


@_parts.register
def _(what: Report) -> Iterator[str]:
    yield f"<h3>{safe(what.title)}</h3>"
    yield from plain_sections(what.sections)


@_parts.register
def _(what: Check) -> Iterator[str]:
    verdict = f"failed: {listed(what.failed)}" if what.failed else what.verdict
    singular = f", {what.singular} of them without rates" if what.singular else ""
    yield plain_table(
        findings_table(what, _finding_place), f"Checks of {counted(what.poses, 'pose')}{singular}: {verdict}"
    )


def _finding_place(name: str, pose: tuple[int, ...]) -> str:
    return f"{name}, pose {', '.join(map(str, pose))}" if name and pose else name


@_parts.register
def _(what: Circuits) -> Iterator[str]:
    yield from plain_sections(circuits_report(what).sections)


@_parts.register
def _(what: Configurations) -> Iterator[str]:
    yield from plain_sections([configurations_section(what)])


@_parts.register
def _(what: Configuration) -> Iterator[str]:
    mechanism = what.structure.mechanism
    caption = f"<strong>{safe(what.name)}</strong>: {safe(mechanism.title)}"
    if len(mechanism.links) <= MOST_LINKS:
        yield plain_figure(draw(solve(what.structure, what.values, modes=what, order=0)).svg, caption)
    else:
        yield f"<p>{caption}</p>"
    columns = Column("link"), Column("angle", "deg", "fixed", floor=1e-9)
    rows = tuple((name, float(degrees(angle))) for name, angle in what.angles.items())
    yield plain_table(TableBlock(columns, rows), "Angles of the links")


@_parts.register
def _(what: Centres | MobilityAnalysis | Interference | CamAnalysis | Singularities) -> Iterator[str]:
    yield from map(plain_block, _BLOCKS[type(what)](what))


@_parts.register
def _(what: StudyResult | ToleranceAnalysis | Optimum | MechanismComparison) -> Iterator[str]:
    yield from plain_sections(report(what).sections)


@_parts.register
def _(what: Answer) -> Iterator[str]:
    yield plain_figure(synthesis_picture(what).svg, safe(what.task.in_words))
    yield from plain_sections(synthesis_report(what).sections)


@_parts.register
def _(what: Dyads | Cognates) -> Iterator[str]:
    picture = dyads_picture(what) if isinstance(what, Dyads) else cognates_picture(what)
    yield plain_figure(picture.svg, safe(repr(what)))


def text_of(what: Forces | Simulation) -> str:
    """Return the report on forces or a simulation as text."""
    return (simulation_report(what) if isinstance(what, Simulation) else forces_report(what)).text()


@_parts.register
def _(what: Forces | Simulation) -> Iterator[str]:
    motion = what.phases[0].motion if isinstance(what, Simulation) else what.motion
    yield from forces_html(what, len(motion.mechanism.links) <= MOST_LINKS)


def forces_html(what: Forces | Simulation, drawn: bool) -> Iterator[str]:
    """Yield a picture, if `drawn`, and tables of forces or a simulation."""
    if isinstance(what, Simulation):
        yield from (framed_player(phase.motion) for phase in what.phases if drawn)
        yield from plain_sections(simulation_report(what).sections)
        return
    sample = Sample(what.motion)
    caption = f"<strong>{safe(what.mechanism.title)}</strong>: {safe('; '.join(assumptions(sample, what)))}"
    yield plain_figure(draw(what).svg, caption) if drawn else f"<p>{caption}</p>"
    yield from map(plain_block, (*reactions_blocks(sample, what), *drives_blocks(sample, what)))
