"""Arguments of public functions, checked against their annotations; numbers among them read as arrays.

Values that NumPy would silently convert to numbers, such as dates and texts, are refused.
"""

from __future__ import annotations

import ast
import inspect
import os
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Set
from functools import cache, partial, wraps
from numbers import Integral, Real
from types import MappingProxyType
from typing import Any, NamedTuple, ParamSpec, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from compoundkin.base.display import hidden_character_problem, short_repr
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem, suggestion

P = ParamSpec("P")
R = TypeVar("R")


# The argument that says how many, which people write in the place of others.
_COUNT = "count"


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function with its arguments checked against its annotations.

    It raises InvalidInput, which names the argument, the required type, and how to obtain one.

    >>> @checked
    ... def twice(number: int) -> int:
    ...     return 2 * number
    >>> twice("x")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: number: 'x' is no whole number
    """
    types: list[_ArgumentTypes] = []

    @wraps(function)
    def checking(*args: P.args, **kwargs: P.kwargs) -> R:
        # annotations are read at the first call, so that importing the package stays quick
        if not types:
            types.append(_ArgumentTypes(function))
        types[0].check(args, kwargs)
        return function(*args, **kwargs)

    return checking


class _ArgumentTypes:
    """The required types of a function's arguments, by position and by name."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.placed: list[tuple[str, ArgumentType | None]] = []
        self.named: dict[str, ArgumentType | None] = {}
        self.more: ArgumentType | None = None
        self.others: ArgumentType | None = None
        self.name, self.is_open = function.__name__, False
        for name, parameter in inspect.signature(function).parameters.items():
            form = Annotation(inspect.unwrap(function).__globals__).form(parameter.annotation)
            if parameter.kind is parameter.VAR_POSITIONAL:
                self.more_called, self.more = name, form
            elif parameter.kind is parameter.VAR_KEYWORD:
                self.others, self.is_open = form, True
            else:
                self.named[name] = form
                if parameter.kind is not parameter.KEYWORD_ONLY:
                    self.placed.append((name, form))

    def check(self, args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> None:
        """Raise InvalidInput for the first argument that does not fit."""
        for (name, form), value in zip(self.placed, args, strict=False):
            if form is not None and not form.fits(value):
                if _COUNT in self.named and isinstance(value, int) and not isinstance(value, bool):
                    what = f"{short_repr(value)} is no {form.called}"
                    raise InvalidInput(Problem(name, what, f"{name} come here; how many there are is {_COUNT}={value}"))
                raise refused(name, value, form)
        if self.more is not None:
            for value in args[len(self.placed) :]:
                if not self.more.fits(value):
                    raise refused(self.more_called, value, self.more)
        for name, value in kwargs.items():
            if name not in self.named and not self.is_open:
                what = f"{self.name}() got an unexpected keyword argument {name!r}"
                raise TypeError(f"{what}; {suggestion(name, list(self.named))}")
            form = self.named.get(name, self.others)
            if form is not None and not form.fits(value):
                raise refused(name, value, form)


def refused(where: str, value: object, form: ArgumentType) -> InvalidInput:
    """Return the error of an argument that does not fit."""
    # a result holds what it was made of: a motion has its mechanism
    source = next((word for word in form.called.split(" or ") if is_called(_part(value, word), word)), None)
    remedy = f"take its .{source}" if source else form.remedy
    if isinstance(value, str) and hidden_character_problem(value) and form.fits(""):
        return InvalidInput(Problem(where, hidden_character_problem(value), "leave it out"))
    if isinstance(value, list | tuple) and form.fits(""):
        remedy = "write one text for each, without a list"
    if is_beyond(value) and form.fits(1):
        return InvalidInput(Problem(where, f"{short_repr(value)} is too large", remedy))
    return InvalidInput(Problem(where, f"{short_repr(value)} is no {form.called}", remedy))


def _part(value: object, name: str) -> object:
    try:
        return getattr(value, name, None)
    except CompoundkinError:  # configurations of a group alone have no structure
        return None


Test: TypeAlias = Callable[[Any], bool]
# What gives an object of each class that calls are given.
OBTAINED_BY: Mapping[str, str] = MappingProxyType(
    {
        "Mechanism": "load() reads one from a file, or a shipped one by its name",
        "Structure": "decompose() gives one",
        "Motion": "solve() gives one",
        "Circuits": "circuits() gives them",
        "Task": "ck.tasks.poses() and others make one",
        "Configuration": "configurations() has them",
        "Group": "decompose(mechanism).groups are some",
        "Chain": "chains.chains() gives some",
        "AssurGroup": "chains.assur_group() gives one by its name",
        "Joints": "write chains.Joints(links, joints)",
        "Coloured": "write chains.Coloured(colours, masks)",
        "Profile": "profiles.disc(), profiles.profile() and others make one",
        "Synthesised": "profiles.synthesise() makes one",
        "DoubleCam": "profiles.conjugate() and profiles.constant_breadth() make them",
        "Program": "laws.program() makes one",
        "ProgramSegment": "laws.rise(), laws.fall() and laws.dwell() make them",
        "ForcePort": "write advantage.ForcePort(link, point, angle) or advantage.TorquePort(link)",
        "DesignAtlas": "coupler_atlas() makes one",
        "MultiGraph": "decompose(mechanism).graph is one",
    }
)


class ArgumentType(NamedTuple):
    """What an argument may be: a test, a name, and how to get one."""

    fits: Test
    called: str
    remedy: str = ""


# No machine counts farther, and no list is longer.
GREATEST = 2**63
# Real numbers to Python, but hardly ever intended as numbers.
_NOT_NUMBERS = (bool, np.timedelta64)


def is_whole(value: object) -> bool:
    """Tell whether a value is a whole number; True and False are none."""
    return isinstance(value, Integral) and not isinstance(value, _NOT_NUMBERS) and abs(int(value)) < GREATEST


def is_beyond(value: object) -> bool:
    """Tell whether a value is a whole number, and too large for one."""
    return isinstance(value, Integral) and not isinstance(value, _NOT_NUMBERS) and abs(int(value)) >= GREATEST


def is_real(value: object) -> bool:
    """Tell whether a value is one real number, no date, text, True or False."""
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "fiu" and not is_masked(value)
    if isinstance(value, Integral):
        return not isinstance(value, _NOT_NUMBERS) and abs(int(value)) < sys.float_info.max
    return isinstance(value, Real)


def is_masked(value: object) -> bool:
    """Return whether a value is a masked array, without importing numpy.ma, which takes long."""
    masked = sys.modules.get("numpy.ma")
    return masked is not None and isinstance(value, masked.MaskedArray)


def is_finite_real(value: object) -> bool:
    """Tell whether a value is one real number that is finite."""
    return is_real(value) and bool(np.isfinite(float(cast("Any", value))))


def is_text(value: object) -> bool:
    """Return whether a value is a text without hidden characters."""
    return isinstance(value, str) and not hidden_character_problem(value)


def _is_flag(value: object) -> bool:
    return isinstance(value, bool | np.bool_) or (is_whole(value) and value in (0, 1))


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping) and all(isinstance(key, str) for key in value)


