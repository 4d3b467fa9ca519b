"""What cam pairs have in common: a profile that leads a roller, a knife edge or a flat face."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from compoundkin.curves import Curve
from compoundkin.pairs.contact import Contact
from compoundkin.pairs.contract import Ends, Poses
from compoundkin.profiles import Profile
from compoundkin.series import Number


class Profiled(Contact):
    """A contact with a profile of the link `on`."""

    leads: ClassVar[bool] = True
    is_flat: ClassVar[bool]  # whether a flat face touches, which has no pitch curve

    profile: Profile

    @property
    def curve(self) -> Curve:
        """The profile as a curve."""
        return self.profile.curve

    @property
    def outward(self) -> float:
        """+1 where the follower is on the side to which the curve's normal points, else -1."""
        raise NotImplementedError

    @property
    def extent(self) -> float:
        """The diagonal of the box around the profile."""
        return self.curve.size

    @property
    def roller(self) -> float:
        """The radius of the roller, of several designs the greatest; 0 without one."""
        return 0.0

    @abstractmethod
    def parameter(self, ends: Ends, poses: Poses) -> Number:
        """The parameter of the profile at the contact."""

    @abstractmethod
    def led(self, ends: Ends, poses: Poses) -> Number:
        """The point of the follower that is led: the roller's middle or the edge; of a flat face the contact."""

    def stretch(self, ends: Ends, poses: Poses) -> Number:
        """Between which of the places where the profile's derivatives jump the contact is."""
        return self.curve.stretch(self.parameter(ends, poses))
