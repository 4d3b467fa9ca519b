"""The construction of a dyad by circles and lines, as one draws it with compasses and a ruler."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.dyad_loci import CircleLocus, Loci, Locus, same_locus
from compoundkin.kinematics.groups import DyadSolver, as_dyad
from compoundkin.structure import Group
from compoundkin.view.sketch.kinematic_sketch import layered, nearby
from compoundkin.view.sketch.labels import Label, label_around, label_beside, placed, point_letters, text_half
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture import SIDE, Picture, checked_size, lines_below, lines_of_text, width_with
from compoundkin.view.sketch.picture_options import Drawable, PictureOptions, pose_notes, scene_of
from compoundkin.view.sketch.scene import Scene, Window, fitted_window, window_around
from compoundkin.view.sketch.shapes import CircleShape, Polygon, Polyline, Shape, ShapeGroup, Text, shape_corners, sheet
from compoundkin.view.sketch.sketch_style import LETTER, PIN, STUD, style_of

# Loci of both modes that differ by less than this part of the size are one.
SAME = 1e-6
# Places along a radius for its length, the middle first, and how far beside it, in picture units.
ALONG = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2)
BESIDE = 6.0
# On the side of the other link a length is worse than outside by this.
INSIDE = 24.0
# A dyad without circles, such as two blocks on one pin, that reaches over less than this part of the mechanism's size
# is shown with the mechanism around it.
NARROW = 0.2
# A guide that is used for more than so many sizes of the mechanism is drawn where the pose needs it.
LONG = 10.0
# The picture is at least so wide, for what stands below it.
WIDE = 380.0


@dataclass(frozen=True)
class DrawnDyad:
    """A dyad at a pose, with its constructions in both modes."""

    scene: Scene
    group: Group
    modes: tuple[Loci, ...]
    names: tuple[str, str, str]
    window: Window

    @property
    def painter(self) -> Painter:
        """The painter of its links alone."""
        return Painter(self.scene, self.window, frozenset(self.group.links))

    def style(self, kind: str) -> str:
        """Return a style in the colour of its group."""
        return style_of(kind, self.scene.groups[self.group.links[0]])

    def other_curves(self) -> list[Locus]:
        """Return the curves of the other mode that this one does not share."""
        size = self.scene.mechanism.geometry.size
        return [curve for loci in self.modes[1:] for curve in loci.curves
                if not any(same_locus(curve, own, SAME * size) for own in self.modes[0].curves)]  # fmt: skip


def construction(what: Drawable, options: PictureOptions) -> Picture:
    """Draw the construction of a dyad at one pose.

    Its mode is solid and the other one dashed. Circles have their centres at the outer pins and meet each other or
    lines where the inner pair is. Raises InvalidInput for a link of no dyad, and for a mechanism that is shown as
    drawn. Source: e.g. F. Grashof, Theoretische Maschinenlehre, or any course of descriptive kinematics.
    """
    scene = scene_of(what, options.at, options.pose, options.design)
    scene = scene.compact(LONG * scene.mechanism.geometry.size)
    solver = _solver(scene, options.link)
    modes = _modes(scene, solver)
    drawn = DrawnDyad(scene, solver.group, modes, solver.letters, _window(scene, solver.group, modes))
    shapes = list(_shapes(drawn))
    found = placed(_labels(drawn), shapes, drawn.window.width, drawn.window.height)
    names = [Text(at, key.partition(" ")[2], key.partition(" ")[0]) for key, at in found.items()]
    faint = ShapeGroup(tuple(layered(Painter(scene, drawn.window))), "ghost")
    return _finished(drawn, [faint, *shapes, *names], checked_size(options.size))


def _solver(scene: Scene, link: str | None) -> DyadSolver:
    """The solver of the dyad with a link, or of the first one; raises InvalidInput without one."""
    if scene.shown is None:
        what = "a mechanism that is shown as drawn is not constructed"
        raise InvalidInput(Problem("construction", what, "give it drivers"))
    solvers = scene.shown.solving_order.solvers
    dyads = [dyad for dyad in map(as_dyad, solvers) if dyad is not None]
    known = [dyad for dyad in dyads if link is None or link in dyad.group.links]
    if known:
        return known[0]
    listed = "; ".join(", ".join(dyad.group.links) for dyad in dyads)
    remedy = f"the dyads have {listed}" if dyads else "none of its groups is a dyad"
    if link is None:
        raise InvalidInput(Problem("construction", "there is no dyad", "circles and lines construct dyads only"))
    scene.mechanism.link(link)
    group = next((one.group for one in solvers if link in one.group.links), None)
    what = f"{link!r} belongs to the group {group.name}, which is not a dyad" if group else f"{link!r} is in no group"
    raise InvalidInput(Problem("link", what, remedy))


def _modes(scene: Scene, solver: DyadSolver) -> tuple[Loci, ...]:
    """The constructions of a dyad at the pose shown, in the mode shown and in the other."""
    assert scene.shown is not None
    design, pose = scene.pose
    part = scene.shown.inputs.cut(slice(design, design + 1), slice(pose, pose + 1))
    with np.errstate(all="ignore"):
        block = scene.shown.block(part, 0, np.array([[float(pose)]]), np.array([[design]]))
        found = solver.constructions(block)
    if not found:
        raise InvalidInput(Problem("link", f"a dyad {solver.name} has no construction", "draw another one"))
    return found


def _window(scene: Scene, group: Group, modes: Sequence[Loci]) -> Window:
    """The window on a dyad's links and on all its circles."""
    circles = [curve for loci in modes for curve in loci.curves if isinstance(curve, CircleLocus)]
    places = [scene.at(link, p) for link in group.links for p in scene.points[link].values()]
    places += [loci.meeting for loci in modes]
    places += [circle.centre + circle.radius * e for circle in circles for e in (1, 1j, -1, -1j)]
    apart = np.ptp(np.abs(np.array(places) - modes[0].meeting))
    if not circles and apart < NARROW * (size := scene.mechanism.geometry.size):
        places += [modes[0].meeting + size * e / 2.0 for e in (1 + 1j, -1 - 1j)]
    first = window_around([np.array(places)], [])
    points = first.at(np.array(places))
    links = shape_corners(layered(Painter(scene, first, frozenset(group.links))))
    words = [width_with(lines_below([note], 0.0)[0]) for note in _notes(scene, modes)]
    return fitted_window(first, np.append(points, nearby(points, links)), max(WIDE, *words))


