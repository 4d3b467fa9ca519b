"""The program of a page: all links and some outputs of a mechanism, of its dimensions, at every pose of a motion.

Its operations become a table of whole numbers, which a small interpreter in any language computes row by row. Only
dimensions that can be changed one by one are inputs: the mechanism can still be built, and no redundant pair opens.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.groups.pair_sides import Reason
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solving_order import residual
from compoundkin.model.attributes import OF_LINKS
from compoundkin.model.pairs.profile_contact import Approach, ProfileContact, as_profile_contact
from compoundkin.programs.backends.tape_program import Instruction, allocate_rows
from compoundkin.programs.dimensions import FreeDimension, StatedDimensions, mechanism_with
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, node_strata
from compoundkin.programs.graph.operation_graph import (
    CONSTANT,
    DRIVE,
    INPUT,
    OPERATIONS,
    PARAMETER,
    SEED,
    SIGN,
    InputNumber,
    OperationGraph,
    group_seed,
)
from compoundkin.programs.recording.recorded_mechanism import RecordedMechanism, Recording, record_mechanism
from compoundkin.programs.recording.recorded_motion import ProgramOutput, RecordedLink, RecordedMotion, record_outputs
from compoundkin.programs.recording.recorded_number import RecordedNumber
from compoundkin.programs.recording.seeded_order import MORE_ORDERS, whole_curve
from compoundkin.programs.solved_designs import ProgramConfiguration, seed_values
from compoundkin.programs.sources.fixed_configuration import CarriedState, carried_states, changed_modes

# Pages show positions, velocities and accelerations.
HIGHEST = 2


class RecordedReason(NamedTuple):
    """A reason why a pose is not assembled.

    It has the node of where it holds, None everywhere; texts, and nodes for numbers.
    """

    holds: int | None
    words: tuple[str | int, ...]


@dataclass(frozen=True, repr=False)
class PageProgram(ShortRepr):
    """A mechanism as operations on its dimensions and drivers.

    It is in the configuration of a motion of one design. Results are nodes of the graph of the `mechanism`.
    """

    motion: Motion
    stated: StatedDimensions
    mechanism: RecordedMechanism
    outputs: tuple[ProgramOutput, ...]
    recorded: tuple[RecordedNumber, ...]
    # what else it computes, last of all, and the rows that are given for that
    more: tuple[int, ...] = ()
    rows: tuple[InputNumber, ...] = ()

    def with_more(self, nodes: Sequence[int], rows: Iterable[InputNumber]) -> PageProgram:
        """Return it with further nodes, which may depend on `rows` that are known at the poses.

        Raises InvalidInput where they depend on anything else that the program is not given.
        """
        graph, rows = self.mechanism.graph, tuple(rows)
        known = {*self.drives, *self.seeds, *rows, *(one.inputs[0] for one in self.mechanism.recording.free)}
        for given in (graph.nodes[k].given for k in graph.inputs(nodes)):
            if given is not None and given not in known:
                raise InvalidInput(Problem(given.full_name, "the program of a page is not given it"))
        return replace(self, more=tuple(nodes), rows=rows)

    @classmethod
    def of(cls, motion: Motion, outputs: Sequence[ProgramOutput] = ()) -> PageProgram:
        """Record a motion; outputs that no program tells are left out.

        Where it passes a change point, the signs of the groups that go on in their other modes are seeds. Raises
        InvalidInput where such a group is beside one without a closed form.
        """
        changed = changed_modes(motion)
        if changed and motion.solving_order.numbered:
            what = "the motion passes a change point beside a group without a closed form"
            raise InvalidInput(Problem(", ".join(changed[0].group.links), what, "leave the change point out"))
        order = min(HIGHEST, motion.order)
        signs, still, ends = ProgramConfiguration.of(motion).signs, _zero_rates(motion, order), motion.inputs.ends
        signs = {k: sign for k, sign in signs.items() if k not in {solver.index for solver in changed}}
        stated = StatedDimensions(motion.mechanism, ends)
        # coordinates of points, and numbers of pairs
        single = [one for one in stated.known.values() if one.is_read and not one.is_vector]
        free = buildable_dimensions(stated, single)
        mechanism = record_mechanism(Recording(motion.solving_order, signs, free, order, still, ends))
        found = dict(_recordable(mechanism, [one for one in outputs if one.attribute.order <= order]))
        return cls(motion, stated, mechanism, tuple(found), tuple(found.values()))

    @cached_property
    def dimensions(self) -> tuple[FreeDimension, ...]:
        """Single numbers of which each may be changed alone.

        They are coordinates of points, and numbers of pairs that something depends on.
        """
        free = self.mechanism.recording.free
        read = [one for one in free if one.is_of_link or not self._inputs.isdisjoint(one.inputs)]
        return consistent_dimensions(self.motion, self.mechanism, self.carried[0], self.stated, read)

    @cached_property
    def contacts(self) -> tuple[SearchedContact, ...]:
        """The contacts with profiles that it depends on."""
        names = dict.fromkeys(one.name for one in self._inputs if one.kind == SEED)
        return tuple(SearchedContact.of(self.mechanism, name) for name in names if name in self.mechanism.order.pairs)

    @cached_property
    def followers(self) -> tuple[SearchedFollower, ...]:
        """The groups whose contacts are found anew at each pose, as `solve` does."""
        contacts = {one.name: one for one in self.contacts}
        signed = [one for one in self.mechanism.order.solvers if one.index in self.mechanism.recording.signs]
        ways = ((solver, solver.approach(self.mechanism.block)) for solver in signed)
        return tuple(
            SearchedFollower.of(self, contacts[pair.name], solver, approach)
            for solver, approach in ways
            if approach
            for pair in solver.group.outer
            if pair.name in contacts
        )

    @cached_property
    def signs(self) -> Mapping[InputNumber, int]:
        """The signs that groups with change points have where other dimensions leave them none."""
        own = ProgramConfiguration.of(self.motion).signs
        indices = {group_seed(solver.index): solver.index for solver in self.mechanism.order.solvers}
        return {one: own[indices[one.name]] for one in self.seeds if one.part == SIGN}

    def keeps_change_points(self, one: FreeDimension) -> bool:
        """Return whether the change points of the motion hang on nothing that a dimension changes."""
        return self._meeting.isdisjoint(one.inputs)

    @cached_property
    def _meeting(self) -> Set[InputNumber]:
        """What the discriminants of groups with change points depend on."""
        graph, notes = self.mechanism.graph, self.mechanism.notes
        names = {one.name for one in self.signs}
        groups = [solver.index for solver in self.mechanism.order.solvers if group_seed(solver.index) in names]
        nodes = [self.mechanism.number(note.c[0]).x for k in groups for note in notes[k]]
        inputs = (graph.nodes[k].given for k in graph.inputs(_once(nodes)))
        return {one: None for one in inputs if one is not None}.keys()

    @property
    def order(self) -> int:
        """The highest derivative that it tells."""
        return self.mechanism.recording.order

    @cached_property
    def drives(self) -> tuple[InputNumber, ...]:
        """The values and rates of drivers, all that there may be."""
        names = self.mechanism.drives
        return tuple(InputNumber(DRIVE, name, str(k)) for name in names for k in range(HIGHEST + 1))

    @cached_property
    def goods(self) -> tuple[tuple[int, int], ...]:
        """The truths on which its groups and ends of guides hang, in order."""
        return tuple((index, self.mechanism.number(good).x) for index, good in self.mechanism.block.goods)

    @cached_property
    def links(self) -> Mapping[str, tuple[tuple[int, int, int], ...]]:
        """The nodes of each link's origin and angle, and of their derivatives in order."""
        found = RecordedMotion(self.mechanism).links
        return {name: tuple(self._moved(found[name], k) for k in range(self.order + 1)) for name in found}

    def _moved(self, link: RecordedLink, k: int) -> tuple[int, int, int]:
        z = self.mechanism.number(link.origin.derivative(k))
        return z.real.x, z.imag.x, self.mechanism.number(getattr(link, OF_LINKS[k])).x

    @cached_property
    def reasons(self) -> tuple[tuple[RecordedReason, ...], ...]:
        """Why each group is not assembled, each guide with ends beyond them, and why each pair does not fit."""
        order, block = self.mechanism.order, self.mechanism.block
        fits = order.fits
        found = (*(solver.reasons(block) for solver in order.solvers),
                 *(order.guide_ends.reasons(block, pair) for pair in order.guide_ends.pairs),
                 *(fits.reasons(block, k) for k in range(len(fits.pairs) if fits.asked else 0)))  # fmt: skip
        return tuple(tuple(map(self._reason, reasons)) for reasons in found)

    def _reason(self, reason: Reason) -> RecordedReason:
        number = self.mechanism.number
        holds = None if reason.holds is True else number(reason.holds).x
        return RecordedReason(holds, tuple(one if isinstance(one, str) else number(one).x for one in reason.words))

    @cached_property
    def _results(self) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]:
        """The nodes of what groups hang on, of all positions, of rates and outputs."""
        places = (node for moved in self.links.values() for node in moved[0])
        rates = (node for moved in self.links.values() for nodes in moved[1:] for node in nodes)
        told = (node for one in self.recorded for node in (one.x, one.y) if node is not None)
        return tuple(node for _, node in self.goods), _once(places), _once((*rates, *told))

    @cached_property
    def seeds(self) -> tuple[InputNumber, ...]:
        """What is found outside of it: states of groups, counted turns, contacts with profiles."""
        return tuple(one for one in self._inputs if one.kind == SEED)

    @cached_property
    def _inputs(self) -> Set[InputNumber]:
        """What anything depends on, in order."""
        graph = self.mechanism.graph
        inputs = (graph.nodes[k].given for k in graph.inputs(_once(k for part in self._results for k in part)))
        return {one: None for one in inputs if one is not None}.keys()

    @cached_property
    def carried(self) -> tuple[tuple[CarriedState, ...], tuple[CarriedState, ...]]:
        """What becomes of its seeds in their order; sides of singularities."""
        contacts = {one.name for one in self.contacts}
        found = carried_states(self.mechanism, [k for part in self._results for k in part], contacts)
        count = len(self.seeds) - sum(one.name in contacts for one in self.seeds)
        return found[:count], found[count:]

    def own(
        self, nodes: Sequence[int], poses: Number, rows: Mapping[InputNumber, Number] = MappingProxyType({})
    ) -> list[Number]:
        """Return values of nodes, with the mechanism's own dimensions, at some poses; `rows` are (designs, poses)."""
        motion, given = self.motion, {**seed_values(self.seeds, self.motion), **rows}
        for one in self.drives:
            given[one] = np.broadcast_to(motion.inputs.drives[one.name][int(one.part)], motion.failed.shape)
        numbers: dict[InputNumber, Number] = {one: values[0, poses] for one, values in given.items()}
        for free in self.mechanism.recording.free:
            numbers[free.inputs[0]] = float(np.ravel(self.stated.own(free))[0])
        return node_values(self.mechanism.graph, nodes, numbers)

    @cached_property
    def table(self) -> OperationTable:
        """Its operations, in five sections: what closes groups, positions, rates and outputs, reasons, what else."""
        closing, places, rates = self._results
        carried = (one.now.x for part in self.carried for one in part)
        aims = (part.x for one in self.contacts for part in (one.aim.real, one.aim.imag))
        paths = (node for one in self.followers for node in one.nodes)
        reasons = (node for each in self.reasons for one in each for node in (one.holds, *one.words))
        told = _once(node for node in reasons if isinstance(node, int))
        shown = {one.inputs[0]: None for one in self.dimensions}
        free = self.mechanism.recording.free
        known = {one.inputs[0]: float(np.ravel(self.stated.own(one))[0]) for one in free if one.inputs[0] not in shown}
        sections = _once((*closing, *carried, *aims, *paths)), places, rates, told, _once(self.more)
        return operation_table(
            self.mechanism.graph, sections, tuple(shown), (*self.drives, *self.seeds, *self.rows), known
        )


