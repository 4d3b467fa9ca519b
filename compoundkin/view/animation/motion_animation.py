"""`animate`: a motion as an animation."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem, UnassembledPoses
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion, solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure
from compoundkin.view.animation.animation import Animation
from compoundkin.view.animation.frame_caption import Caption
from compoundkin.view.animation.overlays import moving_centres, with_arrows
from compoundkin.view.animation.timeline import timeline_of
from compoundkin.view.sketch.arrows import wanted
from compoundkin.view.sketch.moving_sketch import moving_sketch
from compoundkin.view.sketch.picture import checked_size
from compoundkin.view.sketch.shown_pose import scene_in
from compoundkin.view.sketch.sketches import asked_labels, asked_paths

# A mechanism's own range is shown in at least so many steps, as a full turn is.
FEWEST = 72


def animate(
    what: Motion | Mechanism | Structure,
    *,
    design: int = 0,
    paths: str | Sequence[str] | bool = (),
    vectors: str | Sequence[str] = (),
    centres: bool = False,
    labels: bool | str | Sequence[str] = True,
    seconds: float | None = None,
    fps: float | None = None,
    back: bool | None = None,
    size: float | None = None,
) -> Animation:
    """A motion as an animation, to be saved as GIF, MP4 or SVG.

    A mechanism is solved over its drivers' own ranges, finely enough to be shown.

    `paths`, `vectors`, `centres`, `labels` and `size` are those of `draw`; vectors have one scale throughout. A motion
    in time is shown as fast as it is, any other one takes about four seconds, or `seconds`; `fps` is how many frames
    there are a second at most, 25 if left out. A motion that ends as it begins goes on for ever; any other one goes
    back the way it came, unless `back` is False. Poses that cannot be assembled are left out.

    Raises InvalidInput, UnknownName for what does not fit, NotAssembled where no pose is assembled, and what `solve`
    raises for a mechanism that it cannot solve.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> len(animate(crank))
    72
    """
    kinds, asked, shown_size = wanted(vectors), asked_labels(labels), checked_size(size)
    motion = _motion(what)
    scene = scene_in(motion, None, None, design)
    sketch = moving_sketch(motion, design, paths=asked_paths(scene, paths), labels=asked)
    timeline = timeline_of(sketch.scene, motion, design, back, seconds, fps)
    sketch, arrows = with_arrows(sketch, kinds, bool((timeline.ways < 0).any()))
    names = [f"{number} {name}" for name, number in scene.numbers.items()] if "links" in asked else []
    shown = timeline.poses[timeline.frames]
    caption = Caption(sketch, shown, tuple(names), tuple(one.scale for one in arrows), bool(asked))
    return Animation(sketch, timeline, caption, arrows, moving_centres(sketch) if centres else (), shown_size)


def _motion(what: Motion | Mechanism | Structure) -> Motion:
    if isinstance(what, Motion):
        return what
    if not isinstance(what, Mechanism | Structure):
        raise InvalidInput(Problem("animate", f"{what!r} is no motion and no mechanism", "load() one from a file"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnassembledPoses)
        motion = solve(what)
        finer = finer_values(motion)
        return motion if finer is None else solve(what, finer)


def finer_values(motion: Motion) -> dict[str, Number] | None:
    """Values of the drivers with others evenly between them, where there are too few to be shown one after another.

    None where there are enough, and where rates or dimensions change along the motion with the values.
    """
    count, drives = motion.inputs.poses, motion.inputs.drives
    parts = -(-FEWEST // max(count - 1, 1))
    rates = [np.shape(rate)[-1:] for numbers in drives.values() for rate in numbers[1:]]
    if motion.time is not None or motion.inputs.designs > 1 or not 1 < count <= FEWEST or (count,) in rates:
        return None
    places = np.linspace(0.0, count - 1.0, (count - 1) * parts + 1)
    rows = {name: np.broadcast_to(np.ravel(numbers[0]), (count,)) for name, numbers in drives.items()}
    return {name: np.interp(places, np.arange(count), row) for name, row in rows.items()}
