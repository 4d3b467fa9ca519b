"""What notebooks show of forces and of simulations: a picture with the forces, and short tables."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.simulation.simulation import Simulation
from compoundkin.view.page.html_blocks import plain_block, plain_figure, plain_sections
from compoundkin.view.page.markup import safe
from compoundkin.view.page.player import framed
from compoundkin.view.report.force_assumptions import assumptions
from compoundkin.view.report.force_tables import drives_blocks, reactions_blocks
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.report.simulation_report import simulation_report
from compoundkin.view.sketch import draw


def forces_html(what: Forces | Simulation, drawn: bool) -> Iterator[str]:
    """Yield a picture, if `drawn`, and tables of forces or a simulation."""
    if isinstance(what, Simulation):
        yield framed(what.motion) if drawn else ""
        yield from plain_sections(simulation_report(what).sections)
        return
    sample = Sample(what.motion)
    caption = f"<strong>{safe(what.mechanism.title)}</strong>: {safe('; '.join(assumptions(sample, what)))}"
    yield plain_figure(draw(what).svg, caption) if drawn else f"<p>{caption}</p>"
    yield from map(plain_block, (*reactions_blocks(sample, what), *drives_blocks(sample, what)))
