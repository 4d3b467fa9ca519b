"""A scene in numbers with notes: points, sides of pairs and poses as inputs of what draws a mechanism anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.poses import FIXED, End, Pose
from compoundkin.base.series import Number, Series, constant
from compoundkin.kinematics import Motion
from compoundkin.model.elements import FRAME
from compoundkin.model.outlines.outline_shapes import outline_shapes
from compoundkin.model.pairs.contract import Ends
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.recorded_dimensions import recorded_ends, recorded_geometry
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.view.sketch.noted_numbers import noted
from compoundkin.view.sketch.scene import Scene

# What the pose of a link is told by: the place of its origin, the unit vector of its angle.
POSE = "pose"
PLACE, TURN = ("x", "y"), ("cos", "sin")


def noted_scene(scene: Scene, motion: Motion, free: Sequence[FreeDimension]) -> tuple[Scene, OperationGraph]:
    """Return a scene in numbers with notes, and the graph of these.

    Inputs are the dimensions that are free, and the poses of the links along the motion, which is of one design.
    """
    graph = OperationGraph()
    geometry = recorded_geometry(graph, motion.mechanism.geometry, free)
    ends = recorded_ends(graph, motion.solving_order, geometry, free, motion.inputs.ends)
    points = {
        link: {letter: _noted(graph, p, geometry.points[link][letter]) for letter, p in own.items()}
        for link, own in scene.points.items()
    }
    sides = {name: _sides(graph, own, ends.get(name, own)) for name, own in scene.ends.items()}
    whole = {name: _along(graph, name, pose) for name, pose in scene.whole.items()}
    own = outline_shapes(motion.mechanism, points, motion.shape)
    return replace(scene, points=points, ends=sides, whole=whole, outlines=own), graph


def _noted(graph: OperationGraph, value: Number, recorded: Any) -> Any:
    """A number with its note; the mechanism's own number where it cannot change."""
    if value is None or np.ndim(value):
        return value
    note = recorded.c[0] if isinstance(recorded, Series) else recorded
    if not isinstance(note, RecordedNumber):
        note = RecordedNumber(graph, graph.constant(0.0)).like(value)
    return noted(value, note)


def _sides(graph: OperationGraph, own: Ends, recorded: Ends) -> Ends:
    both = zip(own, recorded, strict=True)
    return tuple(End(*(_noted(graph, *parts) for parts in zip(one, other, strict=True))) for one, other in both)


def _along(graph: OperationGraph, link: str, pose: Pose) -> Pose:
    """The poses of a link along the motion. Those of the frame are no inputs, nor are counted turns."""
    if link == FRAME:
        return FIXED
    z, u = (
        constant(noted(one.c[0], RecordedNumber.given(graph, *(InputNumber(POSE, link, part) for part in parts))))
        for one, parts in ((pose.z, PLACE), (pose.u, TURN))
    )
    return Pose(z, u, pose.theta)
