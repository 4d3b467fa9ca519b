"""`draw`: the kinds of pictures of a mechanism, a structure or a motion at one pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem, nearest
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.kinematics import Motion, solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure
from compoundkin.view.sketch.asked_values import Drawable, structure_of
from compoundkin.view.sketch.centre_pictures import circle_diagram
from compoundkin.view.sketch.configuration_pictures import circuits_picture, configurations_picture
from compoundkin.view.sketch.construction import construction
from compoundkin.view.sketch.force_polygons import force_polygons
from compoundkin.view.sketch.force_sketch import force_sketch
from compoundkin.view.sketch.free_bodies import free_bodies
from compoundkin.view.sketch.graph_picture import graph
from compoundkin.view.sketch.groups_in_graph import groups_in_graph
from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.scene import groups_of, numbers_of
from compoundkin.view.sketch.shown_pose import Wishes, scene_of
from compoundkin.view.sketch.sketches import sketch
from compoundkin.view.sketch.structure_pictures import groups_picture, loops, loops_in_graph
from compoundkin.view.sketch.vectors import vector_polygon


@checked
def draw(
    what: Motion | Mechanism | Structure | Forces,
    at: Any = None,
    *,
    kind: str = "sketch",
    pose: int | None = None,
    design: int = 0,
    ghosts: int = 0,
    paths: str | Sequence[str] | bool = (),
    centres: bool = False,
    vectors: Any = (),
    labels: bool | str | Sequence[str] = True,
    size: float | None = None,
    link: str | None = None,
    dimensions: bool = False,
) -> Picture:
    """Draw a mechanism at one pose, in the conventions of textbooks.

    `kind` is "sketch", the kinematic sketch; "groups", the mechanism taken apart: frame and driver, then each Assur
    group in solving order, the pairs by which it is attached in dashed circles; "loops", the independent loops as
    polygons of vectors; "graph", the kinematic graph of links and pairs; "circle", the circle diagram of the instant
    centres; "polygon", the polygon of the velocities of all points (`vectors="acceleration"`: of their accelerations)
    with the images of the links; "construction", how the dyad with a `link` (the first one if left out) is drawn
    with circles and lines, its other mode dashed; "configurations", all of them at the pose, or "circuits", all those
    of the driver that `at` leaves out, side by side on one scale; "free-bodies", each link or one `link` alone with all
    that acts on it; or "force-polygon", the forces on each link or one head to tail. The last two are of forces, or
    find them; the sketch of forces has them as arrows, that in each pair on its second link, or all those on one
    `link`.

    The pose is that of the drivers' values `at` (radians or lengths: a number, or several by name), or the pose with
    the index `pose`; else the one nearest to the mechanism's drawing. Graph and circle diagram have none. In a sketch,
    `ghosts` so many other poses are drawn faintly; `paths` names points whose paths along the motion are drawn (True
    for all that are on one link only); `centres` adds the instant centres and the lines that give them; `vectors`
    "velocity", "acceleration" or both. `labels` is True, False, or some of "points", "links". `dimensions` adds
    lengths, angles, radii, offsets of pivots and guides. `size` is the longer side in pixels, such that texts are
    legible if left out.

    A mechanism is solved first; one that cannot be solved is shown as drawn. Raises InvalidInput, UnknownName for
    what does not fit it or the kind of picture, NotAssembled for a pose that does not close, NotDetermined where a
    mechanism that the drivers do not determine is asked for its groups or centres.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> draw(crank, at=0.5).title
    'Crank'
    >>> draw(crank, kind="graph").description
    '2 links, 1 pairs'
    >>> draw(crank, at=0.5, kind="polygon").title
    'Crank: velocity polygon'
    """
    if kind not in KINDS:
        raise InvalidInput(Problem("kind", f"there is no picture {kind!r}", nearest(kind, list(KINDS))))
    wishes = Wishes(at, pose, design, ghosts, paths, centres, vectors, labels, size, link, dimensions)
    drawn, known = KINDS[kind]
    if isinstance(what, Forces) and kind in OF_FORCES:
        drawn, known = OF_FORCES[kind]
    elif isinstance(what, Forces):
        what = what.motion
    if unfit := wishes.others(known):
        raise InvalidInput(Problem(unfit[0], f"it does not go with the kind {kind!r}", "leave one of them out"))
    return drawn(what, wishes)


def _of_forces(drawn: Callable[[Forces, Wishes], Picture]) -> Callable[[Drawable | Forces, Wishes], Picture]:
    """Return what draws forces, or those of a motion or a mechanism, which are found first."""
    return lambda what, wishes: drawn(_forces(what), wishes)


def _forces(what: Drawable | Forces) -> Forces:
    """The forces, or those of a motion; of a mechanism those over its drivers' own ranges."""
    if isinstance(what, Forces):
        return what
    return force_analysis(what if isinstance(what, Motion) else solve(what))


