"""Studies as plain data: what files hold of them, by what they are known again, and where two differ."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from hashlib import sha256
from types import CodeType, ModuleType
from typing import Any

import numpy as np

from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.kinematics.configuration import SIGNS, Configuration
from compoundkin.model.mechanism import Mechanism

# What stands in the data for things that cannot be written: what they are called and what tells them from others.
CALLED, CONTENT = "called", "content"
# Samples give their columns to the dimensions in order, which tables of JSON do not keep for certain.
ORDER = "order of dimensions"


def plain(value: Any) -> Any:
    """Return a value as plain numbers, texts, lists and tables; points as [x, y].

    Functions, and configurations without a name of signs, are told by a digest.

    >>> plain({"crank": np.array([0.0, 1.5]), "at": 2 + 1j, "n": np.int64(3)})
    {'crank': [0.0, 1.5], 'at': [2.0, 1.0], 'n': 3}
    """
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, complex | np.complexfloating):
        return [float(value.real), float(value.imag)]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple | range | np.ndarray):
        return [plain(one) for one in value]
    return _told(value)


def plain_numbers(value: Any) -> Any:
    """Return numbers, or tables of them by name, as plain floats.

    >>> plain_numbers({"crank": range(2)}), plain_numbers(5)
    ({'crank': [0.0, 1.0]}, 5.0)
    """
    if isinstance(value, Mapping):
        return {str(key): plain_numbers(one) for key, one in value.items()}
    return None if value is None else np.asarray(value, dtype=float).tolist()


def _told(value: Any) -> Any:
    """Say of what cannot be written how it is called, and by what it differs from others."""
    if isinstance(value, Configuration):
        if set(value.modes.values()) <= set(SIGNS.values()):
            return value.name
        places = {link: plain((pose.z.c[0], pose.u.c[0])) for link, pose in value.poses.items()}
        return {CALLED: value.name, CONTENT: digest(places)}
    return {CALLED: getattr(value, "__qualname__", type(value).__name__), CONTENT: digest(_content(value))}


def _content(function: Any, callers: tuple[Any, ...] = ()) -> Any:
    """Return what a function does, and the values that it holds and reads of its module: lists of plain things."""
    code = getattr(function, "__code__", None)
    if code is None:
        return repr(function)
    names = {name for one in _codes(code) for name in one.co_names} & function.__globals__.keys()
    read = {name: function.__globals__[name] for name in sorted(names)}
    read |= {name: cell.cell_contents for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True)}
    callers = (*callers, function)
    given = plain([function.__defaults__, function.__kwdefaults__])
    return [_instructions(code), given, {name: _read(value, callers) for name, value in read.items()}]


def _read(value: Any, callers: tuple[Any, ...]) -> Any:
    """Return what tells a value that functions read from others; a library is what it is called."""
    if isinstance(value, ModuleType) or any(value is one for one in callers):
        return value.__name__
    return _content(value, callers) if hasattr(value, "__code__") else plain(value)


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Yield the code of a function and of those inside it."""
    yield code
    for one in code.co_consts:
        if isinstance(one, CodeType):
            yield from _codes(one)


def _instructions(code: CodeType) -> Any:
    return [code.co_code.hex(), list(code.co_names), [_constant(one) for one in code.co_consts]]


def _constant(value: Any) -> Any:
    if isinstance(value, CodeType):
        return _instructions(value)
    # the order of a set is another in every process
    return sorted(map(repr, value)) if isinstance(value, frozenset) else repr(value)


def plain_mechanism(mechanism: Mechanism) -> Any:
    """Return the document of a mechanism's file. Raises InvalidInput where it has none."""
    return json.loads(dumps(mechanism, "json"))


def mechanism_from(document: Any) -> Mechanism:
    """Return the mechanism of a document. Raises InvalidMechanism listing all problems."""
    return loads(json.dumps(document), "json", "mechanism")


def digest(data: Any) -> str:
    """Return a text that is the same for equal data only."""
    return sha256(json.dumps(data, sort_keys=True).encode("utf-8", "surrogatepass")).hexdigest()


def differences(own: Any, other: Any, where: str = "") -> Iterator[str]:
    """Yield the places where two sets of data differ.

    >>> list(differences({"sample": {"seed": 1}, "speed": 3}, {"sample": {"seed": 2}, "speed": 3}))
    ['sample.seed']
    """
    if isinstance(own, Mapping) and isinstance(other, Mapping):
        for key in dict.fromkeys([*own, *other]):
            yield from differences(own.get(key), other.get(key), f"{where}.{key}" if where else key)
    elif own != other:
        yield where