def _are_all(fits: Test, value: object) -> bool:
    """Return whether every entry of a list fits. An iterator that can be read only once is not tested."""
    # the edges of a graph are a set and a table at once
    is_table = isinstance(value, Mapping) and not isinstance(value, Set)
    if isinstance(value, str | bytes) or is_table or not isinstance(value, Iterable):
        return False
    if isinstance(value, np.ndarray) and value.ndim != 1:
        return False
    return not isinstance(value, Collection) or all(map(fits, value))


_PLAIN: Mapping[str, ArgumentType] = MappingProxyType(
    {
        "str": ArgumentType(is_text, "text"),
        "int": ArgumentType(is_whole, "whole number"),
        "float": ArgumentType(is_real, "number"),
        "bool": ArgumentType(_is_flag, "yes or no", "write True or False"),
        "None": ArgumentType(lambda value: value is None, ""),
        "Mapping": ArgumentType(_is_table, "table by name", 'write {"name": ...}'),
        "Callable": ArgumentType(callable, "function"),
        "PathLike": ArgumentType(lambda value: isinstance(value, str | os.PathLike), "path"),
    }
)
# Annotations whose values the called function itself reads, with errors of its own.
_ANYTHING = frozenset({"Any", "Number", "Sizes", "Reach", "Item", "object"})
_LISTS = ("Sequence", "Iterable", "tuple")


