"""A motion as one flat table: a row per pose, a column per quantity; CSV, NPZ, Parquet, pandas."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.atomic import write_atomically
from compoundkin.model.elements import FRAME

if TYPE_CHECKING:
    from compoundkin.kinematics import Motion

Array: TypeAlias = np.ndarray[Any, Any]

# What the derivatives of each are called in a column's name, from the zeroth on.
POINT = ("position", "velocity", "acceleration", "jerk")
LINK = ("angle", "angular_velocity", "angular_acceleration", "angular_jerk")
PAIR = ("value", "rate", "second", "third")
DRIVE = ("value", "speed", "acceleration", "jerk")
PER_SECOND = ("", "/s", "/s^2", "/s^3")


def columns(motion: Motion, *, degrees: bool = False) -> dict[str, Array]:
    """The flat columns of a motion by name: `time` if it has any, drivers, points (.x, .y), links, pairs, `assembled`.

    Every array has one entry a pose, the last axis of the motion running fastest; where the motion has
    designs, index columns come first: `design`, or `design0`, `design1` ... Angles are radians, or degrees
    where that is asked for; rates are always by radians and seconds.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> columns(solve(crank, {"crank": [0.0, 1.0]}), degrees=True)["B.position.x"].round(3).tolist()
    [2.0, 1.081]
    """
    out = _designs(motion.shape)
    for name, unit, values in _quantities(motion):
        shown = np.rad2deg(values) if degrees and unit == "rad" else values
        out[name] = np.broadcast_to(shown, motion.shape).reshape(-1)
    out["assembled"] = np.broadcast_to(motion.assembled, motion.shape).reshape(-1)
    return out


def units(motion: Motion, *, degrees: bool = False) -> dict[str, str]:
    """The unit of every column that has one.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"), unit="mm")
    >>> units(solve(crank, {"crank": 0.0}))["B.velocity.x"]
    'mm/s'
    """
    found = {name: unit for name, unit, _ in _quantities(motion)}
    return {name: "deg" if degrees and unit == "rad" else unit for name, unit in found.items()}


def save_table(motion: Motion, path: str | os.PathLike[str]) -> None:
    """Write the flat table to a .csv (angles in degrees), .npz or .parquet file (radians), by the suffix.

    The file is replaced whole or not at all. Raises InvalidInput where it cannot be written.

    >>> import tempfile
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_table(solve(crank, {"crank": 0.0}, order=0), f"{folder}/crank.csv")
    ...     print(Path(f"{folder}/crank.csv").read_text().splitlines()[0].split(",")[:2])
    ['crank.value [deg]', 'A.position.x [length]']
    """
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        known = ", ".join(WRITERS)
        raise InvalidInput(Problem(str(path), "the name does not tell the format", f"tables end in {known}"))
    write_atomically(path, WRITERS[suffix](motion))


def to_pandas(motion: Motion) -> Any:
    """The flat table as a pandas DataFrame, angles in radians.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.kinematics import solve
    >>> crank = Mechanism("m", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> to_pandas(solve(crank, {"crank": [0.0, 1.0]}))["crank.value"].tolist()
    [0.0, 1.0]
    """
    try:
        import pandas
    except ImportError:
        raise _missing("pandas", "pandas") from None
    return pandas.DataFrame(columns(motion))


def _designs(shape: tuple[int, ...]) -> dict[str, Array]:
    """The index columns of the designs: one for each axis before the last."""
    axes = shape[:-1]
    names = ["design"] if len(axes) == 1 else [f"design{i}" for i in range(len(axes))]
    places = np.indices(shape)[: len(axes)]
    return {name: place.reshape(-1) for name, place in zip(names, places, strict=True)}


def _quantities(motion: Motion) -> Iterator[tuple[str, str, Array]]:
    """Name, unit and values of every quantity; where a pin and a driver have one name, the driver's."""
    orders = range(motion.order + 1)
    length = motion.mechanism.unit or "length"
    if motion.time is not None:
        yield "time", "s", motion.time
    for name, driven in motion.drives.items():
        unit = "rad" if driven.is_angle else length
        yield from ((f"{name}.{DRIVE[k]}", unit + PER_SECOND[k], driven.derivative(k)) for k in orders)
    for name, point in motion.points.items():
        for k in orders:
            vector = np.asarray(point.derivative(k))
            yield f"{name}.{POINT[k]}.x", length + PER_SECOND[k], vector.real
            yield f"{name}.{POINT[k]}.y", length + PER_SECOND[k], vector.imag
    for name, link in motion.links.items():
        if name != FRAME:
            yield from ((f"{name}.{LINK[k]}", "rad" + PER_SECOND[k], getattr(link, LINK[k])) for k in orders)
    for name, pair in motion.pairs.items():
        unit = "rad" if pair.is_angle else length
        known = range(1, motion.order + 1) if name in motion.drives else orders
        yield from ((f"{name}.{PAIR[k]}", unit + PER_SECOND[k], pair.derivative(k)) for k in known)


def _csv(motion: Motion) -> Callable[[BinaryIO], None]:
    table, unit = columns(motion, degrees=True), units(motion, degrees=True)
    heads = [f"{name} [{unit[name]}]" if name in unit else name for name in table]

    def write(file: BinaryIO) -> None:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        rows = csv.writer(text, lineterminator="\n")
        rows.writerow(heads)
        # lists of Python floats, which are written with as many digits as tell them apart
        rows.writerows(zip(*(values.tolist() for values in table.values()), strict=True))
        text.detach()

    return write


def _npz(motion: Motion) -> Callable[[BinaryIO], None]:
    table = columns(motion)
    # NumPy 2 stubs take any keyword for `allow_pickle`
    save: Any = np.savez
    return lambda file: save(file, **table)


def _parquet(motion: Motion) -> Callable[[BinaryIO], None]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise _missing("pyarrow", "parquet") from None
    table, unit = columns(motion), units(motion)
    arrays = {name: pyarrow.array(values) for name, values in table.items()}
    fields = [pyarrow.field(n, a.type, metadata={"unit": unit[n]} if n in unit else None) for n, a in arrays.items()]
    whole = pyarrow.Table.from_arrays(list(arrays.values()), schema=pyarrow.schema(fields))
    return lambda file: pyarrow.parquet.write_table(whole, file)


def _missing(package: str, extra: str) -> InvalidInput:
    return InvalidInput(Problem("", f"this needs {package}", f"pip install 'compoundkin[{extra}]'"))


WRITERS: dict[str, Callable[[Motion], Callable[[BinaryIO], None]]] = {
    ".csv": _csv,
    ".npz": _npz,
    ".parquet": _parquet,
}
