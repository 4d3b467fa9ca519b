"""The mechanisms that come with the package, by their names.

>>> from compoundkin import catalog
>>> catalog.load_named("six-bar").title
'Six-bar of Example 3-4'
"""

from __future__ import annotations

from compoundkin.files.shipped_mechanisms import folder, load_named, names, path, resolve

__all__ = ["folder", "load_named", "names", "path", "resolve"]