@dataclass(frozen=True, repr=False)
class SearchedContact(ShortRepr):
    """A contact with a profile, which whoever runs the program searches.

    `aim` is what it is searched by in the profile's frame: the place to which the nearest point is the contact, or, of
    a flat face, the direction in which that is farthest. The program is given the parameter there, and the profile's
    Taylor coefficients.
    """

    name: str
    pair: ProfileContact
    aim: RecordedNumber

    @classmethod
    def of(cls, mechanism: RecordedMechanism, name: str) -> SearchedContact:
        """Return the contact of a recorded pair."""
        pair = as_profile_contact(mechanism.order.pairs[name])
        assert pair is not None
        block = mechanism.block
        aim = pair.aim(block.ends[name], tuple(block.world[one].trimmed(0) for one in pair.members))
        return cls(name, pair, mechanism.number(aim))

    def numbers(self, aim: Number, order: int) -> dict[InputNumber, Number]:
        """Return what the program is given where the contact is searched by values of its aim."""
        curve = whole_curve(self.pair)
        s = (curve.support if self.pair.is_flat else curve.foot)(aim).c[0]
        found = {InputNumber(SEED, self.name, PARAMETER): s}
        for k, one in enumerate(curve.expansion(s, order)):
            found |= {InputNumber(SEED, self.name, f"x{k}"): one.real, InputNumber(SEED, self.name, f"y{k}"): one.imag}
        return found


