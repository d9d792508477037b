"""Bands of regions, triangulated: few triangles, and the times at which their corners are swept."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.motion.front.bands import bands_of, simplified
from geotween.motion.front.corners import corner_shares
from geotween.motion.front.inside import innermost
from geotween.motion.front.knots import Knots, divided, middles, opened
from geotween.motion.front.meshes import TICKS, Flags, Mesh, Spans
from geotween.motion.front.plane import Change, Floats, Ints
from geotween.motion.front.skeleton import Skeleton, skeleton_of
from geotween.motion.front.triangulate import triangulated


@dataclass(frozen=True, eq=False)
class Coarse:
    """Triangles of regions, whose corners lie on level sets.

    Attributes
    ----------
    points : (p, 2)
    triangles : (T, 3) counter-clockwise.
    times : (T, 3) key times.
    region : (T,)
    skeleton : the lines between bands.
    unsound : (R,) regions that could not be parted so: their triangles do not tile them.
    """

    points: Floats
    triangles: Ints
    times: Floats
    region: Ints
    skeleton: Skeleton
    unsound: Flags


def coarse(change: Change, mesh: Mesh, spans: Spans, tolerances: Floats) -> Coarse:
    """Part the regions of a mesh into bands, simplified at the tolerance (R,) of each region."""
    rim = mesh.rim(change)
    skeleton = simplified(skeleton_of(change, mesh, rim, spans), spans, tolerances)
    faces, band, broken = bands_of(skeleton)
    skeleton, inside = innermost(mesh, rim, spans, skeleton, faces, band)
    triangles, face, sound = triangulated(faces, skeleton.points, inside)
    unsound = np.zeros(len(spans.counts), dtype=bool)
    unsound[spans.region[band[~sound]]] = True
    unsound[spans.region[broken]] = True
    shares = corner_shares(change, mesh, rim, spans, skeleton, triangles, band[face])
    delay = np.zeros(triangles.shape, dtype=np.intp)
    knots = divided(Knots(skeleton.points, triangles, face, band[face], shares, delay))
    share = knots.at(middles(knots, spans))
    low, high = spans.ends[knots.band].T[..., None]
    knots, times = opened(knots, np.rint((low + (high - low) * share) * TICKS) / TICKS, spans)
    region = spans.region[knots.band]
    return Coarse(knots.points, knots.triangles, times, region, skeleton, unsound)
