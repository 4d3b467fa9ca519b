"""All configurations of a mechanism, or all its circuits, side by side and to one scale."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.base.poses import Pose
from compoundkin.kinematics import Motion
from compoundkin.kinematics.configuration import BETWEEN, Configuration, dimensions_at
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.kinematics.solution import quietly_solved
from compoundkin.model.attributes import VELOCITY, unit_suffix
from compoundkin.model.outline_shapes import outline_shapes
from compoundkin.structure import Structure
from compoundkin.view.sketch.kinematic_sketch import by_links, ghost_shapes, in_layers, layered, window_on
from compoundkin.view.sketch.labels import label_shapes, labels_of, placed
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture import (
    GAP,
    NARROW,
    PAPER_WIDTH,
    Picture,
    PicturePart,
    in_rows,
    with_minus_signs,
    with_notes,
)
from compoundkin.view.sketch.picture_options import (
    Drawable,
    PictureOptions,
    driver_value_text,
    driver_values_by_name,
    ends_of,
    label_kinds,
    one_design,
    scene_of,
    structure_of,
)
from compoundkin.view.sketch.scene import MARGIN, Scene, Window, fitted_window
from compoundkin.view.sketch.shapes import Shape, ShapeGroup, Text, leaves, moved_shapes, shape_corners
from compoundkin.view.sketch.sketch_style import LETTER, LINE, SMALL
from compoundkin.view.sketch.vectors import VectorScale, vector_shapes

if TYPE_CHECKING:
    from compoundkin.analysis.singularity import Singularity
    from compoundkin.configurations.circuit import Circuit

# More panels than this are not compared.
MOST = 40
# Panels are no larger than this, in picture units: up to so many of them such that two stand side by side, or three.
LARGEST = {8: 340.0, MOST: 222.0}
# The longest arrow is this part of the mechanism's size.
LONGEST = 0.35
# They are at least so wide, for their headings.
NARROWEST = 200.0
# Room above and below what a panel shows, its letters too.
ABOVE = 4.0
# Of more than so many panels those of more than so many links have no numbers: their colours tell the groups.
FEW_PANELS, FEW_LINKS = 8, 12


@dataclass(frozen=True, eq=False)
class _ConfigurationPanel:
    """One configuration with its heading, a description, and others that are drawn faintly."""

    heading: str
    said: str
    scene: Scene
    faint: tuple[Scene, ...] = ()
    arrows: Mapping[str, complex] = field(default_factory=dict)

    def tips(self) -> dict[str, complex]:
        """The vectors of arrows in the plane, the longest of them LONGEST of the size."""
        longest = max(map(abs, self.arrows.values()), default=0.0)
        part = LONGEST * self.scene.mechanism.geometry.size / longest if longest else 0.0
        return {letter: part * way for letter, way in self.arrows.items()}


def configurations_picture(what: Drawable, options: PictureOptions) -> Picture:
    """Draw all configurations at a value of every driver. Raises what `configurations` does."""
    # late: other pictures need none of this
    from compoundkin.configurations.enumeration import configurations

    what, design = one_design(what, options.design)
    options = replace(options, design=design)
    structure = structure_of(what)
    found = configurations(structure, _values(what, structure, options))
    ones = list(found)
    scenes = _scenes(structure, ones)
    panels = [
        _ConfigurationPanel(str(k), one.name, s) for k, (one, s) in enumerate(zip(ones, scenes, strict=True), start=1)
    ]
    notes = [*_drivers(structure, ones[0].values if ones else {}), found.count_in_words.rstrip(".")]
    return _picture(structure, panels, notes, "configurations", options)


def _values(what: Drawable, structure: Structure, options: PictureOptions) -> dict[str, float] | None:
    """The requested values; else those of the pose that a sketch would show."""
    if options.at is not None:
        return driver_values_by_name(structure, options.at)
    try:
        scene = scene_of(what, None, options.pose, options.design)
    except (InvalidInput, NotAssembled):
        if options.pose is not None:
            raise
        # there may be other configurations than the one that is drawn
        return None
    return {step.drive.name: scene.driver_value(step.drive.name) for step in scene.driven} if scene.shown else None


def circuits_picture(what: Drawable, options: PictureOptions) -> Picture:
    """Draw all circuits. Each is in the middle of its first branch, its other branches faint.

    The driver moves that `at` leaves out, the first of those; the others stand still. Raises what `circuits` does.
    """
    from compoundkin.configurations.circuit_search import circuits

    structure = structure_of(one_design(what, options.design)[0])
    names = [drive.name for drive in structure.mechanism.drives]
    given = driver_values_by_name(structure, options.at) if options.at is not None else {}
    free = [name for name in names if name not in given] or names
    values = {name: value for name, value in given.items() if name != free[0]} if free else {}
    found = circuits(structure, free[0] if free else None, values)
    scenes = iter(_scenes(structure, [branch.configuration for branch in found.branches]))
    panels = []
    for circuit in found.circuits:
        first, *others = [next(scenes) for _ in circuit.branches]
        said = _of_circuit(structure, found.driver, circuit)
        panels.append(_ConfigurationPanel(f"circuit {circuit.number}", said, first, tuple(others)))
    count = f"{count_phrase(len(found.circuits), 'circuit')} of {found.driver}"
    branches = f"{count_phrase(len(found.branches), 'branch', 'branches')}, each in its middle"
    return _picture(structure, panels, [count, branches, *_drivers(structure, found.fixed)], "circuits", options)


def singularities_picture(what: Drawable | Singularity, options: PictureOptions) -> Picture:
    """Draw the singular poses of a motion, or one, a panel for each branch with the velocities of points along it.

    Dead points of outputs are drawn where one is given alone. Raises InvalidInput where no pose is singular.
    """
    from compoundkin.analysis.singularities import singular_poses
    from compoundkin.analysis.singularity import Singularity

    if isinstance(what, Singularity):
        found: Sequence[Singularity] = [what]
    else:
        what, design = one_design(what, options.design)
        motion = what if isinstance(what, Motion) else quietly_solved(structure_of(what))
        found = singular_poses(motion_of_design(motion, design))
    if not found:
        remedy = "draw its dead points one by one: draw(singularities(motion)[0])"
        raise InvalidInput(Problem("kind", "no pose along the motion is singular", remedy))
    panels = [panel for one in found for panel in _of_singularity(one)]
    counted = count_phrase(len(found), "singular pose")
    notes = [counted, "arrows: velocities along each branch, the longest always alike"]
    return _picture(found[0].motion.structure, panels, notes, "singular poses", options)


def _of_singularity(one: Singularity) -> Iterator[_ConfigurationPanel]:
    """Yield a panel for each branch of a singular pose, or one for the pose alone."""
    structure = one.motion.structure
    if not one.branches:
        yield _ConfigurationPanel(one.name, f"{one.values}: {one.meeting}", _scene_of(one))
    for branch in one.branches:
        heading = one.name if len(one.branches) == 1 else f"{one.name}, branch {branch.number}"
        moving = {letter: v for letter, v in branch.velocities.items() if letter in structure.mechanism.carriers}
        said = f"{one.values}: {branch.in_words}{' (followed)' if branch.followed else ''}"
        yield _ConfigurationPanel(heading, said, _scene_of(one), arrows=moving)


def _scene_of(one: Singularity) -> Scene:
    """The scene of a singular pose; a guide is as long as it is needed there."""
    structure, poses = one.motion.structure, dict(one.poses)
    design = int(np.ravel_multi_index(one.design, one.motion.shape[:-1])) if one.design else 0
    points = dimensions_at(structure, design, int(one.place))
    return Scene(
        structure, poses, poses, points, ends_of(structure), outlines=outline_shapes(structure.mechanism, points)
    )


def _of_circuit(structure: Structure, driver: str, circuit: Circuit) -> str:
    """Return which branches a circuit has, and how far the driver goes."""
    numbers = [str(branch.number) for branch in circuit.branches]
    said = f"branch {numbers[0]}" if len(numbers) == 1 else f"branches {', '.join(numbers)}"
    if circuit.turns_fully:
        return f"{said}: {driver} turns fully"
    is_angle = structure.driven_angles.get(driver, False)
    low, high = (float(degrees(v)) if is_angle else v for v in (circuit.low, circuit.high))
    return f"{said}: {driver} from {low:.4g} to {high:.4g}{unit_suffix(is_angle, structure.mechanism.unit)}"


def _scenes(structure: Structure, ones: Sequence[Configuration]) -> list[Scene]:
    """The scenes of configurations. A guide is as long in each as that one needs it."""
    if not ones:
        return []
    first = ones[0]
    whole = {name: _whole([one.poses[name] for one in ones]) for name in first.poses}
    outlines = outline_shapes(structure.mechanism, first.dimensions)
    scene = Scene(structure, whole, first.poses, first.dimensions, ends_of(structure), outlines=outlines)
    return [replace(one, whole=one.here) for one in (scene.ghost(k) for k in range(len(ones)))]


def _whole(poses: Sequence[Pose]) -> Pose:
    """Several poses of one link as one array."""
    z, u = (np.array([side.c[0] for side in sides]) for sides in zip(*((p.z, p.u) for p in poses), strict=True))
    return Pose.of(z, u)


def _drivers(structure: Structure, values: Mapping[str, float]) -> list[str]:
    """The drivers' values as notes."""
    return [driver_value_text(structure, name, value) for name, value in values.items()]


