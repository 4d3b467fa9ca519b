"""Drivers' values, rates, laws and times: read from a call and a mechanism, in one form of designs x poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import isfinite, prod
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arguments import real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.base.poses import End
from compoundkin.base.series import Series, taylor
from compoundkin.kinematics.block import between_poses, picked, picked_slope, rates, rectangle, repeated, slope
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.attributes import HIGHEST_ORDER, OF_POINTS
from compoundkin.model.elements import Drive
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.contract import Ends

if TYPE_CHECKING:
    from compoundkin.model.laws import Law

# A period is sampled as finely as a full turn in steps of five degrees.
SAMPLES = 73


# Value, speed, acceleration and jerk.
RATES = 4


# A full turn in steps of five degrees: what a driver of a pin does when it is not told otherwise.
FULL_TURN = np.deg2rad(np.arange(0.0, 361.0, 5.0))


FULL_TURN.setflags(write=False)


def inputs(
    solving_order: SolvingOrder,
    values: Mapping[str, Any] | None,
    speed: Any,
    acceleration: Any,
    jerk: Any,
    times: Number | None = None,
    order: int = RATES - 1,
    drives: Sequence[Drive] | None = None,
) -> Inputs:
    """Return the inputs of a solution, in time where `times` are given.

    `drives` may replace the mechanism's own. Raises InvalidInput for unknown drivers or shapes that do not fit.
    """
    mechanism = solving_order.structure.mechanism
    asked = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk}
    _only_known(mechanism, asked)
    given = {one.name: _driver(solving_order, one, asked, times, order) for one in drives or mechanism.drives}
    shape = _shape(solving_order, given)
    fitted = fit(shape)
    driven = {k: tuple(fitted(v) for v in vs) for k, vs in given.items()}
    return Inputs(shape, _fitted_ends(solving_order, fitted), driven)


def _fitted_ends(solving_order: SolvingOrder, fitted: Callable[[Number], Number]) -> Mapping[str, Ends]:
    """Return the pairs' dimensions in the form of the inputs; all numbers are that form already."""
    if solving_order.is_of_numbers:
        return solving_order.ends
    return {k: tuple(mapped(end, fitted) for end in ends) for k, ends in solving_order.ends.items()}


def by_name(mechanism: Mechanism, values: Any) -> Mapping[str, Any] | None:
    """Return the values of the drivers by name. Those of the only one may go without; raises InvalidInput."""
    if values is None or isinstance(values, Mapping):
        return values
    if len(mechanism.drives) != 1:
        raise InvalidInput(Problem("values", "there is more than one driver", "name them: {'driver': ...}"))
    return {mechanism.drives[0].name: values}


def _driver(
    solving_order: SolvingOrder, drive: Drive, asked: Mapping[str, Any], times: Number | None, order: int
) -> tuple[Number, ...]:
    """Value, speed, acceleration and jerk of a driver; those of a law beyond the order are not asked for."""
    value = (asked["values"] or {}).get(drive.name, drive.values)
    if value is None:
        value = _unsaid(solving_order, drive) if times is None else 0.0
    only = len(solving_order.structure.driven) == 1
    rest = [_rate(drive, asked[key], getattr(drive, key), only) for key in ("speed", "acceleration", "jerk")]
    given = tuple(_number(f"{drive.name}", v) for v in (value, *rest))
    if times is None:
        return given
    called = {key: drive.name in what if isinstance(what, Mapping) else what is not None for key, what in asked.items()}
    return timed(drive, given, times, called, order)


def _unsaid(solving_order: SolvingOrder, drive: Drive) -> Number:
    """Return the values of a driver that is given none: a full turn."""
    if not solving_order.structure.driven_angles[drive.name]:
        raise InvalidInput(
            Problem(f"drives.{drive.name}", "it has no values", f"solve(..., {{{drive.name!r}: lengths}})")
        )
    return FULL_TURN


def _rate(drive: Drive, what: Any, default: Number, only: bool) -> Any:
    if what is None:
        return default
    if isinstance(what, Mapping):
        return what.get(drive.name, default)
    if only:
        return what
    raise InvalidInput(
        Problem("speed", "there are several drivers", f"give one for each by name: {{{drive.name!r}: ...}}")
    )


