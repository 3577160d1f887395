#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Curves and points in the volume, edges and points in facets: from a file to a grid that has them, or a refusal."""
import subprocess
import sys
import unittest

import case

CHECKER = case.SHARED.parent / "tools" / "check_mesh.py"
BOX = "g walls\n" + "".join(
    f"f {quad}\n" for quad in ("4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"))
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def box_obj(points, statements):
    return "".join("v %r %r %r\n" % p for p in CORNERS + points) + BOX + statements


def blocks_of(path):
    """Points, and cells by keyword, of a Medit file."""
    words = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    words = " ".join(words).split()
    blocks = {}
    for keyword, width in (("Vertices", 4), ("Edges", 3), ("Triangles", 4), ("Tetrahedra", 5), ("RequiredVertices", 1)):
        if keyword not in words:
            continue
        at = words.index(keyword)
        n = int(words[at + 1])
        blocks[keyword] = [tuple(map(float, words[at + 2 + width * i:at + 2 + width * (i + 1)])) for i in range(n)]
    return blocks


def edges_of(cells):
    return {frozenset((c[i], c[j])) for c in cells for i in range(4) for j in range(i)}


class Embedded(case.Case):
    def test_a_wire_and_a_probe_are_in_the_grid(self):
        points = [(0.3, 0.4, 0.5), (0.5, 0.55, 0.45), (0.7, 0.5, 0.6), (0.2, 0.8, 0.3)]
        self.write("box.obj", box_obj(points, "g wire\nl 1 9 10 11\ng probe\np 12\n"))
        self.expect(0, "mesh", "box.obj", "-o", "grid.mesh", "-o", "grid.vtu", "--hmax", "0.2", "--report", "r.json",
                    says="wire (3)")
        self.expect(0, "check", "grid.vtu")
        grid = blocks_of(self.folder / "grid.mesh")
        at = {p[:3]: i + 1 for i, p in enumerate(grid["Vertices"])}
        edges = edges_of(grid["Tetrahedra"])
        chain = [at[p] for p in CORNERS[:1] + points[:3]]
        for a, b in zip(chain, chain[1:]):
            self.assertIn(frozenset((a, b)), edges)
        self.assertEqual([frozenset(e[:2]) for e in grid["Edges"]], [frozenset(e) for e in zip(chain, chain[1:])])
        self.assertEqual(grid["RequiredVertices"], [(at[points[3]],)])
        report = self.report("r.json")
        self.assertEqual(report["recovery"]["curve_edges"], 3)
        self.assertEqual(report["recovery"]["curve_edges_split"], 0)
        self.assertEqual(report["recovery"]["embedded_points"], 1)
        self.assertEqual([c["name"] for c in report["curves"]], ["wire"])
        self.assertEqual([c["num_cells"] for c in report["points"]], [1])

    def test_curves_may_come_in_a_file_of_their_own(self):
        self.write("box.obj", box_obj([], ""))
        self.write("wire.obj", "v 0.2 0.3 0.4\nv 0.6 0.5 0.45\nv 1 1 1\no wire\nl 1 2 3\n")
        self.expect(3, "info", "wire.obj", says="neither faces")
        self.expect(0, "mesh", "box.obj", "wire.obj", "-o", "grid.vtu", says="wire (2)")

    def test_in_a_far_field_what_lies_in_the_body_is_left_out(self):
        points = [(0.3, 0.4, 0.5), (0.5, 0.55, 0.45), (2.0, 0.5, 0.5), (2.5, 0.6, 0.5)]
        self.write("box.obj", box_obj(points, "g inner\nl 9 10\ng wake\nl 11 12\n"))
        result = self.expect(0, "mesh", "box.obj", "-o", "grid.vtu", "--farfield", "box:5c", "--report", "r.json")
        self.assertIn("curve 'inner'", result.stdout + result.stderr)
        self.assertEqual([c["name"] for c in self.report("r.json")["curves"]], ["wake"])

    def test_what_is_not_valid_is_refused_with_its_place(self):
        for name, points, statements, kind, place in (
                ("through", [(0.25, 0.5, 0.5), (0.25, 0.5, 1.5)], "l 9 10\n", "curves_through_facets", "(0.25, 0.5, 1)"),
                ("crossing", [(0.25, 0.5, 0.5), (0.75, 0.5, 0.5), (0.5, 0.25, 0.5), (0.5, 0.75, 0.5)], "l 9 10\nl 11 12\n",
                 "crossing_curves", "(0.5, 0.5, 0.5)"),
                ("flat", [(0.25, 0.5, 0.5), (0.25, 0.5, 0.5)], "l 9 10\n", "degenerate_curves", "(0.25, 0.5, 0.5)"),
                ("on_facet", [(0.25, 0.5, 1)], "p 9\n", "points_on_facets", "(0.25, 0.5, 1)"),
                ("on_curve", [(0.25, 0.5, 0.5), (0.75, 0.5, 0.5), (0.5, 0.5, 0.5)], "l 9 10\np 11\n",
                 "points_on_curves", "(0.5, 0.5, 0.5)")):
            with self.subTest(name):
                self.write(f"{name}.obj", box_obj(points, statements))
                self.expect(3, "mesh", f"{name}.obj", "-o", f"{name}.vtu", "--report", "r.json", says=place)
                self.assertFalse((self.folder / f"{name}.vtu").exists())
                self.assertTrue((self.folder / f"{name}_defects.vtp").exists())
                errors = [f["kind"] for f in self.report("r.json")["surface"]["findings"] if f["severity"] == "error"]
                self.assertEqual(errors, [kind])
                self.expect(3, "check", f"{name}.obj", says=kind)


