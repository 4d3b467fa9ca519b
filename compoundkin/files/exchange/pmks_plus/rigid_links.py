"""Which links of a share string are one body: welded ones, those of two pins in common, those that the frame holds."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from compoundkin.base.display import abbreviated_list
from compoundkin.files.exchange.pmks_plus.shared_records import SharedJoint, SharedLink, SharedMechanism
from compoundkin.model.geometry import FRAME


class RigidLinks:
    """The bodies of a share string. Each has the key of its first root link, the frame's its own.

    `notes` says what else than whole welds makes links one body.
    """

    def __init__(self, shared: SharedMechanism) -> None:
        self.joints = {joint.id: joint for joint in shared.joints}
        self.roots = [link for link in shared.links if link.is_root]
        self.notes: list[str] = []
        self._same = {FRAME: FRAME} | {_key(link.id): _key(link.id) for link in self.roots}
        self._parts = {link.id: link for link in shared.links if not link.is_root}
        self._whole = {part: link.id for link in self.roots for part in link.parts}
        self._having: dict[str, list[SharedLink]] = {}
        for link in self.roots:
            for id_ in link.joints:
                self._having.setdefault(id_, []).append(link)
        for joint in shared.joints:
            if joint.is_welded:
                self._weld(joint)
        while self._join_held():
            pass

    def body(self, link: str) -> str:
        """Return the body of a link by its id. Parts of welded links have one."""
        return self._now(_key(link if _key(link) in self._same else self._whole[link]))

    def links(self, body: str) -> list[SharedLink]:
        """Return the root links of a body, those that are no blocks first."""
        return sorted((link for link in self.roots if self.body(link.id) == body), key=lambda link: link.is_block)

    @property
    def bodies(self) -> tuple[str, ...]:
        """The keys of all bodies but the frame, in the order of the links."""
        return tuple(dict.fromkeys(body for link in self.roots if (body := self.body(link.id)) != FRAME))

    def at(self, joint: SharedJoint) -> tuple[str, ...]:
        """Return the bodies that meet at a joint, the frame first."""
        own = [self.body(link.id) for link in self.having(joint)]
        grounded = [FRAME] if joint.is_grounded and not joint.slides else []
        return tuple(dict.fromkeys([*grounded, *own]))

    def having(self, joint: SharedJoint) -> list[SharedLink]:
        """Return the root links that a joint is of."""
        return self._having.get(joint.id, [])

    def pin(self, joint: SharedJoint) -> SharedJoint | None:
        """Return the pin of a sliding joint's block, None where there is none."""
        block = next((link for link in self.having(joint) if link.is_block), None)
        return None if block is None else next(self.joints[id_] for id_ in block.joints if id_ != joint.id)

    def names(self) -> Iterator[tuple[str, str]]:
        """Yield each body with what people call it."""
        first: dict[str, SharedLink] = {}
        for link in sorted(self.roots, key=lambda link: link.is_block):
            first.setdefault(self.body(link.id), link)
        for body in self.bodies:
            yield body, first[body].name or first[body].id

    def _weld(self, joint: SharedJoint) -> None:
        """Make the links at a welded pin one. Where its weld is that of parts of one link, others are pinned there."""
        links = self.having(joint)
        whole = next((link for link in links if self._joins_parts(link, joint)), None)
        if whole is None or any(link.is_block for link in links):
            for one, other in pairwise(links):
                self._unite(self.body(one.id), self.body(other.id))
        elif len(links) > 1:
            others = " and ".join(link.id for link in links if link is not whole)
            self.notes.append(f"at {joint.id} parts of link {whole.id} are welded; {others} is pinned there")

    def _joins_parts(self, link: SharedLink, joint: SharedJoint) -> bool:
        """Return whether two parts of a link or more meet at a joint."""
        parts = [self._parts[part] for part in link.parts if part in self._parts]
        return sum(joint.id in part.joints for part in parts) > 1

    def _join_held(self) -> bool:
        """Join bodies that have two pins in common at two places, as the program does. Return whether any have."""
        held: list[tuple[str, str]] = []
        left = self._pins()
        while left:
            one, pins = left.popitem()
            for other, others in [*left.items()]:
                if len(pins & others) > 1 and len({self.joints[id_].at for id_ in pins & others}) > 1:
                    held.append((one, other))
                    self._unite(self._now(other), self._now(one))
                    pins |= left.pop(other)
        self.notes += _said(held[::-1])
        return bool(held)

    def _pins(self) -> dict[str, set[str]]:
        """Return the ids of the pins of each body."""
        pins: dict[str, set[str]] = {body: set() for body in (FRAME, *self.bodies)}
        for joint in self.joints.values():
            for body in self.at(joint) if not joint.slides else ():
                pins[body].add(joint.id)
        return pins

    def _now(self, body: str) -> str:
        now = body
        while self._same[now] != now:
            now = self._same[now]
        self._same[body] = now
        return now

    def _unite(self, one: str, other: str) -> None:
        """Make two bodies one, under the key of the first; the frame stays the frame."""
        kept, gone = (other, one) if other == FRAME else (one, other)
        self._same[gone] = kept


def _said(held: list[tuple[str, str]]) -> Iterator[str]:
    """Yield what is said of links that are held twice, by the frame and by each other."""
    framed = [other if one == FRAME else one for one, other in held if FRAME in (one, other)]
    twins = [f"{one} and {other}" for one, other in held if FRAME not in (one, other)]
    if framed:
        yield f"pinned to the frame twice, and so part of it: {abbreviated_list(framed)}"
    if twins:
        yield f"with two pins in common, and so one link: {abbreviated_list(twins)}"


def _key(link: str) -> str:
    """Return the key of a link by its id; none is that of the frame."""
    return f"link {link}" if link == FRAME else link