@dataclass(frozen=True, repr=False)
class SearchedFollower(ShortRepr):
    """A follower whose contact is found where its path meets the whole profile.

    Whoever runs the program searches it: `start`, `centre` and `toward` are those of the approach, in the profile's
    frame. The coordinate found, the greatest or the least, is the state of the group in `index`.
    """

    contact: SearchedContact
    index: int
    straight: bool
    start: RecordedNumber
    centre: RecordedNumber
    toward: RecordedNumber
    sense: float
    is_greatest: bool

    @classmethod
    def of(
        cls, program: PageProgram, contact: SearchedContact, solver: GroupSolver, approach: Approach
    ) -> SearchedFollower:
        """Return the follower of a contact in the mode of the program."""
        path, number = approach.path, program.mechanism.number
        # which way it goes is a matter of its pair alone: +1 or -1 at all poses
        at = int(np.argmax(np.ravel(program.motion.assembled)))
        turns = [number(one).x for one in (path.sense, approach.sign)]
        sense, sign = (float(np.sign(np.ravel(one)[0])) for one in program.own(turns, np.array([at])))
        greatest = sign * program.mechanism.recording.signs[solver.index] > 0
        numbers = (number(path.start), number(path.centre), number(approach.toward))
        return cls(contact, solver.index, path.straight, *numbers, sense, greatest)

    @property
    def nodes(self) -> tuple[int, ...]:
        """The nodes of what it is searched by."""
        parts = (part for one in (self.start, self.centre) for part in (one.real.x, one.imag.x))
        return (*parts, self.toward.x, *(() if self.toward.y is None else (self.toward.y,)))


