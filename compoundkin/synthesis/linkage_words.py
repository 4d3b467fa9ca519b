"""The words of linkages that are made from their lengths: what each takes, how it is typed, checked, listed and drawn.

One declaration, a function with its annotations and meanings, serves Python (`ck.linkages`), `compoundkin new`, and
specifications such as "four-bar:60,20,50,40" wherever a file is expected.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, Literal, TypeAlias

import numpy as np

from compoundkin.base.arguments import is_real
from compoundkin.base.arrays import TURN
from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem, plain_word, suggestion
from compoundkin.model.elements import Drive, drawn, drive
from compoundkin.model.fields import Item
from compoundkin.model.geometry import deg
from compoundkin.model.laws.cam_laws import LAWS
from compoundkin.model.mechanism import Mechanism

# What a parameter is: its annotation says how it is read, checked and shown.
Length: TypeAlias = float
Angle: TypeAlias = float
Count: TypeAlias = int
Real: TypeAlias = float
Place: TypeAlias = "tuple[float, float] | complex"
Closure: TypeAlias = Literal["open", "crossed"]
WORDS: Mapping[str, tuple[str, ...]] = {
    "Closure": ("open", "crossed"),
    "SixBar": ("Watt I", "Watt II", "Stephenson I", "Stephenson II", "Stephenson III"),
    "QuickReturn": ("crank-shaper", "Whitworth"),
    "Follower": ("knife", "roller", "flat"),
    "ArmOrSun": ("arm", "sun"),
    "RiseLaw": tuple(name for name in LAWS if name not in ("dwell", "constant-velocity")),
}
# What parameters that most linkages have mean.
UNIT = "The unit of lengths, any word."
CLOSURE = "Which of two ways to assemble it."
SixBar: TypeAlias = Literal["Watt I", "Watt II", "Stephenson I", "Stephenson II", "Stephenson III"]
QuickReturn: TypeAlias = Literal["crank-shaper", "Whitworth"]
Follower: TypeAlias = Literal["knife", "roller", "flat"]
ArmOrSun: TypeAlias = Literal["arm", "sun"]
RiseLaw: TypeAlias = str
# Cranks are drawn at this angle where they can be.
DRAWN = np.pi / 3.0
# A pose is looked for at so many angles of a crank; a driver that does not turn fully has so many poses.
TRIED, POSES = 720, 73
# Links in one line, or lengths whose sums are equal, but for rounding: parts of a length, or of its square.
FOLDED = 1e-12
# The pins of a linkage in a pose, where they depend on it.
PinPlaces: TypeAlias = "dict[str, complex]"


@dataclass(frozen=True)
class LinkageParameter:
    """A parameter of a linkage: its name, its kind ("Length", "Angle", "Place" ...), its meaning, and its default."""

    name: str
    kind: str
    meaning: str
    default: Any

    @property
    def is_required(self) -> bool:
        """Whether it must be given."""
        return self.default is inspect.Parameter.empty

    @property
    def words(self) -> tuple[str, ...]:
        """The words that it may be, empty for numbers."""
        return WORDS.get(self.kind, ())

    @property
    def shown_default(self) -> str:
        """Its default as it is typed, angles in degrees."""
        return f"{np.rad2deg(self.default):g}" if self.kind == "Angle" else f"{self.default}"

    def value(self, text: str) -> Any:
        """Return the value that a text means, angles in degrees. Raises InvalidInput."""
        if self.words:
            near = {plain_word(word): word for word in self.words}
            if plain_word(text) not in near:
                raise wrong(self.name, f"{text!r} is none of its words", suggestion(text, list(self.words)))
            return near[plain_word(text)]
        if self.kind == "str":
            return text
        try:
            numbers = [float(part) for part in text.split(",")]
        except ValueError:
            raise wrong(self.name, f"{text!r} is no number", self.meaning) from None
        if self.kind == "Place":
            if len(numbers) != 2:
                raise wrong(self.name, f"{text!r} are not two numbers", self.meaning)
            return tuple(numbers) if self.name == "pivot" else (numbers[0], float(deg(numbers[1])))
        if len(numbers) != 1:
            raise wrong(self.name, f"{text!r} is not one number", self.meaning)
        if self.kind == "Count" and numbers[0] != round(numbers[0]):
            raise wrong(self.name, f"{text} is not a whole number", self.meaning)
        if self.kind == "Count":
            return int(numbers[0])
        return float(deg(numbers[0])) if self.kind == "Angle" else numbers[0]


@dataclass(frozen=True)
class LinkageKind:
    """A kind of linkage: its name on the command line, what it is, its parameters, an example, and its function."""

    name: str
    summary: str
    parameters: tuple[LinkageParameter, ...]
    example: str
    build: Callable[..., Mechanism]

    def written(self, texts: Sequence[str]) -> Mechanism:
        """Return the linkage of parameters as they are typed: "ground=60", or values alone, in the order of the list.

        Raises InvalidInput for what is missing, unknown, or cannot be.
        """
        given: dict[str, Any] = {}
        known = {one.name: one for one in self.parameters}
        typed = [*reversed(texts)]
        while typed:
            text = typed.pop()
            name, equals, value = text.partition("=")
            if not equals:
                free = next((one.name for one in self.parameters if one.name not in given), None)
                if free is None:
                    raise wrong(self.name, f"{text!r} is one value too many", f"known: {self.usage}")
                name, value = free, text
                if known[name].kind == "Place" and "," not in text and typed and "=" not in typed[-1]:
                    value += f",{typed.pop()}"  # the second number of a place
            name = name.strip().replace("-", "_")
            if name not in known:
                raise wrong(name, f"a {self.name} has no such parameter", suggestion(name, list(known)))
            if name in given:
                raise wrong(name, "it is given twice", "leave one of them out")
            given[name] = known[name].value(value.strip())
        missing = [one for one in self.parameters if one.is_required and one.name not in given]
        if missing:
            names = ", ".join(one.name for one in missing)
            what = f"{names} {'are' if len(missing) > 1 else 'is'} missing"
            raise InvalidInput(Problem(self.name, what, f"such as {self.name} {self.example}"))
        return self.build(**given)

    @property
    def usage(self) -> str:
        """Its parameters in a line; those that may be left out in brackets."""
        return " ".join(one.name if one.is_required else f"[{one.name}]" for one in self.parameters)


_DECLARED: dict[str, LinkageKind] = {}


def kind_of(function: Callable[..., Mechanism]) -> LinkageKind:
    """Return the kind of linkage that a function has been declared to make."""
    return _DECLARED[function.__name__]


def linkage(example: str, **meanings: str) -> Callable[[Callable[..., Mechanism]], Callable[..., Mechanism]]:
    """Return a decorator that declares a kind of linkage by its function and the meaning of each of its parameters."""

    def listed(function: Callable[..., Mechanism]) -> Callable[..., Mechanism]:
        parameters = tuple(
            LinkageParameter(name, str(one.annotation).removesuffix(" | None"), meanings[name], one.default)
            for name, one in inspect.signature(function).parameters.items()
        )

        @wraps(function)
        def checking(*args: Any, **kwargs: Any) -> Mechanism:
            names = [one.name for one in parameters]
            for unknown in kwargs.keys() - set(names):
                raise wrong(unknown, f"a {name} has no such parameter", suggestion(unknown, names))
            given = {*names[: len(args)], *kwargs}
            if missing := [one.name for one in parameters if one.is_required and one.name not in given]:
                such = f"such as {function.__name__}({', '.join(example.split())})"
                raise wrong(name, f"{', '.join(missing)} {'are' if len(missing) > 1 else 'is'} missing", such)
            bound = inspect.signature(function).bind(*args, **kwargs)
            for one in parameters:
                if one.name in bound.arguments:
                    _check(one, bound.arguments[one.name])
            return function(*args, **kwargs)

        name = function.__name__.replace("_", "-")
        summary = (function.__doc__ or "").partition("\n")[0].removeprefix("Return a ").removeprefix("Return an ")
        summary = summary.removeprefix("Return the ")
        _DECLARED[function.__name__] = LinkageKind(name, summary, parameters, example, checking)
        return checking

    return listed


def _check(one: LinkageParameter, value: Any) -> None:
    """Raise InvalidInput for a value that is not of its parameter's kind."""
    if value is None and one.default is None:
        return
    if one.words:
        if not (isinstance(value, str) and value in one.words):
            raise wrong(one.name, f"{short_repr(value)} is none of its words", suggestion(value, list(one.words)))
    elif one.kind == "Place":
        place(one.name, value)
    elif one.kind == "str":
        if not isinstance(value, str):
            raise wrong(one.name, f"{short_repr(value)} is no word", one.meaning)
    elif isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim):
        many = 'many lengths are for a linkage of one: with_dimensions(linkage, {"crank.B.x": lengths}), or study(...)'
        raise wrong(one.name, f"{short_repr(value)} is not one number", many)
    elif not is_real(value) or not np.isfinite(value):
        raise wrong(one.name, f"{short_repr(value)} is not one number", one.meaning)
    elif one.kind in ("Length", "Count") and value <= 0:
        raise wrong(one.name, f"{value:g} is not above zero", one.meaning)
    elif one.kind == "Count" and value != round(value):
        raise wrong(one.name, f"{value:g} is not a whole number", one.meaning)


