"""`compoundkin mcp`: a server of the Model Context Protocol, by which programs that talk use the command line.

Each tool is a verb: its arguments become options, the mechanism a file in a folder of the call's own, and the verb runs
in a process of its own that is ended when it takes too long. So a tool says what the command line says, with the same
errors, reads no file but the one that it was sent, and leaves none behind.

Source: Model Context Protocol, specification of 2025-11-25, tools; the SDK in Python is the extra `mcp`.
"""

from __future__ import annotations

import base64
import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from compoundkin.base.errors import missing_extra
from compoundkin.base.suffixes import suffix_for
from compoundkin.cli.shell import leave_at_once

# A call may take so many seconds; a mechanism may have so many characters, a reply as many.
SECONDS, MOST_TEXT = 60.0, 200_000
# A message about wrong arguments repeats them: beyond so many characters it names the rule alone.
MOST_WORDS = 500
# Where pictures and new mechanisms are written in the folder of a call.
PICTURE, BETTER, FOUND = "picture.png", "better.toml", "found"

Schema = dict[str, Any]
Arguments = Mapping[str, Any]


@dataclass(frozen=True)
class Tool:
    """A verb as a tool: the arguments after its file as JSON Schemas, those that must be there, the words after FILE.

    The file is a mechanism or a task; a tool that does without one says how one is written.
    """

    name: str
    description: str
    arguments: Mapping[str, Schema]
    required: tuple[str, ...]
    words: Callable[[Arguments], Iterator[str]]
    file: str = "mechanism"

    @property
    def schema(self) -> Schema:
        """The schema of all arguments."""
        return {
            "type": "object",
            "properties": {self.file: FILES[self.file](), **self.arguments},
            "required": list(self.required),
            "additionalProperties": False,
        }


def _text(description: str, **more: Any) -> Schema:
    return {"type": "string", "maxLength": 2_000, "description": description, **more}


def _texts(description: str, example: str) -> Schema:
    items = {"type": "string", "maxLength": 200}
    return {"type": "array", "items": items, "maxItems": 50, "description": description, "examples": [[example]]}


def _switch(description: str) -> Schema:
    return {"type": "boolean", "default": False, "description": description}


def _mechanism() -> Schema:
    """Return the schema of a mechanism: a name, the text of a file, or its document with the keys that files have."""
    from compoundkin.files.json_schema import schema

    whole = schema()
    keys = {name: _outline(key) for name, key in whole["properties"].items()}
    document = {**{key: whole[key] for key in ("type", "required", "additionalProperties")}, "properties": keys}
    text = {"type": "string", "minLength": 1, "maxLength": MOST_TEXT}
    return {
        "anyOf": [text, document],
        "description": "The name of a shipped mechanism (six-bar); a linkage by its lengths (four-bar:60,20,50,40); or "
        "a mechanism file, as its text in TOML or its document in JSON. Angles are in degrees. `describe` without a "
        "mechanism explains the format and lists names.",
    }


def _outline(key: Schema) -> Schema:
    """Return what a key of the document is, without its parts: the reader of files names every fault in them."""
    return {word: key[word] for word in ("type", "enum", "description") if word in key}


MOTION = {
    "drive": {
        "type": "object",
        "additionalProperties": {"type": "string", "maxLength": 500, "pattern": r"^[-+0-9.eE,: ]+$"},
        "description": 'Values of drivers by name, degrees or lengths: {"crank": "0:360:5"} (from:to:step), "35" or '
        '"0,35,60". As the mechanism says where it is left out.',
    },
    "speed": _text("The driver's rate in rad/s or length/s; also 300rpm."),
    "modes": {
        "type": "object",
        "additionalProperties": {"enum": [1, -1]},
        "description": 'Which of two ways to assemble a group: {"rocker": -1}.',
    },
}
LOADS = {
    "loads": _texts("Forces on points in the axes of the frame.", "C=0,-500"),
    "torques": _texts("Torques on links, counterclockwise.", "rocker=-120"),
    "masses": _texts("Masses of links, uniform bodies.", "arm=15"),
    "gravity": _text("In m/s^2.", examples=["0,-9.81"]),
    "units": _text("Of length, mass and force where the mechanism has none.", examples=["mm,kg,N"]),
}


