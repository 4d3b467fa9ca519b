"""`draw_structure`: pictures of what a mechanism is made of."""

from __future__ import annotations

from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem, nearest
from compoundkin.kinematics import Motion
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure, decompose
from compoundkin.view.sketch.circle_picture import circle_diagram
from compoundkin.view.sketch.graph_picture import graph
from compoundkin.view.sketch.groups_picture import apart
from compoundkin.view.sketch.loops_picture import loops, loops_in_graph
from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.scene import groups_of, numbers_of
from compoundkin.view.sketch.shown_pose import scene_of, solved_over

VIEWS = ("groups", "loops", "graph", "circle")


def draw_structure(what: Motion | Mechanism | Structure, view: str = "groups", *, size: float | None = None) -> Picture:
    """A picture of the structure of a mechanism.

    `view` is "groups", the mechanism taken apart: frame and driver, then each Assur group in solving order, the pairs
    by which it is attached to what stands before it in dashed circles; "loops", the independent loops as polygons of
    vectors; "graph", the kinematic graph of links and pairs; or "circle", the circle diagram of the instant centres.
    Raises InvalidInput for another view, or for the loops of a mechanism without any; NotDetermined where a mechanism
    that the drivers do not determine is asked for its groups or centres.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> draw_structure(crank, "graph").description
    '2 links, 1 pairs'
    """
    if view not in VIEWS:
        raise InvalidInput(Problem("view", f"there is no view {view!r}", nearest(str(view), list(VIEWS))))
    structure = _structure(what)
    if view == "loops":
        return _loops(what, structure, size)
    if structure.faults and view != "graph":
        # some of its pairs may be redundant, as solving finds
        motion = solved_over(structure.mechanism)
        structure = structure if motion is None else motion.structure
    if view == "graph":
        return graph(structure, numbers_of(structure), groups_of(structure), size)
    if structure.faults:
        problems = [Problem("structure", fault.text, fault.remedy) for fault in structure.faults]
        raise NotDetermined(problems, heading=f"{structure.mechanism.title!r} cannot be taken apart")
    if view == "circle":
        return circle_diagram(structure, numbers_of(structure), size)
    return apart(scene_of(what if isinstance(what, Motion) else structure.mechanism, None, None, 0), size)


def _loops(what: Motion | Mechanism | Structure, structure: Structure, size: float | None) -> Picture:
    """The loops on the mechanism; in its graph where it cannot be shown at any pose."""
    try:
        scene = scene_of(what, None, None, 0)
    except (InvalidInput, NotAssembled, NotDetermined):
        return loops_in_graph(structure, size)
    return loops(scene, size)


def _structure(what: Motion | Mechanism | Structure) -> Structure:
    if isinstance(what, Motion):
        return what.structure
    if not isinstance(what, Mechanism | Structure):
        raise InvalidInput(Problem("draw_structure", f"{what!r} is no mechanism", "load() one from a file"))
    return what if isinstance(what, Structure) else decompose(what)
