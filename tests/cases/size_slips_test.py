#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Slips in what is asked of sizes: each is answered with file and line, what is wrong, what is allowed."""
import unittest

import case

INPUT = '[input]\nfiles = ["square.poly"]\n'  # two lines, so what follows stands in line 3 and on


def square(n=4):
    """A square of side 2 round the origin, n segments a side, as .poly; its curve is patch_1."""
    ring = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    points = [(a[0] + (b[0] - a[0]) * i / n, a[1] + (b[1] - a[1]) * i / n)
              for a, b in zip(ring, ring[1:] + ring[:1]) for i in range(n)]
    lines = [f"{len(points)} 2 0 0", *(f"{i} {x} {y}" for i, (x, y) in enumerate(points)), f"{len(points)} 1",
             *(f"{i} {i} {(i + 1) % len(points)} 1" for i in range(len(points))), "0"]
    return "\n".join(lines) + "\n"


def background(sizes=(0.1, 0.1, 0.1, 0.1), shift=0.0):
    """Two triangles over a square of side 4, moved along x, with the node field h: MSH 2.2."""
    corners = [(-2 + shift, -2), (2 + shift, -2), (2 + shift, 2), (-2 + shift, 2)]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", "4",
             *(f"{i + 1} {x} {y} 0" for i, (x, y) in enumerate(corners)), "$EndNodes", "$Elements", "2",
             "1 2 2 1 1 1 2 3", "2 2 2 1 1 1 3 4", "$EndElements", "$NodeData", "1", '"h"', "1", "0", "3",
             "0", "1", "4", *(f"{i + 1} {h}" for i, h in enumerate(sizes)), "$EndNodeData"]
    return "\n".join(lines) + "\n"


def point_source(*lines):
    return "\n".join(['[[size.source]]', 'type = "point"', "at = [0, 0]", *lines])