def _picture(
    structure: Structure,
    panels: Sequence[_ConfigurationPanel],
    notes: Sequence[str],
    kind: str,
    options: PictureOptions,
) -> Picture:
    """The panels in rows, and what stands below them."""
    kinds = label_kinds(options.labels)
    shown = panels[:MOST]
    if len(shown) > FEW_PANELS and len(structure.mechanism.links) > FEW_LINKS:
        kinds = tuple(kind for kind in kinds if kind != "links")
    parts = _parts(shown, kinds)
    shapes, width, height = in_rows(parts, widest=PAPER_WIDTH)
    more = [f"and {len(panels) - MOST} more"] if len(panels) > MOST else []
    legend = shown[0].scene.legend.items() if shown and "links" in kinds else ()
    notes = [*notes, *more, *(f"{number} {name}" for name, number in legend)]
    described = "; ".join(f"{panel.heading}: {panel.said}" for panel in panels)
    title = f"{structure.mechanism.title}: {kind}"
    return with_notes(shapes, width, height, notes, title, described, options.size, legible=True)


def _parts(panels: Sequence[_ConfigurationPanel], kinds: Sequence[str]) -> list[PicturePart]:
    """The panels with their headings, all in one window."""
    scenes = [scene for panel in panels for scene in (panel.scene, *panel.faint)]
    if not scenes:
        return []
    window = _window(panels, scenes, next(size for count, size in LARGEST.items() if len(panels) <= count))
    across = int(window.width / (SMALL * NARROW))
    wrap = textwrap.TextWrapper(across, break_on_hyphens=False, break_long_words=False).wrap
    said = [wrap(with_minus_signs(panel.said).replace(BETWEEN, " /\u00a0")) for panel in panels]
    down = LINE * (1 + max(map(len, said)))
    drawn = [_drawn(panel, window, kinds) for panel in panels]
    columns = max(1, int((PAPER_WIDTH + GAP) // (window.width + GAP)))
    parts = []
    for first in range(0, len(panels), columns):
        # a row is as tall as what it shows, and its panels have the frame at one height
        row = slice(first, first + columns)
        heights = [corner.imag for shapes in drawn[row] for corner in (*shape_corners(shapes), *_of_texts(shapes))]
        low, high = min(heights, default=0.0) - ABOVE, max(heights, default=0.0) + ABOVE
        for panel, lines, shapes in zip(panels[row], said[row], drawn[row], strict=True):
            top = complex(window.width / 2.0, LINE * 0.5)
            heads: list[Shape] = [Text(top, panel.heading, "heading")]
            heads += [
                Text(top + 1j * LINE * i, line.replace("\u00a0", " "), "note") for i, line in enumerate(lines, start=1)
            ]
            part = ShapeGroup((*heads, *moved_shapes(shapes, 1j * (down - low))))
            parts.append(PicturePart((part,), window.width, high - low + down))
    return parts


def _of_texts(shapes: Sequence[Shape]) -> Iterator[complex]:
    """Yield the places above and below letters and numbers: headings keep clear of them."""
    for shape in leaves(shapes):
        if isinstance(shape, Text):
            yield from (shape.at - LETTER / 2.0 * 1j, shape.at + LETTER / 2.0 * 1j)


def _window(panels: Sequence[_ConfigurationPanel], scenes: Sequence[Scene], largest: float) -> Window:
    """The one window of all scenes."""
    first = window_on(scenes[0], scenes[1:])
    scale = min(1.0, (largest - 2.0 * MARGIN) / max(first.width - 2.0 * MARGIN, first.height - 2.0 * MARGIN))
    whole = Window(first.scale * scale, first.corner, 0.0, 0.0)
    points = np.array([p for scene in scenes for p in shape_corners(layered(Painter(scene, whole)))] or [0j])
    tips = [complex(whole.at(panel.scene.letters[k] + way)) for panel in panels for k, way in panel.tips().items()
            if k in panel.scene.letters]  # fmt: skip
    points = np.concatenate([points, tips])
    found = fitted_window(whole, points, NARROWEST)
    if found.width <= largest:
        return found
    # labels and heads of arrows keep their size, so that all does not shrink alike
    narrower = Window(whole.scale * (largest - 2.0 * MARGIN) / (found.width - 2.0 * MARGIN), whole.corner, 0.0, 0.0)
    return fitted_window(narrower, (points - whole.at(0j)) * narrower.scale / whole.scale + narrower.at(0j), NARROWEST)


def _drawn(panel: _ConfigurationPanel, window: Window, kinds: Sequence[str]) -> list[Shape]:
    painter = Painter(panel.scene, window)
    laid = in_layers(painter)
    places = {letter: complex(window.at(place)) for letter, place in panel.scene.letters.items()}
    rates = {letter: way for letter, way in panel.tips().items() if letter in places}
    arrows = vector_shapes(places, rates, VectorScale(VELOCITY, window.scale, 1.0, "", 1))
    behind = [*(one.shape for one in laid), *arrows]
    found = placed(labels_of(painter, laid, kinds), behind, window.width, window.height)
    faint = (ghost_shapes(other, window) for other in panel.faint)
    return [*faint, *by_links(laid), *arrows, *label_shapes(panel.scene, found)]
