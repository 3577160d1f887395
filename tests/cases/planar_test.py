#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Grids in the plane: airfoil sections in a far field, a job file with holes, regions and sizes, what is refused."""
import itertools
import math
import subprocess
import sys
import unittest

import case

CHECKER = case.SHARED.parent / "tools" / "check_mesh.py"
SQUARE = "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n4 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n0\n"


def naca0012(n=60):
    def half_thickness(x):
        return 0.6 * (0.2969 * math.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4)

    xs = [0.5 * (1 + math.cos(math.pi * i / n)) for i in range(n + 1)]
    points = [(x, half_thickness(x)) for x in xs] + [(x, -half_thickness(x)) for x in reversed(xs[:-1])]
    return "NACA 0012\n" + "".join(f"{x:.7f} {y:.7f}\n" for x, y in points)


def area(points):
    return 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(points, points[1:] + points[:1]))


class Section(case.Case):
    def setUp(self):
        super().setUp()
        self.write("foil.dat", naca0012())

    def test_a_section_in_a_far_field_is_ready_for_a_solver(self):
        self.expect(0, "mesh", "foil.dat", "-o", "c.su2", "-o", "c.vtu", "--farfield", "circle:50c", "--report", "r.json",
                    "--require", "min_angle > 28")
        text = (self.folder / "c.su2").read_text()
        self.assertIn("NDIME= 2", text)
        self.assertIn("MARKER_TAG= foil", text)
        self.assertIn("MARKER_TAG= farfield", text)
        self.assertEqual(text.split("MARKER_TAG= foil")[1].split("MARKER_ELEMS=")[1].split()[0], "121")
        quality = self.report("r.json")["quality"]
        self.assertLess(abs(quality["volume"] - math.pi * 2500) / 2500, 0.05)

    def test_the_given_points_stay(self):
        self.expect(0, "mesh", "foil.dat", "-o", "c.mesh", "--farfield", "circle:20c")
        words = (self.folder / "c.mesh").read_text().split("Vertices")[1].split()
        points = [(float(words[1 + 3 * i]), float(words[2 + 3 * i])) for i in range(121)]
        given = [tuple(map(float, line.split())) for line in naca0012().splitlines()[1:]]
        self.assertEqual(points, given)

    def test_the_same_bytes_for_any_number_of_threads(self):
        files = []
        for threads in (1, 2, 8):
            self.expect(0, "mesh", "foil.dat", "-o", f"{threads}.vtu", "--farfield", "circle:20c", "-j", threads)
            files.append((self.folder / f"{threads}.vtu").read_bytes())
        self.assertEqual(files[0], files[1])
        self.assertEqual(files[0], files[2])

    def test_the_inside(self):
        self.expect(0, "mesh", "foil.dat", "-o", "c.msh", "--report", "r.json")
        given = [tuple(map(float, line.split())) for line in naca0012().splitlines()[1:]]
        self.assertAlmostEqual(self.report("r.json")["quality"]["volume"], area(given), 12)

    def test_it_is_looked_at(self):
        self.expect(0, "info", "foil.dat", says="line")
        self.expect(0, "check", "foil.dat")
        self.expect(0, "mesh", "foil.dat", "--stop-after", "geometry")
        self.expect(0, "mesh", "foil.dat", "-o", "c.vtu", "--farfield", "circle:20c")
        self.expect(0, "check", "c.vtu", says="min_angle")


class PlanarErrors(case.Case):
    def test_what_cannot_be_gridded_is_refused_with_the_place(self):
        crossing = SQUARE.replace("1 1 2\n2 2 3", "1 1 3\n2 3 2").replace("3 3 4\n4 4 1", "3 2 4\n4 4 1")
        self.write("cross.poly", crossing)
        self.expect(3, "mesh", "cross.poly", "-o", "c.vtu", says="cross")
        self.expect(3, "check", "cross.poly", says="(0.5, 0.5")
        self.write("open.poly", SQUARE.replace("4 0\n1 1 2", "3 0\n1 1 2").replace("4 4 1\n", ""))
        self.expect(3, "mesh", "open.poly", "-o", "c.vtu", says="bound nothing")
        self.assertNotIn("c.vtu", self.files())

    def test_a_segment_of_no_length_is_named(self):
        self.write("point.poly", SQUARE.replace("4 0\n1 1 2", "5 0\n5 3 3\n1 1 2"))
        self.expect(0, "mesh", "point.poly", "-o", "c.vtu",
                    says=["1 segments of no length", "the first at (1, 1)"])

    def test_a_far_field_that_is_too_small(self):
        self.write("foil.dat", naca0012())
        self.expect(3, "mesh", "foil.dat", "-o", "c.vtu", "--farfield", "circle:0.3c", says="does not enclose")

    def test_formats_without_a_plane(self):
        self.write("square.poly", SQUARE)
        self.expect(2, "mesh", "square.poly", "-o", "foam/", says="OpenFOAM")
        self.expect(2, "mesh", "square.poly", "-o", "c.stl", says="surfaces only")
        self.assertEqual(self.files(), ["square.poly"])

    def test_options_of_the_plane(self):
        self.write("square.poly", SQUARE)
        self.expect(2, "mesh", "square.poly", "-o", "c.vtu", "--boundary", "splti", says="split")
        self.expect(0, "mesh", "square.poly", "-o", "c.vtu", "--boundary", "split", "--hmax", "0.05")
        self.expect(5, "mesh", "square.poly", "-o", "c.vtu", "--require", "min_angle > 60.5", says="min_angle")


