"""What a study finds of each design: a curve along the motion or a figure, with its slopes by the free dimensions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from compoundkin.base.arrays import Number
from compoundkin.model.attributes import Dimension
from compoundkin.studies.responses.designs import Designs


@dataclass(frozen=True)
class Response(ABC):
    """What is asked of every design by a name: "G.position", "ram.stroke".

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
        """Return its values; NaN where there is none.

        They are (designs,) of a figure, (designs, poses) of a course.
        """

    @property
    def has_slopes(self) -> bool:
        """Whether its slopes are known exactly."""
        return True

    @abstractmethod
    def slopes(self, designs: Designs) -> Number:
        """Return its slopes by the coordinates of the designs.

        They are (coordinates, designs), and poses for a course.
        """
