"""What goes with a moving sketch: arrows of velocities and accelerations, and instant centres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.analysis.centres import instant_centres
from compoundkin.base.series import Number
from compoundkin.view.sketch.centre_pictures import DOT, TOGETHER, centre_name
from compoundkin.view.sketch.label_places import Label, around, placed, text_half
from compoundkin.view.sketch.moving_sketch import MovingSketch
from compoundkin.view.sketch.picture import MARGIN, Window
from compoundkin.view.sketch.shapes import CircleShape, Shape, Text, leaves, moved
from compoundkin.view.sketch.sketch_style import LETTER, SMALL
from compoundkin.view.sketch.vectors import VectorScale, vector_shapes

# So near to the edge of a picture a centre is left out.
EDGE = 2.0
# The name of a centre stands so far beside it where no better place is known.
BESIDE = 9.0 - 9.0j
FAR = 22.0


@dataclass(frozen=True, eq=False)
class Arrows:
    """Vectors of one kind at all points over the assembled poses. `places` on the picture."""

    scale: VectorScale
    places: dict[str, Number]
    rates: dict[str, Number]

    def sign(self, way: int) -> int:
        """Tell what they are multiplied by where the motion goes back. Velocities turn round, accelerations do not."""
        return int(way**self.scale.order)

    def shapes(self, k: int, way: int) -> list[Shape]:
        """Return the arrows at the k-th assembled pose."""
        rates = {letter: complex(v[k]) * self.sign(way) for letter, v in self.rates.items() if np.isfinite(v[k])}
        return vector_shapes({letter: complex(self.places[letter][k]) for letter in rates}, rates, self.scale)


@dataclass(frozen=True, eq=False)
class MovingCentre:
    """An instant centre, or several that are always at one place. It is shown at some poses."""

    name: str
    places: Number
    shown: Number
    beside: complex = BESIDE

    @property
    def marks(self) -> tuple[Shape, ...]:
        """A dot with its name, as seen from the centre."""
        halo, name = (Text(self.beside, self.name, style) for style in ("centre-name halo", "centre-name"))
        return CircleShape(0j, DOT, "centre"), halo, name

    def shapes(self, k: int) -> list[Shape]:
        """Draw it at the k-th assembled pose; nothing where it is off the picture."""
        return moved(self.marks, complex(self.places[k])) if self.shown[k] else []


def with_arrows(sketch: MovingSketch, kinds: Sequence[str], back: bool) -> tuple[MovingSketch, tuple[Arrows, ...]]:
    """Return arrows of some kinds and the sketch with room for them. With a way `back`, for both senses.

    Raises InvalidInput where the motion was not solved for them.
    """
    made: list[Arrows] = []
    for scale in filter(None, map(sketch.scale, kinds)):
        rates = sketch.rates(scale.kind)
        made.append(Arrows(scale, {letter: places_of(sketch, letter) for letter in rates}, rates))
    tips = [tip for arrows in made for tip in _tips(arrows, back)]
    larger = sketch.holding(np.concatenate(tips), MARGIN / 2.0) if tips else sketch
    return larger, tuple(replace(one, places={k: places_of(larger, k) for k in one.places}) for one in made)


def places_of(sketch: MovingSketch, letter: str) -> Number:
    """Tell where a point is on the picture, (poses,)."""
    return np.broadcast_to(sketch.window.at(sketch.scene.places(letter)), (sketch.scene.count,))


def _tips(arrows: Arrows, back: bool) -> list[Number]:
    ways = {1, arrows.sign(-1)} if back else {1}
    found = []
    for letter, rates in arrows.rates.items():
        rate = np.conjugate(np.where(np.isfinite(rates), rates, 0.0)) * arrows.scale.per_unit
        found += [arrows.places[letter] + sign * rate for sign in sorted(ways)]
    return found


def moving_centres(sketch: MovingSketch) -> tuple[MovingCentre, ...]:
    """Return all instant centres that are ever on the picture. Those that are always at one place are together."""
    scene, window = sketch.scene, sketch.window
    centres = instant_centres(sketch.motion)
    apart: list[tuple[list[str], Number]] = []
    for pair in centres:
        rows = np.reshape(centres[pair].point, (sketch.motion.inputs.designs, -1))
        row = np.where(np.isfinite(rows[sketch.design]), rows[sketch.design], np.nan)
        places = np.asarray(window.at(np.broadcast_to(row, sketch.motion.inputs.poses)[scene.known]))
        same = next((names for names, other in apart if _always_together(places, other)), None)
        if same is None:
            apart.append(([centre_name(scene, *pair)], places))
        else:
            same.append(centre_name(scene, *pair))
    found = [MovingCentre(" ".join(names), places, _seen(window, places)) for names, places in apart]
    return _beside(sketch, [one for one in found if one.shown.any()])


def _always_together(one: Number, other: Number) -> bool:
    known = np.isfinite(one) & np.isfinite(other)
    return bool(known.any() and np.all(np.abs(one - other)[known] < TOGETHER))


def _seen(window: Window, places: Number) -> Number:
    with np.errstate(invalid="ignore"):
        across = (places.real >= EDGE) & (places.real <= window.width - EDGE)
        return np.isfinite(places) & across & (places.imag >= EDGE) & (places.imag <= window.height - EDGE)


def _beside(sketch: MovingSketch, centres: Sequence[MovingCentre]) -> tuple[MovingCentre, ...]:
    """The centres with their names where they are in nobody's way at the pose shown first."""
    k = int(np.searchsorted(sketch.scene.known, sketch.scene.pose[1]))
    shapes = list(leaves(sketch.shapes(k)))
    taken = [Label(f"text {n}", text_half(s.text, LETTER), (s.at,), (0.0,)) for n, s in enumerate(texts_in(shapes))]
    here = [one for one in centres if one.shown[k]]
    wanted = [around(c.name, complex(c.places[k]), text_half(c.name, SMALL), 5.0, 1 + 1j) for c in here]
    found = placed([*taken, *wanted], shapes, sketch.window.width, sketch.window.height)
    offs = {c.name: complex(found[c.name] - c.places[k]) for c in here}
    # farther off a name would seem to belong to nothing once the centre has moved on
    return tuple(replace(c, beside=offs[c.name]) if abs(offs.get(c.name, FAR)) < FAR else c for c in centres)


def texts_in(shapes: Sequence[Shape]) -> list[Text]:
    """Return the texts among shapes."""
    return [shape for shape in shapes if isinstance(shape, Text)]
