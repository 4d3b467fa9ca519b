"""The points of a share string: its pins and tracers, those that are one pin put together."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.files.exchange.drawings.drawn_elements import DrawnPoint
from compoundkin.files.exchange.pmks_plus.rigid_links import RigidLinks
from compoundkin.files.exchange.pmks_plus.shared_records import SharedJoint, SharedMechanism


class SharedPoints:
    """The points by the ids of their joints. Joints of one link at one place are one point."""

    def __init__(self, shared: SharedMechanism, rigid: RigidLinks) -> None:
        self._rigid = rigid
        self._of: dict[str, list[SharedJoint]] = {}
        places: dict[complex, list[list[SharedJoint]]] = {}
        for joint in shared.joints:
            if rigid.having(joint) and (not joint.slides or self.stands_apart(joint)):
                self._put(joint, places.setdefault(joint.at, []))

    def __contains__(self, joint: SharedJoint) -> bool:
        return joint.id in self._of

    def key(self, joint: SharedJoint) -> str:
        """Return the key of a joint's point."""
        return self._of[joint.id][0].id

    def all(self) -> Iterator[DrawnPoint]:
        """Yield all points, each with the links of all its joints."""
        for id_, joints in self._of.items():
            first = joints[0]
            if first.id == id_:
                links = dict.fromkeys(link for joint in joints for link in self._rigid.at(joint))
                yield DrawnPoint(id_, first.at, tuple(links), first.name, first.where)

    def stands_apart(self, joint: SharedJoint) -> bool:
        """Return whether a sliding joint is drawn elsewhere than the pin of its block."""
        pin = self._rigid.pin(joint)
        return pin is not None and pin.at != joint.at

    def _put(self, joint: SharedJoint, there: list[list[SharedJoint]]) -> None:
        """Put a joint to those at its place that are of a link of its own."""
        own = set(self._rigid.at(joint))
        met = [others for others in there if any(own & set(self._rigid.at(other)) for other in others)]
        whole = [*(other for others in met for other in others), joint]
        there[:] = [*(others for others in there if others not in met), whole]
        for one in whole:
            self._of[one.id] = whole