def _groups(what: Drawable, wishes: Wishes) -> Picture:
    structure = _taken_apart(what)
    known = what if isinstance(what, Motion) else structure.mechanism
    try:
        scene = scene_of(known, wishes.at, wishes.pose, wishes.design)
    except (InvalidInput, NotAssembled):
        # how it is taken apart is a matter of its letters: it needs no pose unless one is asked for
        if wishes.others(("size",)):
            raise
        return groups_in_graph(structure, wishes.size)
    return groups_picture(scene, wishes.size)


def _circle(what: Drawable, wishes: Wishes) -> Picture:
    structure = _taken_apart(what)
    return circle_diagram(structure, numbers_of(structure), wishes.size)


def _graph(what: Drawable, wishes: Wishes) -> Picture:
    structure = structure_of(what)
    return graph(structure, numbers_of(structure), groups_of(structure), wishes.size)


def _loops(what: Drawable, wishes: Wishes) -> Picture:
    """The loops on the mechanism; in its graph where it cannot be shown at any pose."""
    try:
        scene = scene_of(what, wishes.at, wishes.pose, wishes.design)
    except (InvalidInput, NotAssembled, NotDetermined):
        if wishes.others(("size",)):
            raise
        return loops_in_graph(structure_of(what), wishes.size)
    return loops(scene, wishes.size)


def _taken_apart(what: Drawable) -> Structure:
    """The structure; raises NotDetermined where it cannot be taken apart."""
    structure = structure_of(what)
    if structure.faults:
        problems = [Problem("structure", fault.text, fault.remedy) for fault in structure.faults]
        raise NotDetermined(problems, heading=f"{structure.mechanism.title!r} cannot be taken apart")
    return structure


POSE = ("at", "pose", "design")
# Each kind of picture: what draws it, and which of the wishes it knows.
KINDS: Mapping[str, tuple[Callable[[Any, Wishes], Picture], Sequence[str]]] = {
    "sketch": (sketch, (*POSE, "ghosts", "paths", "centres", "vectors", "labels", "size", "dimensions")),
    "groups": (_groups, (*POSE, "size")),
    "loops": (_loops, (*POSE, "size")),
    "graph": (_graph, ("size",)),
    "circle": (_circle, ("size",)),
    "polygon": (vector_polygon, (*POSE, "vectors", "size")),
    "construction": (construction, (*POSE, "link", "size")),
    "configurations": (configurations_picture, (*POSE, "labels", "size")),
    "circuits": (circuits_picture, ("at", "design", "labels", "size")),
    "free-bodies": (_of_forces(free_bodies), (*POSE, "link", "size")),
    "force-polygon": (_of_forces(force_polygons), (*POSE, "link", "size")),
}
# The same of forces, where it is another picture.
OF_FORCES: Mapping[str, tuple[Callable[[Any, Wishes], Picture], Sequence[str]]] = {
    "sketch": (_of_forces(force_sketch), (*POSE, "labels", "link", "size")),
    **{kind: KINDS[kind] for kind in ("free-bodies", "force-polygon")},
}
