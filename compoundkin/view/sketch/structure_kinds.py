"""The pictures of a structure that are asked for: taken apart, its loops, its graph, the circle of its centres."""

from __future__ import annotations

from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined, Problem
from compoundkin.kinematics import Motion
from compoundkin.structure import Structure
from compoundkin.view.sketch.asked_values import Drawable, structure_of
from compoundkin.view.sketch.graph_picture import graph
from compoundkin.view.sketch.groups_in_graph import groups_in_graph
from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.scene import groups_of, numbers_of
from compoundkin.view.sketch.shown_pose import Wishes, scene_of
from compoundkin.view.sketch.structure_pictures import groups_picture, loops, loops_in_graph


def groups_apart(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the mechanism taken apart into groups.

    They are drawn in its graph where it cannot be shown at any pose.
    """
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


def circle_of_centres(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the circle diagram of the instant centres."""
    # late: other pictures need none of this
    from compoundkin.view.sketch.centre_pictures import circle_diagram

    structure = _taken_apart(what)
    return circle_diagram(structure, numbers_of(structure), wishes.size)


def kinematic_graph(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the graph of links and pairs."""
    structure = structure_of(what)
    return graph(structure, numbers_of(structure), groups_of(structure), wishes.size)


def independent_loops(what: Drawable, wishes: Wishes) -> Picture:
    """Draw the loops on the mechanism.

    They are drawn in its graph where it cannot be shown at any pose.
    """
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
