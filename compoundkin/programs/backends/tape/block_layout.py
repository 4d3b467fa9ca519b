"""How designs x poses are cut into blocks whose rows stay in cache, and the pieces in which sums are taken."""

from __future__ import annotations

from typing import NamedTuple

from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE

# Numbers in a row of a block: the calls of NumPy take a tenth of the time, and some thirty rows stay in cache.
BLOCK = 12_288
# Poses that are summed as one piece, before the sums of pieces: so results do not depend on blocks.
PIECE = 1024
# Below so many numbers for each thread, threads cost more than they bring.
FOR_A_THREAD = 32_768


class PoseBlock(NamedTuple):
    """A rectangle of designs and poses. Each range ends before its last number."""

    design: int
    design_end: int
    pose: int
    pose_end: int

    @property
    def shape(self) -> tuple[int, int]:
        """How many designs and poses it has."""
        return self.design_end - self.design, self.pose_end - self.pose

    def part(self, stratum: int) -> PoseBlock:
        """Return the places that values of a stratum have."""
        designs = (self.design, self.design_end) if stratum & BY_DESIGN else (0, 1)
        return PoseBlock(*designs, *((self.pose, self.pose_end) if stratum & BY_POSE else (0, 1)))

    def window(self) -> tuple[slice, slice]:
        """Return the index of its places in an array."""
        return slice(self.design, self.design_end), slice(self.pose, self.pose_end)

    def pieces(self) -> tuple[slice, slice]:
        """Return the index of its pieces in an array of sums."""
        return slice(self.design, self.design_end), slice(self.pose // PIECE, -(-self.pose_end // PIECE))


def number_of_pieces(poses: int) -> int:
    """Return in how many pieces sums over poses are taken."""
    return -(-poses // PIECE)


def useful_threads(threads: int, count: int) -> int:
    """Return how many threads pay for so many numbers in a row."""
    return max(1, min(threads, count // FOR_A_THREAD))


def pose_blocks(designs: int, poses: int, threads: int, marches: bool) -> list[list[PoseBlock]]:
    """Cut designs x poses into blocks. Those of one list must follow one another.

    Blocks of several designs have all poses; others have one design and some pieces of poses. In a march each block is
    one pose of many designs.

    >>> pose_blocks(40, 3000, 1, False)[1]
    [PoseBlock(design=4, design_end=8, pose=0, pose_end=3000)]
    >>> [(run[0].pose, run[0].pose_end) for run in pose_blocks(1, 20_000, 1, False)]
    [(0, 10240), (10240, 20000)]
    """
    if marches:
        ranges = _cut(designs, max(1, min(BLOCK, -(-designs // threads))), 1)
        return [[PoseBlock(*part, k, k + 1) for k in range(poses)] for part in ranges]
    if designs == 1 or poses > BLOCK:
        ranges = _cut(poses, max(1, min(BLOCK, -(-poses // threads))), PIECE)
        return [[PoseBlock(k, k + 1, *part)] for k in range(designs) for part in ranges]
    wide = max(1, BLOCK // poses)
    return [[PoseBlock(*part, 0, poses)] for part in _cut(designs, min(wide, -(-designs // threads)), 1)]


def _cut(count: int, most: int, grain: int) -> list[tuple[int, int]]:
    """Cut a range into equal parts of whole grains and about `most` at most."""
    parts = -(-count // most)
    each = grain * -(-count // (parts * grain))
    return [(k, min(k + each, count)) for k in range(0, count, each)]
