"""Mechanisms built group by group, or at random.

>>> from compoundkin.composing import random_mechanism
>>> random_mechanism(groups=3, seed=1)
Mechanism('3 random groups, seed 1': 8 links, 1 driver)
"""

from __future__ import annotations

from compoundkin.synthesis.composer import Composer, random_mechanism

__all__ = ["Composer", "random_mechanism"]
