"""What a page needs to solve its mechanism anew: dimensions, drivers at its poses, the program, words for gaps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.one_design import motion_of_design
from compoundkin.model.attributes import RADIANS, coordinate_dimension, unit_of
from compoundkin.programs.calls.seed_values import seed_values
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.recording.recorded_outputs import ProgramOutput, output_of
from compoundkin.programs.tables.page_program import PageProgram, RecordedReason
from compoundkin.view.page.live.followed_quantities import followed_quantities
from compoundkin.view.page.live.own_values import OwnValues
from compoundkin.view.page.live.panel_data import panel_data, template_data
from compoundkin.view.page.live.table_data import table_data
from compoundkin.view.page.markup import exact
from compoundkin.view.report.shown_poses import Sample


def live_data(sample: Sample, chosen: Any, links: Sequence[str], outputs: Sequence[str]) -> dict[str, Any] | None:
    """Return what a page needs to be live, or why it cannot be.

    It is of some poses of a sample. None is that of a single pose, or of a mechanism without drivers.
    """
    if len(chosen) < 2 or not sample.motion.mechanism.drives:
        return None
    try:
        return LiveData(motion_of_design(sample.motion, sample.design), chosen, links, outputs).data
    except CompoundkinError as error:
        return {"why": f"This mechanism cannot be changed here: {error.problems[0].what}."}


@dataclass(frozen=True, eq=False)
class LiveData:
    """One design of a motion at the poses of a page. `links` and `outputs` are those of the page."""

    motion: Motion
    chosen: Any
    links: Sequence[str]
    names: Sequence[str]

    @cached_property
    def program(self) -> PageProgram:
        """What computes it."""
        return PageProgram.of(self.motion, [*self._told()])

    def _told(self) -> Iterator[ProgramOutput]:
        """Yield the page's outputs, and what its figures are made of."""
        followed = followed_quantities(self.motion, self.names) if self.names else ()
        for name in dict.fromkeys((*self.names, *followed)):
            try:
                yield output_of(self.motion, name)
            except CompoundkinError:
                # forces, and figures of whole motions, are no outputs of a program
                continue

    @cached_property
    def places(self) -> Mapping[int, int]:
        """The places of nodes."""
        return self.program.table.places

    @property
    def data(self) -> dict[str, Any]:
        """All of it for a script: lengths in the user's unit, angles in radians."""
        program, table = self.program, self.program.table
        if not program.dimensions:
            what = "it is overconstrained, and moves by its special dimensions only"
            raise InvalidInput(Problem(self.motion.mechanism.title, what, "take out what is redundant"))
        names = [one.name for one in program.dimensions]
        return {
            "dimensions": [self._dimension(one) for one in program.dimensions],
            "drives": [self._drive(name) for name in program.mechanism.drives],
            "size": self.motion.size,
            "states": list(self._states()),
            "sides": [self.places[one.now.x] for one in program.carried[1]],
            "groups": list(self._groups()),
            "panel": panel_data(program.stated, names),
            "toml": template_data(program.stated, names, self.motion),
            "program": {
                **table_data(table),
                "ends": list(table.ends),
                "goods": [[index, self.places[node]] for index, node in program.goods],
                "links": [self._link(name) for name in self.links],
                "outputs": list(self._outputs()),
            },
        }

    def _groups(self) -> Iterator[dict[str, Any]]:
        """Yield what may keep a pose from being assembled: groups, then guides with ends, and why."""
        guides = self.program.mechanism.order.guide_ends.pairs
        named = [(group.name, group.links) for group in self.motion.structure.groups]
        named += [(pair.name, pair.members) for pair in guides]
        ended = {pair.name for pair in guides}
        for (name, links), reasons in zip(named, self.program.reasons, strict=True):
            told = [self._reason(one) for one in reasons]
            yield {"name": name, "links": list(links), "guide": name in ended, "reasons": told}

    def _reason(self, one: RecordedReason) -> dict[str, Any]:
        holds = None if one.holds is None else self.places[one.holds]
        return {"holds": holds, "words": [word if isinstance(word, str) else self.places[word] for word in one.words]}

    def _states(self) -> Iterator[dict[str, Any]]:
        """Yield what is carried from design to design: its row, what becomes of it, what it is in the own motion."""
        program = self.program
        own = seed_values(program.seeds, self.motion)
        for row, (given, state) in enumerate(zip(program.seeds, program.carried[0], strict=True), len(program.drives)):
            values = exact(own[given][0][self.chosen])
            kinds = {"angle": state.is_angle, "corrected": state.is_corrected}
            yield {"row": row, "now": self.places[state.now.x], "own": values, **kinds}

    def _dimension(self, one: FreeDimension) -> dict[str, Any]:
        unit = self.program.stated.unit(one)
        kind = "point" if one.is_of_link else "angle" if unit == RADIANS else "length" if unit else "ratio"
        value = float(np.ravel(self.program.stated.own(one))[0])
        return {
            "name": one.name,
            "owner": one.owner,
            "word": one.word,
            "part": one.part,
            "kind": kind,
            "unit": unit,
            "value": value,
        }

    def _drive(self, name: str) -> dict[str, Any]:
        values = [
            np.broadcast_to(v, self.motion.failed.shape)[0][self.chosen] for v in self.motion.inputs.drives[name][:3]
        ]
        dimension = coordinate_dimension(self.motion.structure.driven_angles[name])
        unit = unit_of(self.motion.mechanism.unit, dimension)
        return {"name": name, "unit": unit, "value": exact(values[0]), "rates": [exact(v) for v in values[1:]]}

    def _link(self, name: str) -> dict[str, Any]:
        at = [[self.places[node] for node in nodes] for nodes in self.program.links[name]]
        wrapped = self.program.mechanism.block.world[name].theta is None
        return {"at": at, "wrapped": wrapped, "own": self._own.has_link(name)}

    @cached_property
    def _own(self) -> OwnValues:
        return OwnValues(self.program, self.chosen)

    def _outputs(self) -> Iterator[dict[str, Any]]:
        for output, number in zip(self.program.outputs, self.program.recorded, strict=True):
            nodes = {"": number.x} if number.y is None else {"x": number.x, "y": number.y}
            parts = {part: self.places[node] for part, node in nodes.items()}
            own = self._own.has_output(output, [*nodes.values()])
            yield {"name": output.name, "parts": parts, "wrapped": output.is_wrapped, "own": own}
