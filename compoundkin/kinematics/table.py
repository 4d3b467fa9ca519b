"""`Table`: columns of quantities of a motion, a row for each pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics.derived.contract import HasQuantities
from compoundkin.kinematics.quantities import Quantity, quantity, read_of
from compoundkin.kinematics.quantity_owners import owner_of
from compoundkin.model.attributes import TABULATED, TIME, VALUE, unit_of
from compoundkin.model.geometry import FRAME

ASSEMBLED, DESIGN = "assembled", "design"
# What files and data frames say of the angles in them.
ANGLES = "radians"


class AtPoses(HasQuantities, Protocol):
    """A motion: what has quantities, at poses."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of every array of the motion, the last axis its poses."""

    @property
    def order(self) -> int:
        """The highest derivative that is known."""

    @property
    def time(self) -> Number | None:
        """The times of the poses, where it is in time."""

    @property
    def assembled(self) -> Number:
        """Which poses are assembled."""


def data_frame(title: str, columns: Mapping[str, Any], units: Mapping[str, str]) -> Any:
    """Return columns as a pandas DataFrame.

    Its `attrs` hold the title, the units and how angles are counted. Raises InvalidInput where pandas is not installed.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise InvalidInput(Problem("", "this needs pandas", "pip install 'compoundkin[pandas]'")) from None
    frame = pandas.DataFrame(columns)
    frame.attrs = {"title": title, "angles": ANGLES, "units": dict(units)}
    return frame


@dataclass(frozen=True, eq=False, repr=False)
class Table:
    """Columns of real quantities, a row for each pose. The last axis of the motion, its poses, runs fastest.

    Where the motion has designs, index columns come first: `design`, or `design0`, `design1` ... Then come the time,
    if it has any, drivers, points (.x, .y), links, pairs, and whether each pose is `assembled`. Angles are radians, in
    `shown` degrees; rates are always by radians and seconds.
    """

    title: str
    columns: tuple[Quantity, ...]

    @cached_property
    def _named(self) -> Mapping[str, Quantity]:
        return {column.name: column for column in self.columns}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(self._named)

    @property
    def units(self) -> Mapping[str, str]:
        """The unit of every column that has one."""
        return {column.name: column.unit for column in self.columns if column.unit}

    @property
    def shown(self) -> Table:
        """As it is shown to people: angles in degrees."""
        return replace(self, columns=tuple(column.shown for column in self.columns))

    def __getitem__(self, name: str) -> Quantity:
        """Return a column by its name; raises UnknownName with the nearest there is."""
        if name not in self._named:
            raise UnknownName(Problem(str(name), "the table has no such column", suggestion(str(name), self.names)))
        return self._named[name]

    def __len__(self) -> int:
        return len(self.columns[-1].values)

    def to_pandas(self) -> Any:
        """Return it as a pandas DataFrame, angles in radians.

        Its `attrs` hold the title, the units and how angles are counted. Raises InvalidInput where pandas is not
        installed.
        """
        return data_frame(self.title, {column.name: column.values for column in self.columns}, self.units)

    def __repr__(self) -> str:
        return f"Table({self.title!r}: {len(self)} rows of {len(self.columns)} columns)"


def table_of(motion: AtPoses, *names: str) -> Table:
    """Return the table of the quantities named, with designs, time and drivers.

    Everything where none is named. Raises UnknownName for a quantity that the motion does not have.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> found = table_of(solve(crank, {"crank": [0.0, 1.0]}), "B.velocity")
    >>> found, found.names
    (Table('m': 2 rows of 4 columns), ('crank.value', 'B.velocity.x', 'B.velocity.y', 'assembled'))
    >>> found.shown["crank.value"].values.round(3).tolist()
    [0.0, 57.296]
    """
    chosen = _chosen(motion, names) if names else _everything(motion)
    whole = (*_time(motion), *chosen, Quantity(ASSEMBLED, "", motion.assembled))
    columns = {column.name: column for column in _designs(motion.shape)}
    for column in (part for one in whole for part in one.components):
        columns.setdefault(column.name, _flat(column, motion.shape))
    return Table(motion.mechanism.title, tuple(columns.values()))


def _chosen(motion: AtPoses, names: Sequence[str]) -> Iterator[Quantity]:
    """Return the drivers' values and what is named."""
    found = [quantity(motion, name) for name in names]
    yield from (read_of(owner_of(motion, "drives", name), VALUE) for name in motion.drives)
    yield from found


def _flat(found: Quantity, shape: tuple[int, ...]) -> Quantity:
    return replace(found, values=np.broadcast_to(found.values, shape).reshape(-1))


def _designs(shape: tuple[int, ...]) -> Iterator[Quantity]:
    """Return the index columns of the designs: one for each axis before the last."""
    axes = len(shape) - 1
    for axis in range(axes):
        yield Quantity(DESIGN if axes == 1 else f"{DESIGN}{axis}", "", np.indices(shape)[axis].reshape(-1))


def _time(motion: AtPoses) -> Iterator[Quantity]:
    if motion.time is not None:
        yield Quantity(TIME, unit_of("", "time"), motion.time, dimension="time", symbol="t")


def _everything(motion: AtPoses) -> Iterator[Quantity]:
    """Return all derivatives of all there is; where a pin and a driver have one name, the value is the driver's."""
    for kind, words in TABULATED.items():
        for name in getattr(motion, kind):
            first = int(kind == "pairs" and name in motion.drives)
            if (kind, name) != ("links", FRAME):
                owner = owner_of(motion, kind, name)
                yield from (read_of(owner, word) for word in words[first : motion.order + 1])
