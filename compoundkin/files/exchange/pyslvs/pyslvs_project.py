"""Project files of Pyslvs-UI, in YAML: read and written."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable, Writable
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.pyslvs.expression import GROUND, PyslvsExpression, parsed_expression
from compoundkin.files.exchange.pyslvs.expression_joints import read_expression
from compoundkin.files.exchange.pyslvs.project_text import entry_count, project_entries, scalar
from compoundkin.files.exchange.pyslvs.written_expression import expression_of, inputs_of, pyslvs_joints, pyslvs_notes
from compoundkin.files.exchange.shown_mechanism import ShownMechanism

_MECHANISM, _INPUT, _LINKS = "mechanism", "input", "links"
# What is kept of a project beside the mechanism, and what one of them is called.
_LEFT_OUT = {"storage": "stored mechanism", "path": "recorded path", "collection": "collected chain"}
# How a file begins that Python objects, or a database, are kept in.
_PICKLE, _DATABASE = b"\x80", b"SQLite format 3\0"
_MARK = re.compile(r"(^|[{,\s])['\"]?mechanism['\"]?\s*:")
_OWN = re.compile(r"['\"]?(pyslvs_ver|file_type|input|links|storage)['\"]?\s*:")
VERSION = "22.7.0"


class PyslvsProject(Readable, Writable):
    """Project files of Pyslvs-UI."""

    name: ClassVar[str] = "pyslvs-project"
    program: ClassVar[str] = "Pyslvs-UI"
    title: ClassVar[str] = "Pyslvs-UI project (.pyslvs)"
    suffix: ClassVar[str] = ".pyslvs"

    def recognises(self, content: Content) -> bool:
        """Return whether it has the keys of a project, or is an old one."""
        if content.raw.startswith((_PICKLE, _DATABASE)):
            return True
        if not content.is_text or not _OWN.search(content.head) or b"M[" not in content.raw:
            return False
        return bool(_MARK.search(content.raw.decode("utf-8-sig", "ignore")))

    def read(self, content: Content) -> Imported:
        """Return the mechanism of a project. A pickle is refused unread: reading one may run anything."""
        _refuse_objects(content)
        problems = Problems(content.where)
        entries = project_entries(content.text, problems)
        if _MECHANISM not in entries:
            problems.add("", "the project has no mechanism", "its entry is mechanism: M[...]")
        problems.raise_if_any()
        raw, line = entries[_MECHANISM]
        text = scalar(raw, f"line {line}", problems)
        problems.raise_if_any()
        found = parsed_expression(text, problems, content.where) if text.strip() else PyslvsExpression()
        found.inputs = entries.get(_INPUT, ("", 0))[0]
        dropped = {called: entry_count(entries[key][0]) for key, called in _LEFT_OUT.items() if key in entries}
        return read_expression(content, found, problems, self.name, dropped)

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the project, as Pyslvs-UI writes it."""
        joints = pyslvs_joints(drawing_of(shown))
        inputs = "".join(f"- - {base}\n  - {driver}\n" for base, driver in inputs_of(joints))
        colours = {name: "White" if name == GROUND else "Blue" for name in joints.names.values()}
        text = (
            f"file_type: 0\n{_INPUT}:{chr(10) + inputs if inputs else ' []' + chr(10)}"
            f"{_LINKS}:\n{''.join(f'  {name!r}: {colour}' + chr(10) for name, colour in sorted(colours.items()))}"
            f"{_MECHANISM}: {expression_of(joints)}\npath: {{}}\npyslvs_ver: {VERSION}\nstorage: {{}}\n"
        )
        return Exported(text.encode(), self.name, pyslvs_notes(joints))


def _refuse_objects(content: Content) -> None:
    if content.raw.startswith(_PICKLE):
        what = "this is a pickle, which is not read: it may run anything"
    elif content.raw.startswith(_DATABASE):
        what = "this is a database of an early Pyslvs"
    else:
        return
    raise InvalidInput(Problem(content.where, what, "open it in Pyslvs-UI and save it as YAML"))


FORMAT = PyslvsProject()