def _motion(given: Arguments) -> Iterator[str]:
    yield from (f"--drive={name}={values}" for name, values in given.get("drive", {}).items())
    yield from (f"--mode={link}={sign}" for link, sign in given.get("modes", {}).items())
    yield from _options(given, speed="speed")


def _options(given: Arguments, **names: str) -> Iterator[str]:
    """Yield the options of arguments: one for a text, one for each text of a list, a flag for a switch."""
    for name, option in names.items():
        value = given.get(name, ())
        if value is True:
            yield f"--{option}"
        else:
            yield from (f"--{option}={one}" for one in ([value] if isinstance(value, str) else value or ()))


def _loads(given: Arguments) -> Iterator[str]:
    yield from _options(given, loads="load", torques="torque", masses="mass", gravity="gravity", units="units")


def _describe(given: Arguments) -> Iterator[str]:
    yield from ("structure", "--format=markdown")


def _solve(given: Arguments) -> Iterator[str]:
    yield from ("solve", *_motion(given), *_options(given, outputs="output"))


def _report(given: Arguments) -> Iterator[str]:
    yield from ("report", "--format=markdown", *_motion(given))


def _forces(given: Arguments) -> Iterator[str]:
    yield from ("forces", "--format=markdown", *_motion(given), *_loads(given), *_options(given, statics="statics"))


def _optimise(given: Arguments) -> Iterator[str]:
    yield from ("optimise", f"--to-file={BETTER}", *_motion(given))
    yield from (f"--free={name}={low!r}:{high!r}" for name, (low, high) in given["free"].items())
    yield from _options(given, least="least", greatest="greatest", full_turn="full-turn", assembled="assembled")
    for name in ("target", "at_least", "at_most"):
        yield from (f"--{name.replace('_', '-')}={figure}={value!r}" for figure, value in given.get(name, {}).items())


def _draw(given: Arguments) -> Iterator[str]:
    yield from ("draw", f"--to-file={PICTURE}", *_loads(given))
    yield from _options(given, at="at", forces="forces", configurations="configurations", dimensions="dimensions")


def _numbers(description: str) -> Schema:
    return {"type": "object", "additionalProperties": {"type": "number"}, "description": description}


def _synthesise(given: Arguments) -> Iterator[str]:
    yield from ("synthesise", "--format=markdown", f"--save={FOUND}")
    yield from (f"--picture={PICTURE}" for _ in range(given.get("picture", False)))


def _task() -> Schema:
    """Return the schema of a task: the text of a file, or its document with the keys that files have."""
    from compoundkin.dimensional.task_words import CONDITIONS, KEYS

    keys: Schema = {key: {} for own in KEYS.values() for key in own}
    conditions = {"type": "object", "properties": {key: {} for key in CONDITIONS}, "additionalProperties": False}
    document = {
        "type": "object",
        "properties": {"format": {"const": 1}, "task": {"enum": [*KEYS]}, **keys, "conditions": conditions},
        "required": ["format", "task"],
        "additionalProperties": False,
    }
    return {
        "anyOf": [{"type": "string", "minLength": 1, "maxLength": MOST_TEXT}, document],
        "description": "A task file, as its text in TOML or its document in JSON; angles in degrees: "
        '{"format": 1, "task": "poses", "link": "plate", "poses": [[2.9, 0.1, -35], [2.5, 0.4, 12], [1.9, 0.5, 40]], '
        '"conditions": {"transmission": 30}}. '
        f"Keys: {'; '.join(f'{kind}: {chr(44).join(keys)}' for kind, keys in KEYS.items())}.",
    }


