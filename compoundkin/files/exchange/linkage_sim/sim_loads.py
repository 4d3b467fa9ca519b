"""Masses, gravity and forces of linkage_sim that this program has words for; others are counted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compoundkin.files.exchange.json_text import JsonRecord
from compoundkin.files.exchange.linkage_sim.fixed_bodies import Placed
from compoundkin.files.exchange.linkage_sim.sim_points import SimPoints
from compoundkin.files.exchange.linkage_sim.sim_records import GROUND, SimFile
from compoundkin.model.elements import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads import Gravity, damper, force, mass, spring, torque

_CONSTANT = "Constant"


class SimLoads:
    """The loads of a file. `left_out` counts, by what they are, those that have no word here."""

    def __init__(self, file: SimFile, placed: Mapping[str, Placed], points: SimPoints) -> None:
        self._file, self._placed, self._points = file, placed, points
        self.left_out: dict[str, int] = {}
        self.items = [*self._masses(), *(item for k, one in enumerate(file.forces, 1) for item in self._load(one, k))]

    def _masses(self) -> Iterator[Item]:
        """Yield the masses of links; those of bodies that are one link together are added."""
        for host, name in self._points.link.items():
            parts = [
                (weight, self._placed[key].at(centre), inertia)
                for key, body in self._file.bodies.items()
                for weight, centre, inertia in body.masses
                if self._placed[key].host == host
            ]
            whole = sum(weight for weight, _, _ in parts)
            if name != FRAME and whole:
                centre = sum(weight * place for weight, place, _ in parts) / whole
                inertia = sum(own + weight * abs(place - centre) ** 2 for weight, place, own in parts)
                yield mass(name, whole, at=centre, inertia=inertia)

    def _load(self, one: JsonRecord, k: int) -> Iterator[Item]:
        kind = one.text("type", "force")
        made = self._between(kind, one, k) or self._around(kind, one, k) or self._on_link(kind, one, k)
        if made is None:
            self.left_out[kind] = self.left_out.get(kind, 0) + 1
        else:
            yield made

    def _between(self, kind: str, one: JsonRecord, k: int) -> Item | None:
        """Return a spring or a damper between points of two bodies."""
        if kind not in ("LinearSpring", "LinearDamper"):
            return None
        bodies = self._bodies(one, "body_a", "body_b")
        if bodies is None:
            return None
        (link, at), (to, there) = (self._end(one, body, side) for body, side in zip(bodies, "ab", strict=True))
        if kind == "LinearSpring":
            stiffness, length = one.number("stiffness"), one.number("free_length")
            return spring(link, at, to=to, at=there, stiffness=stiffness, free_length=length, name=f"spring {k}")
        return damper(link, at, to=to, at=there, rate=one.number("damping"), name=f"damper {k}")

    def _around(self, kind: str, one: JsonRecord, k: int) -> Item | None:
        """Return a spring or a damper that turns about the pin of two links."""
        if kind not in ("TorsionSpring", "RotaryDamper"):
            return None
        bodies = self._bodies(one, "body_i", "body_j")
        if bodies is None:
            return None
        on, moving = (self._placed[key] for key in bodies)
        pin = self._points.pin(on.host, moving.host)
        if pin is None:
            return None
        if kind == "RotaryDamper":
            return damper(pair=pin, rate=one.number("damping"), name=f"damper {k}")
        free = one.number("free_angle") + on.turn - moving.turn
        is_first = [*self._points.of].index(on.host) < [*self._points.of].index(moving.host)
        stiffness = one.number("stiffness")
        return spring(pair=pin, stiffness=stiffness, free=free if is_first else -free, name=f"spring {k}")

    def _on_link(self, kind: str, one: JsonRecord, k: int) -> Item | None:
        """Return gravity, or a constant force or torque on a link."""
        if kind == "Gravity" and not self._file.is_mounted:
            vector = one.vector("g_vector")
            return Gravity(vector)
        modulation = one.given.get("modulation", {})
        constant = isinstance(modulation, Mapping) and modulation.get("modulation_type", _CONSTANT) == _CONSTANT
        body = str(one.given.get("body_id"))
        if kind not in ("ExternalForce", "ExternalTorque") or not constant or body not in self._file.bodies:
            return None
        if self._placed[body].host == GROUND:
            return None
        name = self._points.named(body)
        if kind == "ExternalTorque":
            return torque(name, one.number("torque"), name=f"torque {k}")
        return force(name, one.vector("force"), at=self._end(one, body, "")[1], name=f"force {k}")

    def _bodies(self, one: JsonRecord, *keys: str) -> tuple[str, ...] | None:
        """Return the bodies that a load joins; none where it names one that is not there."""
        bodies = tuple(str(one.given.get(key)) for key in keys)
        for body in bodies:
            if body not in self._file.bodies:
                one.wrong(f"there is no body {body!r}")
                return None
        return bodies

    def _end(self, one: JsonRecord, body: str, side: str) -> tuple[str, complex]:
        """Return an end of a load: the link, and the place in its axes of a named point, else of that written."""
        word = f"point_{side}" if side else "local_point"
        points = self._file.bodies[body].points
        named = one.given.get(f"{word}_name")
        own = points[named] if isinstance(named, str) and named in points else one.vector(word)
        return self._points.named(body), self._placed[body].at(own)
