"""Exercises: variants of one mechanism in rounded numbers, questions, worked solutions, answers as a table."""

from __future__ import annotations

import csv
import io
import os
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.analysis.equations.loop_equations import loop_equations
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, degrees
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem, UnknownName, suggestion
from compoundkin.base.suffixes import suffix_for
from compoundkin.files.atomic import new_folder
from compoundkin.files.saved_files import save
from compoundkin.kinematics import Motion, solve
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import (
    ACCELERATION,
    ANGLE,
    ANGULAR_ACCELERATION,
    ANGULAR_VELOCITY,
    EFFORT,
    FORCE,
    LENGTH,
    SPEED,
)
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.dimensions import StatedDimensions, free_dimensions, mechanism_with
from compoundkin.structure import Structure, roman
from compoundkin.structure.decomposition import decompose_near_drawing
from compoundkin.view.report.centres_section import centres_sections
from compoundkin.view.report.equations_sections import constants_section, equations_section, pose_section, rates_section
from compoundkin.view.report.groups_section import solving_section
from compoundkin.view.report.pose_sample import Sample
from compoundkin.view.report.report_data import NOT_SOLVED, Block, Cell, Column, Paragraph, Section, TableBlock
from compoundkin.view.report.report_forms import Report, latex_document
from compoundkin.view.report.structure_sections import loops_section, mobility_section
from compoundkin.view.report.wording import listed, number_text
from compoundkin.view.sketch.shapes import Shape, ShapeGroup

if TYPE_CHECKING:
    from compoundkin.dynamics.forces import Forces

# The questions that can be set, in the order of a course.
KINDS = ("mobility", "groups", "positions", "velocities", "accelerations", "forces")
# A variant is sought this often before it is given up.
TRIALS = 200
# After so many of them strokes may end before the given ones, by the rest of this share of the poses.
WHOLE_TRIALS, LEAST_SHARE = 20, 0.5
# Poses of the cycle at which a variant must assemble where the given mechanism does.
CYCLE = 73
# Angles nearer to a multiple of a right angle (degrees), and links nearer to parallel, are special cases.
NEARLY = 3.0
# Rates greater than this, in those of the driver, are near a limit position.
FASTEST = 12.0
GIVEN_POINTS = (
    "Points are given in the frame of their own link; the angle of a link of two points is that of the line from the "
    "first to the second."
)
# Colours and rings of groups in a sketch: the figure of a sheet has none, as it would give them away.
OF_GROUPS = re.compile(r"\b([a-z-]+)\d+\b")
# Links that turn slower than this part of the driver are near a dead point.
SLOWEST = 0.02
# Two digits are printed; after a leading 1 half steps, so that 1.25 lies between 1.2 and 1.3.
HALF_BELOW = 2.0
# A coordinate below this part of the size is the rounding of a zero.
ROUNDING = 1e-9
# By which part lengths are changed to see whether they can be.
SLIGHTLY = 0.02
# A point slower than this part of the mechanism's size a second stands still.
STILL = 1e-9
# A driver's angle is printed in steps of so many degrees.
STEP_OF_ANGLES = 5.0


@dataclass(frozen=True)
class ExerciseAnswer:
    """A number or word that is asked for; `unit` is "" where there is none."""

    quantity: str
    value: float | int | str
    unit: str = ""


@dataclass(frozen=True)
class Question:
    """A question of one kind with its answers and the sections of its worked solution."""

    kind: str
    text: str
    answers: tuple[ExerciseAnswer, ...]
    solution: tuple[Section, ...] = field(repr=False)


