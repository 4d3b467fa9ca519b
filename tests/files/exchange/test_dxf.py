"""DXF files read back by ezdxf: true sizes against the mechanism's own numbers, contours against shapely's unions."""

from __future__ import annotations

import cmath
import io
import random
import re
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf.lldxf.encoding import decode_dxf_unicode

import compoundkin as ck
from compoundkin.files import load
from compoundkin.files.exchange.dxf.dxf_format import FORMAT, whole_motion
from compoundkin.files.exchange.dxf.link_contours import ContourEdge, contours
from compoundkin.files.exchange.known_formats import write
from compoundkin.files.exchange.posed_mechanism import posed_mechanism
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.model.outline_shapes import OutlineShape, outline_shapes

FINE = 256  # chords of a quarter turn of shapely's circles


def read(mechanism: ck.Mechanism | str, at: dict[str, float] | None = None, **options: Any) -> Any:
    exported = write(load(mechanism) if isinstance(mechanism, str) else mechanism, "dxf", at, **options)
    document = ezdxf.read(io.StringIO(exported.content.decode("ascii")))
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    return document


def inserted(document: Any, link: str) -> Any:
    (one,) = (one for one in document.modelspace().query("INSERT") if one.dxf.name == f"LINK-{link}")
    return one


def place(entity: Any, key: str = "center") -> complex:
    found = entity.dxf.get(key)
    return complex(found.x, found.y)


def shape_of(one: OutlineShape) -> Any:
    places = [(p.real, p.imag) for p in one.core]
    kind = shapely.Polygon if one.closed else shapely.Point if len(places) == 1 else shapely.LineString
    core = kind(places[0] if kind is shapely.Point else places)
    return core.buffer(one.radius, quad_segs=FINE) if one.radius else core


def polygon_of(polyline: Any) -> Any:
    """A polyline with bulges as a polygon, by ezdxf's own flattening."""
    from ezdxf.path import make_path

    return shapely.Polygon([(p.x, p.y) for p in make_path(polyline).flattening(1e-3)])


# --- the pose ---------------------------------------------------------------------------------------------


def test_links_lie_where_the_pose_has_them_at_true_size() -> None:
    crusher, at = load("jaw-crusher"), {"eccentric": ck.deg(70)}
    shown, document = posed_mechanism(crusher, at), read(crusher, at)
    assert document.header["$INSUNITS"] == 4
    assert {one.dxf.name for one in document.layers} >= {"LINKS", "JOINTS", "GROUND", "CRANKS", "CURVES", "NAMES"}
    motion = ck.solve(crusher, at)
    outlines = outline_shapes(crusher, shown.points)
    for link in crusher.links:
        own = list(inserted(document, link).virtual_entities())
        marked = [place(one, "location") for one in own if one.dxftype() == "POINT"]
        for letter in shown.points[link]:
            asked = complex(np.ravel(motion.points[letter].position)[0])
            assert min(abs(p - asked) for p in marked) < 1e-9 * motion.size
        drawn = shapely.union_all([polygon_of(one) for one in own if one.dxftype() == "LWPOLYLINE"])
        if link != "eccentric":  # whose disc is a circle
            asked = sum(shape_of(one).area for one in outlines if one.body == link)
            assert drawn.area == pytest.approx(asked, rel=1e-4)
    (disc,) = (one for one in inserted(document, "eccentric").virtual_entities() if one.dxftype() == "CIRCLE")
    assert (place(disc), disc.dxf.radius) == (pytest.approx(0j, abs=1e-9), pytest.approx(60.0))
    layers = {one.dxf.name: one.dxf.layer for one in document.modelspace().query("INSERT")}
    assert layers["LINK-frame"] == "GROUND"
    assert layers["LINK-eccentric"] == "CRANKS"
    assert layers["LINK-jaw"] == "LINKS"


def test_pins_are_holes_in_every_link_that_they_join() -> None:
    crusher = load("jaw-crusher")
    shown, document = posed_mechanism(crusher), read(crusher)
    for letter, links in (("B", ("pitman", "rear-toggle", "front-toggle")), ("D", ("front-toggle", "jaw"))):
        for link in links:
            own = inserted(document, link).virtual_entities()
            holes = [(place(one), one.dxf.radius) for one in own if one.dxf.layer == "JOINTS" and "CIRCLE" in str(one)]
            assert (pytest.approx(shown.place(link, letter), abs=1e-9), pytest.approx(15.0)) in holes
    # joints without a size of their own have a circle, to be seen
    free = [place(one) for one in document.modelspace().query("CIRCLE")]
    assert any(abs(p - shown.place("frame", "E")) < 1e-9 for p in free)
    assert not any(abs(p - shown.place("jaw", "D")) < 1e-9 for p in free)


