"""`read` and `write`: a mechanism out of any known format, and into any."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.files.exchange.content import content_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.known_formats import readable_formats, writable_formats
from compoundkin.files.exchange.recognition import recognised
from compoundkin.files.exchange.shown_mechanism import shown_mechanism
from compoundkin.model.mechanism import Mechanism


@checked
def read(source: str | os.PathLike[str], form: str = "") -> Imported:
    """Read a mechanism that another program has saved or shared.

    `source` is the path of a file, a link, or a text of several lines; nothing is fetched, nothing executed. The format
    is recognised by the content, unless `form` names it. Raises InvalidInput, with every element that cannot be said
    here and its line; InvalidMechanism where what is read cannot be one.

    >>> read("ground,crank,R,0,0,tfft\\ncrank,rod,R,1,2\\nrod,slide,R,5,0\\nslide,ground,P,5,0,0").mechanism.pins["B"]
    ('crank', 'rod')
    """
    content = content_of(source)
    known = readable_formats()
    if form and form not in known:
        raise InvalidInput(Problem("form", f"no format {form!r} is read", suggestion(form, list(known))))
    return recognised(content, known, form).read(content)


@checked
def write(mechanism: Mechanism, form: str, at: Mapping[str, float] | None = None, **options: Any) -> Exported:
    """Write a mechanism in the format of another program.

    It is drawn `at` values of its drivers (radians, lengths), at the pose nearest to its drawing where they are left
    out. Raises InvalidInput listing all that the format cannot say.

    >>> from compoundkin.files import load
    >>> write(load("slider-crank"), "pmks").text.splitlines()[0].split(",")[2]
    'R'
    """
    known = writable_formats()
    if form not in known:
        raise InvalidInput(Problem("form", f"no format {form!r} is written", suggestion(form, list(known))))
    target = known[form]
    unknown = [name for name in options if name not in target.options]
    if unknown:
        remedy = suggestion(unknown[0], list(target.options))
        raise InvalidInput(Problem(unknown[0], f"{form} is written without it", remedy))
    return target.write(shown_mechanism(mechanism, at), **options)
