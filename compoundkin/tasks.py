"""Tasks of dimensional synthesis, for `synthesise`: poses, points, both, curves, functions, swings, strokes.

>>> import compoundkin as ck
>>> ck.tasks.points([(0, 0), (1, 0.5), (2, 0)]).in_words
'a point through 3 points'
"""

from __future__ import annotations

from compoundkin.dimensional.task_words import curve, dwell, function, mixed, output, points, poses, stroke, swing

__all__ = ["curve", "dwell", "function", "mixed", "output", "points", "poses", "stroke", "swing"]
