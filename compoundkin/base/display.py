"""Objects that show themselves in notebooks. What they show comes after all of them, and only notebooks pay for it."""

from __future__ import annotations

from functools import cached_property
from importlib import import_module


class Shows:
    """What a notebook shows of an object: tables and pictures, as `showing.html_of` makes them."""

    def _repr_html_(self) -> str | None:
        """As HTML; None where the text says it better, or where it would take long."""
        made: str | None = import_module("compoundkin.view.notebook").html_of(self)
        return made


class ShowsPicture(Shows):
    """An object that has a picture too, drawn once."""

    def _repr_svg_(self) -> str | None:
        """As SVG; None where there is no picture, or where it would take long."""
        return self._picture

    @cached_property
    def _picture(self) -> str | None:
        made: str | None = import_module("compoundkin.view.notebook").svg_of(self)
        return made
