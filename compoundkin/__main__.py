"""``python -m compoundkin`` is the command line."""

from __future__ import annotations

from compoundkin.cli import main

if __name__ == "__main__":
    main()
