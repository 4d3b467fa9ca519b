"""A pose as a DXF drawing: a block for each link, joints, paths and names on layers of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.curves.samples import convex_hull
from compoundkin.files.exchange.dxf.coupler_paths import CouplerPath
from compoundkin.files.exchange.dxf.dxf_pen import DxfPen
from compoundkin.files.exchange.dxf.legal_names import LegalNames
from compoundkin.files.exchange.dxf.link_parts import LinkPart
from compoundkin.files.exchange.dxf.profile_splines import ProfileSpline
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.geometry import FRAME

LINKS, JOINTS, GROUND, CRANKS, CURVES, NAMES = "LINKS", "JOINTS", "GROUND", "CRANKS", "CURVES", "NAMES"
# Of parts the middle lines of slots and guides, which are not cut.
CENTRES = "CENTRES"
# Each layer with its colour, by AutoCAD's index.
LAYERS: Mapping[str, int] = MappingProxyType(
    {LINKS: 5, JOINTS: 3, GROUND: 8, CRANKS: 1, CURVES: 6, NAMES: 7, CENTRES: 8}
)
# Sizes of what has none of its own, in parts of the mechanism's: circles of joints, supports, letters.
JOINT, SUPPORT, LETTER = 0.01, 0.03, 0.025


def draw_pose(
    document: Any, shown: ShownMechanism, parts: Sequence[LinkPart], splines: Mapping[int, ProfileSpline], size: float
) -> None:
    """Draw a mechanism of a size at its pose."""
    model, names = document.modelspace(), LegalNames()
    for part in parts:
        block = document.blocks.new(names.of(f"LINK-{part.link}"))
        draw_part(DxfPen(block), part, splines)
        draw_centre_lines(DxfPen(block), part, splines)
        _draw_bars(DxfPen(block), part)
        pose = shown.poses[part.link]
        place, turn = complex(pose.z.c[0]), float(np.rad2deg(np.angle(complex(pose.u.c[0]))))
        on = GROUND if part.link == FRAME else CRANKS if part.link in shown.structure.driven else LINKS
        model.add_blockref(block.name, (place.real, place.imag), dxfattribs={"layer": on, "rotation": turn})
    _draw_joints(model, shown, parts, size)
    _draw_names(model, shown, parts, size)


def draw_part(pen: DxfPen, part: LinkPart, splines: Mapping[int, ProfileSpline], layer: int | None = None) -> None:
    """Draw a link at true size: all its sheets, or that on one layer."""
    holes = DxfPen(pen.layout, JOINTS if layer is None else pen.layer, pen.by)
    drawn: set[object] = set()
    for sheet in part.sheets:
        for shape in (*sheet.contours, *sheet.holes):
            if layer in (None, sheet.layer) and shape not in drawn:
                (holes.circle if shape in sheet.holes else pen.contour)(*(shape if shape in sheet.holes else (shape,)))
                drawn.add(shape)
    for curve in part.profiles:
        if curve.closed:
            pen.spline(splines[id(curve)])


def draw_centre_lines(pen: DxfPen, part: LinkPart, splines: Mapping[int, ProfileSpline]) -> None:
    """Draw what has no width: guides, the middle lines of slots."""
    for guide in dict.fromkeys(part.guides):
        if guide[0] != guide[-1]:
            pen.line(guide)
    for groove in part.grooves:
        pen.arc(*groove)
    for curve in part.profiles:
        if not curve.closed:
            pen.spline(splines[id(curve)])


def _draw_bars(pen: DxfPen, part: LinkPart) -> None:
    """Draw wheels and belts; of a link without an outline lines between its points too."""
    for wheel in dict.fromkeys(part.wheels):
        pen.circle(*wheel)
    for belt in part.belts:
        pen.line(belt[:-1], closed=True)
    joints = DxfPen(pen.layout, JOINTS, pen.by)
    for place in dict.fromkeys(part.points.values()):
        joints.point(place)
    corners = convex_hull(part.points.values())
    if part.link != FRAME and not part.is_cut and len(corners) > 1:
        pen.line(corners, closed=True)


def draw_paths(document: Any, paths: Sequence[CouplerPath]) -> None:
    """Draw paths of points."""
    pen = DxfPen(document.modelspace(), CURVES)
    for path in paths:
        pen.line(path.places, path.closed)


def _draw_joints(model: Any, shown: ShownMechanism, parts: Sequence[LinkPart], size: float) -> None:
    """Draw a circle for each pin that has no hole of its own size, and a triangle under those of the frame."""
    with_holes = {(part.link, p) for part in parts for sheet in part.sheets for p, _ in sheet.holes}
    for letter, links in shown.mechanism.carriers.items():
        real = [link for link in links if link not in shown.mechanism.auxiliary_links]
        if len(real) < 2:
            continue
        at = shown.place(real[0], letter)
        if not any((link, shown.points[link][letter]) in with_holes for link in real):
            DxfPen(model, JOINTS).circle(at, JOINT * size)
        if FRAME in real:
            foot = SUPPORT * size
            DxfPen(model, GROUND).line((at, at - foot * (0.6 + 1j), at + foot * (0.6 - 1j)), closed=True)


def _draw_names(model: Any, shown: ShownMechanism, parts: Sequence[LinkPart], size: float) -> None:
    """Write the letters of points beside them, the names of links into their middle."""
    pen, height = DxfPen(model, NAMES), LETTER * size
    named = {letter: part.link for part in parts for letter in part.points}
    for letter, link in named.items():
        pen.text(letter, shown.place(link, letter) + JOINT * size * (1.5 + 1.5j), height)
    for part in parts:
        if part.link != FRAME and part.points:
            middle = sum(part.points.values()) / len(part.points)
            beside = 0j if len(part.points) > 1 else size * (1.5 - 4j) * JOINT
            pen.text(part.link, shown.place(part.link, middle) + beside, 0.8 * height)