@dataclass(frozen=True)
class Exercise:
    """One variant: the mechanism with its rounded numbers, the motion at the given pose, the questions."""

    number: int
    mechanism: Mechanism = field(repr=False)
    motion: Motion = field(repr=False)
    given: tuple[tuple[Cell, ...], ...]
    drives: tuple[tuple[Cell, ...], ...]
    questions: tuple[Question, ...]

    @property
    def title(self) -> str:
        """The title of the mechanism and the number of the variant."""
        return f"{self.mechanism.title}: exercise {self.number}"

    @cached_property
    def sheet(self) -> Report:
        """What a student gets: the given values and the questions."""
        asked = (
            Section(f"question-{k}", f"{k}. {one.kind.capitalize()}", (Paragraph(one.text),))
            for k, one in enumerate(self.questions, 1)
        )
        sections = Section("given", "Given", tuple(self._given_blocks())), *asked
        return Report(self.title, sections, NOT_SOLVED)

    @cached_property
    def solution(self) -> Report:
        """The worked solution: the given values, then each question with its answers and the working."""
        sections = [Section("given", "Given", tuple(self._given_blocks()))]
        for k, one in enumerate(self.questions, 1):
            rows = tuple((a.quantity, a.value if isinstance(a.value, str) else float(a.value), a.unit)
                         for a in one.answers)  # fmt: skip
            words = any(isinstance(a.value, str) for a in one.answers)
            cells = tuple((q, v if isinstance(v, str) else number_text(v), u) for q, v, u in rows) if words else rows
            answers = TableBlock((Column("answer"), Column("value", style="text" if words else "each"), Column("unit")),
                                 cells)  # fmt: skip
            head = Section(f"question-{k}", f"{k}. {one.kind.capitalize()}", (Paragraph(one.text), answers))
            sections += [head, *(replace(part, key=f"{part.key}-{k}") for part in one.solution)]
        return Report(f"{self.title}, solution", tuple(sections), NOT_SOLVED)

    def figure(self, form: str = "svg", with_groups: bool = False) -> str:
        """Return the sketch at the given pose as "svg" or "tikz", with the colours of groups or without."""
        from compoundkin.view.sketch import draw

        drawn = draw(self.motion, pose=0)
        shapes = drawn.shapes if with_groups else tuple(map(_of_one_group, drawn.shapes))
        return replace(drawn, shapes=shapes).content(form).decode()

    def _given_blocks(self) -> Iterator[Block]:
        unit = self.mechanism.unit
        yield TableBlock(
            (Column("driver"), Column("value"), Column("unit"), Column("rate"), Column("unit")), self.drives
        )
        yield Paragraph(GIVEN_POINTS)
        yield TableBlock((Column("of"), Column("dimension"), Column("value"), Column("unit")), self.given)
        if self.mechanism.loads or self.mechanism.masses:
            from compoundkin.view.report.forces_section import loads_table, masses_table

            forces = _forces(self.motion)
            if forces is not None:
                yield from (table for table in (masses_table(forces), loads_table(forces)) if table.rows)
        if not unit:
            yield Paragraph("Lengths are in one unit.")


@dataclass(frozen=True)
class Exercises:
    """Variants of one exercise, as many as asked for; `fixed` are dimensions that all of them share."""

    variants: tuple[Exercise, ...]
    fixed: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.variants)

    def __getitem__(self, k: int) -> Exercise:
        return self.variants[k]

    @property
    def answers(self) -> tuple[tuple[Any, ...], ...]:
        """All answers as rows: variant, question, kind, quantity, value, unit."""
        return tuple(
            (one.number, k, asked.kind, a.quantity, a.value, a.unit)
            for one in self.variants
            for k, asked in enumerate(one.questions, 1)
            for a in asked.answers
        )

    def answers_csv(self) -> str:
        """Return the answers as a CSV table to correct by."""
        to = io.StringIO()
        writer = csv.writer(to, lineterminator="\n")
        writer.writerow(("variant", "question", "kind", "quantity", "value", "unit"))
        for *row, value, unit in self.answers:
            writer.writerow((*row, f"{value:.6g}" if isinstance(value, float) else value, unit))
        return to.getvalue()

    def save(self, folder: str | os.PathLike[str], progress: Callable[[int, int], None] | None = None) -> Path:
        """Write sheets and solutions of all variants into a folder, as Markdown, HTML and LaTeX, and the answers.

        Each variant has its mechanism file and its figure beside them. The folder is there with all of them, or not at
        all. Raises InvalidInput where it cannot be made, or holds files already.
        """
        with new_folder(folder) as target:
            for k, one in enumerate(self.variants):
                for name, content in _files(one):
                    (target / name).write_bytes(content)
                save(one.mechanism, target / f"{one.number:02d}{suffix_for('mechanism', 'toml')}")
                if progress is not None:
                    progress(k + 1, len(self.variants))
            (target / f"answers{suffix_for('table', 'csv')}").write_bytes(self.answers_csv().encode())
        return Path(folder)