class PlanarJob(case.Case):
    def test_the_example_with_holes_regions_and_sizes(self):
        example = case.ROOT / "examples" / "planar_section"
        subprocess.run([sys.executable, example / "make_channel.py"], cwd=self.folder, check=True)
        self.write("section.toml", (example / "section.toml").read_text())
        self.expect(0, "mesh", "section.toml", "--report", "r.json")
        report = self.report("r.json")
        self.assertGreater(report["quality"]["measures"]["min_angle"]["min"], 25)
        text = (self.folder / "channel.su2").read_text()
        for name in ("body", "walls"):
            self.assertIn(f"MARKER_TAG= {name}", text)


    def test_the_example_with_splines(self):
        self.write("job.toml", (case.ROOT / "examples" / "plane" / "ellipse_in_channel.toml").read_text())
        self.expect(0, "mesh", "job.toml", "--report", "r.json", "--require", "min_angle > 30")
        report = self.report("r.json")
        # A spline through the ends of the axes is not quite the ellipse, whose area is pi 0.5 0.2.
        self.assertAlmostEqual(12 - report["quality"]["volume"], math.pi * 0.1, delta=0.03)
        self.assertEqual(report["front"]["closed_by_delaunay"], 0)
        text = (self.folder / "ellipse_in_channel.su2").read_text()
        for name in ("body", "channel"):
            self.assertIn(f"MARKER_TAG= {name}", text)

    def test_curves_that_cannot_be_are_refused_with_their_place(self):
        for entry, says in (("at = [[0, 0]]", "at least 2 points"), ("at = [[0, 0], [0, 0], [1, 1]]", "the same"),
                            ("at = [[0, 0, 1], [1, 0, 1]]", "plane"), ("at = [[0, 0], [1, 1]]\nclosed = true", "3 points")):
            with self.subTest(entry):
                self.write("job.toml", f"[[planar.curve]]\n{entry}\n[output]\nfiles = ['c.vtu']\n")
                self.expect(2, "mesh", "job.toml", says=[says, "planar.curve"])

    def test_each_method_grids_the_same_domain(self):
        self.write("square.poly", SQUARE)
        for method in ("front", "front-delaunay", "delaunay"):
            with self.subTest(method):
                self.expect(0, "mesh", "square.poly", "-o", "c.vtu", "--boundary", "split", "--hmax", "0.05", "--report",
                            "r.json", "--set", f"planar.method={method}", "--require", "min_angle > 29.9")
                self.assertAlmostEqual(self.report("r.json")["quality"]["volume"], 1, 12)
        self.expect(2, "mesh", "square.poly", "-o", "c.vtu", "--set", "planar.method=ruppert", says="front-delaunay")


