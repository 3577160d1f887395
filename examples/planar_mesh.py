# SPDX-License-Identifier: Apache-2.0
"""Triangles of a wanted size in a flat region with holes, for the example surfaces.

The boundary's points are given and stay; interior points are packed in layers from the boundary inwards, about one
wanted size apart, and then relaxed as a truss of springs under repeated Delaunay triangulation (P.-O. Persson and
G. Strang, A simple mesh generator in MATLAB, SIAM Review 46, 2004). Nothing is random: the same input gives the same
triangles. Needs numpy and scipy.
"""

import numpy as np
from scipy.spatial import Delaunay, cKDTree

PACKING = 0.72  # closest two points may be packed, in wanted sizes
BOUNDARY_GAP = 0.55  # closest a packed point may come to a boundary segment, in wanted sizes
GOAL_ANGLE = 30.0  # degrees; repair stops once no corner is sharper


class PlanarMeshError(RuntimeError):
    """The boundary could not be kept; says where."""


def spread(length, size, at_least=1, even=False):
    """Parameters in [0, length] of points along a curve, the spacing following size(s) (s: array of arc lengths).

    Ends included. The number of intervals is the integral of ds/size rounded, at least `at_least`, even if `even`.
    """
    s = np.linspace(0.0, length, 4001)
    density = 1.0 / size(s)
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    intervals = max(at_least, int(round(count[-1])))
    if even and intervals % 2:
        intervals += 1
    result = np.interp(np.linspace(0.0, count[-1], intervals + 1), count, s)
    result[0], result[-1] = 0.0, length
    return result


def corner_angles(points, triangles):
    """(n, 3) corner angles in degrees of triangles in the plane or in space."""
    p = points[triangles]
    angles = np.empty((len(triangles), 3))
    for k in range(3):
        u, v = p[:, (k + 1) % 3] - p[:, k], p[:, (k + 2) % 3] - p[:, k]
        cosine = np.einsum("ij,ij->i", u, v) / (np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1))
        angles[:, k] = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return angles


class _Region:
    """The flat region: its boundary segments, and whether points lie inside."""

    def __init__(self, loops):
        self.points = np.concatenate(loops)
        starts = np.cumsum([0] + [len(loop) for loop in loops])
        segments = [np.stack([np.arange(a, b), np.roll(np.arange(a, b), -1)], 1) for a, b in zip(starts, starts[1:])]
        self.segments = np.concatenate(segments)
        self.a, self.b = self.points[self.segments[:, 0]], self.points[self.segments[:, 1]]
        self.lengths = np.linalg.norm(self.b - self.a, axis=1)
        self.tree = cKDTree(self.points)
        self.segments_at = np.empty((len(self.points), 2), dtype=int)  # the one that begins at a point, and that ends
        self.segments_at[self.segments[:, 0], 0] = np.arange(len(self.segments))
        self.segments_at[self.segments[:, 1], 1] = np.arange(len(self.segments))

    def contains(self, at):
        """Even-odd rule, (n, 2) -> (n,) bool; in slices to bound the memory."""
        inside = np.zeros(len(at), dtype=bool)
        ax, ay, bx, by = self.a[:, 0], self.a[:, 1], self.b[:, 0], self.b[:, 1]
        slope = (bx - ax) / np.where(by == ay, 1.0, by - ay)
        for k in range(0, len(at), 2048):
            x, y = at[k : k + 2048, 0, None], at[k : k + 2048, 1, None]
            crosses = ((ay > y) != (by > y)) & (x < ax + (y - ay) * slope)
            inside[k : k + 2048] = crosses.sum(axis=1) % 2 == 1
        return inside

    def distance(self, at):
        """Distance to the nearest boundary segment, of those at the six nearest boundary points."""
        _, near = self.tree.query(at, min(6, len(self.points)))
        candidates = self.segments_at[near].reshape(len(at), 2 * near.shape[1])
        a, along = self.a[candidates], (self.b - self.a)[candidates]
        to = at[:, None, :] - a
        t = np.clip(np.einsum("ijk,ijk->ij", to, along) / self.lengths[candidates] ** 2, 0.0, 1.0)
        return np.linalg.norm(to - t[:, :, None] * along, axis=2).min(axis=1)