def _files(one: Exercise) -> Iterator[tuple[str, bytes]]:
    """Yield the names and contents of a variant's files."""
    from compoundkin.view.page.report_page import page_of

    for report, stem in ((one.sheet, f"{one.number:02d}"), (one.solution, f"{one.number:02d}-solution")):
        svg, tikz = (one.figure(form, with_groups=report is one.solution) for form in ("svg", "tikz"))
        figure = f'<figure style="margin:0 0 .5em;max-width:30em">{svg}</figure>'
        page = page_of(report.title, report.sections, report.outcome, figures={"given": figure})
        head, _, rest = report.markdown().partition("\n\n")
        yield stem + suffix_for("picture", "svg"), svg.encode()
        image = f"![The mechanism at the given pose]({stem}{suffix_for('picture', 'svg')})"
        yield stem + suffix_for("report", "markdown"), f"{head}\n\n{image}\n\n{rest}".encode()
        yield stem + suffix_for("report", "html"), page.html.encode()
        yield stem + suffix_for("picture", "tikz"), latex_document(report.title, report.sections, tikz).encode()


@checked
def exercise(
    mechanism: Mechanism, *, vary: float = 0.1, seed: int = 0, count: int = 1, questions: str | Sequence[str] = ()
) -> Exercises:
    """Return variants of an exercise on a mechanism: given values, questions by kind, answers, worked solutions.

    Each dimension is multiplied by a factor within `vary` (a fraction) of 1 and rounded to the two digits that a
    textbook prints; the rounded numbers are what is solved. Driver values are rounded to 5 degrees. Variants assemble
    wherever the mechanism does in its cycle, and at the pose no link is parallel to another or to an axis, no instant
    centre at infinity, no rate near a limit. `questions` are some of "mobility", "groups", "positions", "velocities",
    "accelerations", "forces"; left out, all that the mechanism allows. The same seed gives the same variants; variant k
    does not depend on how many there are. Raises InvalidInput, UnknownName for an unknown kind of question, and
    NotDetermined or InvalidMechanism where the mechanism itself cannot be solved.

    >>> from compoundkin.model.elements import drive, link
    >>> parts = link("frame", A=0, D=60), link("crank", A=0, B=20), link("coupler", B=0, C=50)
    >>> four_bar = Mechanism("Four-bar", *parts, link("rocker", D=0, C=40), drive("crank"), unit="mm")
    >>> made = exercise(four_bar, seed=7, questions="mobility")
    >>> made.answers
    ((1, 1, 'mobility', 'links', 4, ''), (1, 1, 'mobility', 'pairs', 4, ''), (1, 1, 'mobility', 'mobility', 1, ''))
    """
    if not 0.0 <= vary < 1.0:
        raise InvalidInput(Problem("vary", f"{vary!r} is no fraction", "0.1 is ten percent; at least 0, below 1"))
    if count < 1:
        raise InvalidInput(Problem("count", f"there are no {count} variants", "at least 1"))
    if seed < 0:
        raise InvalidInput(Problem("seed", f"{seed} is negative", "0 or a positive whole number"))
    kinds = _checked_kinds(mechanism, (questions,) if isinstance(questions, str) else tuple(questions))
    template = _Template(mechanism, vary)
    variants = tuple(_variant(template, seed, k, kinds) for k in range(1, count + 1))
    return Exercises(variants, template.fixed)


def _checked_kinds(mechanism: Mechanism, wanted: Sequence[str]) -> tuple[str, ...]:
    for kind in wanted:
        if kind not in KINDS:
            raise UnknownName(Problem(f"questions: {kind}", "there is no such question", suggestion(kind, list(KINDS))))
    has_forces = mechanism.units is not None and bool(mechanism.loads or mechanism.masses)
    if "forces" in wanted and not has_forces:
        what = "the mechanism has no loads or masses, or no units of force"
        raise InvalidInput(Problem("questions: forces", what, "write loads and [units], or leave this question out"))
    chosen = wanted or (KINDS if has_forces else KINDS[:-1])
    return tuple(kind for kind in KINDS if kind in chosen)