def place(name: str, value: Any) -> complex:
    """Return a place given by x and y, or as a complex number. Raises InvalidInput for anything else."""
    try:
        found = complex(*value) if isinstance(value, Sequence) and len(value) == 2 else complex(value)
    except (TypeError, ValueError, OverflowError):
        raise wrong(name, f"{short_repr(value)} are not two numbers", "write (x, y)") from None
    if not np.isfinite(found):
        raise wrong(name, f"{short_repr(value)} is not finite", "write (x, y)")
    return found


def polar_place(name: str, value: Any) -> complex:
    """Return a place given by its distance and angle."""
    found = place(name, value)
    return complex(found.real * np.exp(1j * found.imag))


def wrong(where: str, what: str, remedy: str = "") -> InvalidInput:
    """Return the error for a parameter."""
    return InvalidInput(Problem(where, what, remedy))


def third_pin(first: complex, one: float, second: complex, two: float, closure: Closure) -> complex | None:
    """Return where circles about two places meet, to the left of the way from the first to the second where open."""
    way = second - first
    distance = abs(way)
    if distance == 0.0:  # one pin: any place of two equal circles, none that is chosen
        return None
    along = (distance**2 + one**2 - two**2) / (2.0 * distance)
    square = one**2 - along**2
    if square < -FOLDED * max(one, distance) ** 2:
        return None
    across = np.sqrt(max(square, 0.0))
    return complex(first + way / distance * (along + (1j if closure == "open" else -1j) * across))


