"""Groups without a closed form in programs: Newton's steps from states nearby, against `solve`."""

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.programs.backends import runner_of
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, flat_program
from compoundkin.programs.recording.input_kinds import DIMENSION, DRIVE, SEED
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_mechanism import Recording, recorded
from compoundkin.programs.recording.recorded_outputs import output_of, recorded_outputs
from compoundkin.programs.seed_values import seed_values

NAMES = (
    "3-rrr",
    "class-iii-six-bar",
    "stephenson-ii",
    "stephenson-ii-driven-at-binary",
    "stephenson-iii-driven-at-dyad",
    "stephenson-iii-floating-driver",
)
WORDS = ("position", "velocity", "acceleration")


def motion_of(name):
    """Return a catalog mechanism's motion, and its recording with some points as inputs."""
    motion = ck.solve(ck.catalog.load_named(name))
    order = motion.solving_order
    free = tuple(f"{link}.{letter}" for link, own in motion.mechanism.geometry.points.items()
                 for letter in own if link != "frame")[:4]  # fmt: skip
    signs = {s.index: motion.sign(s.index, 0) for s in order.solvers if not s.is_numbered}
    return motion, Recording(order, signs, free)


def numbers_of(motion, wanted):
    """Return what a program is given: a dimension by design, the others at every pose."""
    shape = motion.failed.shape
    seeds = seed_values([one for one in wanted if one.kind == SEED], motion)
    for one in wanted:
        if one.kind == DIMENSION:
            link, _, letter = one.name.partition(".")
            place = complex(motion.mechanism.geometry.points[link][letter])
            yield np.full((shape[0], 1), place.real if one.part == "x" else place.imag)
        elif one.kind == DRIVE:
            yield np.broadcast_to(np.asarray(motion.inputs.drives[one.name][int(one.part)], float), shape)
        else:
            yield seeds[one]


@pytest.mark.parametrize("name", NAMES)
def test_every_point_equals_solve(name):
    motion, recording = motion_of(name)
    mechanism = recorded(recording)
    letters = list(motion.mechanism.carriers)
    names = (f"{letter}.{word}" for word in WORDS for letter in letters)
    places = recorded_outputs(mechanism, (output_of(motion, name) for name in names))
    nodes = [node for place in places for node in (place.x, place.part(1))]
    graph = mechanism.graph
    given = {node.given: BY_DESIGN if node.given.kind == DIMENSION else BY_BOTH for node in graph.nodes if node.given}
    flat = flat_program(graph, [*nodes, RecordedLimits(mechanism).certain.x], given)
    shape = motion.failed.shape
    outputs = [np.empty(flat.shape(node, *shape)) for node in flat.outputs]
    wanted = [graph.nodes[k].given for k in flat.inputs]
    runner_of(flat, "numpy")(list(numbers_of(motion, wanted)), outputs, shape)
    found = [np.broadcast_to(x + 1j * y, shape) for x, y in zip(outputs[:-1:2], outputs[1:-1:2], strict=True)]
    for k, word in enumerate(WORDS):
        expected = [getattr(motion.points[letter], word).reshape(shape) for letter in letters]
        scale = max(np.nanmax(np.abs(one)) for one in expected)
        for one, other in zip(expected, found[k * len(letters) :], strict=False):
            np.testing.assert_allclose(other, one, rtol=0.0, atol=1e-12 * scale)
    assert ((outputs[-1] > 0.0) == motion.assembled.reshape(shape)).all()
