"""Springs between points of two links, and along the coordinate of a pair."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem, suggestion
from compoundkin.model.fields import NameWording, value_key
from compoundkin.model.geometry import FRAME, real
from compoundkin.model.loads.amounts import Amount, LoadFunction, LoadTable, as_amount, needs_rates, value_of
from compoundkin.model.loads.attachments import (
    VARIABLES,
    EndSeparation,
    PairLoad,
    PointToPointLoad,
    attachment_point,
    check_ends,
)
from compoundkin.model.loads.contract import COORDINATE, Load, LoadedPoses, NamedParts

TENSION, COMPRESSION = "tension", "compression"
_STIFFNESS = "Force or torque for a unit of extension, or the force itself as a table over that."
_PRELOAD = "Its pull where it has its free length or angle."
_ONLY = 'Whether it acts in "tension" or in "compression" only.'


@dataclass(frozen=True, eq=False, repr=False)
class Spring(PointToPointLoad):
    """A spring between points of two links, which pulls with stiffness times extension, plus a preload.

    >>> spring("arm", "A", at="S", stiffness=900, free_length=0.2).name
    'spring on arm'
    """

    stiffness: Amount = field(kw_only=True, metadata=value_key("amount", _STIFFNESS))
    free_length: Number = field(default=0.0, kw_only=True, metadata=value_key("length", "Its length without load."))
    preload: Number = field(default=0.0, kw_only=True, metadata=value_key("length", _PRELOAD))
    only: str | None = field(default=None, kw_only=True, metadata=value_key("name", _ONLY))

    title: ClassVar[str] = "spring"
    table: ClassVar[str] = "springs"
    wording: ClassVar[NameWording] = NameWording(verb="pull", two_links="a spring has its ends on two links")
    amounts: ClassVar[tuple[str, ...]] = ("stiffness",)
    own_variable: ClassVar[str] = "extension"

    @property
    def needs_rates(self) -> bool:
        """Whether its force depends on its speed of extension."""
        return needs_rates(self.stiffness)

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown ends, a negative length, an unknown sense."""
        yield from super().problems(written, where)
        yield from side_problems(self.only, where)
        if np.any(np.asarray(self.free_length) < 0.0):
            yield Problem(f"{where}.free_length", "a length is not negative", "give a preload instead")

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the extension and its speed."""
        gap = self.gap(at)
        return {"extension": lambda: gap.length - at.fitted(self.free_length), "rate": lambda: gap.rate}

    def pull(self, gap: EndSeparation, at: LoadedPoses) -> Number:
        """Return its force, exact where the ends of a spring without free length coincide."""
        preload, free = (at.fitted(value, self.where) for value in (self.preload, self.free_length))
        extension = gap.length - free
        if is_force_law(self.stiffness):
            pull = value_of(self.where, self.stiffness, at, self.variables(at)) + preload
            return gap.along(one_sided_pull(pull, self.only), self.where)
        stiffness = at.fitted(self.stiffness, self.where)
        # the part in proportion to the length needs no direction
        force = stiffness * gap.vector + gap.along(preload - stiffness * free, self.where)
        return (
            force if self.only is None else np.where(is_active(stiffness * extension + preload, self.only), force, 0.0)
        )

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return its energy, zero at its free length; None where its force is a function or a table."""
        if is_force_law(self.stiffness):
            return None
        extension = self.gap(at).length - at.fitted(self.free_length)
        return stored_energy(at.fitted(self.stiffness), at.fitted(self.preload), extension, self.only)


