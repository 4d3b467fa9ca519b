"""The definition of a study: mechanism, free dimensions, sample, outputs and drivers; and the same as plain data.

Plain data are what files hold, and identify a study by a digest; functions are described by their code and constants.
"""

from __future__ import annotations

import json
import secrets
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from hashlib import sha256
from types import CodeType, ModuleType
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.kinematics.configuration import SIGNS, Configuration
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import RATES, TIME
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.responses import studied_path
from compoundkin.studies.responses.designs import name_freeing_argument
from compoundkin.studies.samples.design_sample import DesignSample
from compoundkin.studies.samples.variation import Variation
from compoundkin.studies.samples.variations import check_kinds
from compoundkin.studies.study_program import ROW, StudyColumn, StudyProgram

Outputs: TypeAlias = tuple[str, ...] | Mapping[str, Callable[..., Any] | None]
# Arguments of a study besides its dimensions and outputs: how drivers move, and what functions read.
PLAN_ARGUMENTS = ("values", *RATES, TIME, "modes", "given")


@dataclass(frozen=True, eq=False, repr=False)
class StudyPlan:
    """The definition of a study. Its program is compiled when it is needed, and is not pickled."""

    mechanism: Mechanism
    dimensions: Mapping[str, Variation]
    outputs: Outputs
    sample: DesignSample
    values: Any = None
    speed: Any = None
    acceleration: Any = None
    jerk: Any = None
    time: Any = None
    modes: Mapping[str, int] | str | Configuration | None = None
    given: Mapping[str, Any] | None = None
    # identifies copies of one plan that reach a worker with tasks
    key: str = field(default_factory=lambda: secrets.token_hex(8), repr=False)

    def __len__(self) -> int:
        return self.sample.count

    @cached_property
    def program(self) -> StudyProgram:
        """The program that computes its rows."""
        outputs: Any = self.outputs
        arguments: dict[str, Any] = {"given": self.given, "modes": self.modes, **self._rates}
        with name_freeing_argument("dimensions"):
            path, responses = studied_path(self.mechanism, list(self.dimensions), outputs, self.values, **arguments)
        return StudyProgram(self.dimensions, self.sample, path, responses)

    @property
    def columns(self) -> tuple[StudyColumn, ...]:
        """All columns of a row: its number, dimensions, outputs, states."""
        return (StudyColumn(ROW, "", "state"), *self.program.columns)

    @cached_property
    def data(self) -> Mapping[str, Any]:
        """All of it as plain numbers, texts, lists and tables, angles in radians.

        Raises InvalidInput for a mechanism that has no file.
        """
        found = {
            "mechanism": plain_mechanism(self.mechanism),
            ORDER: list(self.dimensions),
            "dimensions": {name: plain_value(one.data) for name, one in self.dimensions.items()},
            "sample": plain_value(self.sample.data),
        }
        moved = {name: self._by_driver(name) for name in ("values", *RATES, TIME)}
        rest = moved | {name: plain_value(getattr(self, name)) for name in ("outputs", "modes", "given")}
        return found | {name: value for name, value in rest.items() if value is not None}

    def _by_driver(self, name: str) -> Any:
        """Return an argument by driver, so that equal motions have equal data."""
        given = getattr(self, name)
        if given is None or isinstance(given, str):
            return given
        drives = self.mechanism.drives
        by_name = isinstance(given, Mapping) or name == TIME or len(drives) != 1
        return plain_numbers(given if by_name else {drives[0].name: given})

    @cached_property
    def fingerprint(self) -> str:
        """A text that is the same for equal studies only."""
        return digest(self.data)

    def design(self, row: int) -> dict[str, Any]:
        """Return the values of the dimensions in a row. Raises InvalidInput where there is no such row."""
        if not 0 <= row < len(self):
            raise InvalidInput(Problem("row", f"there is no row {row}", f"the study has rows 0 to {len(self) - 1}"))
        found: Mapping[str, Number] = self.sample.designs(self.dimensions, range(row, row + 1))
        return {name: value[0].item() for name, value in found.items()}

    @checked
    def mechanism_of(self, row: int) -> Mechanism:
        """Return the mechanism of a row. Raises InvalidInput where there is no such row."""
        return self.program.path.compiled.mechanism(self.design(int(row)))

    @checked
    def motion_of(self, row: int) -> Motion:
        """Return the motion of a row, in the configuration of the study.

        Raises InvalidInput where there is no such row, NotAssembled where it has no pose at all.
        """
        modes = self.program.path.compiled.modes
        return solve(self.mechanism_of(row), self.values, modes=modes, **self._rates)

    @property
    def _rates(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in (*RATES, TIME)}

    def check(self) -> None:
        """Compute one design, so that mistakes are found before a run.

        Raises InvalidInput, UnknownName, and what `solve` raises.
        """
        program = self.program
        check_kinds(self.dimensions, program.path.compiled.programs.dimensions)
        if len(shape := program.path.reference.shape) != 1:
            what = f"the drivers' values have {len(shape)} axes"
            raise InvalidInput(Problem("values", what, "give one motion: each driver a number or a list of poses"))
        names = [column.name for column in self.columns]
        if twice := sorted({name for name in names if names.count(name) > 1}):
            raise InvalidInput(Problem("outputs", f"{twice[0]!r} would be two columns", "name each output once"))
        designs = program.path.designs(self.sample.designs(self.dimensions, range(1)))
        for response in program.responses:
            found = np.shape(response.values(designs))
            expected = (1, designs.poses) if response.is_course else (1,)
            if found != expected:
                raise InvalidInput(Problem(response.name, f"it has shape {found}", f"a design should have {expected}"))

    def __repr__(self) -> str:
        of = f"{count_phrase(len(self.dimensions), 'dimension')}, {count_phrase(len(self.outputs), 'output')}"
        return f"{type(self).__name__}({self.mechanism.title!r}: {len(self):,} designs of {of})"

    def __getstate__(self) -> dict[str, Any]:
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def __eq__(self, other: object) -> bool:
        return self.key == getattr(other, "key", None)

    def __hash__(self) -> int:
        return hash(self.key)


