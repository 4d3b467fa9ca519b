"""All that makes a sketch live: what computes it, what draws it anew, and what can be taken hold of in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from compoundkin.view.page.live.handle_data import handle_data
from compoundkin.view.page.live.live_data import live_data
from compoundkin.view.page.live.redrawn_parts import redrawn_parts
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.sketch.moving_sketch import MovingSketch


def live_sketch(
    sample: Sample, chosen: Any, links: Sequence[str], outputs: Sequence[str], sketch: MovingSketch
) -> dict[str, Any] | None:
    """Return the data of a live sketch. They say why where it cannot be live; None is that of a single pose."""
    live = live_data(sample, chosen, links, outputs)
    if live is None or "why" in live:
        return live
    redraw = redrawn_parts(sketch, [one["name"] for one in live["dimensions"]])
    return {**live, "redraw": redraw, "handles": handle_data(sketch.scene, {name: k for k, name in enumerate(links)})}
