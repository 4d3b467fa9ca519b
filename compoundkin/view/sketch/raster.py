"""Pictures as PNG and PDF, by CairoSVG where it is installed."""

from __future__ import annotations

from typing import Any

from compoundkin.base.errors import InvalidInput, Problem

# A PNG has so many pixels for each of the picture's: sharp on fine screens and in print.
FINE = 2.0


def converted(source: str, form: str) -> bytes:
    """An SVG source as "png" or "pdf"; raises InvalidInput where CairoSVG is not installed."""
    try:
        import cairosvg
    except (ImportError, OSError) as error:
        what = f"{form.upper()} needs CairoSVG and the library Cairo: {error}"
        raise InvalidInput(Problem(f".{form}", what, "pip install compoundkin[pictures], or save an .svg")) from None
    convert: Any = cairosvg.svg2png if form == "png" else cairosvg.svg2pdf
    extra = {"scale": FINE} if form == "png" else {}
    made: bytes = convert(bytestring=on_light_paper(source).encode("utf-8"), **extra)
    return made


def on_light_paper(source: str) -> str:
    """The source without its rules for dark paper, which CairoSVG would apply to any."""
    start, end = source.find("@media"), source.find("</style>")
    return source[:start] + source[end:] if 0 <= start < end else source
