"""The computation of a study: rows of designs with dimensions, outputs and states, the same in any chunk.

The state of a design says whether it assembles over the whole motion, on which branch and circuit, and why not.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import suppress_pose_warnings
from compoundkin.base.version import VERSION
from compoundkin.kinematics.configuration import label
from compoundkin.kinematics.quantities import ASSEMBLED
from compoundkin.model.attributes import component_names, unit_suffix
from compoundkin.programs.backends.runner import THREAD_TURNS
from compoundkin.studies.responses.assembled_range import AssembledRange, assembled_range, failure, is_misfit
from compoundkin.studies.responses.designs import Designs, StudiedPath, designs_at_once
from compoundkin.studies.responses.response import Response
from compoundkin.studies.samples.design_sample import DesignSample
from compoundkin.studies.samples.variation import Variation

# Rows are computed in blocks that begin at multiples of this number, so that results do not depend on chunks.
BLOCK = 4096
ROW = "row"
ColumnKind: TypeAlias = Literal["dimension", "output", "state"]


class StudyColumn(NamedTuple):
    """A column of a study. `width` is the number of poses of a course, None for single values."""

    name: str
    unit: str
    kind: ColumnKind
    width: int | None = None

    @property
    def is_figure(self) -> bool:
        """Whether it is one number of each design: a dimension or a figure."""
        return self.kind != "state" and not self.width


@dataclass(frozen=True, eq=False, repr=False)
class StudyProgram(ShortRepr):
    """The computation of every row of a sample."""

    variations: Mapping[str, Variation]
    sample: DesignSample
    path: StudiedPath
    responses: tuple[Response, ...]

    @property
    def count(self) -> int:
        """How many rows there are."""
        return self.sample.count

    @cached_property
    def block(self) -> int:
        """The number of rows computed at once: a power of two."""
        return min(BLOCK, 1 << (designs_at_once(self.path.reference.inputs.poses).bit_length() - 1))

    @cached_property
    def columns(self) -> tuple[StudyColumn, ...]:
        """The columns besides the number of the row: dimensions, outputs, states."""
        dimensions = [StudyColumn(name, unit, "dimension") for name, unit in self._dimensions()]
        return (*dimensions, *self._outputs(), *(StudyColumn(name, "", "state") for name in STATES))

    def _dimensions(self) -> Iterator[tuple[str, str]]:
        programs = self.path.compiled.programs
        units = {one.name: programs.stated.unit(one) for one in programs.dimensions}
        coordinates = {one.name: one.coordinates for one in programs.dimensions}
        for name in self.variations:
            yield from ((coordinate, units[name]) for coordinate in coordinates[name])

    def _outputs(self) -> Iterator[StudyColumn]:
        poses = self.path.reference.inputs.poses
        for one in self.responses:
            for name in component_names(one.name) if one.is_vector else (one.name,):
                yield StudyColumn(name, one.unit, "output", poses if one.is_course else None)

    def rows(self, rows: range) -> dict[str, Number]:
        """Return the columns of some rows by name: "row", then those of `columns`.

        Points and vectors are two columns, ``.x`` and ``.y``; courses are (rows, poses). A chunk that begins and ends
        at multiples of `block` computes nothing twice.
        """
        parts = [self._cut(start, rows) for start in range(rows.start - rows.start % self.block, rows.stop, self.block)]
        if not parts:
            return self._cut(0, range(0))
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _cut(self, start: int, rows: range) -> dict[str, Number]:
        """Return the requested rows of a block."""
        whole = range(start, min(start + self.block, self.count))
        wanted = slice(max(rows.start - start, 0), max(min(rows.stop, whole.stop) - start, 0))
        return {name: values[wanted] for name, values in self._computed(whole).items()}

    def _computed(self, rows: range) -> dict[str, Number]:
        """Compute a block."""
        with suppress_pose_warnings(), THREAD_TURNS.taken():
            dimensions = self.sample.designs(self.variations, rows)
            designs = self.path.designs(dimensions)
            found = {ROW: np.arange(rows.start, rows.stop)}
            for name, value in dimensions.items():
                found |= _columns(name, np.broadcast_to(value, len(rows)))
            for one in self.responses:
                found |= _columns(one.name, self._values(one, designs))
            return found | design_states(designs)

    @staticmethod
    def _values(one: Response, designs: Designs) -> Number:
        shape = (designs.number, designs.poses) if one.is_course else (designs.number,)
        return np.broadcast_to(one.values(designs), shape)


def _columns(name: str, values: Number) -> dict[str, Number]:
    """Return a column, or two of a planar vector."""
    if not np.iscomplexobj(values):
        return {name: np.asarray(values)}
    return dict(zip(component_names(name), (values.real, values.imag), strict=True))


STATES = (ASSEMBLED, "branch", "circuit", "order_defect", "reason")
_, BRANCH, CIRCUIT, ORDER_DEFECT, REASON = STATES
# The sign of a group whose limit position lies within the motion, where its two modes meet.
BOTH = "+-"


def design_states(designs: Designs) -> dict[str, Number]:
    """Return the states of designs by name. Arrays (designs,); texts are objects or None."""
    found, modes = assembled_range(designs), designs.path.compiled.modes
    branch = modes if isinstance(modes, str) else modes.name
    defect = np.broadcast_to(_turns_back(designs), designs.number)
    return {
        ASSEMBLED: found.assembled,
        BRANCH: _everywhere(branch, designs),
        CIRCUIT: _circuits(designs, found, branch),
        ORDER_DEFECT: defect.copy(),
        REASON: _reasons(designs, found),
    }


def _everywhere(text: str, designs: Designs) -> Number:
    """Return one text for all designs: the same object, not a million equal ones."""
    return np.repeat(np.array([text], dtype=object), designs.number)


def _turns_back(designs: Designs) -> Number:
    """Return the designs in which a driver reverses between poses."""
    found: Number = np.zeros(1, dtype=bool)
    for value, *_ in designs.inputs.drives.values():
        step = np.diff(np.atleast_2d(value), axis=1)
        found = found | ((step > 0.0).any(axis=1) & (step < 0.0).any(axis=1))
    return found


def _circuits(designs: Designs, found: AssembledRange, branch: str) -> Number:
    """Return the branch of each design, with both signs for groups that reach their limit position."""
    if found.assembled.all():
        return _everywhere(branch, designs)
    groups = 1 + np.arange(len(designs.path.reference.structure.groups))
    meets = np.array([(found.failed == k).any(axis=1) | (found.between == k) for k in groups])
    kinds, which = np.unique(meets, axis=1, return_inverse=True)
    names = [_circuit(designs, branch, groups[kind] - 1) for kind in kinds.T]
    return np.array([*names, None], dtype=object)[np.ravel(which)]


def _circuit(designs: Designs, branch: str, groups: Number) -> str:
    """Return the name of a branch with both signs for some groups."""
    for k in groups:
        own = label(designs.path.reference.structure, k)
        branch = re.sub(re.escape(own) + "[+-]", own + BOTH, branch)
    return branch


def _reasons(designs: Designs, found: AssembledRange) -> Number:
    """Return why designs are not assembled, which group between which values of the driver; else None."""
    reasons = np.full(designs.number, None, dtype=object)
    missing = np.flatnonzero(~found.assembled)
    if not len(missing):
        return reasons
    bad = found.failed[missing] != 0
    first = np.argmax(bad, axis=1)
    # the first run of poses that are not assembled: to its last one
    after = np.where(bad | (np.arange(designs.poses) < first[:, None]), designs.poses, np.arange(designs.poses))
    last = after.min(axis=1) - 1
    at_poses = bad.any(axis=1)
    group = np.where(at_poses, found.failed[missing, first], found.between[missing])
    begin = np.where(at_poses, first, found.after[missing])
    end = np.where(at_poses, last, -1)
    codes, which = np.unique(np.stack([group, begin, end], axis=1), axis=0, return_inverse=True)
    reasons[missing] = np.array(list(_texts(designs, codes)), dtype=object)[np.ravel(which)]
    return reasons


def _texts(designs: Designs, codes: Number) -> Iterator[str]:
    """Yield the reason for a group that fails from one pose to another, or after a pose if the last is -1."""
    motion = designs.path.reference
    driver, values, unit = _driver_values(designs)
    for group, begin, end in codes.tolist():
        reason = failure(motion, group)
        if end - begin == designs.poses - 1 and is_misfit(motion, group):
            yield reason
        elif end < 0:
            yield f"{reason} between {driver} {values[begin]} and {values[begin + 1]}{unit}"
        else:
            yield f"{reason} at {driver} {values[begin]}{f' to {values[end]}' if end > begin else ''}{unit}"


def _driver_values(designs: Designs) -> tuple[str, list[str], str]:
    """Return the only moving driver, its values and their unit; numbers of poses if there is none or several."""
    moving = {name: value for name, (value, *_) in designs.inputs.drives.items()
              if np.ndim(value) and len(value) == 1 and np.ptp(value)}  # fmt: skip
    if len(moving) != 1:
        return "pose", [str(k) for k in range(designs.poses)], ""
    ((name, value),) = moving.items()
    is_angle = designs.path.reference.structure.driven_angles[name]
    shown = np.rad2deg(value[0]) if is_angle else value[0]
    return name, [f"{one:.6g}" for one in shown], unit_suffix(is_angle, designs.path.reference.mechanism.unit)


def versions(program: StudyProgram) -> dict[str, str]:
    """Return the versions of the libraries that compute, and the back end."""
    import scipy

    back_end = program.path.compiled.backend
    return {"compoundkin": VERSION, "numpy": np.__version__, "scipy": scipy.__version__, "back end": back_end}


def version_text(own: Mapping[str, str], other: Mapping[str, str]) -> str:
    """Return the differences of two sets of versions as text.

    >>> version_text({"numpy": "2.2", "scipy": "1.17"}, {"numpy": "2.1", "scipy": "1.17"})
    'numpy 2.2, not 2.1'
    """
    names = [name for name in own if own[name] != other.get(name)]
    return "; ".join(f"{name} {own[name]}, not {other.get(name)}" for name in names)
