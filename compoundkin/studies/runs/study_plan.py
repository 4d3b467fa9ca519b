"""What a study is: a mechanism, its free dimensions, their sample, what is asked, and how the drivers move."""

from __future__ import annotations

import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.attributes import RATES, TIME
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.responses import studied_path
from compoundkin.studies.responses.freed_dimensions import freed_by
from compoundkin.studies.runs.study_data import ORDER, digest, plain, plain_mechanism, plain_numbers
from compoundkin.studies.runs.study_program import ROW, StudyColumn, StudyProgram
from compoundkin.studies.samples.contract import DesignSample
from compoundkin.studies.variations import hold_kinds
from compoundkin.studies.variations.contract import Variation

Outputs: TypeAlias = tuple[str, ...] | Mapping[str, Callable[..., Any] | None]
# What a study is told besides its dimensions and outputs: how drivers move, and what functions read.
ASKED = ("values", *RATES, TIME, "modes", "given")


@dataclass(frozen=True, eq=False, repr=False)
class StudyPlan:
    """All that a study is. What computes it is made when it is needed, and stays behind when it is pickled."""

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
    # copies of one plan that come to a worker, each with a task, are one
    key: str = field(default_factory=lambda: secrets.token_hex(8), repr=False)

    def __len__(self) -> int:
        return self.sample.count

    @cached_property
    def program(self) -> StudyProgram:
        """What computes its rows."""
        outputs: Any = self.outputs
        asked: dict[str, Any] = {"given": self.given, "modes": self.modes, **self._rates}
        with freed_by("dimensions"):
            path, responses = studied_path(self.mechanism, list(self.dimensions), outputs, self.values, **asked)
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
            "dimensions": {name: plain(one.data) for name, one in self.dimensions.items()},
            "sample": plain(self.sample.data),
        }
        moved = {name: self._by_driver(name) for name in ("values", *RATES, TIME)}
        rest = moved | {name: plain(getattr(self, name)) for name in ("outputs", "modes", "given")}
        return found | {name: value for name, value in rest.items() if value is not None}

    def _by_driver(self, name: str) -> Any:
        """Return what drives are given by the name of each, so that what is meant alike is the same."""
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

    def hold(self) -> None:
        """Try one design.

        Raises InvalidInput, UnknownName or what solving raises where the study could not be computed.
        """
        program = self.program
        hold_kinds(self.dimensions, program.path.compiled.programs.dimensions)
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