class DanglingFacets(case.Case):
    def test_the_shared_file(self):
        path = self.shared("plc/plc_dangling_facets.poly")
        self.expect(0, "mesh", path, "-o", "grid.vtu", "--report", "r.json")
        self.assertEqual(self.report("r.json")["recovery"]["steiner_left"], 0)
        if not CHECKER.exists():
            self.skipTest("check_mesh.py not found")
        done = subprocess.run(["/usr/bin/python3", CHECKER, self.folder / "grid.vtu"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_edges_and_points_in_a_facet_are_on_the_surface(self):
        inside = [(0.25, 0.25, 1), (0.5, 0.3, 1), (0.6, 0.6, 1), (0.8, 0.7, 1), (0.2, 0.8, 1), (0.5, 0.5, 0.3)]
        points = CORNERS + inside
        lines = [f"{len(points)} 3 0 0"] + [f"{i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(points)]
        lines += ["7 1", "1 0 1", "4 4 3 2 1", "5 0 2", "4 5 6 7 8", "2 5 9", "2 9 10", "2 11 12", "1 13"]
        lines += ["1 0 3", "4 1 2 6 5", "1 0 3", "4 2 3 7 6", "1 0 3", "4 3 4 8 7", "1 0 3", "4 4 1 5 8"]
        lines += ["1 0 7", "2 14 9", "0", "0"]
        self.write("box.poly", "\n".join(lines) + "\n")
        self.expect(0, "mesh", "box.poly", "-o", "grid.mesh", "-o", "grid.vtu", "--report", "r.json")
        self.expect(0, "check", "grid.vtu")
        grid = blocks_of(self.folder / "grid.mesh")
        at = {p[:3]: i + 1 for i, p in enumerate(grid["Vertices"])}
        on_surface = {frozenset((t[i], t[j])) for t in grid["Triangles"] for i in range(3) for j in range(i)}
        for a, b in ((4, 8), (8, 9), (10, 11)):
            self.assertIn(frozenset((at[points[a]], at[points[b]])), on_surface)
        self.assertIn(at[points[12]], {v for t in grid["Triangles"] for v in t[:3]})
        self.assertIn(frozenset((at[points[13]], at[points[8]])), edges_of(grid["Tetrahedra"]))
        recovery = self.report("r.json")["recovery"]
        self.assertEqual((recovery["curve_edges"], recovery["curve_edges_inside"]), (4, 1))


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