@dataclass(frozen=True, eq=False, repr=False)
class PairSpring(PairLoad):
    """A spring along the free coordinate of a pair.

    It is a torsion spring at a pin, or a spring along a slide. It drives the coordinate down with stiffness times the
    excess over `free`, plus a preload.
    """

    stiffness: Amount = field(kw_only=True, metadata=value_key("amount", _STIFFNESS))
    free: Number = field(
        default=0.0, kw_only=True, metadata=value_key("coordinate", "The coordinate without load; degrees of an angle.")
    )
    preload: Number = field(default=0.0, kw_only=True, metadata=value_key("length", _PRELOAD))
    only: str | None = field(default=None, kw_only=True, metadata=value_key("name", _ONLY))

    title: ClassVar[str] = "spring"
    table: ClassVar[str] = "springs"
    amounts: ClassVar[tuple[str, ...]] = ("stiffness",)
    own_variable: ClassVar[str] = COORDINATE

    @property
    def needs_rates(self) -> bool:
        """Whether its force depends on its speed of extension."""
        return needs_rates(self.stiffness)

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find an unknown pair, and an unknown sense."""
        yield from super().problems(written, where)
        yield from side_problems(self.only, where)

    def variables(self, at: LoadedPoses) -> Mapping[str, Callable[[], Number]]:
        """Return the excess of the coordinate over its free one, and its rate."""
        own = super().variables(at)
        return {"extension": lambda: own[COORDINATE]() - at.fitted(self.free, self.where), "rate": own["rate"]}

    def effort(self, at: LoadedPoses) -> Number:
        """Return its effort, against the excess of the coordinate over its free one."""
        own, preload = self.variables(at), at.fitted(self.preload, self.where)
        if is_force_law(self.stiffness):
            return 0.0 - one_sided_pull(value_of(self.where, self.stiffness, at, own) + preload, self.only)
        return 0.0 - one_sided_pull(at.fitted(self.stiffness, self.where) * own["extension"]() + preload, self.only)

    def energy(self, at: LoadedPoses) -> Number | None:
        """Return its energy, zero at its free coordinate; None where its effort is a function or a table."""
        if is_force_law(self.stiffness):
            return None
        extension = at.coordinate(self.pair).c[0] - at.fitted(self.free)
        return stored_energy(at.fitted(self.stiffness), at.fitted(self.preload), extension, self.only)


def as_spring(load: Load) -> Spring | PairSpring | None:
    """Return a load as a spring, or None."""
    return load if isinstance(load, Spring | PairSpring) else None


def is_force_law(stiffness: Amount) -> bool:
    """Return whether a stiffness gives the force itself, as a function or a table."""
    return isinstance(stiffness, LoadFunction | LoadTable)


def is_active(pull: Number, only: str | None) -> Number:
    """Return where a one-sided spring acts; also where its pull is not a number."""
    return np.logical_not(np.less_equal(pull, 0.0) if only == TENSION else np.greater_equal(pull, 0.0))


def one_sided_pull(pull: Number, only: str | None) -> Number:
    """Return the pull of a spring that may act one way only."""
    return pull if only is None else np.where(is_active(pull, only), pull, 0.0)


def stored_energy(stiffness: Number, preload: Number, extension: Number, only: str | None) -> Number:
    """Return the energy of a spring; that of a one-sided spring stays where it no longer acts."""
    whole = (stiffness * extension / 2.0 + preload) * extension
    if only is None:
        return whole
    with np.errstate(all="ignore"):
        released = np.where(np.asarray(stiffness) == 0.0, 0.0, -np.square(preload) / (2.0 * np.asarray(stiffness)))
    return np.where(is_active(stiffness * extension + preload, only), whole, released)


def side_problems(only: str | None, where: str) -> Iterator[Problem]:
    """Find an unknown sense of a one-sided spring."""
    if only not in (None, TENSION, COMPRESSION):
        yield Problem(
            f"{where}.only", f"a spring does not act in {only!r} only", suggestion(only, [TENSION, COMPRESSION])
        )


@checked
def spring(
    link: str = "", point: Any = "", *, to: str = FRAME, at: Any = "", pair: str = "",
    stiffness: Any, free_length: Any = 0.0, free: Any = 0.0, preload: Any = 0.0, only: str | None = None,
    name: str = "",
) -> Spring | PairSpring:  # fmt: skip
    """Return a spring between points of two links, or along a pair.

    ``spring("arm", "A", to="frame", at="S", stiffness=900, free_length=0.2)`` pulls the point A of the arm and the
    point S of the frame together with stiffness times extension plus `preload`; points are letters, or places in their
    links' frames. ``spring(pair="C", stiffness=5, free=0.3)`` drives the coordinate of a pair down by stiffness times
    its excess over `free` (radians or a length): a torsion spring at a pin, a spring along a slide. A `stiffness`
    that is a function of extension ``q``, rate ``w``, time ``t``, or a table over the extension, gives the
    force itself. With ``only="tension"`` or ``"compression"`` it acts in that sense only. Numbers, or arrays for
    designs.

    Raises InvalidMechanism for ends of both sorts.

    >>> spring("arm", "A", to="frame", at="S", stiffness=900, free_length=0.2, only="tension").only
    'tension'
    >>> spring(pair="C", stiffness=5, free=0.3).name
    'spring along C'
    """
    where = f"springs.{name or pair or link}"
    force = as_amount(f"{where}.stiffness", stiffness, "extension", *VARIABLES[1:])
    drawn = real(f"{where}.preload", preload)
    ends = {"link": link, "point": point, "at": at, "free_length": free_length} if pair else {"free": free}
    check_ends(where, pair, link, ends)
    if pair:
        return PairSpring(pair, stiffness=force, free=real(f"{where}.free", free), preload=drawn, only=only, name=name)
    one, other = (attachment_point(f"{where}.{key}", spot) for key, spot in (("point", point), ("at", at)))
    length = real(f"{where}.free_length", free_length)
    return Spring(link, one, to=to, at=other, stiffness=force, free_length=length, preload=drawn, only=only, name=name)