def _once(nodes: Iterable[int]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(nodes))


def _zero_rates(motion: Motion, order: int) -> frozenset[tuple[str, int]]:
    """Return the rates of drivers that are zero at all poses."""
    drives = motion.inputs.drives.items()
    return frozenset((name, k) for name, values in drives for k in range(1, order + 1) if not np.any(values[k]))


def _recordable(
    mechanism: RecordedMechanism, outputs: Sequence[ProgramOutput]
) -> Iterator[tuple[ProgramOutput, RecordedNumber]]:
    for output in outputs:
        try:
            yield output, record_outputs(mechanism, [output])[0]
        except InvalidInput:
            # a figure that is no straight-line arithmetic stays that of the mechanism as it was
            continue


# By which part of the size, or of itself, a dimension is changed: what opens in the second order opens by 1e-4, and no
# number of teeth becomes another one.
TRIAL_CHANGE = 0.0217


# Redundant pairs that open by less (in parts of the size, or radians) stay closed.
OPEN_GAP = 1e-6


# Poses at which they are looked at, and Newton's steps of groups without a closed form.
POSES, STEPS = 5, 8


def buildable_dimensions(stated: StatedDimensions, dimensions: Sequence[FreeDimension]) -> tuple[FreeDimension, ...]:
    """Return the dimensions of which each may be changed alone.

    Numbers of teeth may not, nor the axes of wheels of a given module.
    """
    size = stated.mechanism.geometry.size
    return tuple(_buildable_alone(stated, [(one, _changed(stated, one, size)) for one in dimensions]))


def _changed(stated: StatedDimensions, one: FreeDimension, size: float) -> tuple[float, float]:
    """Return the own value of a dimension, and by how much it is changed."""
    own = float(np.ravel(stated.own(one))[0])
    return own, TRIAL_CHANGE * (size if one.is_of_link else abs(own) or 1.0)


def _buildable_alone(
    stated: StatedDimensions, changes: Sequence[tuple[FreeDimension, tuple[float, float]]]
) -> Iterator[FreeDimension]:
    """Yield those that can be changed; where all can together, by different parts, each can alone."""
    parts = ((one, own + change * (1.0 + k / len(changes))) for k, (one, (own, change)) in enumerate(changes))
    try:
        mechanism_with(stated, dict(parts))
    except InvalidMechanism:
        if len(changes) > 1:
            half = len(changes) // 2
            yield from _buildable_alone(stated, changes[:half])
            yield from _buildable_alone(stated, changes[half:])
    else:
        yield from (one for one, _ in changes)


