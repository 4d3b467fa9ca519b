"""A motion that plays in a notebook: the moving sketch alone, in a frame of its own."""

from __future__ import annotations

from typing import Any

from compoundkin.kinematics import Motion
from compoundkin.view.page.html_document import POLICY, asset, palette
from compoundkin.view.page.live.lean_data import lean
from compoundkin.view.page.live.live_assets import is_live, scripts_of, styles_of, without_panel
from compoundkin.view.page.markup import data_script, element, lines, safe
from compoundkin.view.page.moving_data import MotionData
from compoundkin.view.page.viewer import player_html
from compoundkin.view.report.shown_poses import Sample
from compoundkin.view.sketch.sketch_style import page_css

# A notebook keeps every output that it shows: a few dozen kilobytes each are enough.
MOST_POSES = 181
# The frame is so high, in pixels: the sketch as it is on a page so wide, the controls below it, those of changes.
WIDTH, HIGHEST, CONTROLS, CHANGES = 640.0, 448.0, 190.0, 72.0
STYLE = "html,body{margin:0;background:var(--paper);font-size:15px}.player{padding:8px}.sketch{max-height:448px}"


def player(motion: Motion, design: int = 0) -> str:
    """Return a document that shows one design under a slider and a button.

    The button plays the motion; the document asks for nothing else.

    Raises NotAssembled where no pose is assembled, InvalidInput where links change their dimensions along the motion.

    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> player(solve(load_named("crank-rocker"))).splitlines()[0]
    '<!DOCTYPE html>'
    """
    moving = MotionData(Sample(motion, design), most=MOST_POSES, with_centres=False)
    return _document(moving, moving.data)


def _document(moving: MotionData, data: dict[str, Any]) -> str:
    styles = palette(), page_css(), asset("page.css"), *map(asset, styles_of(data)), STYLE
    head = [
        '<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        element("title", safe(data["title"])),
        *(element("style", text) for text in styles),
    ]
    scripted = "<script>document.documentElement.classList.add('scripted')</script>"
    body = [
        scripted,
        player_html(moving, data),
        data_script("ck-motion", lean(without_panel(data))),
        *(f"<script>{asset(name)}</script>" for name in scripts_of(data)),
    ]
    return f'<!DOCTYPE html>\n<html lang="en">\n<head>{lines(head)}</head>\n<body>{lines(body)}</body>\n</html>\n'


def framed(motion: Motion) -> str:
    """Return the player of a motion's first design in a frame, for notebooks. Raises what `player` does."""
    moving = MotionData(Sample(motion), most=MOST_POSES, with_centres=False)
    data, window = moving.data, moving.sketch.window
    document = _document(moving, data)
    below = CONTROLS + (CHANGES if is_live(data) else 0.0)
    height = min(HIGHEST, WIDTH * window.height / window.width, window.height * 1.1) + below
    style = f"width:100%;max-width:{WIDTH:.0f}px;height:{height:.0f}px;border:1px solid #8886;border-radius:8px"
    title = f"{motion.mechanism.title}, moving"
    return f'<iframe srcdoc="{safe(document)}" title="{safe(title)}" style="{style}" sandbox="allow-scripts"></iframe>'
