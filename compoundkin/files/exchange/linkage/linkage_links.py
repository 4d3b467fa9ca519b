"""Links of a .linkage2 file: those that share two connectors or are fastened are one, and where its points are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, islice

from compoundkin.base.display import abbreviated_list
from compoundkin.files.exchange.content import Problems
from compoundkin.files.exchange.drawing import DrawnLink, DrawnPoint
from compoundkin.files.exchange.linkage.linkage_records import Fastening, LinkageConnector, LinkageFile, LinkageLink
from compoundkin.model.geometry import FRAME

# No connector of a mechanism joins more; drawings of something else may.
_MOST_AT_ONE = 40


class JoinedLinks:
    """The links of a file as rigid bodies, by keys. An actuator is two, a barrel and a rod."""

    def __init__(self, file: LinkageFile, problems: Problems) -> None:
        self.file, self.problems = file, problems
        self.notes: list[str] = []
        self._parent: dict[str, str] = {FRAME: FRAME}
        self._at: dict[int, list[str]] = {id_: [FRAME] if c.anchor else [] for id_, c in file.connectors.items()}
        self._named = set(_named(file))
        self.links = [link for link in map(self._with_known, file.links) if self._is_one(link)]
        for link in self.links:
            self._place(link)
        for id_, connector in file.connectors.items():
            if len(self._at[id_]) > _MOST_AT_ONE:
                problems.add(
                    connector.where, f"it joins {len(self._at[id_])} links", f"at most {_MOST_AT_ONE} can meet"
                )
        self._fasten_all()
        self._join_all()
        self._turn_together()
        self._join_all()

    def body(self, key: str) -> str:
        """Return the key of the rigid body that a link is part of."""
        while self._parent[key] != key:
            self._parent[key] = self._parent[self._parent[key]]
            key = self._parent[key]
        return key

    def at(self, connector: int) -> tuple[str, ...]:
        """Return the bodies that meet at a connector, in the order of the file."""
        return tuple(dict.fromkeys(map(self.body, self._at[connector])))

    @property
    def drawn(self) -> Iterator[DrawnLink]:
        """Yield the moving bodies with their names."""
        members: dict[str, list[LinkageLink]] = {}
        for link in self.links:
            members.setdefault(self.body(link.key), []).append(link)
        for body, links in members.items():
            if body != FRAME:
                yield DrawnLink(body, _name(links), links[0].where)
        for link in self.links:
            if link.actuator and self.body(rod(link)) == rod(link):
                yield DrawnLink(rod(link), f"{link.called} rod", link.where)

    def _with_known(self, link: LinkageLink) -> LinkageLink:
        """Return a link with those of its connectors that are there."""
        return replace(link, connectors=tuple(c for c in link.connectors if self._has(c, link)))

    def _is_one(self, link: LinkageLink) -> bool:
        """Return whether a link is more than the mark of one connector."""
        known = link.connectors
        alone = len(known) == 1 and not (link.actuator or _is_fastened(link.fastened))
        used = alone and (self.file.connectors[known[0]].input or link.id in self._named)
        if not known or (alone and not used):
            if not known:
                self.file.drop("link without connectors")
            return False
        return True

    def _has(self, connector: int, link: LinkageLink) -> bool:
        if connector in self.file.connectors:
            return True
        if connector not in self.file.drawings[1]:
            self.problems.add(link.where, f"connector {connector} is not there", "take it out of the link")
        return False

    def _place(self, link: LinkageLink) -> None:
        known = link.connectors
        self._parent[link.key] = link.key
        if not link.actuator:
            for connector in known:
                self._at[connector].append(link.key)
            return
        self._parent[rod(link)] = rod(link)
        if len(known) != 2:
            what = f"an actuator has two connectors, this has {len(known)}"
            self.problems.add(link.where, what, "pin further links to its ends")
        for connector, part in zip(known[:2], (link.key, rod(link)), strict=False):
            self._at[connector].append(part)

    def _join(self, one: str, two: str) -> None:
        one, two = self.body(one), self.body(two)
        if one != two:
            kept, gone = (two, one) if two == FRAME else (one, two)
            self._parent[gone] = kept

    def _fasten_all(self) -> None:
        for link in self.links:
            for other in self._fastened_to(link.fastened, link.where):
                if link.actuator:
                    self.problems.add(link.where, "an actuator cannot be fastened: it changes its length")
                self._join(other, link.key)
        for connector in self.file.connectors.values():
            for other in self._fastened_to(connector.fastened, connector.where):
                own = self._sole(connector, connector.where)
                if own:
                    self._join(other, own)
                elif other not in self._at[connector.id]:
                    self._at[connector.id].append(other)

    def _fastened_to(self, fastened: Fastening, where: str) -> Iterator[str]:
        """Yield the links that something is fastened to; pictures are none."""
        if fastened.link is not None and fastened.link not in self.file.drawings[0]:
            found = [link for link in self.links if link.id == fastened.link]
            if len(found) == 1 and not found[0].actuator:
                yield found[0].key
            else:
                self.problems.add(where, f"it is fastened to link {fastened.link}, {_of_those(found)}")
        for id_ in fastened.connectors:
            if id_ in self.file.connectors:
                sole = self._sole(self.file.connectors[id_], where)
                yield from [sole] if sole else []
            elif id_ not in self.file.drawings[1]:
                self.problems.add(where, f"it is fastened to connector {id_}, which is not there")

    def _sole(self, connector: LinkageConnector, where: str) -> str:
        """Return the one body at a connector, or nothing where it is in no link."""
        bodies = self.at(connector.id)
        if len(bodies) > 1:
            what = f"it is fastened at {connector.called}, where several links meet"
            self.problems.add(where, what, "fasten it to one of the links")
        return bodies[0] if bodies else ""

    def _turn_together(self) -> None:
        """Join the links that an input turns. On an anchor all, else all but the one listed first."""
        for connector in self.file.connectors.values():
            if connector.input:
                bodies = self.at(connector.id)
                for other in bodies[2:]:
                    self._join(bodies[1], other)

    def _join_all(self) -> None:
        while self._join_once():
            pass

    def _join_once(self) -> bool:
        """Join the bodies that meet at two places, which cannot move against each other."""
        met: dict[tuple[str, str], int] = {}
        joined = False
        for id_, connector in self.file.connectors.items():
            bodies = self.at(id_) if len(self._at[id_]) <= _MOST_AT_ONE else ()
            for one, two in combinations(sorted(bodies), 2):
                first = met.setdefault((one, two), id_)
                if self.file.connectors[first].at != connector.at and self.body(one) != self.body(two):
                    self._join(one, two)
                    self._tell((one, two), (first, id_))
                    joined = True
        return joined

    def _tell(self, bodies: tuple[str, str], connectors: tuple[int, int]) -> None:
        """Note that two links are one; a link on two anchors is one with the frame as a matter of course."""
        if FRAME not in bodies:
            one, two = (
                next(link.called for link in self.links if link.key == body.split(" rod")[0]) for body in bodies
            )
            self.notes.append(
                f"{one} and {two} share connectors {connectors[0]} and {connectors[1]}: they are one link"
            )


def rod(link: LinkageLink) -> str:
    """Return the key of the moving part of an actuator, at its second connector."""
    return f"{link.key} rod"


def _is_fastened(fastened: Fastening) -> bool:
    return fastened.link is not None or bool(fastened.connectors)


def _named(file: LinkageFile) -> Iterator[int | None]:
    """Yield the ids of links that a fastening or a ratio names."""
    yield from (one.fastened.link for one in file.links)
    yield from (one.fastened.link for one in file.connectors.values())
    yield from (id_ for ratio in file.ratios for id_, _ in ratio.wheels)


def _name(links: list[LinkageLink]) -> str:
    """Return the names of the links that are one, or "link 0+1" by their ids."""
    names = list(dict.fromkeys(link.name for link in links if link.name))
    return "+".join(names) if names else "link " + "+".join(str(link.id) for link in links)


def _of_those(found: list[LinkageLink]) -> str:
    if not found:
        return "which is not there"
    return "which changes its length" if len(found) == 1 else f"and {len(found)} links have this id"


# Connectors are at one place that are nearer to each other than this part of the size; those meant to be snap.
ONE_PLACE = 1e-6


# No drawing is smaller; of such a division would leave nothing.
_LEAST = 1e-200


# More hints are no help.
_MOST = 6


def unjoined(joined: JoinedLinks, size: float) -> Iterator[tuple[LinkageConnector, LinkageConnector]]:
    """Yield pairs of connectors at one place without a link in common."""
    near = ONE_PLACE * max(size, _LEAST)
    places: dict[tuple[int, int], list[LinkageConnector]] = {}
    for one in joined.file.connectors.values():
        if joined.at(one.id):
            places.setdefault((round(one.at.real / near), round(one.at.imag / near)), []).append(one)
    for here in places.values():
        for one, two in islice(combinations(here, 2), _MOST):
            if not set(joined.at(one.id)) & set(joined.at(two.id)):
                yield one, two


def hint(pairs: list[tuple[LinkageConnector, LinkageConnector]]) -> str:
    """Return the question that may help, or nothing.

    >>> hint([])
    ''
    """
    said = [f"{one.id} and {two.id}" for one, two in pairs]
    return f"did you mean to join connectors {abbreviated_list(said, _MOST)}?" if said else ""


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