# The files that tools take, by the argument that has them.
FILES: Mapping[str, Callable[[], Schema]] = {"mechanism": _mechanism, "task": _task}
_BOUNDS = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
TOOLS = (
    Tool(
        "describe",
        "Take a mechanism apart: links, pairs, Grübler's mobility, loops, Assur groups in order, faults with their "
        "remedy. Without a mechanism: how one is written, and the names of those that are shipped.",
        {}, (), _describe,
    ),
    Tool(
        "solve",
        "Positions, velocities and accelerations as a table in CSV, a row for each pose; angles in degrees.",
        {**MOTION, "outputs": _texts("Quantities; all there are if left out.", "G.velocity")}, ("mechanism",), _solve,
    ),
    Tool(
        "report",
        "The whole report: structure, motion, figures such as the stroke, checks by independent methods.",
        MOTION, ("mechanism",), _report,
    ),
    Tool(
        "optimise",
        "Better dimensions: what may change, what shall be least, greatest or at a target, what must hold. A report, "
        "and the new mechanism in TOML.",
        {
            **MOTION,
            "free": {"type": "object", "minProperties": 1, "additionalProperties": _BOUNDS,
                     "description": 'Dimensions with their bounds, lengths or degrees: {"crank.B.x": [1, 3]}.'},
            "least": _texts("Figures to make small.", "rocker.angle.stroke"),
            "greatest": _texts("Figures to make great.", "rocker.transmission_angle.least"),
            "target": _numbers('Figures with the values to reach: {"rocker.angle.stroke": 60}.'),
            "at_least": _numbers("Figures with lower bounds."),
            "at_most": _numbers("Figures with upper bounds."),
            "full_turn": _switch("The driver must turn fully."),
            "assembled": _switch("It must be assembled all along the motion."),
        },
        ("mechanism", "free"), _optimise,
    ),
    Tool(
        "forces",
        "Forces in all pairs, efforts of drivers, shaking force, from the masses and loads of mechanism and call.",
        {**MOTION, **LOADS, "statics": _switch("Leave inertia out.")}, ("mechanism",), _forces,
    ),
    Tool(
        "draw",
        "A kinematic sketch as a picture (PNG).",
        {
            **LOADS,
            "at": _texts("The pose: the driver's value, degrees or length.", "crank=35"),
            "forces": _switch("Draw forces."),
            "dimensions": _switch("Draw dimensions."),
            "configurations": _switch("Draw every way to assemble it at this pose."),
        },
        ("mechanism",), _draw,
    ),
    Tool(
        "synthesise",
        "Mechanisms that do a task: guide a body through poses, a point through points, an output by a function; "
        "swing, stroke, dwell. A report, ranked, with what is wrong with the others, and the best as mechanism files. "
        "Without a task: how one is written.",
        {
            "picture": _switch("Draw the mechanisms side by side."),
            "best": {"type": "integer", "minimum": 1, "maximum": 5, "default": 1,
                     "description": "How many mechanisms are sent as files in TOML."},
        },
        (), _synthesise, "task",
    ),
)  # fmt: skip


@click.command(
    epilog="""\b
Examples:
  compoundkin mcp

\b
In the settings of a program that talks:
  {"mcpServers": {"compoundkin":
      {"command": "compoundkin", "args": ["mcp"]}}}
"""
)
def command() -> int:
    """Serve programs that talk (Model Context Protocol) on standard input and output.

    Tools: describe, solve, report, optimise, forces, draw, synthesise. Needs the extra `mcp`.
    """
    made = server()
    import anyio

    try:
        anyio.run(_serve, made)
    except (KeyboardInterrupt, SystemExit):
        # what was begun has been ended; the thread that waits for a line of the other program cannot be
        leave_at_once()
    return 0


async def _serve(made: Any) -> None:
    from mcp.server.stdio import stdio_server

    async with stdio_server() as (incoming, outgoing):
        await made.run(incoming, outgoing, made.create_initialization_options())


def server() -> Any:
    """Return the server, to be run over any transport. Raises InvalidInput where the SDK is not installed."""
    try:
        import mcp_types as types
        from mcp.server import Server
    except ImportError:
        raise missing_extra("mcp", "the SDK of the Model Context Protocol is not installed", "mcp") from None
    from compoundkin.base.version import VERSION

    known = {tool.name: tool for tool in TOOLS}

    async def list_tools(*_: Any) -> Any:
        hints = types.ToolAnnotations(read_only_hint=True, open_world_hint=False)
        return types.ListToolsResult(
            tools=[
                types.Tool(name=one.name, description=one.description, input_schema=one.schema, annotations=hints)
                for one in known.values()
            ]
        )

    async def call_tool(_: Any, params: Any) -> Any:
        parts, is_error = await call(known, params.name, params.arguments or {})
        content: list[Any] = [
            types.TextContent(text=part)
            if isinstance(part, str)
            else types.ImageContent(data=base64.b64encode(part).decode(), mime_type="image/png")
            for part in parts
        ]
        return types.CallToolResult(content=content, is_error=is_error)

    return Server("compoundkin", version=VERSION, on_list_tools=list_tools, on_call_tool=call_tool)