def is_called(value: object, word: str) -> bool:
    """Return whether a value is an instance of a class, given by its name in words."""
    return any(in_words(kind.__name__) == word for kind in type(value).__mro__)


@cache
def in_words(name: str) -> str:
    """Return the name of a class in words."""
    return re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower()


class Annotation:
    """What annotations ask for, read where names mean what they do in a module."""

    def __init__(self, names: Mapping[str, Any]) -> None:
        self.names = names

    def form(self, annotation: object) -> ArgumentType | None:
        """Return the type that an annotation requires; None where the called function checks it."""
        if annotation is inspect.Parameter.empty:
            return None
        return self._of(ast.parse(str(annotation), mode="eval").body)

    def _of(self, node: ast.expr) -> ArgumentType | None:
        if isinstance(node, ast.BinOp):
            return _union(self._of(node.left), self._of(node.right))
        if isinstance(node, ast.Subscript) and ast.unparse(node.value) == "Literal":
            return _PLAIN["str"]
        if isinstance(node, ast.Subscript):
            inner = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            if ast.unparse(node.value) in _LISTS:
                return self._list(inner)
            return self._table(inner[1]) if ast.unparse(node.value) == "Mapping" else self._of(node.value)
        name = ast.unparse(node).rpartition(".")[2]
        if name in _ANYTHING:
            return None
        return _PLAIN.get(name) or self._named(name)

    def _named(self, name: str) -> ArgumentType | None:
        """Return the type that a name requires: a class, the members of a protocol, or an alias."""
        meant = self.names.get(name)
        if meant is not None and not isinstance(meant, type):
            return self.form(meant)
        if getattr(meant, "_is_protocol", False):
            members = [key for key in vars(meant) if not key.startswith("_")]
            # what has a motion's poses is called one
            called = name if name in OBTAINED_BY else "Motion"
            return ArgumentType(
                lambda v: all(hasattr(v, key) for key in members), in_words(called), OBTAINED_BY[called]
            )
        return ArgumentType(partial(is_called, word=in_words(name)), in_words(name), OBTAINED_BY.get(name, ""))

    def _table(self, node: ast.expr) -> ArgumentType:
        """Return the type of a table of such values; the called function reports details of numbers in it."""
        form = None if ast.unparse(node) in _PLAIN else self._of(node)
        if form is None:
            return _PLAIN["Mapping"]
        return ArgumentType(
            lambda v: _is_table(v) and all(map(form.fits, v.values())), f"table of {form.called}s by name"
        )

    def _list(self, nodes: list[ast.expr]) -> ArgumentType:
        """Return the type of a list of such values; ``tuple[float, float]`` has just two."""
        many = isinstance(nodes[-1], ast.Constant) or len(nodes) == 1
        forms = [self._of(node) for node in nodes if not isinstance(node, ast.Constant)]
        tests = [_is_anything if form is None else form.fits for form in forms]
        if many:
            return ArgumentType(partial(_are_all, tests[0]), f"list{_of_plural(forms[0])}")
        return ArgumentType(partial(_are_each, tests), f"{len(forms)} values{_of_plural(forms[0])}")


def _of_plural(form: ArgumentType | None) -> str:
    return "" if form is None else f" of {form.called.removesuffix('s')}s"


def _is_anything(value: object) -> bool:
    return True


def _are_each(tests: list[Test], value: object) -> bool:
    """Return whether a list has as many values as tests, and each passes its own."""
    if not isinstance(value, list | tuple | np.ndarray) or getattr(value, "ndim", 1) == 0 or len(value) != len(tests):
        return False
    return all(fits(one) for fits, one in zip(tests, value, strict=True))


