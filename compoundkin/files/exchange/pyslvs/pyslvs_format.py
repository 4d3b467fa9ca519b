"""Expressions of pyslvs: read and written."""

from __future__ import annotations

from typing import Any, ClassVar

from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Readable, Writable
from compoundkin.files.exchange.drawings.drawing_of_mechanism import drawing_of
from compoundkin.files.exchange.exchanged import Exported, Imported
from compoundkin.files.exchange.problems import Problems
from compoundkin.files.exchange.pyslvs.expression import parsed_expression
from compoundkin.files.exchange.pyslvs.expression_joints import PROGRAM, read_expression
from compoundkin.files.exchange.pyslvs.written_expression import expression_of, inputs_of, pyslvs_joints, pyslvs_notes
from compoundkin.files.exchange.shown_mechanism import ShownMechanism


class PyslvsFormat(Readable, Writable):
    """Expressions of pyslvs."""

    name: ClassVar[str] = "pyslvs"
    program: ClassVar[str] = PROGRAM
    title: ClassVar[str] = "pyslvs expression M[...]"

    def recognises(self, content: Content) -> bool:
        """Return whether it begins with M[, perhaps after comments."""
        lines = (line.strip() for line in content.head.splitlines())
        first = next((line for line in lines if line and not line.startswith("#")), "")
        return content.is_text and first.replace(" ", "").startswith("M[")

    def read(self, content: Content) -> Imported:
        """Return the mechanism of an expression.

        Inputs may follow it, or stand in a comment `# inputs: [(0, 1)]`.
        """
        problems = Problems(content.where)
        found = parsed_expression(content.text, problems, content.where)
        return read_expression(content, found, problems, self.name, {})

    def write(self, shown: ShownMechanism, **options: Any) -> Exported:
        """Return the expression, with its inputs in a comment."""
        joints = pyslvs_joints(drawing_of(shown))
        text = f"# inputs: {inputs_of(joints)}\n{expression_of(joints, chr(10) + '  ')}\n"
        return Exported(text.encode(), self.name, pyslvs_notes(joints))


FORMAT = PyslvsFormat()
