"""`studio`: the window in a notebook, a widget. Its messages are those of the server, JSON texts to the same function.

Source: anywidget, front-end modules and custom messages (anywidget.dev).
"""

from __future__ import annotations

import hashlib
import json
import re
from functools import cache
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.errors import missing_extra
from compoundkin.model.mechanism import Mechanism
from compoundkin.studio.answers import answer
from compoundkin.studio.server import ASSETS, PAGE, message_in, solving_script

MODULE = "widget.js"
# What a window begins with that is given nothing.
START = 'format = 1\ntitle = "Mechanism"\n'
# Pixels; a page has the height of its window.
HEIGHT = 680


@checked
def studio(mechanism: Mechanism | None = None) -> Any:
    """Return a window in which a mechanism is drawn, a widget for JupyterLab, VS Code and marimo.

    What is drawn is its `document`, the text of a mechanism file, at each step, and its `mechanism`; a document that is
    set is shown. Needs the extra `notebook`; raises InvalidInput without it.

    >>> window = studio()  # doctest: +SKIP
    >>> window.mechanism  # doctest: +SKIP
    """
    from compoundkin.files.mechanism_files import dumps

    return widget_class()(document=START if mechanism is None else dumps(mechanism))


@cache
def widget_class() -> Any:
    """Return the class of the widget. Raises InvalidInput where anywidget is not installed."""
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise missing_extra(
            "studio", "the studio in a notebook needs anywidget", "notebook", "in a terminal: compoundkin studio"
        ) from None

    class StudioWidget(anywidget.AnyWidget):
        """A window of the studio. `document` is what is drawn, the text of a mechanism file."""

        _esm = bundled()
        document = traitlets.Unicode(START)

        def __init__(self, **given: Any) -> None:
            super().__init__(**given)
            self._drawn = self.document
            self.on_msg(self._heard)
            self.observe(self._given, "document")

        @property
        def mechanism(self) -> Mechanism:
            """What is drawn. Raises InvalidMechanism for what is none yet."""
            from compoundkin.files.mechanism_files import loads

            return loads(self.document)

        def _heard(self, _: Any, content: Any, buffers: Any) -> None:
            text = content.get("text") if isinstance(content, dict) else None
            if (reply := self._reply(text) if isinstance(text, str) else None) is not None:
                self.send({"text": json.dumps(reply, allow_nan=False)})

        def _reply(self, text: str) -> dict[str, Any] | None:
            message = message_in(text)
            if message is None:
                return opening(self.document) if '"hello"' in text else None
            reply = answer(message.document, message.question)
            # what follows from a document is asked for whenever it changes, or comes with the edit that changes it
            if message.sort == "structure" or "structure" in reply:
                self._drawn = self.document = reply.get("text", message.document)
            return {**reply, "id": message.number}

        def _given(self, change: Any) -> None:
            if change["new"] != self._drawn:
                self._drawn = change["new"]
                self.send({"text": json.dumps({**opening(self.document), "is_given": True})})

    return StudioWidget


def opening(document: str) -> dict[str, Any]:
    """Return what a window begins with."""
    mark = hashlib.sha256(document.encode("utf-8")).hexdigest()
    return {"text": document, "mark": mark, "file": "Studio", "folder": "", "is_new": False, "is_kept": True}


def bundled() -> str:
    """Return the page's scripts, its styles and its elements as one module."""
    from compoundkin.view.page.html_document import page_palette

    html = (ASSETS / PAGE).read_text(encoding="utf-8")
    markup = html[html.index("<body>") + len("<body>") : html.index("</body>")]
    style = page_palette() + (ASSETS / "studio.css").read_text(encoding="utf-8")
    style = re.sub(r":root((?:\[[^\]]*\]|:not\([^)]*\))+)", r":host(\1)", style).replace(":root", ":host")
    style += f".studio{{height:{HEIGHT}px!important;min-height:0}}.theme{{display:none}}"
    # in a narrow cell the drawing is seen whole with its driver, the rest is scrolled to
    style += "@container (max-width:52rem){#canvas{height:23rem}}"
    modules: dict[str, str] = {}
    _add(MODULE, modules)
    constants = f"const STYLE = {json.dumps(style)}, MARKUP = {json.dumps(markup)}, modules = {{}};\n"
    whole = "\n".join(f"modules[{json.dumps(name)}] = (() => {{\n{text}}})();" for name, text in modules.items())
    return f"{solving_script()}\n{constants}{whole}\nexport default modules[{json.dumps(MODULE)}].default;\n"


_IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./([\w.]+)";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?:(class|const) (\w+)|default (.+);$)", re.MULTILINE)


def _add(name: str, modules: dict[str, str]) -> None:
    """Add a module after those that it imports, as the body of a function that returns what it exports."""
    text = (ASSETS / name).read_text(encoding="utf-8")
    for _, other in _IMPORT.findall(text):
        if other not in modules:
            _add(other, modules)
    names = [word or "default" for _, word, _ in _EXPORT.findall(text)]
    text = _IMPORT.sub(lambda found: f'const {found[1]} = modules["{found[2]}"];', text)
    text = _EXPORT.sub(lambda found: f"{found[1]} {found[2]}" if found[1] else f"const default_ = {found[3]};", text)
    told = ", ".join(f"{one}: default_" if one == "default" else one for one in names)
    modules[name] = f"{text}return {{ {told} }};\n"
