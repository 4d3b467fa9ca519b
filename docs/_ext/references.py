"""How docstrings read as pages: names in single backticks, signatures, members."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.domains.python import PyXRefRole

import compoundkin as ck

# Where every public name is described: the package, its named modules, not those whose names are words of all days.
NAMED = ("results", "errors", "laws", "profiles", "chains", "figures")
PLACES = {name: f"compoundkin.{part}.{name}" for part in NAMED for name in getattr(ck, part).__all__}
PLACES |= {name: f"compoundkin.{name}" for name in ck.__all__}
# `Motion`, `Pair.glyph`: never parameters or words of files, which are written in lower case.
NAME_OF_CLASS = re.compile(r"[A-Z]\w*[a-z]\w*(\.\w+)*")
# `gaps()` is a function; `gaps` may be a parameter.
CALL = re.compile(r"(\w+)\(\)")
# What a function raises stands in its docstring without backticks.
RAISED = re.compile(rf"(?<![`\w.])({'|'.join(set(ck.errors.__all__) - {'Problem'})})\b(?!`)")
# Nobody makes these but the program: what they are made of says nothing to a reader.
MADE = ("Motion", "PointMotion", "LinkMotion", "PairMotion", "Centres")
# How Sphinx writes an alias that is part of a longer type.
ALIAS = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")


class Name(PyXRefRole):
    """The role of single backticks: the name of a class becomes a link where there is one, all else is code."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """A link or a literal."""
        call = CALL.fullmatch(self.text)
        known = call is not None and call[1] in PLACES
        if known or NAME_OF_CLASS.fullmatch(self.text):
            own = call[1] if call else self.text
            self.name = "py:obj"
            first, *members = own.split(".")
            self.target = ".".join((PLACES.get(first, first), *members))
            return super().run()
        return [nodes.literal(self.rawtext, self.text, classes=["code"])], []


def signature(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str | None, result: str | None
) -> tuple[str | None, str | None]:
    """Aliases by their names, wherever they stand; no parameters for what only the program makes."""
    if what == "class" and name.split(".")[-1] in MADE:
        return "", result
    return tuple(text and ALIAS.sub(r"\1", text) for text in (signature, result))


def name_errors(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """What is raised becomes a name like others, but in examples."""
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else RAISED.sub(r"`\1`", line) for line in lines]


def skip_member(app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """Fields of named tuples are told by the text of their class; "Alias for field number 0" tells nothing."""
    return True if type(obj).__name__ == "_tuplegetter" else None


def setup(app: Sphinx) -> dict[str, Any]:
    """Make it the role of text in single backticks, and mend signatures and members."""
    app.add_role("name", Name())
    app.connect("autodoc-process-signature", signature)
    app.connect("autodoc-process-docstring", name_errors)
    app.connect("autodoc-skip-member", skip_member)
    return {"parallel_read_safe": True}