class _Template:
    """What of a mechanism can vary: lengths whose change alone leaves it assembled, and how its drivers go."""

    def __init__(self, mechanism: Mechanism, vary: float) -> None:
        self.mechanism, self.vary = mechanism, vary
        self.motion = solve(mechanism)
        if not self.motion.assembled.any():
            raise InvalidInput(Problem(mechanism.title, "it is not assembled at any pose", "mend it first: report it"))
        if self.motion.inputs.designs > 1:
            raise InvalidInput(Problem(mechanism.title, "it has several designs", "give one"))
        self.stated = StatedDimensions(mechanism, self.motion.inputs.ends)
        self.is_whole = bool(self.motion.assembled.all())
        # where no driver turns fully, as with cylinders, few variants reach as far at both ends of all strokes
        turns = (one.is_angle and np.ptp(one.value) >= TURN * (1.0 - ROUNDING) for one in self.motion.drives.values())
        self.least_share = 1.0 if any(turns) else LEAST_SHARE
        self.varied: list[dict[str, float]] = []
        fixed: list[str] = []
        for equal in self._equal_lengths():
            if vary and self._may_change(equal):
                self.varied.append(equal)
            else:
                alone = [{name: own} for name, own in equal.items() if vary and len(equal) > 1]
                free = [one for one in alone if self._may_change(one)]
                self.varied += free
                fixed += [name for name in equal if {name: equal[name]} not in free]
        self.fixed = tuple(fixed)

    def _equal_lengths(self) -> list[dict[str, float]]:
        """Return the coordinates of points, equal ones together: a parallelogram remains one."""
        found: dict[str, dict[str, float]] = {}
        for name, one in self.stated.known.items():
            if one.is_of_link and one.part:
                own = float(np.ravel(self.stated.own(one))[0])
                if abs(own) > ROUNDING * self.mechanism.geometry.size:
                    found.setdefault(f"{abs(own):.9g}", {})[name] = own
        return list(found.values())

    def _may_change(self, lengths: Mapping[str, float]) -> bool:
        """Whether the mechanism assembles with these lengths a little shorter, and a little longer."""
        changes = ({name: own * (1.0 + step) for name, own in lengths.items()} for step in (-SLIGHTLY, SLIGHTLY))
        return all(self.solved(values) is not None for values in changes)

    def changed(self, values: Mapping[str, float]) -> Mechanism:
        """Return the mechanism with other lengths."""
        free = free_dimensions(self.stated, list(values))
        return mechanism_with(self.stated, {one: values[one.name] for one in free})

    def solved(self, values: Mapping[str, float], share: float = 1.0) -> Motion | None:
        """Return the motion with other lengths over the cycle; None where less of it assembles than a share."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                # near the drawing: what is overconstrained and no longer fits is not searched for from afar
                structure = decompose_near_drawing(self.changed(values))
                if any(fault.kind == "over" for fault in structure.faults):
                    return None
                motion = solve(structure)
        except CompoundkinError:
            return None
        enough = np.mean(motion.assembled) >= share if self.is_whole else motion.assembled.any()
        return motion if enough else None


def printed(value: float) -> float:
    """Return a number with the two digits that a textbook prints; after a leading 1 in half steps.

    >>> [printed(value) for value in (61.7, 12.27, 0.1234, -348.0)]
    [62.0, 12.5, 0.125, -350.0]
    """
    if value == 0.0:
        return 0.0
    power = int(np.floor(np.log10(abs(value))))
    step = 10.0 ** (power - 1) * (0.5 if abs(value) < HALF_BELOW * 10.0**power else 1.0)
    return float(f"{round(value / step) * step:.12g}")


def _variant(template: _Template, seed: int, number: int, kinds: Sequence[str]) -> Exercise:
    """Return one variant: the first of its random numbers that is no special case."""
    rng = np.random.default_rng((seed, number))
    reason = ""
    for trial in range(TRIALS):
        factors = 1.0 + template.vary * rng.uniform(-1.0, 1.0, len(template.varied))
        values = {n: printed(v * f) for own, f in zip(template.varied, factors, strict=True) for n, v in own.items()}
        share = 1.0 if trial < WHOLE_TRIALS else template.least_share
        place, pace = rng.uniform(), rng.uniform(-1.0, 1.0)
        # where all of the cycle has to assemble, the pose is known before it, and takes a fraction of its time
        is_pose_first = bool(values) and template.is_whole and share == 1.0
        cycle = template.motion if is_pose_first or not values else template.solved(values, share)
        mechanism = template.changed(values) if values and cycle is not None else template.mechanism
        motion = None if cycle is None else _at_pose(mechanism, cycle, place, pace, template.vary)
        # an overconstrained mechanism keeps its special dimensions, and its special positions with them
        reason = "" if motion is None else _special(motion, strict=trial < TRIALS // 2)
        if motion is None or reason:
            continue
        if not is_pose_first or template.solved(values, share) is not None:
            return _exercise(number, mechanism, motion, kinds)
        reason = "it does not assemble wherever the given one does"
    what = f"no variant {number} was found among {TRIALS}: {reason or 'its poses do not assemble'}"
    raise InvalidInput(Problem("vary", what, "vary less, or take another seed"))


def _at_pose(mechanism: Mechanism, cycle: Motion, place: float, pace: float, vary: float) -> Motion | None:
    """Return the motion at one pose of the cycle with a rounded value and rate of each driver."""
    assembled = np.flatnonzero(np.ravel(cycle.assembled))
    k = int(assembled[int(place * len(assembled))])
    values, speeds = {}, {}
    for name, drive in cycle.drives.items():
        value = float(np.broadcast_to(drive.value, cycle.shape).ravel()[k])
        rate = float(np.broadcast_to(drive.rate, cycle.shape).ravel()[k]) or 1.0
        if drive.is_angle:
            value = float(np.deg2rad(round(float(degrees(value)) / STEP_OF_ANGLES) * STEP_OF_ANGLES))
        else:
            value = printed(value)
        values[name], speeds[name] = value, printed(rate * (1.0 + vary * pace))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            motion = solve(mechanism, values, speed=speeds, acceleration=dict.fromkeys(values, 0.0), order=2)
    except CompoundkinError:
        return None
    return motion if motion.assembled.all() else None


def _shortest_arm(mechanism: Mechanism) -> float:
    """Return the least distance of two points of a link: what a cylinder turns may turn as fast as about that arm."""
    size = mechanism.geometry.size
    gaps = (
        abs(complex(np.ravel(one)[0]) - complex(np.ravel(other)[0]))
        for own in mechanism.geometry.points.values()
        for one, other in combinations(own.values(), 2)
    )
    return min((gap for gap in gaps if gap > ROUNDING * size), default=size)


def _special(motion: Motion, strict: bool) -> str:
    """Return what is special about a pose, "" where nothing is: what two students could read off the figure."""
    rates = {name: float(np.ravel(link.angular_velocity)[0]) for name, link in motion.links.items()}
    arm = _shortest_arm(motion.mechanism)
    driven = max(abs(float(np.ravel(one.rate)[0])) / (1.0 if one.is_angle else arm) for one in motion.drives.values())
    if not all(np.isfinite(rate) and abs(rate) <= FASTEST * driven for rate in rates.values()):
        return "a limit position is near"
    if strict:
        # followers rest for a part of the turn
        if not _asked_links(motion) and not _moving_points(motion)[0]:
            return "nothing moves but what is driven"
        turning = {
            (round(float(degrees(np.ravel(one.angle)[0])), 6), round(rates[n], 9))
            for n, one in motion.links.items()
            if abs(rates[n]) > STILL
        }
        if any(abs((angle + 45.0) % 90.0 - 45.0) < NEARLY for angle, _ in turning):
            return "a link is level or upright"
        # a block and its guide have one angle, and so have links that are always parallel
        angles = sorted({(round(angle % 180.0, 6) % 180.0, rate) for angle, rate in turning})
        if any((angles[k][0] - angles[k - 1][0]) % 180.0 < NEARLY for k in range(len(angles)) if len(angles) > 1):
            return "two links are parallel"
        if len(turning) > 1 and min(abs(rate) for _, rate in turning) < SLOWEST * driven:
            return "a dead point is near"
    return ""


def _exercise(number: int, mechanism: Mechanism, motion: Motion, kinds: Sequence[str]) -> Exercise:
    asked = tuple(_QUESTIONS[kind](motion.structure, motion) for kind in kinds)
    return Exercise(number, mechanism, motion, tuple(_dimensions(mechanism, motion)), tuple(_drives(motion)), asked)


def _dimensions(mechanism: Mechanism, motion: Motion) -> Iterator[tuple[Cell, ...]]:
    """Yield the dimensions that are given: of links, a bar by its length, then of pairs."""
    for link, points in mechanism.geometry.points.items():
        places = {letter: complex(np.ravel(point)[0]) for letter, point in points.items()}
        (first, start), *rest = places.items() or (("", 0j),)
        if link != FRAME and len(rest) == 1 and start == 0 and rest[0][1].imag == 0 and rest[0][1].real > 0:
            yield link, f"length {first}{rest[0][0]}", number_text(rest[0][1].real), mechanism.unit
            continue
        for letter, place in places.items():
            if link == FRAME or len(places) > 1 or place:
                text = f"({number_text(place.real)}, {number_text(place.imag)})"
                yield link, f"point {letter}", text, mechanism.unit
    stated = StatedDimensions(mechanism, motion.inputs.ends)
    for one in stated.known.values():
        if one.is_read and not one.is_of_link:
            own, unit = float(np.ravel(stated.own(one))[0]), stated.unit(one)
            shown = float(degrees(own)) if unit == "rad" else own
            yield one.owner, one.number, number_text(shown), "deg" if unit == "rad" else unit


def _drives(motion: Motion) -> Iterator[tuple[Cell, ...]]:
    """Yield the values and the speeds of the drivers."""
    for shown in Sample(motion).drivers:
        drive = motion.drives[shown.name]
        rate = f"{motion.mechanism.unit or 'length'}/s" if not drive.is_angle else "rad/s"
        value, speed = float(np.ravel(shown.values)[0]), float(np.ravel(drive.rate)[0])
        yield shown.name, number_text(value), shown.unit, number_text(speed), rate


def _of_one_group(shape: Shape) -> Shape:
    """Return a shape in the colour of the frame and the driven links."""
    style = OF_GROUPS.sub(r"\g<1>0", shape.style)
    if isinstance(shape, ShapeGroup):
        return replace(shape, style=style, shapes=tuple(map(_of_one_group, shape.shapes)))
    return replace(shape, style=style)


def _mobility(structure: Structure, motion: Motion) -> Question:
    count = structure.mobility
    answers = (
        ExerciseAnswer("links", count.links),
        ExerciseAnswer("pairs", sum(one.number for one in count.pairs)),
        ExerciseAnswer("mobility", count.freedoms),
    )
    text = (
        "How many links and pairs are there (a multiple pin counts once less than its links), and what is the mobility?"
    )
    return Question("mobility", text, answers, (mobility_section(structure, motion), loops_section(structure)))


def _groups(structure: Structure, motion: Motion) -> Question:
    names = [f"{listed(list(group.links))} (class {roman(group.class_)})" for group in structure.groups]
    highest = roman(max((group.class_ for group in structure.groups), default=1))
    answers = (
        ExerciseAnswer("groups", len(structure.groups)),
        ExerciseAnswer("in order", "; ".join(names) or "none"),
        ExerciseAnswer("class of the mechanism", highest),
    )
    text = "Take the mechanism apart into Assur groups, in the order in which they can be solved. Of which class is it?"
    return Question("groups", text, answers, (solving_section(structure, motion),))


def _asked_links(motion: Motion) -> list[str]:
    """The links that turn and are not driven."""
    known = {*motion.structure.translating_links, *_driven(motion), FRAME}
    return [name for name in motion.links if name not in known]


def _driven(motion: Motion) -> set[str]:
    return {link for link in motion.structure.ground.links if link != FRAME}


def _moving_points(motion: Motion) -> tuple[list[str], list[str]]:
    """The points that move: those that are to be found, and those of driven links."""
    slow, of_driven = STILL * motion.mechanism.geometry.size, _driven_points(motion)
    moving = [name for name, point in motion.points.items() if abs(complex(np.ravel(point.velocity)[0])) > slow]
    return [name for name in moving if name not in of_driven], [name for name in moving if name in of_driven]


def _driven_points(motion: Motion) -> set[str]:
    return {letter for link in _driven(motion) for letter in motion.mechanism.geometry.points[link]}


def _asked_points(motion: Motion) -> list[str]:
    """The points that are traced; where none is, the pins that move, then all that may, then those of driven links."""
    carriers = motion.mechanism.carriers
    moving, driven = _moving_points(motion)
    of_driven = _driven_points(motion)
    free = [name for name in motion.points if name not in of_driven and FRAME not in carriers.get(name, ())]
    return [name for name in moving if len(carriers.get(name, ())) == 1] or moving or free or driven


def _answers(motion: Motion, words: Sequence[str]) -> tuple[ExerciseAnswer, ...]:
    sample, found = Sample(motion), []
    for word in words:
        one = sample.quantity(word)
        value = float(np.ravel(one.values)[0])
        value = 0.0 if abs(value) <= sample.floor(one) else value
        found.append(ExerciseAnswer(word, value, one.unit))
    return tuple(found)


def _names(names: Sequence[str], what: str) -> str:
    return f"{what if len(names) == 1 else what + 's'} {listed(list(names))}"


def _positions(structure: Structure, motion: Motion) -> Question:
    links, points = _asked_links(motion), _asked_points(motion)
    words = [f"{name}.{ANGLE}" for name in links] + [f"{name}.{axis}" for name in points for axis in "xy"]
    parts = [_names(links, "the angle of the link")] if links else []
    parts += [_names(points, "the place of the point")] if points else []
    text = f"Find {listed(parts)} at the given pose, in the configuration of the figure."
    found = loop_equations(structure, 2)
    constants = constants_section(found)
    solution = equations_section(found), *((constants,) if constants else ())
    return Question("positions", text, _answers(motion, words), solution)


def _velocities(structure: Structure, motion: Motion) -> Question:
    links, points = _asked_links(motion), _asked_points(motion)
    words = [f"{name}.{ANGULAR_VELOCITY}" for name in links] + [f"{name}.{SPEED}" for name in points]
    parts = [_names(links, "the angular velocity of the link")] if links else []
    parts += [_names(points, "the speed of the point")] if points else []
    text = f"Find all instant centres, and with them {listed(parts)}."
    return Question("velocities", text, _answers(motion, words), centres_sections(Sample(motion)))


def _accelerations(structure: Structure, motion: Motion) -> Question:
    links, points = _asked_links(motion), _asked_points(motion)
    words = [f"{name}.{ANGULAR_ACCELERATION}" for name in links]
    words += [f"{name}.{ACCELERATION}.{axis}" for name in points for axis in "xy"]
    parts = [_names(links, "the angular acceleration of the link")] if links else []
    parts += [_names(points, "the acceleration of the point")] if points else []
    text = f"Find {listed(parts)}; the drivers have constant rates."
    found = loop_equations(structure, 2)
    return Question("accelerations", text, _answers(motion, words), (rates_section(found), pose_section(found, motion)))


def _forces(motion: Motion) -> Forces | None:
    from compoundkin.dynamics.force_analysis import force_analysis

    try:
        return force_analysis(motion)
    except CompoundkinError:
        return None


def _forces_question(structure: Structure, motion: Motion) -> Question:
    from compoundkin.dynamics.force_analysis import force_analysis
    from compoundkin.view.report.forces_section import sheet

    forces = force_analysis(motion)
    pins = list(motion.mechanism.pins)
    words = [f"{name}.{EFFORT}" for name in motion.drives] + [f"{name}.{FORCE}.{LENGTH}" for name in pins]
    known = Sample(motion)
    answers = []
    for word in words:
        try:
            one = quantity(forces, word).shown
        except CompoundkinError:
            continue
        answers.append(ExerciseAnswer(word, float(known.of(one.values)[0]), one.unit))
    text = "Draw the free body of every link, and find the forces in the pins and what the drivers must give."
    return Question("forces", text, tuple(answers), sheet(forces, pose=0).sections)


_QUESTIONS: Mapping[str, Callable[[Structure, Motion], Question]] = {
    "mobility": _mobility,
    "groups": _groups,
    "positions": _positions,
    "velocities": _velocities,
    "accelerations": _accelerations,
    "forces": _forces_question,
}
