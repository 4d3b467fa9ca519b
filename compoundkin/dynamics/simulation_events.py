"""What happens in a simulation: limit positions, ends of guides, lift-off, and what a user asks for."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SimulationEvent:
    """Something that happened. When, what it is called, and whether the simulation stopped there."""

    time: float
    name: str
    text: str
    stops: bool

    def __repr__(self) -> str:
        return f"SimulationEvent({self.name!r} at {self.time:.6g} s: {self.text})"
