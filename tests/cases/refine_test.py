#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""delfront refine: what it writes, what it says, how it fails."""
import math
import unittest

import case


def airfoil(count):
    """A lens of two arcs, as coordinates: sharp at both ends."""
    lines = ["lens"]
    for side in (1, -1):
        for i in range(count):
            t = i / count
            x = 1 - t if side == 1 else t
            lines.append(f"{x!r} {side * 0.4 * x * (1 - x)!r}")
    return "\n".join(lines + ["1.0 0.0", ""])


class Refine(case.Case):
    def setUp(self):
        super().setUp()
        self.write("coarse.stl", case.stl_binary(case.sphere_triangles(2)))
        self.write("fine.stl", case.stl_binary(case.sphere_triangles(4)))
        self.expect(0, "mesh", "coarse.stl", "-o", "ball.vtu", "-q")

    def volume(self, file):
        self.expect(0, "check", file, "--json", "check.json")
        return self.report("check.json")["quality"]["volume"]

    def test_cells_volume_and_names(self):
        result = self.expect(0, "refine", "ball.vtu", "-o", "fine.vtu", "-o", "fine.msh", "--levels", 2, "--report", "r.json")
        self.assertEqual(result.stderr.count("warning"), 0)
        report = self.report("r.json")
        self.assertEqual(report["cells"]["tetrahedron"], 64 * report["cells_before"]["tetrahedron"])
        self.assertEqual(report["cells"]["triangle"], 16 * report["cells_before"]["triangle"])
        self.assertEqual(report["levels"], 2)
        self.assertEqual(report["files_written"], ["fine.vtu", "fine.msh"])
        self.assertAlmostEqual(self.volume("fine.vtu"), self.volume("ball.vtu"), places=10)
        self.assertIn("coarse (5,120)", result.stdout)

    def test_the_geometry_is_neared_by_four_a_level(self):
        sphere = 4 / 3 * math.pi
        lacks = [sphere - self.volume("ball.vtu")]
        for level in (1, 2):
            self.expect(0, "refine", "ball.vtu", "-o", "fine.vtu", "--levels", level, "--geometry", "fine.stl", "--report", "r.json")
            report = self.report("r.json")
            self.assertEqual(report["reversed"] + report["halved"], 0)
            self.assertGreater(report["points_on_surface"], 0)
            lacks.append(sphere - self.volume("fine.vtu"))
        self.assertAlmostEqual(lacks[0] / lacks[1], 4, delta=0.3)
        self.assertAlmostEqual(lacks[1] / lacks[2], 4, delta=0.5)

    def test_the_same_bytes_for_any_number_of_threads(self):
        for threads in (1, 2, 4):
            self.expect(0, "refine", "ball.vtu", "-o", f"{threads}.vtu", "--geometry", "fine.stl", "-j", threads)
        self.assertEqual((self.folder / "1.vtu").read_bytes(), (self.folder / "2.vtu").read_bytes())
        self.assertEqual((self.folder / "1.vtu").read_bytes(), (self.folder / "4.vtu").read_bytes())

    def test_a_geometry_that_changes_nothing_is_said(self):
        self.expect(0, "refine", "ball.vtu", "-o", "fine.vtu", "--geometry", "coarse.stl", says="no new point had to be moved")

    def test_a_geometry_that_lies_elsewhere_is_said(self):
        far = [[(x + 100, y, z) for x, y, z in triangle] for triangle in case.sphere_triangles(4)]
        self.write("far.stl", case.stl_binary(far))
        says = ["none of the", "half an edge's length of far.stl", "it is 99", "elsewhere"]
        self.expect(0, "refine", "ball.vtu", "-o", "fine.vtu", "--geometry", "far.stl", says=says)
        self.expect(0, "mesh", "coarse.stl", "-o", "g.vtu", "--levels", 1, "--geometry", "far.stl", "--report", "r.json", says=says)
        levels = self.report("r.json")["levels"]
        self.assertEqual(levels["out_of_reach"], levels["boundary_points"])
        self.assertGreater(levels["out_of_reach"], 0)
        self.write("far.dat", "far\n21 0\n20 0.1\n20.5 -0.1\n")
        self.write("lens.dat", airfoil(10))
        self.expect(0, "mesh", "lens.dat", "-o", "g.vtu", "--levels", 1, "--geometry", "far.dat", says=["none of the 20", "far.dat"])

    def test_quiet_and_json_on_stdout(self):
        self.assertEqual(self.expect(0, "refine", "ball.vtu", "-o", "fine.vtu", "-q").stdout, "")
        result = self.expect(0, "refine", "ball.vtu", "-o", "fine.vtu", "--report", "-", "--progress", "none")
        self.assertTrue(result.stdout.startswith("{"), result.stdout)

    def test_the_plane(self):
        self.write("coarse.dat", airfoil(10))
        self.write("smooth.dat", airfoil(400))
        self.expect(0, "mesh", "coarse.dat", "-o", "plane.vtu", "--farfield", "circle:3c", "-q")
        result = self.expect(0, "refine", "plane.vtu", "-o", "fine.vtu", "--geometry", "smooth.dat", "--report", "r.json")
        self.assertIn("moved", result.stdout)
        report = self.report("r.json")
        self.assertEqual(report["points_on_features"], 20)
        self.assertEqual(report["cells"]["triangle"], 4 * report["cells_before"]["triangle"])
        self.expect(0, "check", "fine.vtu")


