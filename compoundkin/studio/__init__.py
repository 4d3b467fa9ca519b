"""The studio: a mechanism is drawn, and what is drawn is taken apart and moved at once.

One function without state stands behind it: `answer(document, question) -> reply`, plain data as JSON has it. Its
transports (`compoundkin studio` is one) carry documents and questions, and know nothing of mechanisms; the page draws
what it is told. Undo is a history of whole documents, which whoever asks keeps.
"""

from __future__ import annotations

from compoundkin.studio.answers import answer

__all__ = ["answer"]
