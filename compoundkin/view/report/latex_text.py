"""Reports as LaTeX documents: for `pdflatex`, `xelatex` and `lualatex`, with the packages of any distribution."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from compoundkin.view.report.report_data import (
    Alert,
    FormulaBlock,
    Paragraph,
    Section,
    StepBlock,
    TableBlock,
    not_a_block,
)
from compoundkin.view.report.wording import column_texts, title_with_unit, typeset

PREAMBLE = r"""\documentclass[a4paper,11pt]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath,amssymb,longtable,array,graphicx,tikz}
\setlength{\parindent}{0pt}\setlength{\parskip}{6pt}
\setcounter{MaxMatrixCols}{30}
\allowdisplaybreaks
"""
# Signs that LaTeX reads as commands.
_ESCAPED = {
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
        rf"\ensuremath{{{_SIGNS[sign]}}}" if sign in _SIGNS else _ESCAPED.get(sign, sign) for sign in typeset(text)
    )


def latex_document(title: str, sections: Sequence[Section], figure: str = "") -> str:
    """Return a report as a LaTeX document; `figure` is TikZ and stands below the title."""
    picture = re.search(r"\\begin\{tikzpicture\}.*\\end\{tikzpicture\}", figure, re.DOTALL)
    needs = "".join(f"{line}\n" for line in figure.splitlines() if re.match(r"\\(usetikzlibrary|definecolor)", line))
    parts = [rf"\section*{{{plain_latex(title)}}}"]
    if picture:
        inside = rf"\resizebox{{!}}{{70mm}}{{{picture.group()}}}"
        parts.append(rf"\begin{{center}}{inside}\end{{center}}")
    parts += [part for section in sections for part in _section(section)]
    body = "\n\n".join(parts)
    return f"{PREAMBLE}{needs}\\begin{{document}}\n{body}\n\\end{{document}}\n"


def _section(section: Section) -> Iterator[str]:
    if section.title:
        yield rf"\subsection*{{{plain_latex(section.title)}}}"
    for block in section.blocks:
        yield _block(block)


def _block(block: object) -> str:
    match block:
        case Paragraph():
            return plain_latex(block.text)
        case FormulaBlock():
            if block.latex:
                inside = rf"$\displaystyle {block.latex}$"
                fitted = r"\ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\usebox0}\else\usebox0\fi"
                return rf"\begin{{center}}\sbox0{{{inside}}}{fitted}\end{{center}}"
            return "\\\\\n".join(
                rf"\texttt{{{plain_latex(line).replace('  ', '~~')}}}" for line in block.text.split("\n")
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
    fitted = r"\ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\usebox0}\else\usebox0\fi"
    return f"\\begin{{center}}\\small\\sbox0{{{inside}}}{fitted}\\end{{center}}"
