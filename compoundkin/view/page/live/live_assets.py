"""Scripts and style sheets of a moving sketch, and of dimensions that can be changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# What all others use.
FIRST_SCRIPTS = ("numbers.js", "elements.js")
PLAYER_SCRIPTS = (
    "letters.js",
    "centre_overlay.js",
    "force_overlay.js",
    "overlays.js",
    "reading.js",
    "transport.js",
    "player.js",
    "view_box.js",
)
PLAYER_STYLE = "player.css"
# Before the player, which takes from the path what a live page does not hold.
PATH_SCRIPTS = ("live/machine.js", "live/follower.js", "live/states.js", "live/path.js")
# In this order: each uses those before it.
SCRIPTS = (
    "live/design.js",
    "live/redraw.js",
    "live/vector_scales.js",
    "live/snapping.js",
    "live/handles.js",
    "live/readout.js",
    "live/free_pose.js",
    "live/point_hold.js",
    "live/driver_hold.js",
    "live/drag.js",
    "live/ghost.js",
    "live/history.js",
)
# After those that draw the plots: what makes plots and tables follow.
FIGURES = ("live/line_searches.js", "live/course.js", "live/figures.js")
STYLES = ("live/live.css",)
# What a page with a panel of dimensions has after all others, which hear of the dimensions in its address.
ROW_SCRIPT = "live/rows.js"
PANEL_SCRIPTS = (
    ROW_SCRIPT, "live/assembled_range.js", "live/fragment.js", "live/panel.js", "live/miniature.js",
    "live/exported.js", "live/share.js",
)  # fmt: skip
PANEL_STYLES = ("live/panel.css",)


def is_live(data: Mapping[str, Any]) -> bool:
    """Return whether the data of a motion include its program.

    >>> is_live({"live": None}), is_live({"live": {"why": "profiles"}}), is_live({"live": {"dimensions": []}})
    (False, False, True)
    """
    live = data.get("live")
    return live is not None and "why" not in live


def scripts_of(data: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the names of the scripts of a motion's data.

    >>> "player.js" in scripts_of({"live": None}), "live/path.js" in scripts_of({"live": None})
    (True, False)
    """
    live = is_live(data)
    return (*FIRST_SCRIPTS, *(PATH_SCRIPTS if live else ()), *PLAYER_SCRIPTS, *(SCRIPTS if live else ()))


def styles_of(data: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the names of the style sheets of a motion's data.

    >>> styles_of({"live": None})
    ('player.css',)
    """
    return (PLAYER_STYLE, *(STYLES if is_live(data) else ()))


def without_panel(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a motion for a player without the panel of dimensions.

    >>> without_panel({"live": {"dimensions": [], "panel": {}, "toml": []}})
    {'live': {'dimensions': []}}
    """
    live = data.get("live")
    rest = live and {key: value for key, value in live.items() if key not in ("panel", "toml")}
    return {**data, "live": rest}