def driven_crank(name: str, pose: Callable[[float], PinPlaces | None], crank: str = "crank") -> tuple[Drive, Item]:
    """Return the driver of a crank over all angles at which there is a pose, and one of these poses as drawn.

    It is the longest stretch of angles where there are several. Raises InvalidInput where there is no pose at all.
    """
    angles = np.linspace(0.0, TURN, TRIED, endpoint=False)
    closed = np.array([pose(float(angle)) is not None for angle in angles])
    if closed.all():
        shown = pose(DRAWN)
        assert shown is not None
        return full_turn(crank), drawn(**shown)
    if not closed.any():
        what = "it cannot be assembled at any angle of its crank"
        raise wrong(name, what, "lengthen what does not reach")
    first, count = _longest_run(closed)
    low, high = angles[first], angles[first] + TURN / TRIED * (count - 1)
    low, high = (low - TURN, high - TURN) if low + high > TURN + 1e-9 else (low, high)
    near = DRAWN if low < DRAWN < high else low + 0.5 * (high - low)
    shown = pose(near)
    assert shown is not None
    return drive(crank, values=np.linspace(low, high, POSES) if count > 1 else low), drawn(**shown)


def _longest_run(closed: np.ndarray) -> tuple[int, int]:
    """Return where the longest run of true values on a circle begins, and how long it is."""
    begins = np.flatnonzero(closed & ~np.roll(closed, 1))
    ends = np.flatnonzero(closed & ~np.roll(closed, -1))
    lengths = [int((ends[np.searchsorted(ends, k) % len(ends)] - k) % len(closed)) + 1 for k in begins]
    longest = int(np.argmax(lengths))
    return int(begins[longest]), lengths[longest]


def place_on(first: complex, second: complex, place: complex) -> complex:
    """Return where a place of a link is, seen from its first point with the x axis toward the second."""
    return first + place * (second - first) / abs(second - first)


def full_turn(crank: str) -> Drive:
    """Return the driver of a crank that turns fully."""
    return drive(crank, values=deg(np.arange(0, 361, 5)))


def drawn_linkage(title: str, unit: str, outputs: Sequence[str], description: str, *items: Item) -> Mechanism:
    """Return a linkage of its parts."""
    return Mechanism(title, *items, unit=unit, outputs=tuple(outputs), description=description)
