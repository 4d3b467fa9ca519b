"""Formulas as MathML: all that reports write, read as it was meant."""

from __future__ import annotations

import re
from functools import cache
from xml.etree import ElementTree

import pytest

import compoundkin as ck
from compoundkin.analysis.equations.expressions import latex, text
from compoundkin.analysis.equations.loop_equations import loop_equations
from compoundkin.view.page.mathml import UnknownLatex, mathml, with_formulas
from compoundkin.view.report.report_data import FormulaBlock, Outcome, Section
from compoundkin.view.report.report_forms import Report
from tests import catalog

# The names of elements that MathML Core has, of those that formulas need.
KNOWN = {
    "math",
    "mrow",
    "mi",
    "mn",
    "mo",
    "mtext",
    "mspace",
    "msub",
    "msup",
    "msubsup",
    "mover",
    "mtable",
    "mtr",
    "mtd",
}


def read(formula: str) -> ElementTree.Element:
    """The elements of a formula; scripts must have as many children as they take."""
    root = ElementTree.fromstring(f"<all>{mathml(formula)}</all>")
    for element in root.iter():
        assert element.tag in KNOWN | {"all"}
        wanted = {"msub": 2, "msup": 2, "msubsup": 3, "mover": 2}.get(element.tag)
        assert wanted is None or len(element) == wanted
    return root


def words(equation: object) -> set[str]:
    """The names and numbers in an equation as text."""
    return set(re.findall(r"[A-Za-z]{2,}|\d+\.\d+", text(equation))) - {"deg", "value", "of", "Re"}


@cache
def equations_of(name: str) -> ck.results.LoopEquations:
    return loop_equations(catalog.structure(name), order=2)


@catalog.each(catalog.CHOSEN)
def test_every_equation_of_the_catalog_is_read_with_all_its_names(name: str) -> None:
    found = equations_of(name)
    for equation in (*found.loops, *found.auxiliary, *found.drivers):
        said = "".join(read(latex(equation)).itertext())
        assert all(word in said for word in words(equation)), said
        # as many equals signs, pluses and minuses at the top as the text has
        assert said.count("=") == text(equation).count("=")


@catalog.each(catalog.THIRD)
def test_matrices_and_right_hand_sides_are_read_entry_by_entry(name: str) -> None:
    for rates in equations_of(name).rates:
        for array in (rates.matrix, rates.right_side) if rates.unknowns else ():
            rows = [[cell for cell in row if cell.tag == "mtd"] for row in read(array.latex).iter("mtr")]
            assert [len(row) for row in rows] == [len(row) for row in array.entries]
            both = zip(rows, array.entries, strict=True)
            for cell, entry in (pair for row in both for pair in zip(*row, strict=True)):
                said = "".join(cell.itertext())
                assert all(word in said for word in re.findall(r"\\text\{([^}]*)\}", entry.latex))
                assert said.count("sin") >= entry.text.count("sin(")
                assert len(list(cell.iter("mover"))) == len(re.findall(r"\\d?dot", entry.latex))


def test_scripts_and_signs() -> None:
    root = read(r"-2.5 \theta_{\text{a}} + \overline{\text{AB}}\,e^{i(\theta_{\text{b}} + 35^\circ)} = 0")
    assert [element.tag for element in root] == ["math"] * 3
    assert "".join(root.itertext()) == "−2.5θa +ABei(θb+35°) =0"
    assert [element.get("class") for element in root.iter("mtext")] == [None, "over", None]
    assert [child.tag for child in root[1]] == ["mo", "mtext", "msup"]


@pytest.mark.parametrize("name", ["a_b", "50% {x}", "a#b&c$d", "x^2~", "<b>"])
def test_names_come_through_as_they_are(name: str) -> None:
    parts = ck.link("frame", A=0, D=4), ck.link(name, A=0, B=1), ck.link("rod", B=0, C=3), ck.link("arm", D=0, C=3)
    found = loop_equations(ck.decompose(ck.Mechanism("m", *parts, ck.drive(name))))
    assert name in [element.text for element in read(latex(found.loops[0])).iter("mtext")]


@pytest.mark.parametrize(
    "formula", [r"\frac{1}{2}", r"\text", r"a_{b", r"\text{<b>", r"\begin{bmatrix} 1 & 2", r"\begin{cases}"]
)
def test_what_it_does_not_know_is_shown_as_text(formula: str) -> None:
    with pytest.raises(UnknownLatex):
        mathml(formula)
    section = Section("s", "S", (FormulaBlock("a < b", formula),))
    html = Report("R", (section,), Outcome(True)).html()
    assert '<p class="formula"><code>a &lt; b</code></p>' in html


@pytest.mark.parametrize(
    ("sentence", "formulas"),
    [
        ("The count says F = 0, yet it moves.", ["F=0"]),
        ("It rises by 2 sqrt(L^2 - x^2).", ["2L2−x2"]),
        ("They want cot(outer) - cot(inner) = track / wheelbase, so that", ["cot(outer)−cot(inner)=track/wheelbase"]),
        ("on the shaft. sun = 2 arm - rod.", ["sun=2arm−rod"]),
        ("with the acceleration r w^2 upwards", ["rw2"]),
        ("between them: theta5 = 2 theta2 + 30 degrees. Both", ["θ5=2θ2+30°"]),
        ("by tan 15 degrees = 0.268 of it", ["tan15°=0.268"]),
        ("the line y = 4 at three places", ["y=4"]),
        ("x-axis, and/or 3 + 4 of them at 0 and 180 degrees, a pin (in a slot), 2-dof", []),
    ],
)
def test_formulas_in_sentences(sentence: str, formulas: list[str]) -> None:
    html = with_formulas(sentence, ("arm", "rod", "sun"))
    found = re.findall(r"(?:<math>(?:(?!</math>).)*</math> ?)+", html)
    assert [re.sub(r"<[^>]+>| ", "", one) for one in found] == formulas
    ElementTree.fromstring(f"<all>{html}</all>")
    # nothing of the sentence around them is lost
    rest = re.sub(r"<math>.*</math>", "#", html) if formulas else html
    before, _, after = rest.partition("#")
    assert sentence.startswith(before.rstrip())
    assert sentence.endswith(after.lstrip())


@pytest.mark.parametrize(
    "text",
    [
        "a = ",
        "= b",
        "((a = 2",
        "x^",
        "sqrt(",
        "sqrt()",
        "a = <b>",
        "\\text{a} = 1",
        "é = 1",
        "a^b^c",
        "a = b_c",
        "2^(a+b)",
    ],
)
def test_any_text_is_written(text: str) -> None:
    ElementTree.fromstring(f"<all>{with_formulas(text)}</all>")
