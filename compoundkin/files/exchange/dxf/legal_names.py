"""Names of layers and blocks of DXF files, which allow no punctuation of paths and do not tell capitals apart."""

from __future__ import annotations

import re

# What AutoCAD refuses in names of layers and blocks.
_REFUSED = re.compile(r"[<>/\\\":;?*|=`,]")
LONGEST = 200


class LegalNames:
    """Names given so far, each once.

    >>> names = LegalNames()
    >>> names.of("bar"), names.of("Bar"), names.of("a/b")
    ('bar', 'Bar-2', 'a_b')
    """

    def __init__(self, *taken: str) -> None:
        self._used = {name.casefold() for name in taken}

    def of(self, wanted: str) -> str:
        """Return a name like the one wanted, that nothing has yet."""
        printable = "".join(c if c.isprintable() else "_" for c in wanted)
        name = own = _REFUSED.sub("_", printable).strip()[:LONGEST] or "_"
        k = 1
        while own.casefold() in self._used:
            k += 1
            own = f"{name}-{k}"
        self._used.add(own.casefold())
        return own