def _number(where: str, value: Any) -> Number:
    if type(value) is float and isfinite(value):
        return value
    out = real_numbers(where, value)
    if out.size == 0 or not np.isfinite(out).all():
        raise InvalidInput(Problem(where, "the value is empty or not finite"))
    return float(out) if out.ndim == 0 else out


def _only_known(mechanism: Mechanism, given: Mapping[str, Any]) -> None:
    names = [d.name for d in mechanism.drives]
    wrong = [
        Problem(f"{what}.{name}", f"there is no driver {name!r}", suggestion(name, names))
        for what, table in given.items()
        if isinstance(table, Mapping)
        for name in table
        if name not in names
    ]
    if wrong:
        raise InvalidInput(wrong)


def _shape(solving_order: SolvingOrder, drives: Mapping[str, tuple[Number, ...]]) -> tuple[int, ...]:
    found: tuple[int, ...] = ()
    named = [(f"drives.{k}", v) for k, vs in drives.items() for v in vs if isinstance(v, np.ndarray)]
    for where, value in (*named, *solving_order.dimension_arrays):
        try:
            found = np.broadcast_shapes(found, np.shape(value))
        except ValueError:
            raise InvalidInput(
                Problem(
                    where, f"shape {np.shape(value)} does not broadcast with {found}", "the last axis is the motion"
                )
            ) from None
    return found


def times_of(
    mechanism: Mechanism, values: Mapping[str, Any] | None, time: Any, drives: Sequence[Drive] | None = None
) -> Number | None:
    """Return the times of a motion; None where the drivers' values are given instead.

    They are `time`, else those that the mechanism states, else 73 over the range on which all laws agree; `drives` may
    replace its own. Raises InvalidInput for times that are not numbers, and where laws need times that nothing tells.

    >>> from compoundkin.model.laws import program, rise
    >>> from compoundkin.model.elements import drive, link
    >>> law = program(rise(1.0, over=2.0))
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=1), drive("crank", law=law))
    >>> float(times_of(crank, None, None)[-1])
    2.0
    """
    if time is not None:
        return _checked(time)
    laws = {d.name: d.law for d in drives or mechanism.drives if d.law is not None}
    known = values or {}
    if known and all(name in known for name in laws):
        return None
    if mechanism.time is not None:
        return _checked(mechanism.time)
    return _agreed(laws) if laws else None


def _checked(time: Any) -> Number:
    out = real_numbers("time", time)
    if out.size == 0 or not np.isfinite(out).all():
        raise InvalidInput(Problem("time", "the times are empty or not finite", "give seconds, in order of the motion"))
    return out


def _agreed(laws: Mapping[str, Law]) -> Number:
    spans = list(dict.fromkeys(law.span for law in laws.values()))
    if len(spans) == 1 and spans[0] is not None:
        return np.linspace(*spans[0], SAMPLES)
    told = ", ".join(f"{name} from {law.span[0]:g} to {law.span[1]:g} s" for name, law in laws.items() if law.span)
    what = f"the laws have different ranges: {told}" if told else "nothing tells for how long the drivers move"
    raise InvalidInput(
        Problem("time", what, "give time=numpy.linspace(0, 2, 201), --time 0:2:0.01, or time in the file")
    )


