"""Texts for TeX: what would be a command is written out, signs that it has no letter for are set as formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping

from compoundkin.base.texts import printable

_COMMANDS: Mapping[str, str] = {
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "`": r"\textasciigrave{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedblright{}",
    "'": r"\ensuremath{'}",
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
}
# From alpha on as Unicode lists them.
_GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu"),
    *("xi", "o", "pi", "rho", "varsigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"),
)
_CAPITALS = {"Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi", "Π": "Pi", "Σ": "Sigma", "Φ": "Phi"}
_SIGNS = {
    **{chr(0x3B1 + k): name if name == "o" else f"\\{name}" for k, name in enumerate(_GREEK)},
    **{letter: f"\\{name}" for letter, name in (*_CAPITALS.items(), ("Ψ", "Psi"), ("Ω", "Omega"))},
    **{"−": "-", "·": r"\cdot", "×": r"\times", "±": r"\pm", "°": r"^\circ", "∞": r"\infty", "→": r"\to"},
    **{"≤": r"\le", "≥": r"\ge", "≈": r"\approx", "√": r"\surd", "′": "'", "″": "''", "µ": r"\mu", "∠": r"\angle"},
}
# Raised and lowered signs, several in a row as one formula.
_RAISED, _LOWERED = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "₀₁₂₃₄₅₆₇₈₉₋"
_PLAIN = str.maketrans(_RAISED + _LOWERED, "0123456789-0123456789-")
_RUNS = re.compile(f"[{_RAISED}]+|[{_LOWERED}]+|.", re.DOTALL)
# Two of these would become one sign of another kind.
_DOUBLED = re.compile(r"([-,])(?=\1)")


def tex_text(text: str) -> str:
    r"""Return a text such that TeX sets it as it is written. Letters of other scripts stay: LuaLaTeX sets them.

    >>> print(tex_text("50 % of a_1 at ω₁₂, -0.5°"))
    50 \% of a\_1 at \ensuremath{\omega}\ensuremath{_{12}}, -0.5\ensuremath{^\circ}
    """
    shown = _DOUBLED.sub(r"\1\0", printable(text))
    return "".join(_set(run) for run in _RUNS.findall(shown)).replace("\0", "{}")


def tex_comment(text: str) -> str:
    r"""Return a text as one line of a comment.

    >>> tex_comment("one\ntwo")
    '% one two'
    """
    return "% " + printable(text)


def _set(run: str) -> str:
    if run[0] in _RAISED + _LOWERED:
        return f"\\ensuremath{{{'^' if run[0] in _RAISED else '_'}{{{run.translate(_PLAIN)}}}}}"
    if run in _SIGNS:
        return f"\\ensuremath{{{_SIGNS[run]}}}"
    return _COMMANDS.get(run, run)