def _pack(region, size):
    """Interior points about one wanted size apart: layer after layer from the boundary inwards."""
    along = region.b - region.a
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / region.lengths[:, None]
    middles = 0.5 * (region.a + region.b)
    height = np.sqrt(3) / 2 * np.sqrt(region.lengths * size(middles))
    front = middles + normals * height[:, None]
    parents = middles
    accepted = region.points
    while len(front):
        wanted = size(front)
        nearest, _ = cKDTree(accepted).query(front)
        keep = nearest > PACKING * wanted
        keep[keep] = region.distance(front[keep]) > BOUNDARY_GAP * wanted[keep]
        keep[keep] = region.contains(front[keep])
        front, parents, wanted = front[keep], parents[keep], wanted[keep]
        if len(front) == 0:
            break
        close = cKDTree(front).query_ball_point(front, PACKING * wanted, return_sorted=True)
        alive = np.ones(len(front), dtype=bool)
        for i, others in enumerate(close):
            if alive[i]:
                alive[others] = False
                alive[i] = True
        front, parents, wanted = front[alive], parents[alive], wanted[alive]
        accepted = np.concatenate([accepted, front])
        ahead = front - parents
        ahead /= np.linalg.norm(ahead, axis=1)[:, None]
        spawned = []
        for degrees in (0, 60, -60, 120, -120):
            c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
            turned = np.stack([c * ahead[:, 0] - s * ahead[:, 1], s * ahead[:, 0] + c * ahead[:, 1]], axis=1)
            spawned.append(front + turned * wanted[:, None])
        parents = np.repeat(front, len(spawned), axis=0)
        front = np.stack(spawned, axis=1).reshape(-1, 2)
    return accepted[len(region.points) :]


def _connect(points, region):
    """Delaunay triangles inside the region, anticlockwise; flat ones along straight sides dropped."""
    triangles = Delaunay(points).simplices
    p = points[triangles]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    longest = np.maximum(np.einsum("ij,ij->i", u, u), np.einsum("ij,ij->i", v, v))
    triangles[area < 0] = triangles[area < 0][:, [0, 2, 1]]
    keep = np.abs(area) > 1e-7 * longest
    doubtful = keep & (triangles < len(region.points)).all(axis=1)  # interior points only have triangles inside
    keep[doubtful] = region.contains(p[doubtful].mean(axis=1))
    return triangles[keep]


def _edges(triangles):
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return np.unique(edges, axis=0)


def _relax(points, region, size, passes):
    """Push interior points apart as springs of their wanted length (Persson and Strang 2004)."""
    fixed = len(region.points)
    points = points.copy()
    edges = None
    for step in range(passes):
        if step % 2 == 0:
            edges = _edges(_connect(points, region))
        along = points[edges[:, 1]] - points[edges[:, 0]]
        length = np.linalg.norm(along, axis=1)
        wanted = size(0.5 * (points[edges[:, 0]] + points[edges[:, 1]]))
        wanted = 1.2 * wanted * np.sqrt((length**2).sum() / (wanted**2).sum())
        push = np.maximum(wanted - length, 0.0)[:, None] * along / length[:, None]
        force = np.zeros_like(points)
        for k in range(2):
            force[:, k] = np.bincount(edges[:, 1], push[:, k], len(points))
            force[:, k] -= np.bincount(edges[:, 0], push[:, k], len(points))
        limit = 0.3 * size(points[fixed:])  # too short a way to jump over the boundary
        step_length = 0.2 * np.linalg.norm(force[fixed:], axis=1)
        moved = points[fixed:] + (0.2 * limit / np.maximum(step_length, limit))[:, None] * force[fixed:]
        good = region.distance(moved) > 0.35 * size(moved)
        points[fixed:][good] = moved[good]
    return points


def _smooth(points, triangles, fixed, passes):
    """Move interior points to the mean of their neighbours where that raises their sharpest corner."""
    points = points.copy()
    edges = _edges(triangles)
    both = np.concatenate([edges, edges[:, ::-1]])
    degree = np.maximum(np.bincount(both[:, 0], minlength=len(points)), 1)
    for _ in range(passes):
        before = _sharpest(points, triangles)
        mean = np.stack([np.bincount(both[:, 0], points[both[:, 1], k], len(points)) / degree for k in range(2)], 1)
        trial = points.copy()
        trial[fixed:] = 0.5 * (points[fixed:] + mean[fixed:])
        for _ in range(4):  # take back what made a corner sharper; its neighbours may then have to go back as well
            worse = _sharpest(trial, triangles) < before
            worse[:fixed] = False
            worse &= (trial != points).any(axis=1)
            if not worse.any():
                break
            trial[worse] = points[worse]
        points = trial
    return points


