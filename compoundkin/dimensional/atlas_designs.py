"""Designs of an atlas: drawn from Sobol's sequence for each chain, always the same for a seed, and kept in a folder.

A folder has `atlas.json`, which says what the atlas is, and a Parquet file for each chain, whole or absent: where a run
was ended, the next goes on with the chains that are missing.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem, StudyStopped
from compoundkin.base.suffixes import suffix_for
from compoundkin.dimensional.curve_chains import ChainPlan, CurveChain, curve_chain, curve_chains
from compoundkin.dimensional.curve_likeness import HARMONICS, coefficients
from compoundkin.files.atomic import begin_folder, remove_leftovers, write_once
from compoundkin.files.saved_files import parquet
from compoundkin.studies.samples.random_samples import SobolSample
from compoundkin.studies.study import ends_a_run, run_pieces, workers
from compoundkin.studies.study_folder import part_columns, part_content, part_rows
from compoundkin.studies.study_program import StudyColumn

# Poses of a turn of which a curve is made, those at which a design that is kept must be clear of limits (between 64 one
# in a thousand passes one, where wheels turn fast), and designs that are computed at once.
POSES, CLEAR_AT, BLOCK = 64, 512, 4096
# A curve whose RMS radius is less than this part of its linkage's greatest number is the noise of a point at rest.
LEAST_RADIUS = 0.05
# Draws of a chain for each design that is kept, at most.
DRAWS = 400
# How many designs a chain of eight links has for one of each other.
EIGHTH = 0.12


class DrawnDesigns(NamedTuple):
    """Designs of a chain (designs, numbers), the descriptors of their curves, and the extents of these, (designs, 3).

    Extents are the RMS radius and the middle's two coordinates.
    """

    designs: Number
    descriptors: Number
    extents: Number


class AtlasPart(NamedTuple):
    """The designs of one chain, in memory or in a file."""

    chain: CurveChain
    size: int
    held: DrawnDesigns | None
    path: Path | None = None

    @property
    def descriptors(self) -> Number:
        """The descriptors of all designs (designs, coefficients)."""
        if self.held is not None:
            return self.held.descriptors
        assert self.path is not None
        return part_columns(self.path, [_DESCRIPTOR])[_DESCRIPTOR.name].view(np.complex64).reshape(-1, 2 * HARMONICS)

    @property
    def extents(self) -> tuple[Number, Number]:
        """The RMS radii and the middles of the curves of all designs (designs,)."""
        if self.held is not None:
            radius, x, y = self.held.extents.T
        else:
            assert self.path is not None
            radius, x, y = part_columns(self.path, _EXTENTS).values()
        return radius, x + 1j * y

    def in_memory(self, descriptors: Number) -> AtlasPart:
        """Return it with all that its file has, of which the descriptors are known."""
        if self.held is not None:
            return self
        radius, middle = self.extents
        held = DrawnDesigns(self.designs(), descriptors, np.stack([radius, middle.real, middle.imag], axis=-1))
        return self._replace(held=held)

    def designs(self, at: Number = None) -> Number:
        """Return the designs at some places, else all (designs, numbers)."""
        if self.held is not None:
            return self.held.designs if at is None else self.held.designs[at]
        assert self.path is not None
        columns = _numbers(self.chain)
        found = part_columns(self.path, columns) if at is None else part_rows(self.path, columns, at)
        return np.stack(list(found.values()), axis=-1)


@dataclass(frozen=True)
class AtlasPlan:
    """What an atlas has: so many designs, of chains of at most so many links, drawn by a seed."""

    links: int
    count: int
    seed: int

    @property
    def chains(self) -> tuple[CurveChain, ...]:
        """Its chains, a part each."""
        return curve_chains(self.links)

    @property
    def shares(self) -> list[int]:
        """How many designs each chain has: of eight links there are as many as of all others."""
        weights = np.array([EIGHTH if chain.links == 8 else 1.0 for chain in self.chains])
        ends = np.round(np.cumsum(weights) / weights.sum() * (self.count - len(weights))).astype(int)
        return [int(share) + 1 for share in np.diff(ends, prepend=0)]

    def checked(self) -> AtlasPlan:
        """Return it. Raises InvalidInput where there is no such atlas."""
        if self.links not in (4, 6, 8):
            raise InvalidInput(Problem("links", f"{self.links!r} links are not in an atlas", "take 4, 6 or 8"))
        if self.count < len(self.chains):
            remedy = f"take one of each chain: {len(self.chains)}"
            raise InvalidInput(Problem("count", f"{self.count} designs are too few", remedy))
        if self.seed < 0:
            raise InvalidInput(Problem("seed", f"{self.seed} is no seed", "give a whole number from 0 on"))
        return self


def parts_in_memory(plan: AtlasPlan, on: Any = None) -> tuple[AtlasPart, ...]:
    """Return the parts of an atlas, made here or `on` other workers. Raises StudyStopped where these die."""
    return tuple(AtlasPart(chain, len(drawn.designs), drawn) for _, chain, drawn in _made(plan, {}, on))


# The file that says what an atlas in a folder is, and the columns of descriptors and of curves' extents.
_DEFINITION, _DESCRIPTOR = f"atlas{suffix_for('mechanism', 'json')}", StudyColumn("descriptor", "", "output")
_EXTENTS = [StudyColumn(name, "", "output") for name in ("radius", "middle.x", "middle.y")]
_FORMAT = 3


def parts_in_folder(plan: AtlasPlan, folder: str | os.PathLike[str], on: Any = None) -> tuple[AtlasPart, ...]:
    """Return the parts of an atlas in a folder; those that are missing are made.

    Raises InvalidInput for the folder of another atlas, or of anything else, and where it cannot be written;
    StudyStopped where workers die.
    """
    parquet("folder")
    where = Path(folder)
    there = _plan_in(where)
    if there is None:
        begin_folder(where / _DEFINITION, _definition(plan).encode())
        # which another run may have begun meanwhile
        there = _plan_in(where) or plan
    if there != plan:
        what = f"it holds another atlas, of {there.links} links, {there.count} designs and seed {there.seed}"
        raise InvalidInput(Problem(str(folder), what, "name a new folder"))
    parts = _parts(where, plan)
    kept = {part.chain.plan: part for part in parts if part.path is not None and part.path.exists()}
    if len(kept) < len(parts):
        remove_leftovers(where, is_complete=False)
        fingerprint = hashlib.sha256(_definition(plan).encode()).hexdigest()[:16]
        for k, chain, drawn in _made(plan, kept, on):
            columns = {one.name: drawn.designs[:, n] for n, one in enumerate(chain.numbers)}
            columns[_DESCRIPTOR.name] = np.ravel(drawn.descriptors.view(f"V{drawn.descriptors.strides[0]}"))
            columns |= {one.name: drawn.extents[:, n] for n, one in enumerate(_EXTENTS)}
            content = part_content([*_numbers(chain), _DESCRIPTOR, *_EXTENTS], [columns], fingerprint)
            write_once(where / _file(k), content)
        remove_leftovers(where, is_complete=True)
    return parts


def opened_parts(folder: str | os.PathLike[str]) -> tuple[AtlasPart, ...]:
    """Return the parts of the atlas that a folder holds. Raises InvalidInput where it holds none, or not all of one."""
    parquet("folder")
    where = Path(folder)
    if not where.is_dir():
        what = "it is no folder" if where.exists() else "there is no such folder"
        raise InvalidInput(Problem(str(folder), what, f"coupler_atlas(folder={str(folder)!r}) makes an atlas there"))
    plan = _plan_in(where)
    if plan is None:
        what = f"it holds no atlas of coupler curves: it has no {_DEFINITION}"
        raise InvalidInput(Problem(str(folder), what, "coupler_atlas(folder=...) makes one"))
    parts = _parts(where, plan)
    missing = sum(part.path is not None and not part.path.exists() for part in parts)
    if missing:
        call = f"coupler_atlas({plan.links}, {plan.count}, {plan.seed}, {str(folder)!r})"
        what = f"{missing} of its {len(parts)} chains are missing"
        raise InvalidInput(Problem(str(folder), what, f"{call} goes on with it"))
    return parts


def _parts(where: Path, plan: AtlasPlan) -> tuple[AtlasPart, ...]:
    chains = zip(plan.chains, plan.shares, strict=True)
    return tuple(AtlasPart(chain, share, None, where / _file(k)) for k, (chain, share) in enumerate(chains))


def _file(k: int) -> str:
    return f"{k:03d}{suffix_for('table', 'parquet')}"


def _numbers(chain: CurveChain) -> list[StudyColumn]:
    return [StudyColumn(one.name, "", "dimension") for one in chain.numbers]


def _definition(plan: AtlasPlan) -> str:
    return json.dumps({"format": _FORMAT, **asdict(plan)}) + "\n"


def _plan_in(folder: Path) -> AtlasPlan | None:
    """Return what the atlas in a folder is, None where there is none. Raises InvalidInput where it cannot be read."""
    try:
        found = json.loads((folder / _DEFINITION).read_bytes())
        known, plan = found.pop("format"), AtlasPlan(**found).checked()
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        what = f"it cannot be read: {getattr(error, 'strerror', None) or 'it is damaged'}"
        raise InvalidInput(Problem(str(folder / _DEFINITION), what, "name a new folder")) from None
    if known != _FORMAT:
        raise InvalidInput(Problem(str(folder / _DEFINITION), f"its format {known} is not known", "name a new folder"))
    return plan


class _Piece(NamedTuple):
    """What is computed by itself: so many designs of a chain, where it has eight links on those of its parent."""

    plan: ChainPlan
    kept: int
    seed: int
    base: Number | None = None


def _made(
    plan: AtlasPlan, kept: Mapping[ChainPlan, AtlasPart], on: Any
) -> Iterator[tuple[int, CurveChain, DrawnDesigns]]:
    """Yield chains that are not `kept`, with their places among all, and their designs.

    Those of eight links are dyads on designs of six.
    """
    chains, shares, made = plan.chains, plan.shares, dict[ChainPlan, Number]()

    def base(chain: CurveChain) -> Number:
        parent = chain.parent.plan
        return made[parent] if parent in made else kept[parent].designs()

    missing = [(k, chain) for k, chain in enumerate(chains) if chain.plan not in kept]
    for is_grown in (False, True):
        some = [(k, chain) for k, chain in missing if (chain.links == 8) == is_grown]
        pieces = [_Piece(chain.plan, shares[k], plan.seed + k, base(chain) if is_grown else None) for k, chain in some]
        for (k, chain), drawn in zip(some, _in_order(pieces, on), strict=True):
            if not is_grown:
                made[chain.plan] = drawn.designs
            yield k, chain, drawn


def _in_order(pieces: Sequence[_Piece], on: Any) -> Iterator[DrawnDesigns]:
    """Yield what is made of pieces in their order, here or on other workers."""
    if on is None:
        yield from map(_drawn, pieces)
        return
    done, wanted = dict[int, DrawnDesigns](), 0
    with workers(on, None) as computing:
        assert computing.executor is not None
        numbered = list(enumerate(pieces))
        try:
            for (k, _), found in run_pieces(computing.executor, _drawn_of_numbered, numbered, computing.room):
                done[k] = found
                while wanted in done:
                    yield done.pop(wanted)
                    wanted += 1
        except Exception as error:
            if ends_a_run(error) and not isinstance(error, InvalidInput):
                what = str(error).strip() or type(error).__name__
                raise StudyStopped(Problem("on", what, "make the atlas again")) from error
            raise


def _drawn_of_numbered(one: tuple[int, _Piece]) -> DrawnDesigns:
    return _drawn(one[1])


def _drawn(piece: _Piece) -> DrawnDesigns:
    """Return the first so many designs of a chain that turn fully."""
    chain, count = curve_chain(piece.plan), piece.kept
    most = 1 << max(count * DRAWS, BLOCK).bit_length()
    sample = SobolSample(min(most, 1 << 29), piece.seed)
    found, kept = list[DrawnDesigns](), 0
    for first in range(0, sample.count, BLOCK):
        if kept >= count:
            break
        units = sample.units(len(chain.numbers), range(first, first + BLOCK))
        drawn = chain.designs(units)
        if piece.base is not None:
            own = piece.base[np.arange(first, first + BLOCK) % len(piece.base)].astype(float)
            drawn = chain.parent.grown_designs(chain, own, units, keep=False)
        drawn = drawn.astype(np.float32).astype(float)  # as they are kept
        curves, clear = chain.curves(drawn, POSES)
        drawn, curves = drawn[clear], curves[clear]
        own, radius, middle = coefficients(curves)
        seen = radius > LEAST_RADIUS * chain.size(drawn)
        seen[seen] = chain.curves(drawn[seen], CLEAR_AT)[1]
        extents = np.stack([radius, middle.real, middle.imag], axis=-1)
        some = drawn[seen].astype(np.float32), own[seen].astype(np.complex64), extents[seen].astype(np.float32)
        found.append(DrawnDesigns(*some))
        kept += int(seen.sum())
    return DrawnDesigns(*(np.concatenate(each)[:count] for each in zip(*found, strict=True)))
