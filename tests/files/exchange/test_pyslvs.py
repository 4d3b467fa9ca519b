"""pyslvs and Pyslvs-UI: expressions and projects against the samples; what is refused; there and back."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput
from compoundkin.files.exchange.known_formats import read, write
from compoundkin.files.exchange.posed_mechanism import posed_mechanism
from tests.files.exchange.references import driven_by, entries, entry, holds

EXPRESSION = entry("pyslvs_four_bar")["text"]


@pytest.mark.parametrize("given", entries("pyslvs") + entries("pyslvs-yaml"), ids=lambda given: given["id"])
def test_samples_hold_as_read_and_after_they_were_written(given):
    got = read(given["text"])
    holds(got.mechanism, given)
    for form in ("pyslvs", "pyslvs-project"):
        written = write(got.mechanism, form)
        back = read(written.text)
        assert back.form == form
        holds(back.mechanism, given)
        assert write(back.mechanism, form).text == written.text


def test_names_and_pairs_are_kept():
    (slot,) = read(entry("pyslvs_slider")["text"]).mechanism.written_pairs
    assert (slot.table, slot.members) == ("slots", ("frame", "L2"))
    (slide,) = read(entry("pyslvs_inclined_block")["text"]).mechanism.written_pairs
    assert (slide.table, slide.members, slide.angle) == ("slides", ("frame", "L3"), pytest.approx(np.deg2rad(20)))
    (slot,) = read(entry("pyslvs_moving_slot")["text"]).mechanism.written_pairs
    assert (slot.table, slot.members) == ("slots", ("L2", "L1"))


@pytest.mark.parametrize("inputs", ["", "[(0, 1)]", "# input: [[0, 1]]", "# inputs = [(0, 1), ]"])
def test_an_input_is_the_direction_from_base_to_driven_joint(inputs):
    expected = entry("pyslvs_four_bar")["expected"]
    got = read(f"{EXPRESSION}\n{inputs}\n")
    assert any("'crank' is driven" in note for note in got.notes) == (not inputs)
    (value,) = posed_mechanism(got.mechanism).values.values()
    assert np.rad2deg(value) == pytest.approx(expected["drawn_input_deg"], abs=1e-12)
    motion = ck.solve(got.mechanism, {expected["driver"]: [value, 0.0]}, order=0)
    for name, letter in (("B", "B"), ("C", "C"), ("P", "E")):
        place = complex(*expected["positions_at_input_0"][name])
        assert motion.points[letter].position.ravel()[-1] == pytest.approx(place, abs=1e-8)


def test_the_base_may_be_a_later_joint_of_its_link():
    got = read(f"{EXPRESSION}\n[(3, 2)]").mechanism
    (value,) = posed_mechanism(got).values.values()
    assert got.drives[0].link == "rocker"
    assert value == pytest.approx(np.angle(10 + 40j))
    assert "# inputs: [(3, 2)]" in write(got, "pyslvs").text


@pytest.mark.parametrize(
    ("joint", "way"),
    [("J[P, A[20], P[3, 0], L[ground, ram]]", 0.5), ("J[P, A[20], P[3, 0], L[ram, ground]]", -0.5)],
)
def test_a_slide_is_driven_by_the_distance_of_its_point_from_where_it_is_drawn(joint, way):
    text = f"M[{joint}, J[R, P[3, 0], L[ram, rod]], J[R, P[6, 5], L[rod, arm]], J[R, P[0, 6], L[arm, ground]]]"
    got = read(f"{text}\n[(0, 0)]").mechanism
    for one in (got, read(write(got, "pyslvs-project").text).mechanism):
        assert posed_mechanism(one).values == {"ram": 0.0}
        motion = ck.solve(one, driven_by(posed_mechanism(one), 0.5), order=0)
        moved = motion.points["A"].position.ravel()[-1] - 3
        assert moved == pytest.approx(way * np.exp(1j * np.deg2rad(20)))


def test_a_pin_in_a_slot_is_driven_along_it():
    text = "M[J[R, P[0, 0], L[ground, a]], J[R, P[3, 4], L[a, b]], J[RP, A[0], P[10, 0], L[ground, b]]]\n[(2, 2)]"
    got = read(text).mechanism
    for one in (got, read(write(got, "pyslvs").text).mechanism):
        motion = ck.solve(one, driven_by(posed_mechanism(one), -1.0), order=0)
        assert motion.points["C"].position.ravel()[-1] == pytest.approx(9)
        off = motion.points["B"].position.ravel()[-1]
        assert (abs(off), abs(off - 9)) == (pytest.approx(5), pytest.approx(np.sqrt(65)))


@pytest.mark.parametrize("case", entry("pyslvs_refused")["cases"], ids=lambda case: case["reason"])
def test_what_cannot_be_is_refused_with_its_reason(case):
    with pytest.raises(InvalidInput) as told:
        read(case["text"])
    assert case["reason"] in str(told.value)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("M[J[R, P[0, 1e999], L[ground, a]]]", "line 1: '1e999' is no finite number"),
        ("M[\nJ[R, P[0 0], L[ground, a]]]", "line 2: , is expected, not '0'"),
        ("M[J[R, P[0, 0], L[ground, a b]]]", ", or ] is expected, not 'b'"),
        ("M[J[R, P[0, 0], L[ground, a]]] J[", "stands behind the end"),
        ("M[J[R, P[0, 0], Q[a]]]", "'Q' is none of A, P, L and color"),
        (f"{EXPRESSION}[(0, 9)]", "input (0, 9): there is no such joint; joints are 0 to 4"),
        (f"{EXPRESSION}[(0, 2)]", "input (0, 2): no link holds both joints"),
        (f"{EXPRESSION}[(1, 2)]", "input (1, 2): the base is no R joint of the ground"),
        (f"{EXPRESSION}[(1, 1)]", "input (1, 1): an R joint is driven by another joint of its link"),
        (f"{EXPRESSION}[(0, 1), 2]", "are no pairs of joints"),
        ("M[" + "J[R, P[0, 0], L[ground, a]], " * 301 + "]", "more than 300 joints"),
    ],
)
def test_what_is_wrong_is_named(text, reason):
    with pytest.raises(InvalidInput) as told:
        read(text)
    assert reason in str(told.value)


def test_projects_are_read_however_yaml_writes_them():
    yaml = pytest.importorskip("yaml")
    sample = entry("pyslvs_project")
    project = yaml.safe_load(sample["text"]) | {"storage": {"one": "M[]", "two": "M[J]"}}
    project["mechanism"] = project["mechanism"].replace("coupler", "couplér")
    for how in ({}, {"indent": 4}, {"default_flow_style": True}, {"allow_unicode": True, "default_flow_style": True}):
        got = read(yaml.dump(project, **how))
        assert got.notes[-1].endswith("5 colours, 2 stored mechanisms")
        assert "couplér" in got.mechanism.links
        holds(got.mechanism, sample)
        written = yaml.safe_load(write(got.mechanism, "pyslvs-project").text)
        assert written["input"] == [[0, 1]]
        assert set(written["links"]) == {"ground", "crank", "couplér", "rocker"}


def test_objects_are_never_read(tmp_path):
    for raw in (b"\x80\x04\x95\x0e\x00\x00\x00.", b"SQLite format 3\0"):
        path = tmp_path / "old.pyslvs"
        path.write_bytes(raw)
        with pytest.raises(InvalidInput, match="save it as YAML"):
            read(path)
    for mechanism in ("!!python/object/apply:os.system ['true']", "&a M[J[R, P[0, 0], L[ground, a]]]"):
        with pytest.raises(InvalidInput, match="tag or an anchor"):
            read(f"mechanism: {mechanism} M[\ninput: []\n", "pyslvs-project")


def test_what_pyslvs_has_no_words_for_is_refused_all_at_once():
    gears = read(entry("pmks_text_gears")["text"]).mechanism
    with pytest.raises(InvalidInput, match="gears cannot be said in pyslvs"):
        write(gears, "pyslvs")
    loose = read("0 a R 0 0\na b R 4 3 tfft\nb c R 9 4\nc 0 R 8 0").mechanism
    with pytest.raises(InvalidInput, match="drives pins of the frame only"):
        write(loose, "pyslvs")