def _shapes(drawn: DrawnDyad) -> Iterator[Shape]:
    """The curves, the links in the mode shown, the radii, and where the curves meet."""
    window, own = drawn.window, drawn.modes[0]
    for curve in drawn.other_curves():
        yield _curve(window, curve, drawn.style("dashed"))
    for curve in own.curves:
        yield _curve(window, curve, drawn.style("thin"))
    for other in drawn.modes[1:]:
        yield from _radii(window, other, drawn.style("dashed"))
    yield from _radii(window, own, drawn.style("thin"))
    yield from layered(drawn.painter)
    for other in drawn.modes[1:]:
        yield CircleShape(complex(window.at(other.meeting)), STUD, f"pin {drawn.style('ring')}")
    yield CircleShape(complex(window.at(own.meeting)), STUD, "dot")


def _radii(window: Window, loci: Loci, style: str) -> Iterator[Polyline]:
    """The radii of the circles that have one."""
    for curve in loci.curves:
        if isinstance(curve, CircleLocus) and curve.name:
            yield Polyline(_radius(window, curve), style)


def _radius(window: Window, circle: CircleLocus) -> tuple[complex, complex]:
    return complex(window.at(circle.centre)), complex(window.at(circle.end))


def _curve(window: Window, curve: Locus, style: str) -> Shape:
    """A circle, or a line all across the picture."""
    if isinstance(curve, CircleLocus):
        return CircleShape(complex(window.at(curve.centre)), curve.radius * window.scale, style)
    at, way = complex(window.at(curve.at)), complex(np.conjugate(curve.along)) * window.diagonal
    return Polyline((at - way, at + way), style)


def _labels(drawn: DrawnDyad) -> list[Label]:
    """The letters of the points, the other meeting place, and the lengths of the radii."""
    window, own = drawn.window, drawn.modes[0]
    found = [Label(f"letter {label.key.partition(' ')[2]}", label.half, label.places, label.costs)
             for label in point_letters(drawn.painter)]  # fmt: skip
    inner = drawn.names[1]
    is_inner = abs(drawn.scene.letters[inner] - own.meeting) * window.scale < PIN if inner in drawn.scene.letters else 0
    for other in drawn.modes[1:]:
        at, name = complex(window.at(other.meeting)), f"{inner}\u2032"
        if is_inner and abs(at - window.at(own.meeting)) > PIN:
            found.append(label_around(f"letter {name}", at, text_half(name, LETTER), PIN + 3.0))
    named = [curve for curve in own.curves if isinstance(curve, CircleLocus) and curve.name]
    lines = [_radius(window, curve) for curve in named]
    # rather outside the triangle of the links
    middle = complex(np.mean([place for line in lines for place in line] or [0j]))
    pairs = zip(named, lines, strict=True)
    return found + [
        label_beside(f"number {curve.name}", curve.name, line, middle, ALONG, (BESIDE,), INSIDE)
        for curve, line in pairs
    ]


def _notes(scene: Scene, modes: Sequence[Loci]) -> list[str]:
    """The pose, and the construction in words."""
    return [*pose_notes(scene), *modes[0].told]


def _finished(drawn: DrawnDyad, shapes: Sequence[Shape], size: float | None) -> Picture:
    """The picture with the construction in words below it, on paper over all that is drawn."""
    scene, window, own = drawn.scene, drawn.window, drawn.modes[0]
    notes = _notes(scene, drawn.modes)
    if abs(drawn.modes[-1].meeting - own.meeting) > SAME * scene.mechanism.geometry.size:
        notes.append("dashed: the other mode")
    texts, height = lines_below(lines_of_text(notes, window.width - 2.0 * SIDE), window.height)
    strip = Polygon((1j * window.height, window.width + 1j * window.height, complex(window.width, height),
                     1j * height), "paper")  # fmt: skip
    title = f"{scene.mechanism.title}: construction of {', '.join(drawn.group.links)}"
    paper = sheet(window.width, height)
    return Picture((paper, *shapes, strip, *texts), window.width, height, title, ", ".join(own.told), size, window)
