"""`synthesise`: the mechanisms that do what a task says, all of them where they are finitely many."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import DisplaysHtml, aligned_text, count_phrase, display_function
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.linear import one_thread
from compoundkin.dimensional.added_dyads import added_output, double_dwell
from compoundkin.dimensional.candidates import Candidates
from compoundkin.dimensional.curve_fitting import traced
from compoundkin.dimensional.defects import ACCURACY as ACCURACY_DEFECT
from compoundkin.dimensional.defects import Rejection, SolvedLinkage, confirmed, judged
from compoundkin.dimensional.function_generation import (
    approached_function,
    crank_rocker,
    exact_function,
    stroke_linkage,
)
from compoundkin.dimensional.motion_generation import (
    few_poses_with_timing,
    five_poses,
    four_poses,
    many_poses,
    three_poses,
)
from compoundkin.dimensional.path_generation import mixed_positions, path_points
from compoundkin.dimensional.sampled_functions import sampled_function
from compoundkin.dimensional.sampled_motions import sampled_motion
from compoundkin.dimensional.tasks import (
    ACCURACY,
    COMPACTNESS,
    TRANSMISSION,
    Conditions,
    CurveTask,
    DwellTask,
    FunctionTask,
    MixedTask,
    OutputTask,
    PointTask,
    PoseTask,
    StrokeTask,
    SwingTask,
    Task,
    TimedPointTask,
)
from compoundkin.model.mechanism import Mechanism

# Of a family no more solutions are kept.
KEPT = 40


@dataclass(frozen=True)
class Method:
    """A way to meet a class of tasks: `run` takes a task that it `fits` and gives candidates."""

    of: type[Task]
    run: Callable[[Any], Candidates]
    fits: Callable[[Any], bool] = lambda task: True


# In this order: the first that fits a task is taken.
METHODS: tuple[Method, ...] = (
    Method(PoseTask, sampled_motion, lambda task: task.links > 0),
    Method(PoseTask, five_poses, lambda task: task.count == 5),
    Method(PoseTask, four_poses, lambda task: task.count == 4),
    Method(PoseTask, three_poses, lambda task: task.count == 3),
    Method(PoseTask, many_poses, lambda task: task.count > 5 and len(task.z) == task.count),
    Method(FunctionTask, sampled_function, lambda task: task.links > 0),
    Method(FunctionTask, exact_function, lambda task: len(task.inputs) <= 5),
    Method(FunctionTask, approached_function),
    Method(SwingTask, crank_rocker),
    Method(OutputTask, added_output),
    Method(DwellTask, double_dwell),
    Method(StrokeTask, stroke_linkage),
    Method(PointTask, path_points),
    Method(CurveTask, traced),
    Method(
        MixedTask, mixed_positions, lambda task: len(task.z) in (2, 3, 4) and 2 * len(task.z) + len(task.points) == 10
    ),
    Method(TimedPointTask, few_poses_with_timing, lambda task: 3 <= len(task.points) <= 5),
)


@dataclass(frozen=True, eq=False, repr=False)
class Answer(DisplaysHtml):
    """The answer to a task: `solutions` ranked, the best first; `rejected` with their reasons.

    `complete` says what of how many was found, `note` what is special, `nearest` where there is no solution how far the
    task would have to give.
    """

    task: Task
    solutions: tuple[SolvedLinkage, ...]
    rejected: tuple[Rejection, ...]
    complete: str
    note: str = ""
    nearest: str = ""
    candidates: Candidates | None = field(default=None, repr=False)

    @property
    def mechanisms(self) -> tuple[Mechanism, ...]:
        """The mechanisms without defects, the best first."""
        return tuple(one.mechanism for one in self.solutions)

    def __len__(self) -> int:
        return len(self.solutions)

    def __iter__(self) -> Iterator[SolvedLinkage]:
        return iter(self.solutions)

    def __getitem__(self, index: int) -> SolvedLinkage:
        return self.solutions[index]

    @property
    def front(self) -> tuple[SolvedLinkage, ...]:
        """The solutions that none of as many links or fewer surpasses in accuracy, those of the fewest links first."""
        found = list[SolvedLinkage]()
        for one in sorted(self.solutions, key=lambda one: (len(one.mechanism.links), one.error)):
            if not found or one.error < found[-1].error:
                found.append(one)
        return tuple(found)

    @property
    def reasons(self) -> dict[str, int]:
        """How many candidates were rejected for which reason."""
        return dict(Counter(one.reason for one in self.rejected).most_common())

    def table(self) -> str:
        """Return the solutions as lines of text, then how many were rejected and why."""
        rows: list[tuple[str | float, ...]] = [("no.", "mechanism", "driver", "turns", "transmission", "size", "error")]
        for k, one in enumerate(self.solutions, start=1):
            angle = "-" if np.isnan(one.transmission) else f"{np.rad2deg(one.transmission):.2f}"
            turns = "fully" if one.turns else "partly"
            rows.append((f"{k}", one.mechanism.title, one.driver, turns, angle, f"{one.size:.6g}", f"{one.error:.1e}"))
        lost = ", ".join(f"{count} for {reason}" for reason, count in self.reasons.items())
        end = f"{count_phrase(len(self.rejected), 'candidate')} rejected: {lost}" if lost else "no candidate rejected"
        return "\n".join([aligned_text(rows), f"{self.complete}; {end}"])

    def report(self) -> Any:
        """Return the report on task, solutions and rejections."""
        return display_function("synthesis_report")(self)

    def draw(self, **options: Any) -> Any:
        """Return the picture of all solutions side by side, with the task."""
        return display_function("synthesis_picture")(self, **options)

    def __repr__(self) -> str:
        found = count_phrase(len(self.solutions), "mechanism")
        return f"Answer({self.task.in_words}: {found}, {len(self.rejected)} rejected; {self.complete})"


@checked
@one_thread
def synthesise(
    task: Task,
    *,
    region: Any = None,
    lengths: Any = None,
    ground: Any = None,
    transmission: float = 0.0,
    turning: bool = False,
    prefer: str | None = None,
    obstacles: Any = None,
) -> Answer:
    """Return the mechanisms that do what a task of `tasks` says, ranked, and the candidates with defects.

    `region` holds all fixed pivots: two opposite corners or a polygon. `lengths` are the least and greatest length of
    links between joints, `ground` places of fixed pivots that are given. `transmission` is the least transmission angle
    (radians), `turning` asks for a driver that turns fully. `obstacles` are polygons that pins, and the lines between
    points of a moving link, keep clear of. `prefer` ranks by "transmission", by "compactness",
    the sum of lengths, or by "accuracy"; functions that are approached by accuracy if it is left out. Raises
    InvalidInput for what is no task or condition.

    >>> from compoundkin.dimensional.task_words import poses
    >>> angles = np.deg2rad([36.72, 15.64, -16.48, 31.29, -56.82])
    >>> places = [0.496 - 0.114j, -0.581 + 0.81j, -0.966 - 0.393j, 0.998 - 0.476j, 0.698 + 0.211j]
    >>> task = poses("plate", [(p.real, p.imag, a) for p, a in zip(places, angles)])
    >>> answer = synthesise(task)
    >>> answer.complete
    '4 real dyads of 4, 6 linkages'
    """
    asked = task.under(Conditions.of(region, lengths, ground, transmission, turning, prefer or _usual(task), obstacles))
    method = next((one for one in METHODS if isinstance(task, one.of) and one.fits(task)), None)
    if method is None:
        raise InvalidInput(Problem("task", f"no method meets {task.in_words}", "see the page on synthesis for tasks"))
    candidates = method.run(asked)
    # functions and curves are approached anyhow; of any other task without a tolerance nothing is allowed
    tolerance = (
        np.inf if isinstance(task, FunctionTask | DwellTask | CurveTask) and not task.tolerance else task.tolerance
    )
    found = candidates.verdicts
    if found is None:
        found = tuple(judged(one, asked.conditions, tolerance) for one in candidates)
    bad = [one for one in found if isinstance(one, Rejection)]
    good = sorted((one for one in found if isinstance(one, SolvedLinkage)), key=_rank(asked.conditions.prefer))
    complete = candidates.complete
    if candidates.is_family and len(good) > KEPT:
        complete = f"{complete}, the best {KEPT} of {len(good)} without defects"
        good = good[:KEPT]
    checks = [confirmed(one, asked.conditions) for one in good]
    bad += [one for one in checks if isinstance(one, Rejection)]
    solutions = (one for one in checks if isinstance(one, SolvedLinkage))
    ranked = tuple(sorted(solutions, key=_rank(asked.conditions.prefer)))
    nearest = candidates.nearest or ("" if ranked else _nearest(bad))
    return Answer(asked, ranked, tuple(bad), complete, candidates.note, nearest, candidates)


def _nearest(rejected: list[Rejection]) -> str:
    """Return which tolerance would do, where a linkage misses the task alone."""
    near = [one for one in rejected if one.candidate.error and np.isfinite(one.candidate.error)]
    errors = [one.candidate.error for one in near if one.reason == ACCURACY_DEFECT]
    if errors:
        return f"a tolerance of {min(errors) * 1.001:.4g} would do"
    if not near:
        return ""
    least = min(near, key=lambda one: one.candidate.error)
    return f"the nearest linkage misses the task by {least.candidate.error:.4g}, and has a defect: {least.reason}"


def _usual(task: Task) -> str:
    """Return what answers are ranked by where nothing is said: accuracy where they approach a task."""
    if isinstance(task, FunctionTask):
        approached = task.whole is not None or len(task.inputs) > 5
    else:
        approached = isinstance(task, DwellTask | CurveTask) or (isinstance(task, PoseTask) and task.count > 5)
    return ACCURACY if approached else TRANSMISSION


def _rank(prefer: str) -> Callable[[SolvedLinkage], tuple[float, ...]]:
    if prefer == COMPACTNESS:
        return lambda one: (round(one.size, 9), -np.nan_to_num(one.transmission))
    if prefer == ACCURACY:
        return lambda one: (float(f"{one.error:.6g}"), -np.nan_to_num(one.transmission))
    return lambda one: (-round(float(np.nan_to_num(one.transmission)), 9), round(one.size, 9))
