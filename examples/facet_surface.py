# SPDX-License-Identifier: Apache-2.0
"""A surface put together from faces that share boundary points, and its writers, for the example surfaces."""

import os

import numpy as np

from planar_mesh import corner_angles, spread, triangulate


def line(a, b, size, **how):
    """Points from a to b, both included, spaced by size((n, 3) -> (n,))."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    length = np.linalg.norm(b - a)
    t = spread(length, lambda s: size(a + (s / length)[:, None] * (b - a)), **how) / length
    return _exact_ends(a + t[:, None] * (b - a), a, b)


def curve(at, start, end, size, **how):
    """Points of the curve at(t), t in [start, end], spaced along its arc by size((n, 3) -> (n,))."""
    t = np.linspace(start, end, 20001)
    points = at(t)
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    s = spread(arc[-1], lambda q: size(at(np.interp(q, arc, t))), **how)
    return _exact_ends(at(np.interp(s, arc, t)), points[0], points[-1])


def _exact_ends(points, first, last):
    points[0], points[-1] = first, last
    return points


def loop(*sides):
    """One closed loop from sides that follow each other; each is turned where it runs the wrong way.

    The first side sets the sense. Shared ends are kept once.
    """
    result = [np.asarray(sides[0])]
    for side in sides[1:]:
        end = result[-1][-1]
        result.append(side if np.array_equal(side[0], end) else side[::-1])
        if not np.array_equal(result[-1][0], end):
            raise ValueError(f"sides do not join at {end}")
    if not np.array_equal(result[-1][-1], result[0][0]):
        raise ValueError(f"loop does not close at {result[0][0]}")
    return np.concatenate([side[:-1] for side in result])


class Plane:
    """Maps a plane with the given outward normal to (u, v), so that anticlockwise there is seen from outside."""

    def __init__(self, origin, u, v):
        self.origin = np.asarray(origin, dtype=float)
        self.u = np.asarray(u, dtype=float) / np.linalg.norm(u)
        self.v = np.asarray(v, dtype=float) / np.linalg.norm(v)

    def flat(self, points):
        return np.stack([(points - self.origin) @ self.u, (points - self.origin) @ self.v], axis=1)

    def space(self, uv):
        return self.origin + uv[:, :1] * self.u + uv[:, 1:] * self.v


class Surface:
    """Named triangles; points are shared where their coordinates are equal bit for bit."""

    def __init__(self):
        self.points = []
        self.index = {}
        self.triangles = []
        self.names = []  # of each triangle

    def _vertex(self, point):
        key = tuple(float(x) + 0.0 for x in point)  # + 0.0 turns -0 into 0
        if key not in self.index:
            self.index[key] = len(self.points)
            self.points.append(key)
        return self.index[key]

    def add_triangles(self, name, points, triangles):
        ids = [self._vertex(p) for p in points]
        self.triangles += [tuple(ids[k] for k in t) for t in triangles]
        self.names += [name] * len(triangles)

    def add_face(self, name, loops, chart, size):
        """Triangulate one face: loops of points in space (outer first), a chart with flat() and space(), sizes there.

        Loops may run either way; the side of the chart's normal is the outside.
        """
        flats = []
        for k, points in enumerate(loops):
            flat = chart.flat(points)
            if (signed_area(flat) > 0) != (k == 0):
                points, flat = points[::-1], flat[::-1]
            flats.append((points, flat))
        uv, triangles = triangulate([flat for _, flat in flats], lambda at: size(chart.space(at)))
        border = np.concatenate([points for points, _ in flats])
        points = np.concatenate([border, chart.space(uv[len(border) :])])
        self.add_triangles(name, points, triangles)

    def arrays(self):
        return np.array(self.points), np.array(self.triangles)

    def summary(self):
        """Counts, volume, smallest corner; raises where the surface is not closed and consistently turned."""
        points, triangles = self.arrays()
        check_closed(triangles)
        a, b, c = (points[triangles[:, k]] for k in range(3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        return {
            "points": len(points),
            "triangles": len(triangles),
            "volume": float(volume.sum() / 6),
            "min_angle": float(corner_angles(points, triangles).min()),
        }

    def write(self, path):
        """Write ASCII STL with one solid a name, or OBJ with one group a name, by the extension."""
        writers = {".stl": self._stl, ".obj": self._obj}
        extension = os.path.splitext(path)[1].lower()
        if extension not in writers:
            raise SystemExit(f"{path}: write .stl or .obj")
        os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
        with open(path, "w", encoding="ascii", newline="\n") as file:
            file.writelines(writers[extension]())

    def _groups(self):
        names = np.array(self.names)
        triangles = np.array(self.triangles)
        return [(name, triangles[names == name]) for name in dict.fromkeys(self.names)]

    def _stl(self):
        points = np.array(self.points)
        text = [" ".join(repr(x) for x in p) for p in self.points]
        for name, triangles in self._groups():
            yield f"solid {name}\n"
            p = points[triangles]
            normals = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
            normals = normals / np.linalg.norm(normals, axis=1)[:, None] + 0.0
            for normal, triangle in zip(normals, triangles):
                yield "facet normal {:.6g} {:.6g} {:.6g}\nouter loop\n".format(*normal)
                yield "".join(f"vertex {text[k]}\n" for k in triangle)
                yield "endloop\nendfacet\n"
            yield f"endsolid {name}\n"

    def _obj(self):
        for p in self.points:
            yield "v " + " ".join(repr(x) for x in p) + "\n"
        for name, triangles in self._groups():
            yield f"g {name}\n"
            for triangle in triangles:
                yield "f {} {} {}\n".format(*(triangle + 1))


def signed_area(flat):
    nxt = np.roll(flat, -1, axis=0)
    return 0.5 * float((flat[:, 0] * nxt[:, 1] - nxt[:, 0] * flat[:, 1]).sum())


def check_closed(triangles):
    """Every directed side must occur once, and its reverse once."""
    sides = {}
    for a, b, c in triangles:
        for side in ((a, b), (b, c), (c, a)):
            sides[side] = sides.get(side, 0) + 1
    bad = [side for side, count in sides.items() if count != 1 or (side[1], side[0]) not in sides]
    if bad:
        raise ValueError(f"surface is not closed: {len(bad)} sides, first {bad[0]}")