def test_the_same_drawing_is_the_same_bytes() -> None:
    first, again = (write(load("jansen-leg"), "dxf") for _ in range(2))
    assert first.content == again.content
    assert not ezdxf.options.write_fixed_meta_data_for_testing
    assert first.notes[0] == "the lengths have no unit"
    assert (
        first.notes[2] == "links without an outline, drawn as lines between their points: crank, j, bde, k, c, f, ghi"
    )


def test_a_link_without_outline_is_lines_between_its_points() -> None:
    leg = load("jansen-leg")
    shown, document = posed_mechanism(leg), read(leg)
    (line,) = (one for one in inserted(document, "k").virtual_entities() if one.dxftype() == "LINE")
    ends = {place(line, "start"), place(line, "end")}
    assert all(min(abs(shown.place("k", p) - end) for end in ends) < 1e-9 for p in shown.points["k"])
    (plate,) = (one for one in inserted(document, "bde").virtual_entities() if one.dxftype() == "LWPOLYLINE")
    assert plate.closed
    assert len(plate) == 3


def test_names_of_links_are_made_legal() -> None:
    odd = ck.Mechanism(
        "Odd",
        ck.link("frame", A=0, D=6),
        ck.link("bar/1", A=0, B=2),
        ck.link("Bar|1", B=0, C=5),
        ck.link("bär? 曲柄", D=0, C=5),
        ck.drive("bar/1"),
        unit="ft",
    )
    document = read(odd)
    assert [decode_dxf_unicode(one.dxf.name) for one in document.modelspace().query("INSERT")] == [
        "LINK-frame",
        "LINK-bar_1",
        "LINK-Bar_1-2",
        "LINK-bär_ 曲柄",
    ]
    assert (document.header["$INSUNITS"], document.header["$MEASUREMENT"]) == (2, 0)


def test_names_that_mean_something_in_dxf_are_names() -> None:
    plate = ck.link("Defpoints", A=0, **{"x^2 50%%c": 5})
    odd = ck.Mechanism(
        "Odd", ck.link("frame", A=0), ck.link("0", A=0, B=2), plate, ck.drive("0"), ck.drive("Defpoints"),
        ck.outline("0", 1, pin=0.5), ck.outline("Defpoints", 1, pin=0.5),
    )  # fmt: skip
    document = ezdxf.read(io.StringIO(write(odd, "dxf", parts=True).text))
    # on layer 0 nothing has a colour of its own, Defpoints is not plotted
    assert {one.dxf.layer for one in document.modelspace().query("LWPOLYLINE")} == {"0-2", "Defpoints-2"}
    written = [one.plain_text() for one in read(odd, curves=False).modelspace().query("TEXT")]
    assert "x^2 50%%c" in written


# --- paths ------------------------------------------------------------------------------------------------


def test_paths_are_within_the_stated_error_and_closed() -> None:
    leg, tolerance = load("jansen-leg"), 0.02
    exported = write(leg, "dxf", curves="foot", tolerance=str(tolerance))
    assert "curves are within 0.02 of the exact ones" in exported.notes
    document = ezdxf.read(io.StringIO(exported.text))
    (path,) = document.modelspace().query('LWPOLYLINE[layer=="CURVES"]')
    assert path.closed
    motion = whole_motion(posed_mechanism(leg))
    assert motion is not None
    exact = between(motion, 0, np.linspace(0, motion.inputs.poses - 1, 5000), order=0).points["foot"].position
    line = shapely.LinearRing([(x, y) for x, y, *_ in path.get_points()])
    assert shapely.distance(line, shapely.points(exact.real, exact.imag)).max() <= tolerance
    assert len(path) < 200
    with pytest.raises(ck.errors.UnknownName, match="no point 'toe' moves"):
        write(leg, "dxf", curves=["toe"])
    with pytest.raises(ck.errors.InvalidInput, match="no positive number"):
        write(leg, "dxf", tolerance="-1")


# --- profiles of cams -------------------------------------------------------------------------------------