def _sharpest(points, triangles):
    """Smallest angle at any corner of the triangles round each point; turned triangles count as 0."""
    p = points[triangles]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    angle = corner_angles(points, triangles).min(axis=1)
    angle[u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] <= 0] = 0.0
    result = np.full(len(points), 180.0)
    for k in range(3):
        np.minimum.at(result, triangles[:, k], angle)
    return result


def _mend(points, region, size):
    """One round of repair: drop one end of edges far too short, add a point in triangles far too large or too sharp."""
    fixed = len(region.points)
    triangles = _connect(points, region)
    angles = corner_angles(points, triangles)
    drop, add = [], []
    for t in np.argsort(angles.min(axis=1), kind="stable"):
        if angles[t].min() >= GOAL_ANGLE:
            break
        corner = int(np.argmin(angles[t]))
        a, b = triangles[t][(corner + 1) % 3], triangles[t][(corner + 2) % 3]
        p = points[triangles[t]]
        centre = _circumcentre(p)
        if max(a, b) >= fixed and not {a, b} & set(drop):
            drop.append(max(a, b))
        elif max(a, b) < fixed and region.contains(centre[None])[0]:
            add.append(centre)
    keep = np.ones(len(points), dtype=bool)
    keep[drop] = False
    points = points[keep]
    for centre in add:
        wanted, from_boundary = size(centre[None])[0], region.distance(centre[None])[0]
        if np.linalg.norm(points - centre, axis=1).min() > 0.5 * wanted and from_boundary > 0.4 * wanted:
            points = np.concatenate([points, centre[None]])
    return points


def _circumcentre(p):
    (bx, by), (cx, cy) = p[1] - p[0], p[2] - p[0]
    d = 2.0 * (bx * cy - by * cx)
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    return p[0] + np.array([cy * b2 - by * c2, bx * c2 - cx * b2]) / d


def _check_boundary(triangles, region):
    """Every boundary segment must be a side of exactly one triangle, every other side of two."""
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    sides, count = np.unique(sides, axis=0, return_counts=True)
    open_sides = {tuple(s) for s in sides[count == 1]}
    wanted = {tuple(s) for s in np.sort(region.segments, axis=1)}
    for segment in sorted(wanted - open_sides):
        x, y = region.points[segment[0]]
        raise PlanarMeshError(f"boundary side {segment} near ({x:.6g}, {y:.6g}) is not kept; use smaller sizes there")
    if open_sides - wanted:
        raise PlanarMeshError(f"{len(open_sides - wanted)} sides inside the region have one triangle")
    if count.max() > 2:
        raise PlanarMeshError("a side has more than two triangles")


def triangulate(loops, size, passes=40):
    """Triangulate the region left of the loops (the outer one anticlockwise, holes clockwise).

    loops  arrays of (m, 2) points, each closed without repeating its first point; all of them are kept, in order
    size   function (n, 2) -> (n,): wanted side length, changing by no more than about a third of the distance
    Returns points (the loops' points first) and anticlockwise triangles.
    Raises PlanarMeshError where a boundary segment is not a side of a triangle in the end.
    """
    region = _Region([np.asarray(loop, dtype=float) for loop in loops])
    fixed = len(region.points)
    points = _relax(np.concatenate([region.points, _pack(region, size)]), region, size, passes)
    best, best_angle = None, -1.0
    for _ in range(12):
        triangles = _connect(points, region)
        points = _smooth(points, triangles, fixed, 6)
        triangles = _connect(points, region)
        used = np.zeros(len(points), dtype=bool)
        used[triangles] = True
        sharpest = corner_angles(points, triangles).min()
        if used.all() and sharpest > best_angle:
            best, best_angle = (points, triangles), sharpest
        if best_angle >= GOAL_ANGLE:
            break
        points = _relax(_mend(points, region, size), region, size, 6)
    points, triangles = best
    _check_boundary(triangles, region)
    return points, triangles