async def call(known: Mapping[str, Tool], name: str, given: Arguments) -> tuple[list[str | bytes], bool]:
    """Return the parts of the answer to a call, texts and pictures, and whether it is an error."""
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import best_match

    from compoundkin.base.errors import suggestion

    if name not in known:
        return [f"There is no tool {name!r}; {suggestion(name, list(known))}."], True
    if wrong := best_match(Draft202012Validator(known[name].schema).iter_errors(given)):
        what = wrong.message if len(wrong.message) < MOST_WORDS else f"it does not fit {wrong.validator}"
        return [f"{wrong.json_path.replace('$', 'arguments', 1)}: {what}"], True
    if not _is_plain(given):
        return ["arguments: a text has a character that cannot be passed on"], True
    file = known[name].file
    if file not in given:
        return [await _introduction(file)], False
    with tempfile.TemporaryDirectory(prefix="compoundkin-") as folder:
        verb, *words = known[name].words(given)
        code, out, said = await _run([verb, _file(file, given[file], Path(folder)), *words], folder)
        parts: list[str | bytes] = [_shortened(text) for text in (out, said) if text.strip()]
        parts += [one.read_bytes() for one in [Path(folder, PICTURE)] if one.exists()]
        best = sorted(Path(folder, FOUND).glob("*"), key=lambda one: int(one.stem))[: given.get("best", 1)]
        written = [*(one for one in [Path(folder, BETTER)] if one.exists()), *best]
        parts += [one.read_text(encoding="utf-8") for one in written]
    return parts or ["It is silent."], code not in (0, 3, 4)


def _is_plain(given: Arguments) -> bool:
    """Return whether all texts can be written to a file and given to a process."""
    text = json.dumps(given, ensure_ascii=False).replace("\\\\", "")
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return "\\u0000" not in text


def _file(kind: str, mechanism: str | Mapping[str, Any], folder: Path) -> str:
    """Write a mechanism or a task to a file and return its name; that of a shipped mechanism is returned as it is."""
    is_word = isinstance(mechanism, str) and "\n" not in mechanism and not mechanism.lstrip().startswith("{")
    if kind == "mechanism" and isinstance(mechanism, str) and is_word:
        from compoundkin.files.shipped_mechanisms import shipped
        from compoundkin.synthesis.linkages import is_linkage

        # any other word is looked up as a name, never as a path
        return (
            mechanism
            if is_linkage(mechanism) or mechanism in shipped()
            else f"{Path(mechanism).name or 'mechanism'}".replace(".", "-")
        )
    text = mechanism if isinstance(mechanism, str) else json.dumps(mechanism)
    name = f"{kind}{suffix_for('mechanism', 'json' if text.lstrip().startswith('{') else 'toml')}"
    (folder / name).write_text(text, encoding="utf-8")
    return name


async def _introduction(kind: str) -> str:
    """Return how a mechanism or a task is written, of mechanisms also the names of those that are shipped."""
    with tempfile.TemporaryDirectory(prefix="compoundkin-") as folder:
        await _run(["new", *([kind] if kind == "task" else []), "-o", "mine.toml"], folder)
        example = Path(folder, "mine.toml").read_text(encoding="utf-8")
    text = f"A {kind} file, with what may be in it:\n\n{example}"
    if kind == "task":
        return text
    _, names, _ = await _run(["catalog", "list"], None)
    return f"{text}\n\nShipped mechanisms:\n\n{names}"


async def _run(words: Sequence[str], folder: str | None) -> tuple[int, str, str]:
    """Run a verb in a process of its own; return its exit code and what it wrote to its two streams."""
    import anyio

    program = [sys.executable, "-m", "compoundkin", *words]
    environment = {**os.environ, "COLUMNS": "100", "NO_COLOR": "1", "PYTHONIOENCODING": "utf-8"}
    with anyio.move_on_after(SECONDS):
        done = await anyio.run_process(program, check=False, cwd=folder, env=environment)
        return done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")
    return 2, "", f"It took longer than {SECONDS:g} s and was ended. Ask for fewer poses, starts or links."


def _shortened(text: str) -> str:
    if len(text) <= MOST_TEXT:
        return text
    return f"{text[:MOST_TEXT]}\n... {len(text) - MOST_TEXT:,} characters are left out: ask for fewer poses or outputs."
