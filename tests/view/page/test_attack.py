"""Mistakes that were once in the pages: each test failed before its own was mended."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.report import page
from tests import catalog

pytestmark = pytest.mark.full

PLAYER = "compoundkin.players[0]"
# How far names reach out of the sketch at some poses, in pixels; two pixels of a letter's box are empty.
OUT = f"""() => {{
    const player = {PLAYER};
    let worst = 0;
    for (let k = 0; k < player.poses; k += 3) {{
        player.show(k);
        const all = player.svg.getBoundingClientRect();
        for (const name of player.svg.querySelectorAll(".name text")) {{
            const box = name.getBoundingClientRect();
            worst = Math.max(worst, all.left - box.left, box.right - all.right, all.top - box.top - 2,
                             box.bottom - all.bottom - 2);
        }}
    }}
    return worst;
}}"""


def test_names_that_grow_on_a_phone_stay_in_the_sketch(made: Any, opened: Any) -> None:
    for name in ("ackermann-steering", "jansen-leg"):
        view = opened(made(name), size=(360, 740))
        assert view.value(f"{PLAYER}.letters.size") > 1.2
        assert view.value(OUT) < 1.0, name


def test_the_row_of_the_pose_shown_is_marked_as_soon_as_all_rows_are_seen(opened: Any, tmp_path: Path) -> None:
    page(ck.solve(load("six-bar"), {"crank": ck.deg(np.arange(0, 361, 2))})).save(tmp_path / "fine.html")
    view = opened(tmp_path / "fine.html")
    hidden = view.value("Number(document.querySelector('tr.more[data-pose]').dataset.pose)")
    view.value(f"k => {PLAYER}.show(k)", hidden)
    assert int(view.get_attribute("tr.here", "data-pose")) != hidden
    view.locator(".tools button.more").first.click()
    assert view.locator("tr.here").count() == 1
    assert int(view.get_attribute("tr.here", "data-pose")) == hidden


def test_coming_back_to_a_page_shows_the_pose_and_the_vectors_that_its_controls_tell(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    view.value(
        "() => { const s = document.querySelector('.slider'); s.value = 30; s.dispatchEvent(new Event('input')); }"
    )
    view.check("[data-show=velocity]")
    view.goto("about:blank")
    view.go_back()
    view.wait_for_timeout(200)
    assert view.value(f"{PLAYER}.pose") == int(view.input_value(".slider"))
    arrows = view.locator(".velocities .ck-velocity-head").count()
    assert (arrows > 0) == view.is_checked("[data-show=velocity]")


def test_a_printed_plot_is_as_wide_as_the_paper(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"))
    view.emulate_media(media="print")
    view.set_viewport_size({"width": 680, "height": 960})
    # what is printed was drawn for the screen: measured before the page can fit it to its new width
    wide = view.value("""async () => {
        for (const { plot } of compoundkin.players[0].plots.panels) plot.setSize({ width: 850, height: 190 });
        await null;
        return [...document.querySelectorAll('.plot')].map((plot) => {
            const canvas = plot.querySelector('canvas'), box = canvas.getBoundingClientRect();
            return [box.right - plot.getBoundingClientRect().right, box.width / box.height / (850 / 190)];
        });
    }""")
    assert wide
    for beyond, stretched in wide:
        assert beyond < 0.5
        assert abs(stretched - 1) < 0.02


def test_one_pose_has_no_plots(opened: Any, tmp_path: Path) -> None:
    page(ck.solve(load("six-bar"), {"crank": 0.5})).save(tmp_path / "one.html")
    view = opened(tmp_path / "one.html")
    assert view.locator(".plot, #motion").count() == 0
    assert "velocity of G" in view.text_content(".reading")
    assert view.complaints == []


def test_vectors_stay_in_the_sketch_at_all_poses(opened: Any, tmp_path: Path) -> None:
    motion = catalog.motion("crank-rocker")
    page(motion).save(tmp_path / "vectors.html")
    view = opened(tmp_path / "vectors.html")
    whole = view.get_attribute(".sketch", "viewBox")
    view.check("[data-show=velocity]")
    view.check("[data-show=acceleration]")
    out = view.value(f"""() => {{
        const player = {PLAYER}, box = player.svg.viewBox.baseVal;
        let worst = 0;
        for (let k = 0; k < player.poses; k++) {{
            player.show(k);
            for (const path of player.svg.querySelectorAll(".velocities path, .accelerations path")) {{
                const own = path.getBBox();
                worst = Math.max(worst, box.x - own.x, box.y - own.y, own.x + own.width - box.x - box.width,
                                 own.y + own.height - box.y - box.height);
            }}
        }}
        return worst;
    }}""")
    assert out <= 0.01
    view.uncheck("[data-show=velocity]")
    view.uncheck("[data-show=acceleration]")
    assert [float(x) for x in view.get_attribute(".sketch", "viewBox").split()] == [float(x) for x in whole.split()]


def test_a_link_whose_name_has_a_bar_in_it_lights_up_alone(opened: Any, tmp_path: Path) -> None:
    barred = ck.Mechanism(
        "Bars",
        ck.link("frame", A=0, D=4),
        ck.link("a|b", A=0, B=1),
        ck.link("a", B=0, C=3),
        ck.link("b", D=0, C=3),
        ck.drive("a|b"),
    )
    page(ck.solve(barred)).save(tmp_path / "bars.html")
    view = opened(tmp_path / "bars.html")
    view.locator("#links tbody th", has_text="a|b").hover()
    lit = view.value("[...document.querySelectorAll('#links tr.lit')].map((row) => row.dataset.links)")
    assert lit == ["a|b"]


def test_where_the_system_chooses_colours_the_pose_and_the_switch_can_be_seen(made: Any, opened: Any) -> None:
    view = opened(made("six-bar"), forced_colors="active")
    cursor = "getComputedStyle(document.querySelector('.plot .cursor')).backgroundColor"
    paper = "getComputedStyle(document.querySelector('section')).backgroundColor"
    assert view.value(cursor) != view.value(paper)
    chosen, other = view.value(
        "[...document.querySelectorAll('.theme span')].slice(0, 2).map((one) => getComputedStyle(one).backgroundColor)"
    )
    assert chosen != other


def test_long_names_do_not_widen_the_page(opened: Any, tmp_path: Path) -> None:
    long = ck.Mechanism(
        "Long names",
        ck.link("frame", A=0, D=4),
        ck.link("crank" * 20, A=0, B=1),
        ck.link("r" * 150, B=0, C=3),
        ck.link("the arm " * 15 + "w" * 80, D=0, C=3),
        ck.drive("crank" * 20),
    )
    page(ck.solve(long)).save(tmp_path / "long.html")
    view = opened(tmp_path / "long.html")
    for width in (1440, 360):
        view.set_viewport_size({"width": width, "height": 740})
        assert view.value("document.scrollingElement.scrollWidth") <= width


def test_a_rate_that_is_nothing_but_rounding_is_zero(made: Any, opened: Any) -> None:
    """The tracer of a pantograph moves evenly, so its pen does not accelerate though the links between them do."""
    view = opened(made("pantograph"))
    data = view.value("compoundkin.players[0].plots.add('P.acceleration').plot.data.slice(1)")
    assert all(value == 0 for row in data for value in row)
    assert (
        max(view.value("compoundkin.players[0].plots.add('BP.angular_acceleration').plot.data[1].map(Math.abs)")) > 1e-4
    )


def test_what_cannot_be_known_has_no_unit_and_nothing_is_said_at_every_pose(opened: Any, tmp_path: Path) -> None:
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(load("triple-rocker"), {"driver": ck.deg(np.arange(0, 361, 5))})
    page(motion).save(tmp_path / "gap.html")
    view = opened(tmp_path / "gap.html")
    gap = int(np.flatnonzero(~motion.assembled)[0])
    changes = view.value(
        f"""async (k) => {{
        const player = {PLAYER}, live = [...document.querySelectorAll(".player :is([role=status], output)")];
        let changes = 0;
        player.show(k);
        await new Promise((done) => setTimeout(done, 50));
        const watch = new MutationObserver((found) => {{ changes += found.length; }});
        for (const one of live) if (one.getAttribute("aria-live") !== "off") watch.observe(one, {{ childList: true }});
        player.show(k + 1);
        player.show(k + 2);
        await new Promise((done) => setTimeout(done, 50));
        return [live.length, changes];
    }}""",
        gap,
    )
    assert changes[0] >= 2
    assert changes[1] == 0
    assert view.text_content(".reading td").strip() == "–"
