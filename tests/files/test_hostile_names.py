"""Names are text wherever they are written: a hundred hostile ones change nothing of what a file does.

Each text is reduced to its skeleton: what a program that reads it takes for code, elements or keys, without the texts
and names in it. With a hostile name the skeleton is that of a harmless one, so that no name is code anywhere.
"""

from __future__ import annotations

import ast
import io
import json
import re
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck

MARKUP = [
    "<b>", "</script>", "</script><script>alert(1)</script>", "<!--", "-->", "--><b>", "<!", "]]>", "]]><b>",
    "<![CDATA[", "<img src=x onerror=alert(1)>", "<svg onload=alert(1)>", "</title><b>", "</style><b>", "</text><b/>",
    "</svg>", "</textarea>", '" onmouseover="alert(1)', "' onclick='alert(1)", '"><b>', "'><b>", "&", "&amp;",
    "&lt;b&gt;", "&#60;b&#62;", "&nbsp;", "javascript:alert(1)", "data:text/html;<b>", "<?xml?>", "<?", "?>",
    "<!DOCTYPE x>", "<a href=//x>", "&x;", "<",
]  # fmt: skip
CODE = [
    '"', "'", '"""', "'''", '" + x + "', "' + x + '", "\\", "\\\\", '\\"', "\\'", "\\n", "\\u0022", "\\x22", "*/",
    "*/ x(); /*", "/*", "//", "#", "%", "%{", "%}", "--", ";", "; system('x');", "`", "`${x}`", "${x}", "$(x)", "{x}",
    "{{x}}", "}", "{", "(", ")", "[", "]", "@x", "=1+1", "+1", "-1+1", "=cmd|' /C x'!A0", "__import__('os')",
    "eval('x')", "import os", "x = 1", "?x", "!x", "|x", "^x", "~", "??/", "%:include", "_Pragma(x)", "#define x",
    "lambda: 0", "None", "class", "function", "return", "end", "if", "NaN", "inf", "__proto__", "constructor",
    "toString", "prototype", "arguments", "nan", "pi", "i", "e", "ans", "self", "this",
]  # fmt: skip
TEX = [
    "\\input{x}", "\\write18{x}", "\\end{tikzpicture}", "\\begin{x}", "$", "$$", "\\(", "_", "__", "^^M", "#1", "~",
    "\\\\x", "\\def\\x{}", "\\catcode", "&x", "%x", "}{", "\\", "\\usebox",
]  # fmt: skip
TABLES = [
    "[x]", "[[x]]", "x]", "0\\n", "<<", ">>", "AcDb", "ENDSEC", "999", "%%c", "%%u", "\\U+0041", "\\P", "{\\fx;}",
    "^J",
]  # fmt: skip
OTHER = [
    "é", "أ", "日本", "Ω", "a b", " a", "a ", "A" * 300, "𝛼", "ß", "ı", "ﬁ", "́x", "1", "-", "_x",
]  # fmt: skip
NAMES = sorted({*MARKUP, *CODE, *TEX, *TABLES, *OTHER})
# What a title may hold and a name may not.
LINES = ["x\ny", "x\n#y", "x\n*/y", "x\n%}\ny", "x\r\ny", "x\n\n[links]\n", "x.y", "x,y", "\u2028x", "x\n0\nENDSEC\n"]
HARMLESS = "harmless"
# Twenty at a time, for what takes a tenth of a second each.
LONG = ["".join(NAMES[k::12]).strip().replace("A" * 300, "") for k in range(12)] + LINES[:4]


@cache
def four_bar(name: str) -> ck.Mechanism:
    """A four-bar whose title is a name, and a link and a point too where it may be one."""
    for link, point in ((name, f"{name}P"), (f"{name}L", name), ("bar", f"{name}P"), ("bar", "B")):
        try:
            return ck.Mechanism(
                name,
                ck.link("frame", A=(0, 0), D=(4, 0)),
                ck.link("crank", A=(0, 0), **{point: (1, 0)}),
                ck.link(link, **{point: (0, 0)}, C=(3.5, 0), P=(1, 1)),
                ck.link("rocker", D=(0, 0), C=(3, 0)),
                ck.drive("crank"),
            )
        except ck.errors.CompoundkinError:
            continue
    raise AssertionError(name)


