"""Free dimensions: programs with any of them changed, against the mechanism itself with them changed."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, UnknownName
from compoundkin.programs.compiled_path import compile
from tests.catalog import mechanism as loaded

# Sizes of wheels must fit the distance of their axes; teeth are whole.
FIXED = ("teeth", "radii", "module", "pressure_angle")


@pytest.mark.parametrize(
    "name",
    [
        "six-bar",  # drawn links
        "slider-crank-offset",
        "hydraulic-digger",  # cylinders
        "whitworth-quick-return",
        "geared-five-bar",
        "rack-and-pinion-steering",
        "rolling-wheel",
        "scotch-yoke",
        "windscreen-wiper",
    ],
)
def test_all_dimensions_at_once_move_a_program_as_they_move_the_mechanism(name):
    mechanism, rng = loaded(name), np.random.default_rng(0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        whole = compile(mechanism, "A" if "A" in mechanism.carriers else next(iter(mechanism.carriers)))
        known = whole.programs.stated.known.values()
        free = [one for one in known if one.word not in FIXED and one.part not in ("x", "y")]
        outputs = [f"{point}.{word}" for point in mechanism.carriers for word in ("position", "velocity")]
        path = compile(mechanism, outputs, free=[one.name for one in free])
    size = 1e-4 * mechanism.geometry.size
    dimensions = {}
    for one in free:
        change = rng.standard_normal((3, 1)) * (1.0 if one.word in ("angle", "turn") else size)
        dimensions[one.name] = path.programs.stated.own(one) + change * (np.exp(1j) if one.is_vector else 1.0)
    driven = path.programs.reference.inputs.drives
    values = {driver: np.ravel(numbers[0])[:40] for driver, numbers in driven.items()}
    modes = {path.programs.reference.structure.groups[k].links[0]: sign for k, sign in path.programs.signs.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = path(values, dimensions)
        motion = ck.solve(path.mechanism(dimensions), values, modes=modes)
    for output in outputs:
        solved = np.asarray(getattr(motion.points[output.partition(".")[0]], output.partition(".")[2]))
        scale = max(float(np.nanmax(np.abs(solved))), mechanism.geometry.size)
        assembled = np.where(motion.assembled, found[output], np.nan)
        np.testing.assert_allclose(assembled, solved, atol=1e-12 * scale, rtol=0)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("name", "free"),
    [
        ("belt-coupled-cranks", ("crank/wheel.radii.0", 0.001)),
        ("rolling-wheel", ("contact.radius", 0.02)),
        ("rack-and-pinion-steering", ("bar/pinion.radius", 0.001)),
        ("geared-five-bar", ("crank/wheel.teeth.1", 1.0)),
        ("hydraulic-digger", ("boom-cylinder.stroke.0", 0.05)),
    ],
)
def test_sizes_of_wheels_and_ends_of_guides_are_free(name, free):
    mechanism, (free, change) = loaded(name), free
    path = ck.compile(mechanism, [f"{link}.angle" for link in mechanism.rigid_links], free=free)
    own = float(path.programs.stated.own(path.programs.dimensions[0]))
    dimensions = {free: np.array([[own], [own + change]])}
    driven = path.programs.reference.inputs.drives
    values = {driver: np.ravel(numbers[0])[:30] for driver, numbers in driven.items()}
    found, motion = path(values, dimensions), ck.solve(path.mechanism(dimensions), values, modes=path.modes)
    np.testing.assert_array_equal(found.assembled, motion.assembled)
    for link in mechanism.rigid_links:
        solved = np.broadcast_to(motion.links[link].angle, found.shape)
        np.testing.assert_allclose(found[f"{link}.angle"], solved, atol=1e-11)


def test_teeth_are_free_where_three_wheels_are_placed_together():
    name = "left/planet-1.teeth.0"
    path = ck.compile(loaded("differential"), ["left.angle", "planet-2.angle"], free=name)
    own, found = float(path.programs.stated.own(path.programs.dimensions[0])), path.derivatives(by=name)
    less, more = (path(dimensions={name: own + away}) for away in (-1e-4, 1e-4))
    for out in path.names:
        assert np.allclose(found[out], ck.quantity(ck.solve(loaded("differential")), out).values, atol=1e-12)
        assert np.allclose(found[out, name], (more[out] - less[out]) / 2e-4, atol=1e-8)
    assert np.abs(found["planet-2.angle", name]).max() > 1e-3


def crank(**points):
    """A crank with a block on it."""
    slide = ck.slide("block", on="crank", through="A", angle=0.1, offset=0.5, name="way")
    links = ck.link("frame", A=0), ck.link("crank", A=0, **points), ck.link("block", P=0)
    return ck.Mechanism("m", *links, slide, ck.drive("crank"), ck.drive("block", on="crank", values=1.0))


def test_a_coordinate_of_a_point_is_free_alone():
    path = compile(crank(B=(2, 1)), ["B", "P"], free=["crank.B.x", "way.angle"])
    values = {"crank": [0.0, 0.5, 1.0], "block": 1.0}
    found = path(values, {"crank.B.x": [[3.0], [4.0]]})
    x = np.array([[3.0], [4.0]])
    np.testing.assert_allclose(found["B"], (x + 1j) * np.exp(1j * np.array([0.0, 0.5, 1.0])), atol=1e-14)
    np.testing.assert_allclose(found["P"][1], (1 + 0.5j) * np.exp(1j * np.array([0.1, 0.6, 1.1])), atol=1e-14)
    assert path.mechanism({"crank.B.x": 5}).links["crank"].points["B"] == 5 + 1j


@pytest.mark.parametrize(
    ("free", "error", "text"),
    [
        (
            "crank.C",
            UnknownName,
            "free.crank.C: it has no such dimension, or it is not stated; did you mean 'crank.B'?",
        ),
        ("crnk.B", UnknownName, "did you mean 'crank.B'?"),
        (["way.offset", "way.offset"], InvalidInput, "free.way.offset: it is named twice"),
        (["crank.B", "crank.B.y"], InvalidInput, "free.crank.B.y: it is named twice, as 'crank.B' before"),
        ("way.turn", UnknownName, "not stated"),
    ],
)
def test_what_cannot_be_free_is_told(free, error, text):
    with pytest.raises(error) as told:
        compile(crank(B=2), "B", free=free)
    assert text in str(told.value)


@pytest.mark.parametrize(
    ("dimensions", "text"),
    [
        ({"way.angle": 0.1}, "dimensions.way.angle: this dimension is not free; compile(..., free=['crank.B', 'way.an"),
        ({"crank.C": 0.1}, "dimensions.crank.C: there is no such free dimension; did you mean 'crank.B'?"),
        ({"crank.B": np.nan}, "dimensions.crank.B: the value is empty or not finite"),
        ({"crank.B": "B"}, "dimensions.crank.B: 'B' is not a point; write (x, y) or a complex number"),
        ([1.0], "dimensions: [1.0] is no table by name"),
    ],
)
def test_wrong_dimensions_of_a_call_are_told(dimensions, text):
    path = compile(crank(B=2), "B", free="crank.B")
    with pytest.raises(InvalidInput) as told:
        path(None, dimensions)
    assert text in str(told.value)


def test_a_dimension_that_opens_redundant_pairs_is_refused() -> None:
    lift = ck.load("double-parallelogram-lift")
    with pytest.raises(ck.errors.InvalidInput, match=r"overconstrained.*would open"):
        ck.compile(lift, "lower.angle", free="lower.D")
    wedge = ck.load("wedge-press")
    # where a slide begins opens nothing
    assert ck.compile(wedge, "ram.angle", free="wedge.S").free


def test_teeth_of_a_train_of_three_bodies_may_be_free():
    own = ck.load("differential")
    gears = [item for item in own.items if getattr(item, "teeth", None)]
    free = own.replace(*(replace(gear, module=None) for gear in gears))
    other = free.replace(replace(gears[0], module=None, teeth=(33.0, gears[0].teeth[1])))
    values = {drive.name: k * np.linspace(0, 1, 7) for k, drive in enumerate(own.drives)}
    path = compile(free, "planet-1.angle", free="left/planet-1.teeth.0", backend="numpy")
    angle = path(values, {"left/planet-1.teeth.0": 33.0})["planet-1.angle"]
    solved = ck.solve(other, values, order=0).links["planet-1"].angle
    assert np.allclose(angle, solved, rtol=0, atol=1e-14)
    assert np.ptp(angle - path(values)["planet-1.angle"]) > 0.01
