"""What calls are given: each argument held against the annotation of what is called, before anything else is done."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from compoundkin.base.argument_forms import Annotation, Form, is_beyond, is_called
from compoundkin.base.display import short
from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.base.texts import unseen

P = ParamSpec("P")
R = TypeVar("R")


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function, which refuses arguments that do not fit its annotations.

    It raises InvalidInput, which names the argument, what it should be, and what gives such a thing.

    >>> @checked
    ... def twice(number: int) -> int:
    ...     return 2 * number
    >>> twice("x")
    Traceback (most recent call last):
    compoundkin.base.errors.InvalidInput: number: 'x' is no whole number
    """
    forms: list[_Forms] = []

    @wraps(function)
    def held(*args: P.args, **kwargs: P.kwargs) -> R:
        # read off at the first call, so that importing the package stays quick
        known = forms[0] if forms else _Forms(function)
        if not forms:
            forms.append(known)
        known.hold(args, kwargs)
        return function(*args, **kwargs)

    return held


class _Forms:
    """What the arguments of a function may be, by position and by name."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.placed: list[tuple[str, Form | None]] = []
        self.named: dict[str, Form | None] = {}
        self.more: Form | None = None
        self.others: Form | None = None
        for name, parameter in inspect.signature(function).parameters.items():
            form = Annotation(inspect.unwrap(function).__globals__).form(parameter.annotation)
            if parameter.kind is parameter.VAR_POSITIONAL:
                self.more_called, self.more = name, form
            elif parameter.kind is parameter.VAR_KEYWORD:
                self.others = form
            else:
                self.named[name] = form
                if parameter.kind is not parameter.KEYWORD_ONLY:
                    self.placed.append((name, form))

    def hold(self, args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> None:
        """Raise InvalidInput for the first argument that does not fit."""
        for (name, form), value in zip(self.placed, args, strict=False):
            if form is not None and not form.fits(value):
                raise refused(name, value, form)
        if self.more is not None:
            for value in args[len(self.placed) :]:
                if not self.more.fits(value):
                    raise refused(self.more_called, value, self.more)
        for name, value in kwargs.items():
            form = self.named.get(name, self.others)
            if form is not None and not form.fits(value):
                raise refused(name, value, form)


def refused(where: str, value: object, form: Form) -> InvalidInput:
    """Return the error of an argument that does not fit."""
    # what was made of the thing that is meant holds it: a motion has its mechanism
    held = next((word for word in form.called.split(" or ") if is_called(_part(value, word), word)), None)
    remedy = f"take its .{held}" if held else form.remedy
    if isinstance(value, str) and unseen(value) and form.fits(""):
        return InvalidInput(Problem(where, unseen(value), "leave it out"))
    if isinstance(value, list | tuple) and form.fits(""):
        remedy = "write one text for each, without a list"
    if is_beyond(value) and form.fits(1):
        return InvalidInput(Problem(where, f"{short(value)} is too large", remedy))
    return InvalidInput(Problem(where, f"{short(value)} is no {form.called}", remedy))


def _part(value: object, name: str) -> object:
    try:
        return getattr(value, name, None)
    except CompoundkinError:  # configurations of a group alone have no structure, and say so
        return None
