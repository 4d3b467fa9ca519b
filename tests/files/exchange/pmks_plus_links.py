"""A second reader of share links, of those that we write: as strict as the app, and more."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import unquote

_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"


def number(text: str) -> float:
    assert text
    value = 0
    for digit in text.removeprefix("0"):
        value = value * 64 + _DIGITS.index(digit)
    return -value / 1000 if text.startswith("0") else value / 1000


@dataclass
class ReadJoint:
    id: str
    at: complex
    flags: list[bool]
    slot: list[str]

    @property
    def slides(self) -> bool:
        return self.flags[0]


@dataclass
class ReadLink:
    is_block: bool
    joints: list[str]


def _sections(url: str) -> tuple[list[str], list[list[str]]]:
    text = unquote(url.partition("?")[2])
    assert _DIGITS[(len(text) - 1) % 62] == text[-1]
    settings, rest = text[:-1].split(".")[:4], text[:-1].split(".")[4:]
    found = []
    for _ in range(3):
        end = rest.index("")
        found.append(rest[:end])
        rest = rest[end + 1 :]
    assert rest == ["N_"]
    return settings, found


def _joint(record: str) -> ReadJoint:
    fields = record[1:].split(",")
    assert len(fields) in (5, 8, 9)
    flags = [bool(_DIGITS.index(record[0]) >> bit & 1) for bit in range(6)]
    for text in (fields[4], *fields[8:]):
        number(text)
    return ReadJoint(fields[0], complex(*map(number, fields[2:4])), flags, [text for text in fields[5:8] if text])


def _link(record: str) -> tuple[str, ReadLink]:
    fields = record.split(",")
    assert fields[0][0] in "YAMG"
    assert fields[0][1] in "RP"
    assert fields[-2:] == ["", ""]
    for text in fields[2:6]:
        number(text)
    return fields[0][2:], ReadLink(fields[0][1] == "P", fields[7:-2])


def check_link(url: str) -> int:
    """Check all that the app asks of a link and of what its solvers take; return how many inputs it has."""
    settings, (joint_records, link_records, forces) = _sections(url)
    assert [len(settings[0]), *(len(part.split(",")) for part in settings[1:3]), len(settings[3])] == [2, 2, 2, 4]
    all_joints = [_joint(record) for record in joint_records]
    joints = {joint.id: joint for joint in all_joints}
    links = dict(_link(record) for record in link_records)
    assert (len(joints), len(links)) == (len(joint_records), len(link_records))
    for link in links.values():
        assert len(link.joints) == len(set(link.joints)) >= 2
        assert set(link.joints) <= set(joints)
        assert [joints[k].slides for k in link.joints] == (
            [False, True] if link.is_block else [False] * len(link.joints)
        )
    for joint in all_joints:
        (_check_slider if joint.slides else _check_pin)(joint, joints, links)
    for record in forces:
        flags, link_id, _, *numbers = record[1:].split(",")
        assert flags
        assert not links[link_id].is_block
        assert [number(text) for text in numbers][-1] >= 0.0
    return sum(joint.flags[1] for joint in all_joints)


def _check_slider(joint: ReadJoint, joints: dict[str, ReadJoint], links: dict[str, ReadLink]) -> None:
    (block,) = (link for link in links.values() if joint.id in link.joints)
    assert joints[block.joints[0]].at == joint.at
    assert joint.flags[2] != bool(joint.slot)
    if joint.slot:
        carrier, one, other = joint.slot
        assert not links[carrier].is_block
        assert {one, other} <= set(links[carrier].joints)
        assert joints[one].at != joints[other].at
        assert joint.id not in links[carrier].joints


def _check_pin(joint: ReadJoint, joints: dict[str, ReadJoint], links: dict[str, ReadLink]) -> None:
    own = [link for link in links.values() if joint.id in link.joints]
    blocks = sum(link.is_block for link in own)
    assert own
    assert not joint.slot
    assert blocks <= 1
    # a weld is of a block and one link; an input is between two links, the frame one of them
    assert not joint.flags[3] or (len(own), blocks) == (2, 1)
    assert not joint.flags[1] or (len(own) + joint.flags[2] == 2 and not joint.flags[3])
