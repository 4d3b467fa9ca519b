"""Errors and warnings: one small tree of exceptions that say where a problem is and how to mend it."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from threading import Lock
from typing import TYPE_CHECKING, Any

from compoundkin.base.display import escaped_text


@dataclass(frozen=True)
class Problem:
    """One problem: where it is, what it is, and how to mend it.

    >>> print(Problem("drives[0].link", "there is no link 'crnk'", "did you mean 'crank'?"))
    drives[0].link: there is no link 'crnk'; did you mean 'crank'?
    """

    where: str
    what: str
    remedy: str = ""

    def __str__(self) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        return escaped_text(f"{text}; {self.remedy}" if self.remedy else text)


class CompoundkinError(Exception):
    """The root of every error compoundkin raises on purpose. `problems` lists all that was found.

    `exit_code` is what the command line answers with.
    """

    exit_code = 2

    def __init__(self, problems: Iterable[Problem] | Problem | str, heading: str = "") -> None:
        if isinstance(problems, str):
            problems = Problem("", problems)
        if isinstance(problems, Problem):
            problems = (problems,)
        self.problems: tuple[Problem, ...] = tuple(problems)
        self.heading = heading
        super().__init__(self._text())

    def __reduce__(self) -> tuple[Any, ...]:
        # the text alone would lose its problems between processes
        return type(self), (self.problems, self.heading)

    def _text(self) -> str:
        if len(self.problems) == 1 and not self.heading:
            return str(self.problems[0])
        heading = self.heading or f"{len(self.problems)} problems"
        return "\n".join([f"{heading}:", *(f"  {problem}" for problem in self.problems)])


class InvalidMechanism(CompoundkinError, ValueError):
    """A mechanism or a mechanism file is not valid."""


class InvalidInput(CompoundkinError, ValueError):
    """A call was given values that do not fit the mechanism."""


class UnknownName(CompoundkinError, LookupError):
    """A name that the mechanism, its motion or the catalog does not have."""


class NotDetermined(CompoundkinError):
    """Mobility and drivers disagree, or a part of the mechanism is over- or under-constrained."""


class NotAssembled(CompoundkinError):
    """No pose, or not the requested pose, can be assembled."""

    exit_code = 3


class StudyStopped(CompoundkinError):
    """A study stopped before its end: workers died, or a disk was full. What was written stays."""


class UnassembledPoses(UserWarning):
    """Some poses of a motion cannot be assembled; they are NaN, masked and explained."""


class ChangePointWarning(UserWarning):
    """Drivers rest exactly at a change point, where two branches meet."""


class NearChangePoint(ChangePointWarning):
    """A motion turns back so near to a change point that a rounding of the dimensions decides."""


class DrawnBeyondEnd(UserWarning):
    """The drawn pose is beyond an end of a guide."""


class FewDigits(UserWarning):
    """Some rates have fewer than three digits, next to a limit position."""


class WedgedPoses(UserWarning):
    """Friction has no forces at some poses, or several. They are NaN, named and explained."""


class LikelySlip(UserWarning):
    """A value that is possible but most often a slip."""


class UnmetConstraints(UserWarning):
    """A search found no design at which all its constraints hold."""


def missing_extra(where: str, what: str, extra: str, otherwise: str = "") -> InvalidInput:
    """Return the error for a library that is not installed: what needs it, the extra that brings it, what else helps.

    >>> print(missing_extra("x.png", "PNG needs CairoSVG", "pictures", "save an .svg"))
    x.png: PNG needs CairoSVG; pip install 'compoundkin[pictures]', or save an .svg
    """
    remedy = f"pip install 'compoundkin[{extra}]'"
    return InvalidInput(Problem(where, what, f"{remedy}, or {otherwise}" if otherwise else remedy))


def warn(text: str, category: type[Warning]) -> None:
    """Warn at the line of the user's program that called the package."""
    import inspect
    import warnings

    own, frame, depth = __name__.partition(".")[0], inspect.currentframe(), 1
    # context managers used as decorators stand between the package's own calls
    while frame is not None and f"{frame.f_globals.get('__name__')}.".startswith((f"{own}.", "contextlib.")):
        frame, depth = frame.f_back, depth + 1
    warnings.warn(text, category, stacklevel=depth)


