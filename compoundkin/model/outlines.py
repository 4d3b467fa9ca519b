"""Outlines of links: bars of a width, discs, polygons and pins, each on one layer or several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.fields import DeclaredKeys, Item, link_key, spot_key, value_key
from compoundkin.model.geometry import real, vector
from compoundkin.model.loads.contract import NO_RENAMING

__all__ = ["LinkOutline", "outline"]
OUTLINES = "outlines"


@dataclass(frozen=True, eq=False, repr=False)
class LinkOutline(ShortRepr, Item):
    """An outline of a link: bars or a plate, a disc, a polygon, pins.

    It is on one layer or several. The outline of a link is all that is written of it together.
    """

    link: str = field(metadata=link_key("The link whose outline it is."))
    width: Number = field(
        default=None, metadata=value_key("length", "The width of the rounded bar or plate through the link's points.")
    )
    through: tuple[Any, ...] = field(
        default=(),
        metadata=value_key("spots", "The points, or places in the link's frame, through which bars of the width lead."),
    )
    at: Any = field(
        default=None, metadata=spot_key("link", "The middle of the disc, or the point of the one pin that is meant.")
    )
    radius: Number = field(default=None, metadata=value_key("length", "The radius of a disc."))
    polygon: tuple[Any, ...] = field(
        default=(),
        metadata=value_key("spots", "The corners of a polygon in order: points or places in the link's frame."),
    )
    pin: Number = field(
        default=None,
        metadata=value_key("length", "The diameter of the link's pins; they pass through all layers between."),
    )
    layer: tuple[int, ...] = field(
        default=(0,),
        metadata=value_key(
            "layers", "The layer that it lies on, or several, 0 if left out; higher ones are nearer to the reader."
        ),
    )
    name: str = field(
        default="",
        kw_only=True,
        metadata=value_key("name", "What the outline is called; after its link and what it is if left out."),
    )

    title: ClassVar[str] = "outline"
    table: ClassVar[str] = OUTLINES
    keys = DeclaredKeys()

    def __post_init__(self) -> None:
        """An outline that is given no name is called after its link and what it is."""
        if not self.name:
            object.__setattr__(self, "name", self.called)

    @property
    def called(self) -> str:
        """Its name where none is given."""
        place = f" at {self.at}" if isinstance(self.at, str) else ""
        kinds = (("", self.width), (" disc", self.radius), (" polygon", self.polygon or None), (" pins", self.pin))
        said = next((word for word, value in kinds if value is not None), "")
        return f"{self.link}{'' if place and said == ' disc' else said}{place}"

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return it on a link of another name. A name of its own stays."""
        name = "" if self.name == self.called else self.name
        return replace(self, link=links.get(self.link, self.link), name=name)


@checked
def outline(
    link: str,
    width: Any = None,
    *,
    through: Sequence[Any] = (),
    at: Any = None,
    radius: Any = None,
    polygon: Sequence[Any] = (),
    pin: Any = None,
    layer: int | Sequence[int] = 0,
    name: str = "",
) -> LinkOutline:
    """Return an outline of a link: a width, a disc, a polygon, pins.

    One or several of them; a link may have several outlines, and has them all.

    `width` is that of the rounded bar through the link's points, of the plate around them, or of bars `through` some
    places in this order. A disc of a `radius` is `at` a point, or a place in the link's frame, as are corners of a
    `polygon`. `pin` is the diameter of the pins that join the link to others, or of the one `at` a point; a pin passes
    through the layers of all links that it joins, and those between. `layer` is a whole number, or several.
    Numbers, or arrays for designs, (designs, 1).

    Raises InvalidMechanism for what is no number, place or layer.

    >>> outline("crank", 8, pin=5, layer=1).name
    'crank'
    >>> outline("frame", at=(40, 0), radius=6, layer=[0, 1]).layer
    (0, 1)
    """
    where = f"{OUTLINES}.{link}"
    place = at if at is None or isinstance(at, str) else vector(f"{where}.at", at)
    numbers = {"width": width, "radius": radius, "pin": pin}
    held = {key: real(f"{where}.{key}", value) for key, value in numbers.items()}
    places = {key: _spots(f"{where}.{key}", given) for key, given in (("through", through), ("polygon", polygon))}
    return LinkOutline(link, at=place, layer=_layers(f"{where}.layer", layer), name=name, **held, **places)


def _spots(where: str, given: Any) -> tuple[Any, ...]:
    """Return points by letters and places as they are held."""
    if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
        raise InvalidMechanism(Problem(where, f"{short_repr(given)} is no list of points", 'write ["A", (3, 4), "B"]'))
    return tuple(one if isinstance(one, str) else vector(f"{where}[{k}]", one) for k, one in enumerate(given))


def _layers(where: str, given: Any) -> tuple[int, ...]:
    """Return layers as whole numbers."""
    asked = given if isinstance(given, Sequence) and not isinstance(given, str) else (given,)
    wrong = [one for one in asked if isinstance(one, bool) or not isinstance(one, int | np.integer)]
    if wrong or not asked:
        what = f"{short_repr(wrong[0] if wrong else given)} is no layer"
        raise InvalidMechanism(Problem(where, what, "write a whole number, or a list of them"))
    return tuple(sorted({int(one) for one in asked}))