def moving_link(name: str) -> str:
    return list(four_bar(name).links)[2]


def refused_or(make: Callable[[], str]) -> str | None:
    """A text, or None where the format cannot say a name, which is told before anything is written."""
    try:
        return make()
    except ck.errors.CompoundkinError:
        return None


def program(language: str) -> Callable[[str], str]:
    def text(name: str) -> str:
        mechanism = four_bar(name)
        own = ck.compile(mechanism, [f"{moving_link(name)}.angle", "P.position"], backend="numpy")
        return own.source(language, "four_bar")

    return text


def written(form: str) -> Callable[[str], str]:
    return lambda name: ck.exchange.write(four_bar(name), form).text


# --- skeletons --------------------------------------------------------------------------------------------------


class _Tags(HTMLParser):
    """The elements of a page with their attributes; scripts word for word, and the keys of data."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: set[Any] = set()
        self.scripts: list[str] = []
        self._in: str | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags |= {tag, *((tag, name) for name, _ in attrs)}
        links = {(name, value) for name, value in attrs if name in ("href", "src", "action") and value}
        assert all(value.startswith(("#", "data:image", "http")) for _, value in links), links
        self._in = ("data" if "json" in str(dict(attrs).get("type")) else "script") if tag == "script" else None

    def handle_endtag(self, tag: str) -> None:
        self._in = None

    def handle_data(self, data: str) -> None:
        if self._in == "data":
            json.loads(data)
        elif self._in:
            self.scripts.append(data)

    def handle_comment(self, data: str) -> None:
        self.tags.add("comment")

    def handle_decl(self, decl: str) -> None:
        self.tags.add(decl)

    def handle_pi(self, data: str) -> None:
        self.tags.add(data)


def html(text: str) -> set[Any]:
    tags = _Tags()
    tags.feed(text)
    tags.close()
    return tags.tags | set(tags.scripts)


def xml(text: str) -> set[Any]:
    """The elements with their attributes, and what they link to."""
    return {(one.tag, frozenset(one.attrib)) for one in ET.fromstring(text).iter()}


def python(text: str) -> set[str]:
    """What is imported, defined and called, and the kinds of everything else."""
    nodes = list(ast.walk(ast.parse(text)))
    names = {ast.unparse(node.func) for node in nodes if isinstance(node, ast.Call)}
    names |= {ast.unparse(node) for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)}
    return names | {type(node).__name__ for node in nodes}


def code(comments: str, strings: str = "$^") -> Callable[[str], set[str]]:
    """What a text does beside sums of numbers: the signs and calls outside of comments and strings."""
    left_out = re.compile(rf"{comments}|{strings}", re.S)
    called = re.compile(r"[A-Za-z_]\w*(?=\s*\()|[^\w\s.]")
    return lambda text: set(called.findall(left_out.sub(" ", text)))


def tikz(text: str) -> set[str]:
    """The commands; every brace has its partner."""
    text = re.sub(r"(?<!\\)%.*", "", text)
    plain = re.sub(r"\\[\\{}]", "", text)
    assert plain.count("{") == plain.count("}")
    return set(re.findall(r"\\[A-Za-z@]+|\$", text))


# What TikZ and LaTeX write for characters that they take for commands.
ESCAPES = {"\\textbackslash", "\\textasciitilde", "\\textasciicircum", "\\textquotesingle", "\\textasciigrave"}
ESCAPES |= {"\\textless", "\\textgreater", "\\textbar", "\\textquotedblright", "\\_", "$", "\\Omega"}


def dxf(text: str) -> set[str]:
    """The kinds of entities; codes and values take turns to the end."""
    lines = text.splitlines()
    codes, values = lines[::2], lines[1::2]
    assert len(codes) == len(values)
    assert values[-1] == "EOF"
    return {value for code, value in zip(codes, values, strict=True) if int(code) == 0}


def values(text: str) -> set[str]:
    """The kinds of values of a JSON text."""

    def kinds(value: Any) -> set[str]:
        parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
        return {type(value).__name__}.union(*map(kinds, parts))

    return kinds(json.loads(text))


def in_archive(name: str) -> str:
    with zipfile.ZipFile(io.BytesIO(ck.exchange.write(four_bar(name), "geogebra").content)) as archive:
        assert archive.namelist() == ["geogebra.xml"]
        return archive.read("geogebra.xml").decode()


C_LIKE = code(r"/\*.*?\*/|//[^\n]*")
TEXTS: dict[str, tuple[Callable[[str], str], Callable[[str], set[Any]]]] = {
    "C": (program("c"), C_LIKE),
    "JavaScript": (program("javascript"), C_LIKE),
    "Python": (program("python"), python),
    "MATLAB": (program("matlab"), code(r"%[^\n]*")),
    "TikZ": (lambda name: ck.draw(four_bar(name)).content("tikz").decode(), tikz),
    "SVG": (lambda name: ck.draw(four_bar(name), dimensions=True).svg, xml),
    "moving SVG": (lambda name: ck.animate(four_bar(name)).svg, xml),
    "page": (lambda name: ck.page(ck.solve(four_bar(name), {"crank": ck.deg(np.arange(0, 360, 60))})).html, html),
    "DXF": (written("dxf"), dxf),
    "MuJoCo": (written("mjcf"), xml),
    "Linkage": (written("linkage"), xml),
    "pylinkage": (written("pylinkage"), values),
    "GeoGebra": (in_archive, xml),
    "GeoGebra commands": (written("geogebra-commands"), code("$^", strings=r"\"[^\"]*\"")),
}  # fmt: skip


# What each kind takes for code, beside every fifth of all other names.
OF_KIND = {
    **dict.fromkeys(("C", "JavaScript", "Python", "MATLAB", "GeoGebra commands"), CODE),
    **dict.fromkeys(("SVG", "MuJoCo", "Linkage", "GeoGebra"), MARKUP),
    "TikZ": TEX,
    "pylinkage": CODE[::3],
}


def tried(kind: str) -> list[str]:
    """The names that are tried: joined to long ones where a text takes a tenth of a second."""
    if kind in ("page", "moving SVG", "DXF"):
        return LONG
    return sorted({*OF_KIND[kind], *OTHER, *NAMES[[*TEXTS].index(kind) % 5 :: 5], *LINES})


@pytest.mark.full
@pytest.mark.parametrize("kind", TEXTS)
def test_no_name_is_code(kind: str) -> None:
    write, skeleton = TEXTS[kind]
    expected = skeleton(write(HARMLESS))
    offending = []
    for name in tried(kind):
        text = refused_or(lambda name=name: write(name))
        if text is None:
            continue
        try:
            found = skeleton(text)
        except (SyntaxError, ET.ParseError, AssertionError, ValueError) as error:
            offending.append(f"{name!r}: {error!r}")
            continue
        if not found <= expected | ESCAPES:
            offending.append(f"{name!r}: {sorted(found - expected - ESCAPES, key=str)}")
    assert not offending, "\n".join(offending)


def test_a_file_reads_back_every_name(tmp_path: Path) -> None:
    """A mechanism file is the same mechanism whatever is in its names and its title."""
    for name in (*NAMES, *LINES):
        mechanism = four_bar(name)
        ck.save(mechanism, tmp_path / "four-bar.toml")
        again = ck.load(tmp_path / "four-bar.toml")
        assert (again.title, list(again.links)) == (mechanism.title, list(mechanism.links))
