"""What annotations of arguments ask for: tests of values, their names, and how to come by such a thing."""

from __future__ import annotations

import ast
import inspect
import os
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Set
from functools import cache, partial
from numbers import Integral, Real
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np

from compoundkin.base.texts import unseen

Test: TypeAlias = Callable[[Any], bool]

# What gives an object of each class that calls are given.
MADE_BY: Mapping[str, str] = MappingProxyType(
    {
        "Mechanism": "load() reads one from a file, catalog.load_named() has the shipped ones",
        "Structure": "decompose() gives one",
        "Motion": "solve() gives one",
        "Circuits": "circuits() gives them",
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
        "MultiGraph": "decompose(mechanism).graph is one",
    }
)


class Form(NamedTuple):
    """What an argument may be: a test, a name, and how to get one."""

    fits: Test
    called: str
    remedy: str = ""


# No machine counts farther, and no list is longer.
GREATEST = 2**63
# Real numbers to Python, but never meant as one.
_NO_NUMBERS = (bool, np.timedelta64)


def is_whole(value: object) -> bool:
    """Tell whether a value is a whole number; True and False are none."""
    return isinstance(value, Integral) and not isinstance(value, _NO_NUMBERS) and abs(int(value)) < GREATEST


def is_beyond(value: object) -> bool:
    """Tell whether a value is a whole number, and too large for one."""
    return isinstance(value, Integral) and not isinstance(value, _NO_NUMBERS) and abs(int(value)) >= GREATEST


def is_real(value: object) -> bool:
    """Tell whether a value is one real number, no date, text, True or False."""
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "fiu" and not is_masked(value)
    if isinstance(value, Integral):
        return not isinstance(value, _NO_NUMBERS) and abs(int(value)) < sys.float_info.max
    return isinstance(value, Real)


def is_masked(value: object) -> bool:
    """Tell whether a value is an array of which entries may be left out."""
    # there is none before numpy.ma is loaded, which takes long
    masked = sys.modules.get("numpy.ma")
    return masked is not None and isinstance(value, masked.MaskedArray)


def is_finite_real(value: object) -> bool:
    """Tell whether a value is one real number that is finite."""
    return is_real(value) and bool(np.isfinite(float(cast("Any", value))))


def is_text(value: object) -> bool:
    """Tell whether a value is a text of which every character shows."""
    return isinstance(value, str) and not unseen(value)


def _is_flag(value: object) -> bool:
    return isinstance(value, bool | np.bool_) or (is_whole(value) and value in (0, 1))


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping) and all(isinstance(key, str) for key in value)


def _are_all(fits: Test, value: object) -> bool:
    """Tell whether a list holds what it should. What can be read only once is not looked into."""
    # the edges of a graph are a set and a table at once
    is_table = isinstance(value, Mapping) and not isinstance(value, Set)
    if isinstance(value, str | bytes) or is_table or not isinstance(value, Iterable):
        return False
    if isinstance(value, np.ndarray) and value.ndim != 1:
        return False
    return not isinstance(value, Collection) or all(map(fits, value))


_PLAIN: Mapping[str, Form] = MappingProxyType(
    {
        "str": Form(is_text, "text"),
        "int": Form(is_whole, "whole number"),
        "float": Form(is_real, "number"),
        "bool": Form(_is_flag, "yes or no", "write True or False"),
        "None": Form(lambda value: value is None, ""),
        "Mapping": Form(_is_table, "table by name", 'write {"name": ...}'),
        "Callable": Form(callable, "function"),
        "PathLike": Form(lambda value: isinstance(value, str | os.PathLike), "path"),
    }
)
# What is read as numbers or points by the function itself, which says what is wrong with them.
_ANYTHING = frozenset({"Any", "Number", "Sizes", "Reach", "Item", "object"})
_LISTS = ("Sequence", "Iterable", "tuple")


def is_called(value: object, word: str) -> bool:
    """Tell whether a value is of a class that is called so in words."""
    return any(in_words(kind.__name__) == word for kind in type(value).__mro__)


@cache
def in_words(name: str) -> str:
    """Return the name of a class in words."""
    return re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower()


class Annotation:
    """What annotations ask for, read where names mean what they do in a module."""

    def __init__(self, names: Mapping[str, Any]) -> None:
        self.names = names

    def form(self, annotation: object) -> Form | None:
        """Return what an annotation asks for; None where only the function can tell."""
        if annotation is inspect.Parameter.empty:
            return None
        return self._of(ast.parse(str(annotation), mode="eval").body)

    def _of(self, node: ast.expr) -> Form | None:
        if isinstance(node, ast.BinOp):
            return _either(self._of(node.left), self._of(node.right))
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

    def _named(self, name: str) -> Form | None:
        """Return what a class asks for: one of its kind, what has the members of a protocol, one of an alias."""
        meant = self.names.get(name)
        if meant is not None and not isinstance(meant, type):
            return self.form(meant)
        if getattr(meant, "_is_protocol", False):
            members = [key for key in vars(meant) if not key.startswith("_")]
            return Form(lambda v: all(hasattr(v, key) for key in members), "motion", MADE_BY["Motion"])
        return Form(partial(is_called, word=in_words(name)), in_words(name), MADE_BY.get(name, ""))

    def _table(self, node: ast.expr) -> Form:
        """Return what a table of such things asks for; what is wrong with numbers in it, its function says better."""
        form = None if ast.unparse(node) in _PLAIN else self._of(node)
        if form is None:
            return _PLAIN["Mapping"]
        return Form(lambda v: _is_table(v) and all(map(form.fits, v.values())), f"table of {form.called}s by name")

    def _list(self, nodes: list[ast.expr]) -> Form:
        """Return what a list of such things asks for; ``tuple[float, float]`` has just two."""
        many = isinstance(nodes[-1], ast.Constant) or len(nodes) == 1
        forms = [self._of(node) for node in nodes if not isinstance(node, ast.Constant)]
        tests = [_is_anything if form is None else form.fits for form in forms]
        if many:
            return Form(partial(_are_all, tests[0]), f"list{_of(forms[0])}")
        return Form(partial(_are_each, tests), f"{len(forms)} values{_of(forms[0])}")


def _of(form: Form | None) -> str:
    return "" if form is None else f" of {form.called.removesuffix('s')}s"


def _is_anything(value: object) -> bool:
    return True


def _are_each(tests: list[Test], value: object) -> bool:
    """Tell whether so many values are each what they should be."""
    if not isinstance(value, list | tuple | np.ndarray) or getattr(value, "ndim", 1) == 0 or len(value) != len(tests):
        return False
    return all(fits(one) for fits, one in zip(tests, value, strict=True))


def _either(one: Form | None, other: Form | None) -> Form | None:
    if one is None or other is None:
        return None
    called = dict.fromkeys(form.called for form in (one, other) if form.called)
    return Form(lambda v: one.fits(v) or other.fits(v), " or ".join(called), one.remedy or other.remedy)
