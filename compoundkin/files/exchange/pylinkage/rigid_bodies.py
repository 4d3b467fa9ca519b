"""Which links of pylinkage are one rigid body: it has no word for a body that several links make up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

from compoundkin.files.exchange.pylinkage.pylinkage_records import PylinkageLink
from compoundkin.model.geometry import FRAME

# Joints nearer to each other than this part of the size are at one place, and hold no direction.
_ROUNDING = 1e-9


class RigidBodies:
    """The bodies that links make up.

    Each is called by the id of the first, or of its driver, or FRAME. Links with two common joints are one; so are two
    bars that meet, and a link on which their other ends are.
    """

    def __init__(self, links: Mapping[str, PylinkageLink], fixed: Mapping[str, None], places: Mapping[str, complex]):
        self._places = places
        centre = sum(places.values()) / max(len(places), 1)
        self.near = _ROUNDING * max((abs(place - centre) for place in places.values()), default=0.0)
        self.joints: dict[str, dict[str, None]] = {FRAME: dict(fixed)}
        self.parts: dict[str, list[PylinkageLink]] = {FRAME: []}
        for link in links.values():
            if link.kind == "ground":
                self.parts[FRAME].append(link)
            else:
                # one of theirs may be called as our frame is
                key = f"{link.key} (link)" if link.key == FRAME else link.key
                self.joints[key], self.parts[key] = dict.fromkeys(link.joints), [link]
        self._order = list(links.values())
        self._rank = {body: (body != FRAME, not self._drives(body), k) for k, body in enumerate(self.parts)}
        while self._by_two_joints() or self._by_bars():
            pass

    def at(self, joint: str) -> tuple[str, ...]:
        """Return the bodies that have a joint."""
        return tuple(body for body, joints in self.joints.items() if joint in joints)

    def joined(self) -> Iterator[tuple[str, list[PylinkageLink]]]:
        """Yield the bodies of several links, and the frame if it holds any."""
        for body, parts in self.parts.items():
            moving = sorted((part for part in parts if part.kind != "ground"), key=self._order.index)
            if len(moving) > 1 or (body == FRAME and moving):
                yield body, moving

    def _by_two_joints(self) -> bool:
        """Join what shares joints at two places, and return whether anything does."""
        shared: dict[tuple[str, str], list[str]] = {}
        for joint, bodies in self._bodies_at().items():
            for pair in combinations(bodies, 2):
                shared.setdefault(pair, []).append(joint)
        return self._join_all([pair for pair, joints in shared.items() if len(joints) > 1 and self.apart(joints)])

    def _by_bars(self) -> bool:
        """Join two bars that meet with the link that their other ends are on, and return whether there are any.

        On the frame they are left as they are: what stands still is for the analysis to say.
        """
        at = self._bodies_at()
        for joint, bodies in at.items():
            on: dict[str, list[tuple[str, str]]] = {}
            bars = [bar for bar in bodies if bar != FRAME and len(self.joints[bar]) == 2]
            for bar in bars if len(bars) > 1 else ():
                end = next(one for one in self.joints[bar] if one != joint)
                for third in at[end]:
                    if third not in (bar, FRAME):
                        on.setdefault(third, []).append((bar, end))
            pairs = [(third, bar) for third, bars in on.items() if self.apart([e for _, e in bars]) for bar, _ in bars]
            if self._join_all(pairs):
                return True
        return False

    def _join_all(self, pairs: list[tuple[str, str]]) -> bool:
        """Make one body of every two, called by the first of the file, by its driver if it has one."""
        now = {body: body for pair in pairs for body in pair}
        for pair in pairs:
            kept, gone = sorted((_last(now, body) for body in pair), key=self._rank.__getitem__)
            if kept != gone:
                now[gone] = kept
                self.joints[kept] |= self.joints.pop(gone)
                self.parts[kept] += self.parts.pop(gone)
        return bool(pairs)

    def _bodies_at(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for body, joints in self.joints.items():
            for joint in joints:
                found.setdefault(joint, []).append(body)
        return found

    def apart(self, joints: list[str]) -> bool:
        """Return whether joints are at several places."""
        return any(abs(self._places[joint] - self._places[joints[0]]) > self.near for joint in joints)

    def _drives(self, body: str) -> bool:
        return any(part.is_driver for part in self.parts[body])


def _last(now: Mapping[str, str], body: str) -> str:
    """Return the body that another has become a part of."""
    while now[body] != body:
        body = now[body]
    return body
