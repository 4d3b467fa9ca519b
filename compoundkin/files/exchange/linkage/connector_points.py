"""Connectors as points: those of one link at one place are one pin."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.files.exchange.drawings.drawn_elements import DrawnPoint
from compoundkin.files.exchange.linkage.joined_links import JoinedLinks
from compoundkin.files.exchange.linkage.linkage_records import LinkageConnector


class ConnectorPoints:
    """The points of a file by its connectors' ids. Several may share one."""

    def __init__(self, joined: JoinedLinks) -> None:
        self.joined = joined
        self._first: dict[int, int] = {}
        here: dict[complex, list[LinkageConnector]] = {}
        for one in joined.file.connectors.values():
            if joined.at(one.id):
                here.setdefault(one.at, []).append(one)
            else:
                joined.file.drop("lone connector")
        for connectors in here.values():
            self._merge(connectors)

    def key(self, id_: int) -> str:
        """Return the key of the point that a connector is."""
        return str(self._first[id_])

    @property
    def drawn(self) -> Iterator[DrawnPoint]:
        """Yield the points with their links and names."""
        members: dict[int, list[int]] = {}
        for id_ in self.joined.file.connectors:
            if id_ in self._first:
                members.setdefault(self._first[id_], []).append(id_)
        for first, ids in members.items():
            found = [self.joined.file.connectors[id_] for id_ in ids]
            links = tuple(dict.fromkeys(body for id_ in ids for body in self.joined.at(id_)))
            name = next((one.name for one in found if one.name), "")
            yield DrawnPoint(str(first), found[0].at, links, name, found[0].where)

    @property
    def outputs(self) -> tuple[str, ...]:
        """The keys of the points that draw."""
        draw = (one.id for one in self.joined.file.connectors.values() if one.draw and one.id in self._first)
        return tuple(dict.fromkeys(map(self.key, draw)))

    def _merge(self, connectors: list[LinkageConnector]) -> None:
        """Take connectors at one place for one point where they hang together by links in common."""
        groups: list[tuple[int, set[str]]] = []
        for one in connectors:
            bodies = set(self.joined.at(one.id))
            near = [group for group in groups if group[1] & bodies]
            first = min((id_ for id_, _ in near), default=one.id)
            groups = [group for group in groups if group not in near]
            groups.append((first, bodies.union(*(group[1] for group in near))))
            gone = {id_ for id_, _ in near}
            self._first = {id_: first if kept in gone else kept for id_, kept in self._first.items()}
            self._first[one.id] = first
