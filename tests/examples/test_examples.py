# SPDX-License-Identifier: Apache-2.0
"""The example surfaces: closed, well shaped, named, of the right volume, the same bytes every time."""

import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
for folder in ("", "ahmed", "naca0012_wing"):
    sys.path.insert(0, os.path.join(ROOT, "examples", folder))
import make_ahmed  # noqa: E402
import make_wing  # noqa: E402
import planar_mesh  # noqa: E402


def read_stl(path):
    """ASCII STL -> points (n, 3), triangles (m, 3), name of each triangle; equal coordinates are one point."""
    index, triangles, names, corner, name = {}, [], [], [], None
    with open(path, encoding="ascii") as file:
        for text in file:
            words = text.split()
            if words[0] == "solid":
                name = words[1]
            elif words[0] == "vertex":
                corner.append(index.setdefault(tuple(float(w) for w in words[1:]), len(index)))
            elif words[0] == "endfacet":
                triangles.append(corner)
                names.append(name)
                corner = []
    return np.array(list(index)), np.array(triangles), np.array(names)


def read_obj(path):
    points, triangles, names, name = [], [], [], None
    with open(path, encoding="ascii") as file:
        for text in file:
            words = text.split()
            if words[0] == "v":
                points.append([float(w) for w in words[1:]])
            elif words[0] == "g":
                name = words[1]
            elif words[0] == "f":
                triangles.append([int(w) - 1 for w in words[1:]])
                names.append(name)
    return np.array(points), np.array(triangles), np.array(names)


def normals(points, triangles):
    p = points[triangles]
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    return n / np.linalg.norm(n, axis=1)[:, None]


def triangle_at_side(triangles):
    """{directed side: triangle}; a side run twice in one direction is an error."""
    sides = {}
    for t, (a, b, c) in enumerate(triangles):
        for side in ((a, b), (b, c), (c, a)):
            if side in sides:
                raise AssertionError(f"side {side} is run twice in one direction")
            sides[side] = t
    return sides