class RefineSlips(case.Case):
    def setUp(self):
        super().setUp()
        self.write("box.stl", case.stl_ascii(case.box_triangles()))
        self.expect(0, "mesh", "box.stl", "-o", "box.vtu", "-q")
        self.before = self.files()

    def test_words(self):
        self.expect(2, "refine", says="required")
        self.expect(2, "refine", "box.vtu", says="--output is required")
        self.expect(2, "refine", "box.vtu", "-o", "f.vtu", "--levels", 0, says=["--levels 0", "1 or more"])
        self.expect(2, "refine", "box.vtu", "-o", "f.vtu", "--levels", -3, says=["--levels -3", "1 or more"])
        self.expect(2, "refine", "box.vtu", "-o", "f.vtu", "--levels", "two", says="--levels")
        self.expect(2, "refine", "box.vtu", "-o", "f.vtu", "--level", 2, says="did you mean '--levels'")
        self.expect(2, "refine", "box.vtu", "-o", "f.vtu", "--feature-angle", 200, says="from 0 to 180")
        self.expect(2, "refine", "box.vtu", "-o", "box.vtu", says="would be overwritten")
        self.expect(2, "refine", "box.vtu", "-o", "f.vtu", "--report", "f.vtu", says="same file")
        self.expect(2, "refine", "box.vtu", "-o", "f.nothing", says="f.nothing")
        self.expect(2, "refin", "box.vtu", "-o", "f.vtu", says="did you mean 'refine'")
        self.assertEqual(self.files(), self.before)

    def test_inputs(self):
        self.expect(3, "refine", "missing.vtu", "-o", "f.vtu", says="missing.vtu")
        self.expect(3, "refine", "box.stl", "-o", "f.vtu", says=["not a valid grid", "delfront check box.stl"])
        self.expect(3, "refine", "box.vtu", "-o", "f.vtu", "--geometry", "missing.stl", says="missing.stl")
        self.assertEqual(self.files(), self.before)

    def test_limits(self):
        self.expect(6, "refine", "box.vtu", "-o", "f.vtu", "--levels", 3, "--max-cells", 100, says=["3 times", "--levels"])
        self.expect(6, "refine", "box.vtu", "-o", "f.vtu", "--memory-limit", "1MB", says="--levels")
        self.expect(6, "refine", "box.vtu", "-o", "f.vtu", "--levels", 400, says="--levels")
        self.assertEqual(self.files(), self.before)

    def test_a_run_that_fails_leaves_its_report(self):
        failures = [
            (2, "usage", ["box.vtu", "--levels", 0], "--levels 0"),
            (3, "bad_input", ["box.vtu", "--geometry", "missing.stl"], "missing.stl"),
            (3, "bad_input", ["box.stl"], "not a valid grid"),
            (6, "limit_reached", ["box.vtu", "--levels", 3, "--max-cells", 100], "100"),
        ]
        for code, outcome, words, error in failures:
            self.expect(code, "refine", *words, "-o", "f.vtu", "--report", "r.json")
            report = self.report("r.json")
            self.assertEqual((report["outcome"], report["exit_code"]), (outcome, code))
            self.assertIn(error, report["error"])
            self.assertEqual(report["files_written"], [])
            (self.folder / "r.json").unlink()
        self.assertEqual(self.files(), self.before)
        self.expect(0, "refine", "box.vtu", "-o", "f.vtu", "--report", "r.json")
        report = self.report("r.json")
        self.assertEqual((report["outcome"], report["exit_code"], report["error"]), ("done", 0, None))

    def test_places_where_no_file_can_be(self):
        self.expect(7, "refine", "box.vtu", "-o", "nofolder/f.vtu", says="nofolder/f.vtu")
        self.expect(7, "refine", "box.vtu", "-o", "f.vtu", "--report", "nofolder/r.json", says="nofolder/r.json")
        self.assertEqual(self.files(), self.before)


if __name__ == "__main__":
    unittest.main()