def consistent_dimensions(
    motion: Motion,
    mechanism: RecordedMechanism,
    states: Sequence[CarriedState],
    stated: StatedDimensions,
    dimensions: Sequence[FreeDimension],
) -> tuple[FreeDimension, ...]:
    """Return those whose change opens no redundant pair at any pose.

    All are inputs of the recorded mechanism, whose groups without a closed form have `states`.
    """
    pairs = tuple(mechanism.order.pairs[pair.name] for pair in motion.structure.redundant)
    if not pairs or not dimensions:
        return tuple(dimensions)
    opened = mechanism.number(residual(pairs, mechanism.block, mechanism.order.size)).x
    given = dict(_changed_inputs(motion, mechanism, stated, dimensions))
    given |= _own_states(motion, [one.given for one in states])
    graph = mechanism.graph
    needed = (graph.nodes[k].given for k in graph.inputs([opened, *(one.now.x for one in states)]))
    names = dict.fromkeys(one.name for one in needed if one is not None and one.kind == SEED)
    contacts = [SearchedContact.of(mechanism, name) for name in names if name in mechanism.order.pairs]
    own = {one.name: one.numbers(np.zeros(()), mechanism.recording.order + MORE_ORDERS) for one in contacts}
    given |= _own_states(motion, [given for one in own.values() for given in one])
    for _ in range(STEPS if states or contacts else 0):
        now = node_values(graph, [one.now.x for one in states], given)
        given |= {one.given: value for one, value in zip(states, now, strict=True)}
        for one in contacts:
            x, y = node_values(graph, [one.aim.real.x, one.aim.imag.x], given)
            given |= one.numbers(x + 1j * y, mechanism.recording.order + MORE_ORDERS)
    (found,) = node_values(mechanism.graph, [opened], given)
    rows = np.broadcast_to(found, (len(dimensions), np.shape(found)[-1] if np.ndim(found) else 1))
    stays = np.any(rows <= OPEN_GAP**2, axis=1) & ~np.any(rows > OPEN_GAP**2, axis=1)
    return tuple(one for one, good in zip(dimensions, stays, strict=True) if good)


def _sample_poses(motion: Motion) -> Number:
    """Return the indices of some poses that are assembled."""
    known = np.flatnonzero(motion.failed[0] == 0)
    return known[np.linspace(0, len(known) - 1, POSES).round().astype(int)]


def _own_states(motion: Motion, states: Sequence[InputNumber]) -> dict[InputNumber, Number]:
    own, at = seed_values(states, motion), _sample_poses(motion)
    return {given: values[:, at] for given, values in own.items()}


def _changed_inputs(
    motion: Motion, mechanism: RecordedMechanism, stated: StatedDimensions, dimensions: Sequence[FreeDimension]
) -> Iterator[tuple[InputNumber, Number]]:
    """Yield inputs over (designs, poses): each design has one dimension changed."""
    at, size = _sample_poses(motion), motion.size
    for one in mechanism.recording.free:
        own, change = _changed(stated, one, size)
        yield one.inputs[0], np.array([[own + change * (one == other)] for other in dimensions])
    for name, values in motion.inputs.drives.items():
        for k, value in enumerate(values):
            yield InputNumber(DRIVE, name, str(k)), np.broadcast_to(value, motion.failed.shape)[:, at]


def node_values(graph: OperationGraph, wanted: Sequence[int], given: Mapping[InputNumber, Number]) -> list[Number]:
    """Return the values of some nodes, which broadcast with those given.

    >>> graph, x = OperationGraph(), InputNumber("drive", "crank", "0")
    >>> node_values(graph, [graph.apply("mul", graph.input(x), graph.constant(2.0))], {x: np.array([1.0, 2.0])})
    [array([2., 4.])]
    """
    found: dict[int, Number] = {}
    with np.errstate(all="ignore"):
        for k in graph.needed(wanted):
            node = graph.nodes[k]
            if node.operation == INPUT:
                assert node.given is not None
                found[k] = given[node.given]
            elif node.operation == CONSTANT:
                found[k] = np.float64(node.value)
            else:
                found[k] = OPERATIONS[node.operation].compute(*(found[n] for n in node.operands))
    return [found[k] for k in wanted]