class Levels(case.Case):
    """Coarse sizes at first, then every edge halved."""

    def setUp(self):
        super().setUp()
        self.write("foil.dat", naca0012())
        self.write("square.poly", SQUARE)

    def points_of(self, name, tag):
        """Of a medit file: the points of lines of one number."""
        text = (self.folder / name).read_text()
        numbers = text.split("Vertices")[1].split()
        points = [(float(numbers[1 + 3 * i]), float(numbers[2 + 3 * i])) for i in range(int(numbers[0]))]
        lines = text.split("Edges")[1].split()
        ends = [tuple(map(int, lines[1 + 3 * i : 4 + 3 * i])) for i in range(int(lines[0]))]
        return [points[v - 1] for a, b, ref in ends if ref == tag for v in (a, b)]

    def test_every_method_and_every_level_meets_the_sizes(self):
        for method, levels in itertools.product(("front", "front-delaunay", "delaunay"), (0, 1, 2)):
            with self.subTest(method, levels=levels):
                job = ["square.poly", "--boundary", "split", "--hmax", "0.02", "--levels", levels,
                       "--set", f"planar.method={method}"]
                self.expect(0, "mesh", *job, "-o", "c.vtu", "--report", "r.json", "--require", "min_angle > 28")
                report = self.report("r.json")
                self.assertAlmostEqual(report["quality"]["volume"], 1, 12)
                cells = report["quality"]["num_cells"]
                self.assertAlmostEqual(cells / (2.31 / 0.02**2), 1, delta=0.3)
                self.assertLess(report["quality"]["measures"]["edge_length"]["max"], 0.04)
                self.expect(0, "estimate", *job, "--report", "e.json")
                self.assertAlmostEqual(self.report("e.json")["estimate"]["cells"] / cells, 1, delta=0.25)
                if levels == 0:
                    self.assertIsNone(report["levels"])
                else:
                    self.assertEqual(report["levels"]["levels"], levels)
                    self.assertEqual(cells, 4**levels * report["levels"]["coarse_cells"])

    def test_too_many_cells_are_refused_before_the_work(self):
        for levels in (0, 1):
            self.expect(6, "mesh", "square.poly", "--boundary", "split", "--hmax", "0.002", "--levels", levels, "-o", "c.vtu",
                        "--max-cells", "20000", says=["stopped before gridding", "5.8e+05 cells", "20000 (--max-cells)"])
        # A boundary that is kept coarse keeps cells large: nobody knows before.
        self.expect(0, "mesh", "square.poly", "--hmax", "0.1", "-o", "c.vtu", "--max-cells", "300")

    def test_a_round_far_field_stays_round(self):
        self.expect(0, "mesh", "foil.dat", "-o", "c.mesh", "--farfield", "circle:20c", "--levels", "2", "--report", "r.json")
        rings = [self.points_of("c.mesh", tag) for tag in (1, 2)]
        far = max(rings, key=lambda points: max(x * x for x, _ in points))
        self.assertGreaterEqual(len(far), 2 * 64)
        for x, y in far:
            self.assertAlmostEqual(math.hypot(x - 0.5, y) / 20, 1, 5)
        self.assertEqual(self.report("r.json")["levels"]["reversed"], 0)

    def test_a_spline_stays_one(self):
        circle = [[math.cos(a * math.pi / 8), math.sin(a * math.pi / 8)] for a in range(16)]
        self.write("job.toml", f"[[planar.curve]]\nname = 'disc'\nat = {circle}\nclosed = true\nh = 0.1\n"
                   "[refine]\nlevels = 2\n[output]\nfiles = ['c.mesh']\n")
        self.expect(0, "mesh", "job.toml", "--report", "r.json")
        points = self.points_of("c.mesh", 1)
        for x, y in points:
            self.assertAlmostEqual(math.hypot(x, y), 1, 3)
        self.assertGreater(self.report("r.json")["levels"]["points_on_features"]
                           + self.report("r.json")["levels"]["points_on_surface"], 20)
        self.assertAlmostEqual(self.report("r.json")["quality"]["volume"], math.pi, 2)

    def test_lines_of_a_file_as_the_geometry(self):
        self.write("fine.dat", naca0012(600))
        self.expect(0, "mesh", "foil.dat", "-o", "c.su2", "--farfield", "circle:20c", "--levels", "1", "--geometry", "fine.dat",
                    "--report", "r.json")
        self.assertIn("fine.dat", " ".join(self.report("r.json")["warnings"]))  # it has no far field, nor a foil

    def test_the_wanted_size_is_the_final_one(self):
        self.expect(0, "mesh", "square.poly", "--boundary", "split", "--hmax", "0.1", "--levels", "1", "-o", "c.vtu", "--ascii",
                    "--set", "output.sizes=true")
        text = (self.folder / "c.vtu").read_text()
        values = [float(word) for word in text.split('Name="h"')[1].split(">", 1)[1].split("<")[0].split()]
        self.assertLessEqual(max(values), 0.1 + 1e-12)
        self.assertGreater(max(values), 0.09)

    def test_what_cannot_be_is_refused_before_the_work(self):
        self.expect(2, "mesh", "square.poly", "-o", "c.vtu", "--levels", "9", says=["--levels: ", "8 or fewer"])
        self.expect(2, "mesh", "square.poly", "-o", "c.vtu", "--levels", "-1", says="refine.levels")
        self.expect(2, "mesh", "square.poly", "-o", "c.vtu", "--geometry", "foil.dat", says="refine.levels")
        self.expect(2, "mesh", "square.poly", "-o", "foil.dat.vtu", "--levels", "1", "--geometry", "foil.dat.vtu",
                    says="another name")
        self.expect(6, "mesh", "square.poly", "--boundary", "split", "--hmax", "0.02", "--levels", "1", "-o", "c.vtu",
                    "--max-cells", "3000", says=["limit of 750 cells", "each of which becomes 4"])
        self.assertNotIn("c.vtu", self.files())


class IndependentCheck(case.Case):
    def test_sections(self):
        if not CHECKER.exists() or subprocess.run(["/usr/bin/python3", "-c", "import meshio, scipy"],
                                                  capture_output=True).returncode:
            self.skipTest("the checker, or meshio, is not here")
        for name, method in itertools.product(("naca0012", "rae2822", "s1223"), ("front", "front-delaunay", "delaunay")):
            with self.subTest(name, method=method):
                path = self.shared(f"airfoil/{name}.dat")
                self.expect(0, "mesh", path, "-o", "c.vtu", "--farfield", "circle:50c", "--require", "min_angle > 25",
                            "--set", f"planar.method={method}")
                checked = subprocess.run(["/usr/bin/python3", CHECKER, self.folder / "c.vtu"], capture_output=True, text=True)
                self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


if __name__ == "__main__":
    unittest.main()