def test_profiles_are_splines_within_the_stated_error_on_their_cam() -> None:
    plate = load("groove-cam-plate")
    at = {"plate": 12.0}
    shown = posed_mechanism(plate, at)
    document = ezdxf.read(io.StringIO(FORMAT.write(shown, tolerance=1e-3).text))
    (spline,) = (one for one in inserted(document, "plate").virtual_entities() if one.dxftype() == "SPLINE")
    drawn = np.array([complex(p.x, p.y) for p in spline.construction_tool().approximate(500)])
    own = drawn - shown.place("plate", 0j)
    # the catalog's own formula: y = x^2 / 80, by 25 points of it
    assert np.abs(own.imag - own.real**2 / 80).max() < 1e-3
    assert (own[0], own[-1]) == (pytest.approx(-60 + 45j), pytest.approx(60 + 45j))
    cams = load("disc-cam-offset-roller")
    seen = posed_mechanism(cams)
    document = ezdxf.read(io.StringIO(FORMAT.write(seen).text))
    (disc,) = (one for one in inserted(document, "cam").virtual_entities() if one.dxftype() == "SPLINE")
    places = np.array([complex(p.x, p.y) for p in disc.construction_tool().approximate(300)])
    curve = next(pair for pair in cams.written_pairs if pair.table == "cams").curve  # type: ignore[attr-defined]
    middle = seen.place("cam", complex(np.mean([curve.at(s).c[0] for s in (0.0, np.pi)])))
    assert np.abs(np.abs(places - middle) - 30.0).max() < 1e-2
    assert abs(places[0] - places[-1]) < 1e-9


# --- parts ------------------------------------------------------------------------------------------------


def test_parts_lie_side_by_side_each_on_a_layer_with_its_holes() -> None:
    crusher = load("jaw-crusher")
    exported = write(crusher, "dxf", parts="yes")
    document = ezdxf.read(io.StringIO(exported.text))
    model = document.modelspace()
    toggle = model.query('*[layer=="rear-toggle"]')
    holes = [one for one in toggle if one.dxftype() == "CIRCLE"]
    assert [one.dxf.radius for one in holes] == [15.0, 15.0]
    # the toggle plate's length by the drawn places of its pins, (290, -660) and (0, -600)
    assert abs(place(holes[0]) - place(holes[1])) == pytest.approx(abs(290 - 60j))
    cut = {one: polygon_of(one) for one in model.query("LWPOLYLINE")}
    shapes = list(cut.values())
    assert len(shapes) == 6  # two of the frame
    assert all(not a.intersects(b) for k, a in enumerate(shapes) for b in shapes[:k])
    assert {one.dxf.name for one in document.layers} >= set(crusher.links)
    with pytest.raises(ck.errors.InvalidInput, match="no link has an outline"):
        write(load("six-bar"), "dxf", parts=True)


def test_each_sheet_of_a_thick_link_is_a_part() -> None:
    stepped = ck.Mechanism(
        "Stepped",
        ck.link("frame", A=0),
        ck.link("arm", A=0, B=30),
        ck.drive("arm"),
        ck.outline("arm", 8, pin=3, layer=[0, 1]),
        ck.outline("arm", at="B", radius=9, layer=1),
        unit="mm",
    )
    document = ezdxf.read(io.StringIO(write(stepped, "dxf", parts=True).text))
    sheets = {layer: document.modelspace().query(f'LWPOLYLINE[layer=="arm layer {layer}"]') for layer in (0, 1)}
    areas = {layer: polygon_of(one[0]).area for layer, one in sheets.items()}
    bar = shapely.LineString([(0, 0), (30, 0)]).buffer(4, quad_segs=FINE)
    eye = shapely.Point(30, 0).buffer(9, quad_segs=FINE)
    assert areas[0] == pytest.approx(bar.area, rel=1e-4)
    assert areas[1] == pytest.approx(bar.union(eye).area, rel=1e-4)
    # arcs, not chords: five corners of the bar with an eye, four of the bar
    assert [len(sheets[layer][0]) for layer in (0, 1)] == [4, 5]