def _union(one: ArgumentType | None, other: ArgumentType | None) -> ArgumentType | None:
    if one is None or other is None:
        return None
    called = dict.fromkeys(form.called for form in (one, other) if form.called)
    return ArgumentType(lambda v: one.fits(v) or other.fits(v), " or ".join(called), one.remedy or other.remedy)


Floats: TypeAlias = NDArray[np.float64]
# What NumPy would read as numbers without a word, by the letter of its kind, and what to do instead.
_NOT_REAL = {
    "M": ("dates are no numbers", "give seconds, angles or lengths"),
    "m": ("spans of dates are no numbers", "divide them by numpy.timedelta64(1, 's')"),
    "c": ("complex numbers are no real ones", "take their .real"),
    "U": ("a text is no number", "write numbers without quotes"),
    "S": ("a text is no number", "write numbers without quotes"),
}


def real_numbers(where: str, value: Any, error: type[CompoundkinError] = InvalidInput) -> Floats:
    """Return real numbers as an array of floats.

    Raises the error, naming `where`, for anything else: dates, texts, complex numbers, masked entries.

    >>> real_numbers("time", range(3)).tolist()
    [0.0, 1.0, 2.0]
    >>> real_numbers("time", 1j)
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: time: complex numbers are no real ones; take their .real
    """
    if isinstance(value, float | int) and not isinstance(value, bool):
        return np.asarray(_array(where, value, float, error), dtype=float)
    given = _array(where, value, None, error)
    if given.dtype.kind in _NOT_REAL:
        what, remedy = _NOT_REAL[given.dtype.kind]
        turns = re.fullmatch(r"\s*([\d.]+)\s*rpm\s*", str(value))
        raise error(Problem(where, what, f"write {turns[1]} * 2 * math.pi / 60, in rad/s" if turns else remedy))
    return np.asarray(_array(where, _convertible(value, given), float, error), dtype=float)


def planar_numbers(where: str, value: Any, error: type[CompoundkinError] = InvalidInput) -> NDArray[np.complex128]:
    """Return complex numbers as an array; refuses what `real_numbers` does."""
    given = _array(where, value, None, error)
    if given.dtype.kind in _NOT_REAL and given.dtype.kind != "c":
        raise error(Problem(where, *_NOT_REAL[given.dtype.kind]))
    return np.asarray(_array(where, _convertible(value, given), complex, error), dtype=complex)


def check_design(design: Any, count: int) -> None:
    """Raise InvalidInput for the index of a design that is not there.

    >>> check_design(2, 1)
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: design: there is no design 2; there is only 0
    """
    if isinstance(design, bool) or not isinstance(design, int | np.integer) or not 0 <= design < count:
        known = f"0 to {count - 1}" if count > 1 else "there is only 0"
        raise InvalidInput(Problem("design", f"there is no design {short_repr(design)}", known))


def _convertible(value: Any, array: NDArray[Any]) -> Any:
    """Return the array to convert; an object stays itself, so that an error can show it."""
    return value if array.dtype.kind == "O" else array


def as_python_number(value: Any) -> Any:
    """Return a single number of NumPy as that of Python which it is. All else is returned as it is.

    >>> as_python_number(np.array(3.0)), as_python_number(np.float32(0.5)), as_python_number(3)
    (3.0, 0.5, 3)
    """
    return value.item() if isinstance(value, np.generic | np.ndarray) and value.ndim == 0 else value


def _array(where: str, value: Any, dtype: type | None, error: type[CompoundkinError]) -> NDArray[Any]:
    if is_masked(value) and np.any(value.mask):
        raise error(Problem(where, "some of the numbers are masked", "leave those out, or fill them"))
    try:
        return np.asarray(value, dtype=dtype)
    except (TypeError, ValueError, OverflowError):
        raise error(Problem(where, f"{short_repr(value)} is not a number or an array of numbers")) from None