def timed(
    drive: Drive, given: tuple[Number, ...], times: Number, asked: Mapping[str, bool], order: int
) -> tuple[Number, ...]:
    """Return value, speed, acceleration and jerk of a driver at times.

    `given` are those without a law, from which the driver moves as a polynomial in time; `asked` tells which of
    them the call gives. Raises InvalidInput where a driver has a law and is given them as well, or where they vary
    along the motion.
    """
    if drive.law is not None:
        for what in [key for key, called in asked.items() if called]:
            remedy = f"leave the {what} out, or give values for every driver and no time"
            raise InvalidInput(Problem(f"{what}.{drive.name}", "the driver moves by its law in time", remedy))
        return _by_law(drive, times, order)
    if (
        isinstance(times, np.ndarray)
        and all(type(one) is float for one in given)
        and given[1]
        and given[2:] == (0.0, 0.0)
    ):
        # uniform motion: what the polynomial below is then
        value, speed = given[:2]
        moved = speed * times
        moved += value
        return moved, *given[1:]
    for what, value in zip(asked, given, strict=True):
        if type(value) is not float and np.shape(value)[-1:] > (1,):
            text = f"its {what} {'vary' if what == 'values' else 'varies'} along the motion, which the times do already"
            remedy = "give a single number, where it is at time 0, or a law" if what == "values" else "give one number"
            raise InvalidInput(Problem(f"drives.{drive.name}.{what}", text, remedy))
    moved = taylor(given, times, RATES - 1)
    return tuple(moved.derivative(k) for k in range(RATES))


def _by_law(drive: Drive, times: Number, order: int) -> tuple[Number, ...]:
    law: Any = drive.law
    try:
        moved = law.coordinate(times, order)
    except InvalidInput as error:
        problems = [replace(p, where=f"drives.{drive.name}.{p.where}") for p in error.problems]
        raise InvalidInput(problems) from error.__cause__
    return tuple(moved.derivative(k) for k in range(RATES))


@dataclass(frozen=True, repr=False)
class Inputs(ShortRepr):
    """All numbers of a solution. Every entry is a number, or an array of shape (1 or designs, 1 or poses).

    `ends` are the pairs' dimensions; `drives[name]` the value, speed, acceleration and jerk of a driver.
    """

    shape: tuple[int, ...]
    ends: Mapping[str, Ends]
    drives: Mapping[str, tuple[Number, ...]]

    @property
    def designs(self) -> int:
        """How many designs: the product of all axes but the last."""
        return prod(self.shape[:-1])

    @property
    def poses(self) -> int:
        """How many poses each design has: the length of the last axis."""
        return self.shape[-1] if self.shape else 1

    def cut(self, designs: slice, poses: slice) -> Inputs:
        """Return a rectangle of designs and poses."""
        return self._each(lambda v: rectangle(v, designs, poses))

    def at(self, s: Number) -> Inputs:
        """Return all designs at places `s` (1-D) along the motion. Fractional ones are in between poses.

        The drivers' speeds are then the slopes with respect to `s`.
        """
        i = self._interval(np.floor(s))
        between = self._each(lambda v: between_poses(v, i, s - i))
        slopes = {k: (between.drives[k][0], slope(v[0], i)) for k, v in self.drives.items()}
        return replace(between, drives=slopes)

    def pick(self, designs: Number, s: Number) -> Inputs:
        """Return one pose of each of some designs, `s` its place, as a column."""
        i = self._interval(np.floor(s))
        return self._each(lambda v: picked(v, designs, i, s - i))

    def ahead(self, designs: Number, s: Number) -> Inputs:
        """Do as `pick`. The drivers' speeds are the slopes with respect to `s`, of the way on from there."""
        return self._sloped(designs, s, self._interval(np.floor(s)))

    def _interval(self, start: Number) -> Number:
        return np.clip(start.astype(int), 0, max(self.poses - 2, 0))

    def _sloped(self, designs: Number, s: Number, i: Number) -> Inputs:
        at = partial(picked, designs=designs, i=i, weight=s - i)
        drives = {name: (at(v), picked_slope(v, designs, i)) for name, (v, *_) in self.drives.items()}
        return replace(self, ends=self._ends(at), drives=drives)

    def driven(self, drives: Mapping[str, tuple[Number, ...]]) -> Inputs:
        """Return the same dimensions with other driver values."""
        return self._made(self.shape, self.ends, drives)

    def with_dimensions(self, change: Callable[[Number], Number]) -> Inputs:
        """Return the same drivers with every dimension changed."""
        return self._made(self.shape, self._ends(change), self.drives)

    def repeated(self, copies: int) -> Inputs:
        """Return so many copies of all designs, one after another."""
        return self._each(partial(repeated, copies=copies))

    def of_poses(self, count: int) -> Inputs:
        """Return the same numbers, as a motion of `count` poses."""
        return self._made((*self.shape[:-1], count), self.ends, self.drives)

    def series(self, order: int) -> dict[str, Series]:
        """Return the drivers as series."""
        return {name: rates(values, order) for name, values in self.drives.items()}

    @property
    def is_rigid(self) -> bool:
        """Whether no dimension varies along the motion."""
        values = (v for ends in self.ends.values() for end in ends for v in end if isinstance(v, np.ndarray))
        return all(v.shape[-1] == 1 for v in values)

    @cached_property
    def _rigid(self) -> bool:
        """Whether every dimension is a number."""
        return not any(isinstance(v, np.ndarray) for ends in self.ends.values() for end in ends for v in end)

    def _each(self, change: Any) -> Inputs:
        drives = {k: tuple([change(v) for v in vs]) for k, vs in self.drives.items()}
        return self._made(self.shape, self._ends(change), drives)

    def _made(
        self, shape: tuple[int, ...], ends: Mapping[str, Ends], drives: Mapping[str, tuple[Number, ...]]
    ) -> Inputs:
        """Return other inputs; of the same dimensions is known whether each is a number."""
        made = Inputs(shape, ends, drives)
        if ends is self.ends and "_rigid" in self.__dict__:
            made.__dict__["_rigid"] = self._rigid
        return made

    def _ends(self, change: Any) -> Mapping[str, Ends]:
        if self._rigid:
            return self.ends
        return {name: tuple(mapped(end, change) for end in sides) for name, sides in self.ends.items()}


