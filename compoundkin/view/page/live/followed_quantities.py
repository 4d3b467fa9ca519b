"""The quantities that a live page tells anew at every pose: outputs, their rates, what groups pass on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compoundkin.analysis.characteristics.group_figures import coriolis_names, index_names
from compoundkin.analysis.characteristics.outputs_of_motion import chosen_outputs, outputs_of
from compoundkin.base.errors import CompoundkinError
from compoundkin.kinematics import Motion
from compoundkin.model.attributes import LENGTH, course_figure, order_of
from compoundkin.programs.recording.recorded_outputs import output_of


def followed_quantities(motion: Motion, outputs: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the names of the quantities behind the figures of a report.

    They are those of its outputs, the rates of these, transmission indices and Coriolis accelerations, as far as a
    program can tell them. Of a vector it is the whole vector.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> followed_quantities(solve(load_named("jansen-leg")))[:3]
    ('foot.position', 'foot.velocity', 'foot.acceleration')
    """
    asked = dict.fromkeys(name.removesuffix(f".{LENGTH}") for name in _asked(motion, outputs))
    return tuple(name for name in asked if order_of(name) <= motion.order and _is_told(motion, name))


def _asked(motion: Motion, outputs: Sequence[str]) -> Iterator[str]:
    chosen = [name for name in chosen_outputs(motion, outputs) if not course_figure(name)[1]]
    yield from chosen
    for one in outputs_of(motion, chosen):
        yield from one.names
    yield from index_names(motion)
    yield from coriolis_names(motion)


def _is_told(motion: Motion, name: str) -> bool:
    """Tell whether it is arithmetic of one pose."""
    try:
        output_of(motion, name)
    except CompoundkinError:
        return False
    return True