# The number of an operation is its place here.
CODES = tuple(OPERATIONS)


# An entry of the table: the operation, where its result goes, and three operands.
WIDTH = 5


@dataclass(frozen=True, repr=False)
class OperationTable(ShortRepr):
    """A table of operations, in the order in which they are computed.

    `before` is computed once for all poses, `along` at every pose: section by section, of which `ends` tells after how
    many operations each ends. A place that is not negative is a row over the poses, -1 - k is number k: `constants` are
    the first numbers, the dimensions of a call the next. `rows` and `numbers` are how many there are, `places` those of
    nodes.
    """

    constants: tuple[float, ...]
    numbers: int
    rows: int
    before: tuple[int, ...]
    along: tuple[int, ...]
    ends: tuple[int, ...]
    places: Mapping[int, int]


def operation_table(
    graph: OperationGraph,
    sections: Sequence[Sequence[int]],
    fixed: Sequence[InputNumber],
    along: Sequence[InputNumber],
    known: Mapping[InputNumber, float] = MappingProxyType({}),
) -> OperationTable:
    """Return the table that computes some nodes, section by section.

    `fixed` are the inputs that are one number for all poses, `along` those that are rows, both in their order; others
    are `known` numbers.

    >>> graph, x, a = OperationGraph(), InputNumber("drive", "crank", "0"), InputNumber("dimension", "crank.B", "x")
    >>> node = graph.apply("mul", graph.input(a), graph.apply("cos", graph.input(x)))
    >>> table = operation_table(graph, [[node]], [a], [x])
    >>> [CODES[table.along[k]] for k in (0, 5)], table.rows, table.numbers
    (['cos', 'mul'], 2, 1)
    """
    wanted = [k for section in sections for k in section]
    needed = graph.needed(wanted)
    given = {**dict.fromkeys((*fixed, *known), BY_DESIGN), **dict.fromkeys(along, BY_POSE)}
    strata = node_strata(graph, needed, given)
    work = [k for k in needed if graph.nodes[k].operation not in (CONSTANT, INPUT)]
    rows, ends = _in_sections(graph, sections, {k for k in work if strata[k] & BY_POSE})
    before = [k for k in work if not strata[k] & BY_POSE]
    constants = {k: graph.nodes[k].value for k in needed if graph.nodes[k].operation == CONSTANT}
    constants |= {graph.input(one): value for one, value in known.items()}
    numbers = (*constants, *map(graph.input, fixed), *before)
    held = _row_places(graph, rows, wanted, along)
    places = {k: -1 - place for place, k in enumerate(numbers)} | held
    rows_held = 1 + max(held.values(), default=-1)
    first, along_poses = _entries(graph, before, places), _entries(graph, rows, places)
    return OperationTable(tuple(constants.values()), len(numbers), rows_held, first, along_poses, ends, places)


def _row_places(
    graph: OperationGraph, nodes: Sequence[int], wanted: Sequence[int], along: Sequence[InputNumber]
) -> dict[int, int]:
    """Return the rows that hold inputs and nodes; rows of what is not wanted are taken again."""
    steps = [Instruction(graph.nodes[k].operation, graph.nodes[k].operands, k) for k in nodes]
    held = {graph.input(one): row for row, one in enumerate(along)}
    return held | {k: len(along) + row for k, (_, row) in allocate_rows(steps, {*wanted}).rows.items()}


def _in_sections(
    graph: OperationGraph, sections: Sequence[Sequence[int]], among: Collection[int]
) -> tuple[list[int], tuple[int, ...]]:
    """Return the nodes in the order in which sections need them, and after how many each section ends."""
    found, ends = dict[int, None](), list[int]()
    for section in sections:
        found.update(dict.fromkeys(k for k in graph.needed(section, found) if k in among))
        ends.append(len(found))
    return list(found), tuple(ends)


def _entries(graph: OperationGraph, nodes: Sequence[int], places: Mapping[int, int]) -> tuple[int, ...]:
    found, code = list[int](), {name: number for number, name in enumerate(CODES)}
    for k in nodes:
        node = graph.nodes[k]
        operands = [places[operand] for operand in node.operands]
        found += [code[node.operation], places[k], *operands, *[0] * (WIDTH - 2 - len(operands))]
    return tuple(found)
