"""The studio: a mechanism is drawn, and what is drawn is taken apart and moved at once.

One function without state stands behind it: `answer(document, question) -> reply`, plain data as JSON has it. Its
transports (`compoundkin studio` is one) carry documents and questions, and know nothing of mechanisms; the page draws
what it is told. Undo is a history of whole documents, which whoever asks keeps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from compoundkin.studio.answers import answer

__all__ = ["answer"]


def __getattr__(name: str) -> Any:
    """Return the function, which is imported when it is first asked for: `compoundkin` itself imports this room."""
    if name != "answer":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from compoundkin.studio import answers

    return answers.answer