class SizeSlips(case.Case):
    def setUp(self):
        super().setUp()
        self.write("square.poly", square())

    def refuse(self, code, job, line, *says):
        """The job ends with that code; the message begins with the line and says all of that."""
        self.write("case.toml", INPUT + job + "\n")
        self.expect(code, "mesh", "case.toml", "-o", "a.vtu", says=[f"case.toml:{line}: ", *says])
        self.assertNotIn("a.vtu", self.files())

    def test_sizes_are_positive(self):
        self.refuse(2, "[size]\nhmax = -1", 4, "size.hmax", "-1", "not positive")
        self.refuse(2, "[size]\nhmax = nan", 4, "size.hmax", "nan")
        self.refuse(2, "[size.on.patch_1]\nh = 0", 4, "size.on.patch_1.h", "not positive")
        self.refuse(2, point_source("delta0 = -0.1"), 6, "size.source[0].delta0", "not positive")
        self.refuse(2, "[[size.box]]\nmin = [0, 0]\nmax = [1, 1]\nh = -0.1", 6, "size.box[0].h", "not positive")

    def test_limits_agree(self):
        self.refuse(2, "[size]\nhmin = 1\nhmax = 0.5", 4, "size.hmin: 1 is above size.hmax", "0.5", "case.toml:5")
        self.refuse(2, "[size]\ngrowth = 1", 4, "size.growth", "a number over 1")

    def test_laws_make_sense(self):
        self.refuse(2, point_source("delta0 = 0.1", "r1 = 0"), 7, "size.source[0].r1", "not positive")
        self.refuse(2, point_source("delta0 = 0.1", "r0 = -1"), 7, "size.source[0].r0", "which is negative")
        self.refuse(2, point_source("delta0 = 0.1", "r1 = 1", "law = { gamma = 0 }"), 3, "gamma = 0", "a number > 0")
        self.refuse(2, point_source("delta0 = 0.1", "r1 = 1", 'law = { type = "polynomial", coefficients = [1, -1] }'), 3,
                    "size.source[0]", "coefficients = [1, -1]", "decreases near rho", "a law must not decrease")
        self.refuse(2, point_source("delta0 = 0.1", "r1 = 1", 'law = "polynomial"'), 3, "a polynomial needs coefficients")

        self.refuse(2, point_source("delta0 = 0.1", "law = { gamma = 2 }"), 3, "r1 is missing")
        self.refuse(2, point_source("delta0 = 0.1", 'file = "a.stl"'), 3, "file is of sources of type surface")

    def test_sources_are_whole(self):
        self.refuse(2, point_source(), 3, "size.source[0]", "delta0 is missing")
        self.refuse(2, '[[size.source]]\ntype = "pont"', 4, "size.source[0].type", "did you mean 'point'?")
        self.refuse(2, '[[size.source]]\ndelta0 = 1', 3, "type is missing", "polyline")
        self.refuse(2, '[[size.source]]\ntype = "line"\nat = [0, 0]\ndelta0 = 1', 3, "a line has 2 points, got 1")
        self.refuse(2, point_source("delta = 0.1"), 6, "unknown key 'size.source[0].delta'", "did you mean 'delta0'?")
        self.refuse(2, point_source("delta0 = 0.1", "motion = { rate = 30 }"), 3, "size.source[0]", "no axis")
        self.refuse(2, point_source("delta0 = 0.1", "stretch = { s1 = 0 }"), 3, "size.source[0]", "positive")

    def test_boxes_are_whole(self):
        self.refuse(2, "[[size.box]]\nmin = [0, 0]\nmax = [1, 2]\nradius_to = 1\nh = 1", 3, "radius_to is of cones")
        self.refuse(2, "[[size.box]]\nmin = [1, 1]\nmax = [0, 2]\nh = 1", 3, "min is above max along x")
        self.refuse(2, "[[size.box]]\nmin = [0, 0]\nmax = [1, 1]", 3, "h is missing")
        self.refuse(2, '[[size.box]]\nshape = "sphere"\ncentre = [0, 0]\nh = 1', 3, "radius is missing")

    def test_names_exist(self):
        self.refuse(2, "[size.on.wing]\nh = 0.1", 3, "size.on.wing", "no patch, curve or corner", "patch_1")
        self.refuse(2, "[size]\nexpression = 'distance(\"wing\")'", 4, "no patch, curve or corner", "patch_1")
        self.refuse(2, '[size]\nwithout = ["wak"]\n' + point_source("delta0 = 0.1", 'group = "wake"'), 4,
                    "size.without", "did you mean 'wake'?")

    def test_formulas_have_values(self):
        self.refuse(2, '[size]\nexpression = "0.1 + * x"', 4, "column 7", "expected a number, a name or (")
        self.refuse(2, '[size]\nexpression = "0.1 + r"', 4, "column 7", "unknown name 'r'")
        self.refuse(2, '[size]\nexpression = "0.1 + (x - 0.125)/(x - 0.125)"', 4, "gives nan at (0.125, ")
        self.refuse(2, '[size]\nexpression = "0.1*x"', 4, "sizes must be positive")

    def test_the_formula_at_fault_is_named(self):
        job = '[size.expression]\ndelta = "0.1"\n'
        self.refuse(2, job + 's1 = "-1"', 5, "size.expression.s1: expression '-1' gives -1", "stretchings must be positive")
        self.refuse(2, job + 's1 = "2"\ns2 = "y"', 6, "size.expression.s2: expression 'y'", "stretchings must be positive")
        self.refuse(2, job + 's1 = "1 +"', 5, "size.expression.s1: expression '1 +'")
        self.refuse(2, job + 's1 = "2"\nfirst = ["x", "y", "0"]', 6, "size.expression.first: direction 'first'", "length 0")
        self.refuse(2, job + 's1 = "2"\nfirst = ["1", "r", "0"]', 6, "size.expression.first", "unknown name 'r'")
        self.refuse(2, job + 's1 = "distance(\\"wing\\")"', 5, "size.expression.s1", "no patch, curve or corner")

    def test_backgrounds_hold_sizes(self):
        self.write("nan.msh", background((0.1, 0.1, "nan", 0.1)))
        self.write("negative.msh", background((0.1, 0.1, 0.1, -1)))
        self.write("good.msh", background())
        self.refuse(3, '[size]\nbackground = "none.msh"', 4, "none.msh")
        self.refuse(2, '[size]\nbackground = { file = "good.msh", size = "g" }', 4, "no node field 'g'", "'h'")
        self.refuse(3, '[size]\nbackground = "negative.msh"', 4, "node 3 at (-2, 2, 0)", "-1", "positive")
        self.refuse(3, '[size]\nbackground = "nan.msh"', 4, "nan")

    def test_backgrounds_lie_where_the_grid_is(self):
        self.write("away.msh", background(shift=10))
        self.refuse(3, '[size]\nbackground = "away.msh"', 4, "no place in common", "units")
        for shift, is_warned in ((0, False), (2, True)):  # moved by 2 it covers x > 0: half of the square's outline
            self.write("moved.msh", background(shift=shift))
            self.write("case.toml", INPUT + '[size]\nbackground = "moved.msh"\n')
            said = case.unbroken(self.expect(0, "mesh", "case.toml", "-o", "a.vtu").stderr)
            self.assertEqual(is_warned, "about 50 % of the boundary lies outside of moved.msh" in said, said)

    def test_solutions_are_named(self):
        self.write("flow.msh", background())
        job = '[size.solution]\nfile = "flow.msh"\n'
        self.refuse(2, job + 'sensor = ["Mach"]\ncomplexity = 100', 4, "no node field 'Mach'", "'h'")
        self.refuse(2, job + "complexity = 100", 4, "no sensor")
        self.refuse(2, job + 'sensor = ["h"]', 4, "complexity")


class SizeSurvey(case.Case):
    def test_a_cube_of_even_squares_is_whole(self):
        """Rays through edges: every place of such a cube lies in line with some."""
        n, triangles = 4, []
        for axis in range(3):
            for side in (0, 1):
                for i in range(n):
                    for j in range(n):
                        def corner(a, b):
                            p = [0, 0, 0]
                            p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, a / n, b / n
                            return tuple(p)
                        quad = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
                        quad = quad if side else quad[::-1]
                        triangles += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
        self.write("cube.stl", case.stl_ascii(triangles))
        self.expect(0, "estimate", "cube.stl", "--size", "0.1 + 0.1*x", "--report", "estimate.json")
        self.assertAlmostEqual(self.report("estimate.json")["estimate"]["measure"], 1, places=9)

    def test_a_formula_is_asked_within_the_domain_only(self):
        """It is below 0 beyond the slab; its corners, all of the least size, say nothing of the middle."""
        self.write("slab.poly", "4 2 0 0\n0 -1 -0.5\n1 1 -0.5\n2 1 0.5\n3 -1 0.5\n"
                   "4 1\n0 0 1 1\n1 1 2 1\n2 2 3 1\n3 3 0 1\n0\n")
        for job in (["mesh", "-o", "a.vtu"], ["sizes", "-o", "s.vtu"], ["estimate"]):
            self.expect(0, *job, "slab.poly", "--size", "0.55 - abs(y)", "--set", "planar.boundary=split")
        self.expect(0, "estimate", "slab.poly", "--size", "0.55 - abs(y)", "--set", "planar.boundary=split", "--report",
                    "e.json")
        self.assertGreater(self.report("e.json")["estimate"]["greatest_size"], 0.1)


if __name__ == "__main__":
    unittest.main()
