"""`draw`: the kinds of pictures of a mechanism, a structure or a motion at one pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from compoundkin.analysis.singularity import Singularity
from compoundkin.base import display
from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.kinematics import Motion, solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import Structure
from compoundkin.view.sketch.picture import Picture
from compoundkin.view.sketch.picture_options import Drawable, PictureOptions

if TYPE_CHECKING:
    from compoundkin.dynamics.forces import Forces

POSE = ("at", "pose", "design")


class PictureKind(NamedTuple):
    """A kind of picture: the function that draws it, and the options it takes.

    What draws is `module:function` of this folder, imported when it is used.
    """

    drawn: str
    known: Sequence[str]
    of_forces: bool = False

    def picture(self, what: Drawable | Forces | Singularity, options: PictureOptions) -> Picture:
        """Draw it; forces are found first where it is theirs."""
        made: Picture = display.import_function(f"{__package__}.{self.drawn}")(
            _forces(what) if self.of_forces and not isinstance(what, Singularity) else what, options
        )
        return made


KINDS: Mapping[str, PictureKind] = {
    "sketch": PictureKind(
        "kinematic_sketch:draw_sketch", (*POSE, "ghosts", "paths", "centres", "vectors", "labels", "size", "dimensions")
    ),
    "groups": PictureKind("structure_pictures:draw_groups_apart", (*POSE, "size")),
    "loops": PictureKind("structure_pictures:draw_independent_loops", (*POSE, "size")),
    "graph": PictureKind("structure_pictures:draw_kinematic_graph", ("size",)),
    "circle": PictureKind("structure_pictures:draw_circle_of_centres", ("size",)),
    "polygon": PictureKind("vectors:vector_polygon", (*POSE, "vectors", "size")),
    "construction": PictureKind("construction:construction", (*POSE, "link", "size")),
    "configurations": PictureKind("configuration_pictures:configurations_picture", (*POSE, "labels", "size")),
    "circuits": PictureKind("configuration_pictures:circuits_picture", ("at", "design", "labels", "size")),
    "singularities": PictureKind("configuration_pictures:singularities_picture", ("design", "labels", "size")),
    "free-bodies": PictureKind("force_pictures:free_bodies", (*POSE, "link", "size"), of_forces=True),
    "force-polygon": PictureKind("force_pictures:force_polygons", (*POSE, "link", "size"), of_forces=True),
    "normal-force": PictureKind("along_bars:normal_force_picture", (*POSE, "labels", "link", "size"), of_forces=True),
    "shear": PictureKind("along_bars:shear_picture", (*POSE, "labels", "link", "size"), of_forces=True),
    "bending-moment": PictureKind(
        "along_bars:bending_moment_picture", (*POSE, "labels", "link", "size"), of_forces=True
    ),
}
SKETCH_OF_FORCES = PictureKind("force_pictures:force_sketch", (*POSE, "labels", "link", "size"), of_forces=True)


@checked
def draw(
    what: Motion | Mechanism | Structure | Forces | Singularity,
    at: Any = None,
    *,
    kind: str = "sketch",
    pose: int | None = None,
    design: int = 0,
    ghosts: int = 0,
    paths: str | Sequence[str] | bool = (),
    centres: bool = False,
    vectors: Any = (),
    labels: bool | str | Sequence[str] = True,
    size: float | None = None,
    link: str | None = None,
    dimensions: bool = False,
) -> Picture:
    """Draw a mechanism at one pose, in the conventions of textbooks.

    `kind` is "sketch", the kinematic sketch; "groups", the mechanism taken apart: frame and driver, then each Assur
    group in solving order, the pairs by which it is attached in dashed circles; "loops", the independent loops as
    polygons of vectors; "graph", the kinematic graph of links and pairs; "circle", the circle diagram of the instant
    centres; "polygon", the polygon of the velocities of all points (`vectors="acceleration"`: of their accelerations)
    with the images of the links; "construction", how the dyad with a `link` (the first one if left out) is drawn
    with circles and lines, its other mode dashed; "configurations", all of them at the pose, or "circuits", all those
    of the driver that `at` leaves out, side by side on one scale; "singularities", the singular poses of a motion with
    the velocities along each branch that meets there, as one of `singularities` is drawn too; "free-bodies", each link
    or one `link` alone with all that acts on it; "force-polygon", the forces on each link or one head to tail; or
    "normal-force", "shear", "bending-moment" along the bars of links or of one, with the envelope of all poses. The
    last five are of forces, or find them; the sketch of forces has them as arrows, that in each pair on its second
    link, or all those on one `link`.

    The pose is that of the drivers' values `at` (radians or lengths: a number, or several by name), or the pose with
    the index `pose`; else the one nearest to the mechanism's drawing. Graph and circle diagram have none. In a sketch,
    `ghosts` so many other poses are drawn faintly; `paths` names points whose paths along the motion are drawn (True
    for all that are on one link only); `centres` adds the instant centres and the lines that give them; `vectors`
    "velocity", "acceleration" or both. `labels` is True, False, or some of "points", "links". `dimensions` adds
    lengths, angles, radii, offsets of pivots and guides. `size` is the longer side in pixels, such that texts are
    legible if left out.

    A mechanism is solved first; one that cannot be solved is shown as drawn. Raises InvalidInput, UnknownName for
    what does not fit it or the kind of picture, NotAssembled for a pose that does not close, NotDetermined where a
    mechanism that the drivers do not determine is drawn by its groups or centres.

    >>> from compoundkin.model.elements import drive, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> draw(crank, at=0.5).title
    'Crank'
    >>> draw(crank, kind="graph").description
    '2 links, 1 pairs'
    >>> draw(crank, at=0.5, kind="polygon").title
    'Crank: velocity polygon'
    """
    if kind not in KINDS:
        raise InvalidInput(Problem("kind", f"there is no picture {kind!r}", suggestion(kind, list(KINDS))))
    options = PictureOptions(at, pose, design, ghosts, paths, centres, vectors, labels, size, link, dimensions)
    chosen = KINDS[kind]
    if isinstance(what, Singularity):
        if kind not in ("sketch", "singularities"):
            raise InvalidInput(Problem("kind", f"a singular pose has no {kind!r}", "leave the kind out"))
        chosen = KINDS["singularities"]
    elif not isinstance(what, Drawable) and kind == "sketch":
        chosen = SKETCH_OF_FORCES
    elif not isinstance(what, Drawable) and not chosen.of_forces:
        what = what.motion
    if unfit := options.others(chosen.known):
        raise InvalidInput(Problem(unfit[0], f"it does not go with the kind {kind!r}", "leave one of them out"))
    return chosen.picture(what, options)


def _forces(what: Drawable | Forces) -> Forces:
    """The forces, or those of a motion; of a mechanism those over its drivers' own ranges."""
    if not isinstance(what, Drawable):
        return what
    found: Forces = display.display_function("forces")(what if isinstance(what, Motion) else solve(what))
    return found
