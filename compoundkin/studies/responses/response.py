"""Response: values of a curve along the motion or of a figure for each design, with slopes by free dimensions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import Dimension
from compoundkin.programs.backends.runner import THREAD_TURNS
from compoundkin.programs.derivatives.path_objective import ComputedSum
from compoundkin.studies.responses.designs import Designs


@dataclass(frozen=True)
class Response(ABC):
    """An output of every design by its name: "G.position", "ram.stroke".

    `needs` are the outputs of the compiled path that it reads. A course has a value at every pose, a figure one for
    each design. `unit` is that of its values, radians for angles.
    """

    name: str
    needs: tuple[str, ...] = ()
    unit: str = ""
    dimension: Dimension = "number"
    is_course: bool = False
    is_vector: bool = False

    @abstractmethod
    def values(self, designs: Designs) -> Number:
        """Return its values, NaN where undefined: (designs,) of a figure, (designs, poses) of a course."""

    @property
    def has_slopes(self) -> bool:
        """Whether its slopes are known exactly."""
        return True

    @abstractmethod
    def slopes(self, designs: Designs) -> Number:
        """Return its slopes by the coordinates of the designs.

        They are (coordinates, designs), and poses for a course.
        """


@dataclass(frozen=True)
class CourseResponse(Response):
    """A quantity along the motion, (designs, poses)."""

    is_course: bool = True

    def values(self, designs: Designs) -> Number:
        """Return its values at all poses."""
        return np.asarray(designs.outputs[self.name])

    def slopes(self, designs: Designs) -> Number:
        """Return its slopes at all poses, (coordinates, designs, poses)."""
        return np.array([designs.slopes[self.name, by] for by in designs.path.coordinates])


@dataclass(frozen=True, eq=False)
class SummedResponse(Response):
    """A function of each pose, summed over the poses, (designs,).

    The function reads outputs by name, and the data `given`: numbers, or arrays along the motion.
    """

    function: Callable[[Any], Any] = abs
    given: Mapping[str, Any] = field(default_factory=dict)

    def values(self, designs: Designs) -> Number:
        """Return the sum of each design, NaN where a pose is not assembled, unless the function skips it."""
        return np.asarray(self._computed(designs, False).value)

    def slopes(self, designs: Designs) -> Number:
        """Return its slopes, (coordinates, designs)."""
        by = self._computed(designs, True).slopes
        found = []
        for name, factor in designs.path.directions.values():
            slope = np.broadcast_to(by[name], designs.number)
            found.append(slope.imag if factor == 1j else slope.real)
        return np.array(found)

    def _computed(self, designs: Designs, is_sloped: bool) -> ComputedSum:
        objective = designs.path.objective(self.function)
        with THREAD_TURNS.left():
            found = objective.computed(designs.arguments, self.given, is_sloped)
        designs.note_limits(found.is_clear)
        return found


def summed_response(motion: Motion, name: str, function: object, given: Mapping[str, Any]) -> Response:
    """Return a function of each pose as a response.

    It has only those of the given data that it reads. Raises UnknownName for unknown quantities, InvalidInput for an
    object that is not callable.
    """
    if not callable(function):
        what = f"{function!r} is no function of a pose"
        raise InvalidInput(Problem(f"outputs.{name}", what, 'lambda at: abs(at["G.position"] - at["target"]) ** 2'))
    pose = ReadPose(motion, given)
    try:
        with np.errstate(all="ignore"):
            function(pose)
    except CompoundkinError:
        raise
    except (TypeError, AttributeError, ValueError, ArithmeticError):
        # reported when the function is recorded, as for objectives
        pass
    own = {one: given[one] for one in given if one in pose.read}
    return SummedResponse(name, tuple(one for one in pose.read if one not in given), function=function, given=own)


class ReadPose:
    """The first pose of a motion for a user's function; `read` are the names that it has used."""

    def __init__(self, motion: Motion, given: Mapping[str, Any]) -> None:
        self._motion, self._given = motion, given
        self.read: list[str] = []

    def __getitem__(self, name: str) -> Any:
        """Return a quantity at the first pose, or given data, by name."""
        if name == "assembled":
            return self.assembled
        if name not in self.read:
            self.read.append(name)
        values = self._given[name] if name in self._given else quantity(self._motion, name).values
        return np.ravel(values)[0].item()

    @property
    def assembled(self) -> bool:
        """Whether the pose is assembled."""
        return True