# What other books, programs and countries call what is known here, with our words for it.
_OTHERS = """
# verbs
film movie video gif mp4 animation clip: animate
handout worksheet homework exam assignment: exercise
torque motortorque inputtorque moment: effort forces torques torque
thrust: effort forces
motor actuator servo: size motors
dynamics: forces simulate force_analysis
statics kinetostatics reactions loads force: forces force load efforts
kinematics position positions velocities motion: solve
analyse analyze analysis run info describe summary: report
view show gui browser play: open
sweep variants parametric designs doe batch: study
montecarlo percentile percentiles tolerancing worstcase: tolerance percentile percentiles
validate verify test: check verify
convert translate: import export
list examples library search find mechanisms: catalog list load
picture image sketch drawing polygon diagram: draw
graph chart curve: plot
create init make template: new
edit change modify replace swap: set replace
synthesis synthesize: synthesise
optimize optimization optimisation: optimise
mobility dof grubler gruebler assur groups: structure decompose
centers poles instantcenters: centres instant_centres
stroke deadpoint deadpoints timeratio: characteristics
# quantities
transmission pressureangle mu μ gamma: transmission_angle characteristics
transmissionangle: transmission_angle characteristics groups
omega ω w angularspeed: angular_velocity rate speed
alpha α: angular_acceleration second acceleration
theta θ phi φ rotation orientation: angle value
velocity v: velocity angular_velocity rate speed
speed: angular_velocity rate
acceleration a: acceleration angular_acceleration second
displacement s travel: displacement value
todataframe dataframe pandas df: to_pandas
tocsv toexcel tojson write export savecsv: save
# words of files and of calls
direction: angle
drive driver drivers input inputs: drives values drive
points coordinates sketch joints: drawn
bar bars body bodies members: links link
rpm: speed
path pathpoints trajectory: points
motion rigidbody guidance motiongeneration: poses
couplerpoint tracer: point
output follower: rocker
base fixed: ground frame
# linkages and mechanisms
4bar fourbarlinkage crankrocker: four-bar four_bar
crankslider piston slidercrankmechanism: slider-crank slider_crank
hoist jib lift: hydraulic-crane scissor-lift-loaded
triad classiii: class-iii-six-bar
cylinder: hydraulic-crane oscillating-cylinder
# other programs
solidworks autocad cad step inventor catia: dxf
simulink octave: matlab
adams mujoco: mjcf
latex: tikz
ggb: geogebra
"""


def _other_words() -> Mapping[str, tuple[str, ...]]:
    """Return our words by those of others, in small letters and without separators."""
    found: dict[str, tuple[str, ...]] = {}
    for line in _OTHERS.splitlines():
        others, _, ours = line.partition(": ")
        for other in others.split() if ours else ():
            found[other] = (*found.get(other, ()), *ours.split())
    return found


OTHER_WORDS = _other_words()


def plain_word(name: object) -> str:
    """Return a name in small letters, without separators.

    >>> plain_word("Four-bar"), plain_word("four_bar")
    ('fourbar', 'fourbar')
    """
    return "".join(letter for letter in str(name).lower() if letter not in " -_")


def nearest(name: object, known: Sequence[str]) -> list[str]:
    """Return what an unknown name means: a known one spelled otherwise, what others call so, or the closest one.

    >>> nearest("film", ["animate", "plot"]), nearest("Four Bar", ["four-bar"]), nearest("x", ["rod"])
    (['animate'], ['four-bar'], [])
    """
    import difflib

    plain = plain_word(name)
    same = [one for one in known if plain and plain_word(one) == plain]
    words = (*OTHER_WORDS.get(plain, ()), *OTHER_WORDS.get(plain.removesuffix("s"), ()))
    others = [one for one in dict.fromkeys(words) if one in known]
    return same[:1] or others[:2] or difflib.get_close_matches(str(name), known, n=1)


def suggestion(name: object, known: Sequence[str]) -> str:
    """Return the remedy for an unknown name: the known one that is meant, or the list of known ones.

    >>> suggestion("crnk", ["crank", "rod"])
    "did you mean 'crank'?"
    >>> suggestion("x", ["crank", "rod"])
    'known: crank, rod'
    """
    if found := nearest(name, known):
        return f"did you mean {' or '.join(map(repr, found))}?"
    return f"known: {', '.join(known[:12])}{' ...' if len(known) > 12 else ''}" if known else "there is none"


class ExplainsAttributes:
    """What says of an attribute that it has not what to write instead; `_instead` knows more than the class does."""

    def _instead(self, name: str) -> str:
        return ""

    if not TYPE_CHECKING:  # a type checker knows the attributes

        def __getattr__(self, name: str) -> Any:
            if hasattr(type(self), name):
                return object.__getattribute__(self, name)  # a property that failed: its own error
            raise _NoAttribute(self, name)


class _NoAttribute(AttributeError):
    """An attribute that is not there; what is meant is found when somebody reads it, as `hasattr` asks often."""

    def __init__(self, whole: ExplainsAttributes, name: str) -> None:
        super().__init__(f"{type(whole).__name__!r} object has no attribute {name!r}")
        self._whole, self._name = whole, name

    def __reduce__(self) -> tuple[type[AttributeError], tuple[str]]:
        return AttributeError, (str(self),)

    def __str__(self) -> str:
        what, name, whole = self.args[0], self._name, self._whole
        if name.startswith("_"):
            return str(what)
        package = sys.modules[__name__.partition(".")[0]]
        own = [one for one in dir(whole) if not one.startswith("_")]
        functions = [one for one in (name, *OTHER_WORDS.get(plain_word(name), ())) if one in package.__all__]
        remedy = whole._instead(name)
        if not remedy and functions and (name in functions or not nearest(name, own)):
            remedy = f"write {package.__name__}.{functions[0]}({plain_word(type(whole).__name__)})"
        return f"{what}; {remedy or suggestion(name, own)}"


_lock = Lock()
# Filters of warnings belong to the whole process: who comes first puts them up, who goes last takes them away.
_inside: list[ExitStack] = []
_count = [0]


@contextmanager
def suppress_pose_warnings() -> Iterator[None]:
    """Keep warnings of unassembled poses and few digits still. Threads may do so side by side."""
    with _lock:
        _count[0] += 1
        if _count[0] == 1:
            _inside.append(ExitStack())
            _inside[0].enter_context(warnings.catch_warnings())
            for category in (UnassembledPoses, FewDigits):
                warnings.simplefilter("ignore", category)
    try:
        yield
    finally:
        with _lock:
            _count[0] -= 1
            if not _count[0]:
                _inside.pop().close()