class SurfaceChecks:
    """What every example surface must be; a subclass says which script, names, volume and how many shells."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = os.path.join(cls.folder.name, "a.stl")
        subprocess.run([sys.executable, cls.script, cls.path, *cls.arguments], check=True, stdout=subprocess.DEVNULL)
        cls.points, cls.triangles, cls.names = read_stl(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_is_closed_and_consistently_turned(self):
        sides = triangle_at_side(self.triangles.tolist())
        open_sides = [side for side in sides if (side[1], side[0]) not in sides]
        self.assertEqual(open_sides, [])

    def test_has_the_expected_topology(self):
        sides = triangle_at_side(self.triangles.tolist())
        euler = len(self.points) - len(sides) // 2 + len(self.triangles)
        self.assertEqual(euler, self.euler)

    def test_encloses_the_volume_of_the_air(self):
        p = self.points[self.triangles]
        volume = np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6
        self.assertLess(abs(volume - self.volume), self.volume_tolerance)

    def test_names_every_patch(self):
        self.assertEqual(set(self.names), self.patches)

    def test_has_no_sharp_triangle(self):
        angles = planar_mesh.corner_angles(self.points, self.triangles)
        self.assertGreater(angles.min(), self.min_angle)

    def test_has_no_sharp_edge(self):
        """Neighbouring triangles enclose over 20 degrees, on either side."""
        n = normals(self.points, self.triangles)
        sides = triangle_at_side(self.triangles.tolist())
        pairs = np.array([(t, sides[b, a]) for (a, b), t in sides.items() if a < b])
        fold = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", n[pairs[:, 0]], n[pairs[:, 1]]), -1, 1)))
        self.assertLess(fold.max(), 160)

    def test_gives_the_same_bytes_again(self):
        again = os.path.join(self.folder.name, "again.stl")
        subprocess.run([sys.executable, self.script, again, *self.arguments], check=True, stdout=subprocess.DEVNULL)
        with open(self.path, "rb") as first, open(again, "rb") as second:
            self.assertTrue(first.read() == second.read(), "two runs differ")


class AhmedBody(SurfaceChecks, unittest.TestCase):
    script = os.path.join(ROOT, "examples", "ahmed", "make_ahmed.py")
    arguments = ()
    patches = {"inlet", "outlet", "floor", "top", "side_left", "side_right", "body", "slant", "base", "stilts"}
    euler = 2 - 2 * 3  # one shell: the first stilt joins tunnel and body, each other one adds a handle
    volume = make_ahmed.air_volume()
    volume_tolerance = 2e-4  # of chords: 4 roundings of radius 0.1 in steps of 13 degrees, stilts with 16 sides
    min_angle = 25

    def test_body_has_the_published_size(self):
        body = self.points[self.triangles[np.isin(self.names, ["body", "slant", "base"])]].reshape(-1, 3)
        np.testing.assert_allclose(body.min(axis=0), [0, -0.1945, 0.050], atol=1e-12)
        np.testing.assert_allclose(body.max(axis=0), [1.044, 0.1945, 0.338], atol=1e-12)

    def test_slant_has_the_published_length_and_angle(self):
        slant = self.points[self.triangles[self.names == "slant"]].reshape(-1, 3)
        run, drop = np.ptp(slant[:, 0]), np.ptp(slant[:, 2])
        self.assertAlmostEqual(np.hypot(run, drop), 0.222, 12)
        self.assertAlmostEqual(np.degrees(np.arctan2(drop, run)), 25.0, 9)

    def test_stilts_stand_at_their_places(self):
        stilts = self.points[np.unique(self.triangles[self.names == "stilts"])]
        axes = [(x, y) for x in (0.202, 0.672) for y in (-0.1635, 0.1635)]
        radius = np.min([np.hypot(stilts[:, 0] - x, stilts[:, 1] - y) for x, y in axes], axis=0)
        np.testing.assert_allclose(radius, 0.015, atol=1e-12)
        self.assertEqual((stilts[:, 2].min(), stilts[:, 2].max()), (0.0, 0.05))

    def test_walls_and_body_face_away_from_the_air(self):
        n = normals(self.points, self.triangles)
        for name, way in (("inlet", [-1, 0, 0]), ("floor", [0, 0, -1]), ("side_left", [0, 1, 0]), ("base", [-1, 0, 0])):
            np.testing.assert_allclose(n[self.names == name], np.tile(way, (sum(self.names == name), 1)), atol=1e-9)

    def test_obj_holds_the_same_surface(self):
        path = os.path.join(self.folder.name, "a.obj")
        subprocess.run([sys.executable, self.script, path], check=True, stdout=subprocess.DEVNULL)
        points, triangles, names = read_obj(path)
        np.testing.assert_array_equal(points[triangles], self.points[self.triangles])
        np.testing.assert_array_equal(names, self.names)


class NacaWing(SurfaceChecks, unittest.TestCase):
    script = os.path.join(ROOT, "examples", "naca0012_wing", "make_wing.py")
    arguments = ("--span", "0.5")  # the same edges and tips, fewer triangles
    patches = {"wing", "tip", "trailing_edge", "inlet", "outlet", "farfield"}
    euler = 4  # two shells
    volume = make_wing.air_volume(0.5)
    volume_tolerance = 4e-4  # of chords, at 0.06 on the sides
    min_angle = 20

    def test_points_lie_on_the_published_section(self):
        wing = self.points[np.unique(self.triangles[self.names == "wing"])]
        np.testing.assert_allclose(np.abs(wing[:, 2]), make_wing.half_thickness(wing[:, 0]), atol=1e-9)

    def test_section_is_the_published_one(self):
        x = np.linspace(0, 1, 100001)
        self.assertAlmostEqual(2 * make_wing.half_thickness(x).max(), 0.12, 4)
        self.assertAlmostEqual(2 * make_wing.half_thickness(1.0), 0.00252, 12)
        self.assertAlmostEqual(make_wing.section_area(), np.trapz(2 * make_wing.half_thickness(x), x), 6)


class PlanarMesh(unittest.TestCase):
    def test_fills_a_square_with_a_hole_and_keeps_its_boundary(self):
        outer = [(-1 + 0.1 * k, -1) for k in range(20)] + [(1, -1 + 0.1 * k) for k in range(20)]
        outer = np.array(outer + [(-x, -y) for x, y in outer])
        turn = -2 * np.pi * np.arange(24) / 24
        hole = 0.4 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        points, triangles = planar_mesh.triangulate([outer, hole], lambda at: np.full(len(at), 0.1))
        np.testing.assert_array_equal(points[: len(outer) + len(hole)], np.concatenate([outer, hole]))
        p = points[triangles]
        u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        self.assertGreater(areas.min(), 0)
        self.assertAlmostEqual(areas.sum(), 4 - 24 / 2 * 0.16 * np.sin(2 * np.pi / 24), 12)
        self.assertGreater(planar_mesh.corner_angles(points, triangles).min(), 30)

    def test_says_where_a_boundary_cannot_be_kept(self):
        outer = np.array([(0, 0), (5, 0), (10, 0), (10, 1), (0, 1)])
        hole = np.array([(2, 0.1), (5, 0.9), (8, 0.1)])  # its long side passes the outer point (5, 0) closely
        with self.assertRaisesRegex(planar_mesh.PlanarMeshError, r"near \(2, 0.1\)"):
            planar_mesh.triangulate([outer, hole], lambda at: np.full(len(at), 10.0))


if __name__ == "__main__":
    unittest.main()