@dataclass(frozen=True, repr=False)
class PoseGrid(ShortRepr):
    """The form in which a motion shows its numbers.

    Its shape, the order it was solved to, and which poses do not close.
    """

    shape: tuple[int, ...]
    order: int
    failed: Number  # (designs, poses)

    def require(self, order: int) -> None:
        """Raise InvalidInput for a derivative that was not solved for."""
        if isinstance(order, bool) or not isinstance(order, int | np.integer):
            raise InvalidInput(Problem("order", f"{order!r} is not an order", f"0 to {self.order}"))
        if not 0 <= order <= self.order:
            known = 0 <= order <= HIGHEST_ORDER
            what = OF_POINTS[order] if known else f"derivative {order}"
            remedy = f"solve(..., order={order})" if known else f"0 to {HIGHEST_ORDER}"
            raise InvalidInput(Problem(what, f"the motion was solved to order {self.order}", remedy))

    def shaped(self, value: Number) -> Number:
        """Return a value (1 or designs, 1 or poses) in the motion's shape."""
        return np.broadcast_to(value, self.failed.shape).reshape(self.shape)

    def known(self, value: Number) -> Number:
        """Return a value in the motion's shape, NaN at unassembled poses."""
        shaped = self.shaped(value)
        if not self.failed.any():
            return shaped
        nothing = complex(np.nan, np.nan) if np.iscomplexobj(shaped) else np.nan
        return np.where(self.shaped(self.failed == 0), shaped, nothing)

    def fitted(self, value: Number) -> Number:
        """Return a value as (1 or designs, 1 or poses). It must broadcast with the motion."""
        try:
            np.broadcast_to(value, self.shape)
        except ValueError:
            what = f"shape {np.shape(value)} does not broadcast with {self.shape}"
            raise InvalidInput(Problem("point", what, "the last axis is the motion")) from None
        return fit(self.shape)(value)


def mapped(end: End, change: Any) -> End:
    """Return an end with every number of it changed."""
    return End(*(None if value is None else change(value) for value in end))


def fit(shape: tuple[int, ...]) -> Callable[[Number], Number]:
    """Bring a value into the form (1 or designs, 1 or poses). Numbers stay numbers."""
    designs = prod(shape[:-1])

    def fitted(value: Number) -> Number:
        if isinstance(value, (complex, float, int)):
            return value
        if np.ndim(value) == 0:
            return value.item()
        array = np.asarray(value)
        last = array.shape[-1]
        if array.size == last:
            return array.reshape(1, last)
        return np.broadcast_to(array, (*shape[:-1], last)).reshape(designs, last)

    return fitted