def test_slots_are_cut_as_wide_as_their_pins_and_as_long_as_their_way() -> None:
    swing = ck.Mechanism(
        "Swing",
        ck.link("frame", A=(0, 0), C=(0, -60), E=(70, 0)),
        ck.link("crank", A=0, B=25),
        ck.link("lever", C=0, D=95),
        ck.link("rod", B=0, P=70),
        ck.slot("crank", on="lever", at="B", through="C"),
        ck.arc("rod", on="frame", at="P", centre_at="E", radius=30),
        ck.drive("crank"),
        ck.outline("crank", 10, layer=1),
        ck.outline("crank", at="B", pin=6),
        ck.outline("lever", 16),
        ck.outline("frame", polygon=[(30, -50), (110, -50), (110, 50), (30, 50)]),
        ck.outline("rod", at="P", pin=4),
        ck.mode(1, "rod"),
        unit="mm",
    )
    shown = posed_mechanism(swing)
    model = ezdxf.read(io.StringIO(FORMAT.write(shown, parts=True).text)).modelspace()
    outside, slot = sorted(map(polygon_of, model.query('LWPOLYLINE[layer=="lever"]')), key=lambda one: -one.area)
    assert outside.contains(slot)
    # the pin is 35 to 85 from the lever's pivot
    assert slot.area == pytest.approx(50 * 6 + np.pi * 9, rel=1e-3)
    turn = np.ptp(np.angle(ck.solve(swing, {"crank": np.linspace(0, 2 * np.pi, 3601)}).points["P"].position - 70))
    outside, slot = sorted(map(polygon_of, model.query('LWPOLYLINE[layer=="frame"]')), key=lambda one: -one.area)
    assert slot.area == pytest.approx(turn * 30 * 4 + np.pi * 4, rel=1e-3)
    low = complex(*outside.bounds[:2]) - (30 - 50j)  # where the frame's axes lie on the sheet
    middles = [complex(a, b) for a, b in slot.exterior.coords]
    assert max(abs(abs(p - low - 70) - 30) for p in middles) < 2.01
    assert [one.dxftype() for one in model.query('*[layer=="CENTRES"]')] == ["ARC", "LINE"]


# --- contours ---------------------------------------------------------------------------------------------


def random_shapes(rng: random.Random) -> list[OutlineShape]:
    found: list[OutlineShape] = []

    def add(core: list[complex], closed: bool, radius: float) -> None:
        found.append(OutlineShape("a", ("a",), tuple(core), closed, radius, (0,), ("",) * len(core)))

    def point() -> complex:
        return complex(rng.uniform(-10, 10), rng.uniform(-10, 10))

    for _ in range(rng.randint(2, 4)):
        kind = rng.randint(0, 3)
        if kind == 0:
            add([point()], False, rng.uniform(0.5, 4))
        elif kind == 1:
            add([point() for _ in range(rng.randint(2, 4))], False, rng.uniform(0.5, 3))
        elif kind == 2:
            middle, corners = point(), rng.randint(3, 6)
            ways = [
                cmath.rect(rng.uniform(1, 6), 2 * np.pi * (k + 0.7 * rng.random()) / corners) for k in range(corners)
            ]
            add([middle + way for way in ways], True, 0.0)
        elif found:
            add([found[0].core[0]], False, (found[0].radius or 1.0) * rng.choice([1.0, 1.5]))
    return found


def area_of(loop: tuple[ContourEdge, ...]) -> float:
    """The signed area by Green's theorem, of arcs that of their segments too."""
    chords = sum((edge.start.conjugate() * edge.stop).imag / 2 for edge in loop)
    return chords + sum(edge.radius**2 * (edge.turn - np.sin(edge.turn)) / 2 for edge in loop)


def test_contours_are_the_unions_that_shapely_finds() -> None:
    for seed in range(60):
        shapes = random_shapes(random.Random(seed))
        polygons = [shape_of(one) for one in shapes]
        if all(one.is_valid for one in polygons):
            whole, loops = shapely.union_all(polygons), contours(shapes)
            assert sum(map(area_of, loops)) == pytest.approx(whole.area, rel=2e-4), seed
            holes = sum(len(one.interiors) for one in getattr(whole, "geoms", [whole]))
            assert sum(area_of(loop) < 0 for loop in loops) == holes
            assert all(abs(loop[k - 1].stop - loop[k].start) < 1e-7 for loop in loops for k in range(len(loop)))


# --- without ezdxf, and the page --------------------------------------------------------------------------


def test_without_ezdxf_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "ezdxf", None)
    with pytest.raises(ck.errors.InvalidInput, match=r"pip install 'compoundkin\[dxf\]'"):
        write(load("crank-rocker"), "dxf")


def test_the_page_on_cad_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[3] / "docs" / "exchange" / "cad.md").read_text("utf-8")
    exec("\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL)), {})
    shown = "".join(re.findall(r"```text\n(.*?)```", page, re.DOTALL))
    assert capsys.readouterr().out == shown
    assert {one.name for one in tmp_path.iterdir()} >= {"stopped.dxf", "parts.dxf", "cam.csv"}