# Keys of objects that cannot be written: their name, and a digest of their content.
CALLED, CONTENT = "called", "content"
# A sample assigns its columns to the dimensions in order, which JSON does not guarantee.
ORDER = "order of dimensions"


def plain_value(value: Any) -> Any:
    """Return a value as plain numbers, texts, lists and tables; points as [x, y].

    Functions, and configurations without a name of signs, become a name and a digest.

    >>> plain_value({"crank": np.array([0.0, 1.5]), "at": 2 + 1j, "n": np.int64(3)})
    {'crank': [0.0, 1.5], 'at': [2.0, 1.0], 'n': 3}
    """
    if isinstance(value, Mapping):
        return {str(key): plain_value(one) for key, one in value.items()}
    if isinstance(value, complex | np.complexfloating):
        return [float(value.real), float(value.imag)]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple | range | np.ndarray):
        return [plain_value(one) for one in value]
    return _function_data(value)


def plain_numbers(value: Any) -> Any:
    """Return numbers, or tables of them by name, as plain floats.

    >>> plain_numbers({"crank": range(2)}), plain_numbers(5)
    ({'crank': [0.0, 1.0]}, 5.0)
    """
    if isinstance(value, Mapping):
        return {str(key): plain_numbers(one) for key, one in value.items()}
    return None if value is None else np.asarray(value, dtype=float).tolist()


def _function_data(value: Any) -> Any:
    """Return the name and digest of an object that cannot be written."""
    if isinstance(value, Configuration):
        if set(value.modes.values()) <= set(SIGNS.values()):
            return value.name
        places = {link: plain_value((pose.z.c[0], pose.u.c[0])) for link, pose in value.poses.items()}
        return {CALLED: value.name, CONTENT: digest(places)}
    return {CALLED: getattr(value, "__qualname__", type(value).__name__), CONTENT: digest(_content(value))}


def _content(function: Any, callers: tuple[Any, ...] = ()) -> Any:
    """Return a function's code, defaults, closure and the globals that it reads, as plain lists."""
    code = getattr(function, "__code__", None)
    if code is None:
        return repr(function)
    names = {name for one in _codes(code) for name in one.co_names} & function.__globals__.keys()
    read = {name: function.__globals__[name] for name in sorted(names)}
    read |= {name: cell.cell_contents for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True)}
    callers = (*callers, function)
    given = plain_value([function.__defaults__, function.__kwdefaults__])
    return [_instructions(code), given, {name: _read(value, callers) for name, value in read.items()}]


def _read(value: Any, callers: tuple[Any, ...]) -> Any:
    """Return the content of a value that a function reads; a module is its name."""
    if isinstance(value, ModuleType) or any(value is one for one in callers):
        return value.__name__
    return _content(value, callers) if hasattr(value, "__code__") else plain_value(value)


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
    # the order of a set differs between processes
    return sorted(map(repr, value)) if isinstance(value, frozenset) else repr(value)


def plain_mechanism(mechanism: Mechanism) -> Any:
    """Return the document of a mechanism's file. Raises InvalidInput where it has none."""
    return json.loads(dumps(mechanism, "json"))


def mechanism_of_document(document: Any) -> Mechanism:
    """Return the mechanism of a document. Raises InvalidMechanism listing all problems."""
    return loads(json.dumps(document), "json", "mechanism")


def digest(data: Any) -> str:
    """Return a fingerprint of data, the same for equal data only."""
    return sha256(json.dumps(data, sort_keys=True).encode("utf-8", "surrogatepass")).hexdigest()


def differences(own: Any, other: Any, where: str = "") -> Iterator[str]:
    """Yield the keys at which two sets of data differ.

    >>> list(differences({"sample": {"seed": 1}, "speed": 3}, {"sample": {"seed": 2}, "speed": 3}))
    ['sample.seed']
    """
    if isinstance(own, Mapping) and isinstance(other, Mapping):
        for key in dict.fromkeys([*own, *other]):
            yield from differences(own.get(key), other.get(key), f"{where}.{key}" if where else key)
    elif own != other:
        yield where
