"""An objective recorded: a user's function of one pose, run once on numbers that note what is done with them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem, UnknownName, nearest
from compoundkin.programs.graph.input_kinds import PARAMETER
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.recording.numpy_answers import one_pose
from compoundkin.programs.recording.recorded_number import RecordedNumber

# What an objective reads besides outputs and what it is given.
ASSEMBLED = "assembled"


class ObjectivePose:
    """One pose of a path, as an objective sees it.

    `at["G.position"]` is an output of the path, `at["target"]` what is given under this name with each call;
    `at.assembled`, or `at["assembled"]`, tells whether the pose is.
    """

    def __init__(self, known: Mapping[str, RecordedNumber], assembled: RecordedNumber) -> None:
        self._known = {**known, ASSEMBLED: assembled}
        self.read: set[str] = set()

    def __getitem__(self, name: str) -> RecordedNumber:
        """Return an output of the path, or what is given with the call."""
        if name not in self._known:
            what = "it is no output of the path, and was not given with the call"
            raise UnknownName(Problem(str(name), what, nearest(name, list(self._known))))
        self.read.add(name)
        return self._known[name]

    @property
    def assembled(self) -> RecordedNumber:
        """Whether the pose is assembled."""
        return self[ASSEMBLED]

    def __repr__(self) -> str:
        return f"ObjectivePose({', '.join(self._known)})"


def parameter(graph: OperationGraph, name: str, is_complex: bool) -> RecordedNumber:
    """Return what is given under a name with a call, as a recorded number."""
    return RecordedNumber.given(graph, *parts(name, is_complex))


def parts(name: str, is_complex: bool) -> tuple[InputNumber, ...]:
    """Return the real numbers that are given under a name."""
    return tuple(InputNumber(PARAMETER, name, part) for part in (("x", "y") if is_complex else ("",)))


def recorded_cost(
    function: Callable[[ObjectivePose], Any],
    graph: OperationGraph,
    outputs: Mapping[str, RecordedNumber],
    given: Mapping[str, bool],
    assembled: RecordedNumber,
) -> int:
    """Return the node of what an objective says of one pose.

    `given` tells of each name given with the call whether it is complex. Raises InvalidInput for what cannot be
    recorded, UnknownName for what is not read or not there.
    """
    taken = [Problem(name, "the pose has this by itself", "give it another name") for name in _own(outputs, given)]
    if taken:
        raise InvalidInput(taken)
    pose = ObjectivePose({**outputs, **{name: parameter(graph, name, c) for name, c in given.items()}}, assembled)
    try:
        with one_pose():
            cost = assembled.like(function(pose))
    except CompoundkinError:
        raise
    except (TypeError, AttributeError, ValueError, OverflowError) as error:
        what = f"it cannot be recorded: {error}"
        remedy = "write it of one pose, in arithmetic and NumPy's functions of numbers; np.where instead of if"
        raise InvalidInput(Problem("objective", what, remedy)) from error
    unread = [name for name in given if name not in pose.read]
    if unread:
        what, read = "the objective does not read it", [name for name in pose.read if name not in outputs]
        raise UnknownName([Problem(name, what, nearest(name, read)) for name in unread])
    if cost.y is not None:
        raise InvalidInput(Problem("objective", "its value is complex", "take abs(...) ** 2, or a .real part"))
    if graph.is_truth(cost.x):
        return graph.apply("select", cost.x, graph.constant(1.0), graph.constant(0.0))
    return cost.x


def _own(outputs: Mapping[str, RecordedNumber], given: Mapping[str, bool]) -> list[str]:
    """Return what is given under a name that means something already."""
    return [name for name in given if name in outputs or name == ASSEMBLED]
