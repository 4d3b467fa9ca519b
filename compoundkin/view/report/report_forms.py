"""A report, and the forms in which it is written: text, Markdown, JSON, a page; documents of LaTeX.

LaTeX is for `pdflatex`, `xelatex` and `lualatex`, with the packages of any distribution.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any, ClassVar

from compoundkin.base.buffers import without_collection
from compoundkin.base.display import DisplaysHtml
from compoundkin.base.suffixes import Kind
from compoundkin.files.saved_files import Savable
from compoundkin.view.report.report_data import (
    ABOUT,
    Alert,
    Cell,
    FormulaBlock,
    Outcome,
    Paragraph,
    Section,
    StepBlock,
    Subject,
    TableBlock,
    not_a_block,
    summarised,
)
from compoundkin.view.report.wording import column_texts, formula_latex, formulas_in, title_with_unit, typeset

if TYPE_CHECKING:
    from compoundkin.view.page import Page

_ESCAPED = str.maketrans({mark: f"\\{mark}" for mark in "\\`*_|<>"})


def json_text(title: str, sections: Sequence[Section], outcome: Outcome) -> str:
    """Return the report as a JSON text. `title`, `outcome`, and `sections` by their keys in reading order.

    A table has `columns` (name and unit) and `rows`; what is not assembled is null, a vector is [x, y].

    >>> sections = [Section("about", "", (Paragraph("Watch B."),))]
    >>> json.loads(json_text("Crank", sections, Outcome(True)))["sections"]["about"]["blocks"]
    [{'kind': 'paragraph', 'text': 'Watch B.'}]
    """
    parts = {s.key: {"title": s.title, "blocks": [_as_data(block) for block in s.blocks]} for s in sections}
    result = {**asdict(outcome), "passed": outcome.passed}
    whole = {"format": 1, "title": title, "outcome": result, "sections": parts}
    return json.dumps(whole, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _as_data(block: object) -> dict[str, Any]:
    match block:
        case Paragraph():
            return {"kind": "paragraph", "text": block.text}
        case FormulaBlock():
            return {"kind": "formula", "text": block.text, **({"latex": block.latex} if block.latex else {})}
        case Alert():
            return {"kind": "alert", "text": block.text, "remedy": block.remedy}
        case StepBlock():
            return {"kind": "step", "title": block.title, "facts": [list(fact) for fact in block.facts]}
        case TableBlock():
            columns = [{"name": column.name, "unit": column.unit} for column in block.columns]
            return {
                "kind": "table",
                "columns": columns,
                "rows": [[_cell_as_data(cell) for cell in r] for r in block.rows],
            }
    raise not_a_block(block)


def _cell_as_data(cell: Cell) -> Any:
    if isinstance(cell, tuple):
        return [_cell_as_data(value) for value in cell]
    if isinstance(cell, str):
        return cell.replace("\n", " ")
    return None if isinstance(cell, float) and not isfinite(cell) else cell


def markdown(title: str, sections: Sequence[Section]) -> str:
    """Return the report as Markdown, for GitHub and the like.

    >>> print(markdown("Crank", [Section("about", "", (Paragraph("a | b"),))]))
    # Crank
    <BLANKLINE>
    a \\| b
    <BLANKLINE>
    """
    parts = [f"# {_plain(title)}", *(part for section in sections for part in _section_as_markdown(section))]
    return "\n\n".join(parts) + "\n"


def _section_as_markdown(section: Section) -> Iterator[str]:
    if section.title:
        yield f"## {_plain(section.title)}"
    for block in section.blocks:
        yield _as_markdown(block)


def _as_markdown(block: object) -> str:
    match block:
        case Paragraph():
            return _plain(block.text)
        case FormulaBlock():
            return f"$$\n{block.latex}\n$$" if block.latex else f"```text\n{typeset(block.text)}\n```"
        case Alert():
            remedy = f" *Remedy:* {_plain(block.remedy)}." if block.remedy else ""
            return f"> **{_plain(block.text)}**{remedy}"
        case StepBlock():
            facts = "\n".join(f"- *{_plain(term)}*: {_plain(text)}" for term, text in block.facts)
            return f"### {_plain(block.title)}\n\n{facts}"
        case TableBlock():
            rows = block.selected_rows
            cells = [column_texts(column, [row[k] for row in rows]) for k, column in enumerate(block.columns)]
            heads = [_plain(title_with_unit(column)) for column in block.columns]
            rules = ["---:" if column.is_number else "---" for column in block.columns]
            lines = [heads, rules, *(map(_plain, row) for row in zip(*cells, strict=True))]
            return "\n".join(f"| {' | '.join(line)} |" for line in lines)
    raise not_a_block(block)


def _plain(text: str) -> str:
    """Return text without markup."""
    return " ".join(typeset(text).translate(_ESCAPED).split())


@dataclass(frozen=True)
class Report(DisplaysHtml, Savable):
    """The report of a mechanism, in the order in which it is read.

    `subject` is what it is about, for the pictures of its page, and `outputs` and `design` are those it was made with.
    `studied` is the study, tolerance analysis or search that it reports.
    """

    saved_as: ClassVar[Kind] = "report"

    title: str
    sections: tuple[Section, ...]
    outcome: Outcome
    subject: Subject | None = field(default=None, repr=False, compare=False)
    outputs: Sequence[str] = field(default=(), repr=False, compare=False)
    design: int = field(default=0, repr=False, compare=False)
    studied: object = field(default=None, repr=False, compare=False)

    def section(self, key: str) -> Section | None:
        """Return the section of a key; None where the report has none."""
        return next((section for section in self.sections if section.key == key), None)

    def text(self, width: int = 80, colour: bool = False, whole: bool = False) -> str:
        """Write it as text, no line longer than `width`; in colour for a terminal.

        Of hundreds of links or groups the first ones are written, all if it is to be `whole`.
        """
        # rich costs as much to load as all of compoundkin, and only the text needs it
        from compoundkin.view.report.terminal_text import terminal_text

        return terminal_text(
            self.title, self.sections if whole else tuple(map(summarised, self.sections)), width, colour
        )

    def markdown(self) -> str:
        """Write it as Markdown, for GitHub and the like."""
        return markdown(self.title, self.sections)

    def json(self) -> str:
        """Write it as JSON: the same sections, with every row and every digit."""
        return json_text(self.title, self.sections, self.outcome)

    def html(self) -> str:
        """Write it as one HTML file with its pictures, which needs no other file."""
        return self.page().html

    def page(self) -> Page:
        """Return it as a page, which can be saved and opened in the browser."""
        from compoundkin.view.page.report_page import page_of

        figures: dict[str, str] = {}
        if self.studied is not None:
            # what studies and their plots take is not loaded for other pages
            from compoundkin.view.page.study_figures import study_figures

            figures = study_figures(self.studied)
        subject = self.subject, self.outputs, self.design
        # shapes and nodes by the ten thousand, none in a cycle: looking for cycles takes a tenth of the time
        with without_collection():
            return page_of(self.title, self.sections, self.outcome, *subject, figures)

    def content(self, form: str) -> bytes:
        """Return the bytes of a file in the form "text", "markdown", "json" or "html"."""
        if form == "text":
            return self.text(whole=True).encode("utf-8")
        return {"markdown": self.markdown, "json": self.json, "html": self.html}[form]().encode("utf-8")

    def __repr__(self) -> str:
        return f"Report({self.title!r}: {', '.join(section.key for section in self.sections)})"


# --- LaTeX ----------------------------------------------------------------------------------------------------------


PREAMBLE = r"""\documentclass[a4paper,11pt]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath,amssymb,longtable,array,graphicx,tikz}
\setlength{\parindent}{0pt}\setlength{\parskip}{6pt}
\setcounter{MaxMatrixCols}{30}
\allowdisplaybreaks
\newcommand{\fitted}[1]{\sbox0{#1}\ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\usebox0}\else\usebox0\fi}
"""
# Signs that LaTeX reads as commands.
_COMMANDS = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}",
    "|": r"\textbar{}", '"': r"\textquotedbl{}",
}  # fmt: skip
# Signs that reports write beyond ASCII, as mathematics.
_SIGNS = {
    "α": r"\alpha", "β": r"\beta", "γ": r"\gamma", "δ": r"\delta", "ε": r"\varepsilon", "θ": r"\theta", "μ": r"\mu",
    "ρ": r"\rho", "σ": r"\sigma", "τ": r"\tau", "φ": r"\varphi", "ψ": r"\psi", "ω": r"\omega", "Σ": r"\Sigma",
    "Δ": r"\Delta", "Ω": r"\Omega", "π": r"\pi", "·": r"\cdot", "×": r"\times", "−": "-", "±": r"\pm", "≤": r"\leq",
    "≥": r"\geq", "≠": r"\neq", "≈": r"\approx", "°": r"^\circ", "∞": r"\infty", "√": r"\surd", "→": r"\to",
    "′": "'", "″": "''", "²": "^2", "³": "^3", "¹": "^1", "⁻": "^{-}", "⁰": "^0", "⁴": "^4", "⁵": "^5", "⁶": "^6",
    "⁷": "^7", "⁸": "^8", "⁹": "^9", "₀": "_0", "₁": "_1", "₂": "_2", "₃": "_3", "₄": "_4", "₅": "_5", "₆": "_6",
    "₇": "_7", "₈": "_8", "₉": "_9", "∠": r"\angle", "∥": r"\parallel", "⊥": r"\perp", "∑": r"\sum",
}  # fmt: skip
# A table of more columns is set in small letters and never wider than the page.
_WIDE = 6
_TALL = 35


def plain_latex(text: str) -> str:
    """Return text in which no sign is a command of LaTeX.

    >>> plain_latex("50 % of A_1 & ω²")
    '50 \\\\% of A\\\\_1 \\\\& \\\\ensuremath{\\\\omega}\\\\ensuremath{^2}'
    """
    return "".join(
        rf"\ensuremath{{{_SIGNS[sign]}}}" if sign in _SIGNS else _COMMANDS.get(sign, sign) for sign in typeset(text)
    )


def latex_document(title: str, sections: Sequence[Section], figure: str = "") -> str:
    """Return a report as a LaTeX document; `figure` is TikZ and stands below the title."""
    picture = re.search(r"\\begin\{tikzpicture\}.*\\end\{tikzpicture\}", figure, re.DOTALL)
    needs = "".join(f"{line}\n" for line in figure.splitlines() if re.match(r"\\(usetikzlibrary|definecolor)", line))
    parts = [rf"\section*{{{plain_latex(title)}}}"]
    if picture:
        inside = rf"\resizebox{{!}}{{70mm}}{{{picture.group()}}}"
        parts.append(rf"\begin{{center}}\fitted{{{inside}}}\end{{center}}")
    parts += [part for section in sections for part in _section(section)]
    body = "\n\n".join(parts)
    return f"{PREAMBLE}{needs}\\begin{{document}}\n{body}\n\\end{{document}}\n"


def _section(section: Section) -> Iterator[str]:
    if section.title:
        yield rf"\subsection*{{{plain_latex(section.title)}}}"
    for block in section.blocks:
        # only what people have written of a mechanism has formulas in sentences
        yield latex_sentence(block.text) if section.key == ABOUT and isinstance(block, Paragraph) else _block(block)


def latex_sentence(text: str) -> str:
    r"""Return a sentence with its formulas as mathematics.

    >>> print(latex_sentence("It rises by r sin(x) & more."))
    It rises by $r\:\sin(x)$ \& more.
    """
    return "".join(_dollars(formula_latex(part)) if found else plain_latex(part) for part, found in formulas_in(text))


def _dollars(latex: str) -> str:
    return f"${latex}$".replace("·", r"\cdot ")


def _block(block: object) -> str:
    match block:
        case Paragraph():
            return plain_latex(block.text)
        case FormulaBlock():
            if block.latex:
                inside = rf"$\displaystyle {block.latex}$"
                return rf"\begin{{center}}\fitted{{{inside}}}\end{{center}}"
            return "\\\\\n".join(
                rf"\fitted{{\texttt{{{plain_latex(line).replace('  ', '~~')}}}}}" for line in block.text.split("\n")
            )
        case Alert():
            remedy = rf" \emph{{Remedy:}} {plain_latex(block.remedy)}." if block.remedy else ""
            return rf"\textbf{{{plain_latex(block.text)}}}{remedy}"
        case StepBlock():
            facts = "\n".join(rf"\item[{{{plain_latex(term)}}}] {plain_latex(text)}" for term, text in block.facts)
            head = rf"\textbf{{{plain_latex(block.title)}}}"
            return f"{head}\n\\begin{{description}}\n{facts}\n\\end{{description}}" if facts else head
        case TableBlock():
            return _table(block)
    raise not_a_block(block)


def _table(table: TableBlock) -> str:
    rows = table.selected_rows
    if not rows:
        return ""
    cells = [column_texts(column, [row[k] for row in rows]) for k, column in enumerate(table.columns)]
    sides = "".join("r" if column.is_number else "l" for column in table.columns)
    heads = " & ".join(rf"\textbf{{{plain_latex(title_with_unit(column))}}}" for column in table.columns)
    lines = [
        " & ".join(map(plain_latex, (text.replace("\n", " ") for text in row))) for row in zip(*cells, strict=True)
    ]
    body = "\n".join(rf"{line} \\" for line in lines)
    if len(rows) > _TALL and len(table.columns) <= _WIDE:
        return f"\\begin{{longtable}}{{{sides}}}\n{heads} \\\\ \\hline\\endhead\n{body}\n\\end{{longtable}}"
    inside = f"\\begin{{tabular}}{{{sides}}}\n{heads} \\\\ \\hline\n{body}\n\\end{{tabular}}"
    return f"\\begin{{center}}\\small\\fitted{{{inside}}}\\end{{center}}"
