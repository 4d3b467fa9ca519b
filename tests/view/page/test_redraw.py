"""Sketches drawn anew in the browser: as painters in Python draw the mechanism of the changed dimensions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.programs.dimensions import StatedDimensions, free_dimensions, mechanism_with
from compoundkin.view.sketch.kinematic_sketch import carried_shapes
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture_options import scene_in
from compoundkin.view.sketch.scene import DEVIATION, Window
from compoundkin.view.sketch.shapes import ArcShape, CircleShape, Strokes, leaves
from tests import catalog

# The vertices of all elements of the sketch but names, on the picture, in the order of the elements.
VERTICES = """() => {
  const svg = document.querySelector("svg.sketch"), found = [];
  for (const part of svg.querySelectorAll(".parts > g:not(.name)")) {
    const own = part.transform.baseVal.consolidate().matrix;
    const at = (x, y) => [own.a * x + own.c * y + own.e, own.b * x + own.d * y + own.f];
    for (const one of part.querySelectorAll("path, circle")) {
      if (one.localName === "circle") {
        found.push([at(one.cx.baseVal.value, one.cy.baseVal.value), [one.r.baseVal.value, 0]]);
        continue;
      }
      const d = one.getAttribute("d").replace(/A\\S+ \\S+ 0 0 [01] /g, "L");
      found.push((d.match(/[ML]\\S+ [^MLZ]+/g) || []).map((p) => at(...p.slice(1).split(" ").map(Number))));
    }
  }
  return found;
}"""
CHANGED = f"(values) => {{ const [{{ design }}] = compoundkin.players; design.change(values); return ({VERTICES})(); }}"

# Mechanisms of dyads, slides, slots, gears and outlines.
NAMES = (
    "jaw-crusher",
    "slider-crank-offset",
    "scotch-yoke",
    "quick-return-pin-in-slot",
    "geared-five-bar",
    "oscillating-cylinder",
)
# Vertices are written to a hundredth of a picture unit, and so are the places of parts.
WRITTEN = 0.02
# What no dimension moves, as the outline of a fixed jaw, stays as the page has it, to a tenth.
STILL = 0.08
# Points are moved by up to this part of the mechanism's size, angles by so much.
MOVED = 0.008
# A line of more vertices is a curve, of which those are left out that it does not need.
CORNERS = 20


def _flat(shape: Any) -> list[complex]:
    """The numbers of an element as the browser lists them."""
    if isinstance(shape, CircleShape):
        return [shape.centre, complex(shape.radius)]
    if isinstance(shape, ArcShape):
        return [shape.start, shape.stop]
    if isinstance(shape, Strokes):
        return [point for line in shape.lines for point in line]
    return [*shape.points]


def _painted(motion: ck.results.Motion, pose: int, window: dict[str, float]) -> list[list[complex]]:
    """The vertices that painters lay at a pose of a motion, in the window of the page."""
    on = Window(window["scale"], complex(window["x"], window["y"]), window["width"], window["height"])
    painter = Painter(scene_in(motion, None, pose, 0), on)
    return [_flat(shape) for one in carried_shapes(painter) for shape in leaves([one.shape])]


def _apart(found: Any, own: Any) -> float:
    """How far two elements are from each other.

    Hulls may begin at another corner. Belts may have other vertices: these are on the line of the other then.
    """
    if len(found) == len(own) and (off := float(np.abs(found - own).max())) < WRITTEN:
        return off
    assert len(own) > 2
    return max(_off(found, own), _off(own, found)) - (DEVIATION if len(own) > CORNERS else 0.0)


def _off(points: Any, line: Any) -> float:
    """The greatest distance of points from a closed line."""
    start, way = line[None], np.roll(line, -1)[None] - line[None]
    share = np.clip((np.conjugate(way) * (points[:, None] - start)).real / np.maximum(np.abs(way) ** 2, 1e-12), 0, 1)
    return float(np.abs(start + share * way - points[:, None]).min(axis=1).max())


def _changes(motion: ck.results.Motion, names: list[str], seed: int) -> dict[str, float]:
    """Other values of all dimensions but teeth."""
    stated, rng = StatedDimensions(motion.mechanism, motion.inputs.ends), np.random.default_rng(seed)
    found = {}
    for one in free_dimensions(stated, names):
        unit = stated.unit(one)
        by = MOVED * (1.0 if unit == "rad" else motion.size if unit else 0.0)
        found[one.name] = float(stated.own(one) + by * rng.uniform(-1.0, 1.0))
    return found


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@pytest.mark.parametrize("name", [*NAMES[:2], *(pytest.param(name, marks=pytest.mark.full) for name in NAMES[2:])])
def test_what_is_drawn_anew_is_what_painters_draw(name: str, made: Any, opened: Any) -> None:
    motion, view = catalog.motion(name), opened(made(name))
    names, window, pose = view.value(
        "() => { const [player] = compoundkin.players; return [player.design.names, player.data.window, player.pose]; }"
    )
    stated = StatedDimensions(motion.mechanism, motion.inputs.ends)
    limit = STILL if motion.mechanism.outlines else WRITTEN
    for seed in range(2):
        values = _changes(motion, names, seed)
        drawn = view.value(CHANGED, values)
        mechanism = mechanism_with(stated, {one: values[one.name] for one in free_dimensions(stated, list(values))})
        signs = {mode.links[0]: int(mode.sign) for mode in motion.modes.values() if mode.sign is not None}
        wanted = _painted(ck.solve(mechanism, modes=signs), pose, window)
        assert len(drawn) == len(wanted)
        for found, own in zip(drawn, wanted, strict=True):
            assert _apart(np.array([complex(*p) for p in found]), np.array(own)) < limit
    assert not view.complaints
