"""Names of axes in several lines, broken where they may be."""

from __future__ import annotations

import re


def broken(label: str, room: int) -> str:
    """Return a name with its unit in lines of so many characters.

    It is broken behind dots and before its unit, behind underscores where a part is longer than a line.

    >>> broken("plate.transmission_angle.least [deg]", 20)
    'plate.\\ntransmission_angle.\\nleast [deg]'
    """
    parts = [one for part in re.findall(r"[^. ]+[. ]*|[. ]+", label) for one in _short_parts(part, room)]
    lines = [""]
    for part in parts:
        if len(lines[-1]) + len(part.rstrip()) <= room:
            lines[-1] += part
        else:
            lines.append(part)
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _short_parts(part: str, room: int) -> list[str]:
    if len(part.rstrip()) <= room:
        return [part]
    pieces = re.findall(r"[^_]+_?|_", part)
    return [piece[k : k + room] for piece in pieces for k in range(0, len(piece), room)]
