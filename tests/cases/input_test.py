#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bad input is refused with what and where (exit 3); odd but valid input is gridded."""
import re
import struct
import unittest

import case


class BadInput(case.Case):
    def expect_refused(self, name, says=(), defects=False):
        """mesh, info and check all say no; mesh leaves a defects file where there are places, and nothing else."""
        before = self.files()
        said = ""
        for command in (["mesh", name, "-o", "out.vtu"], ["info", name], ["check", name]):
            result = self.expect(3, *command)
            said += result.stdout + result.stderr
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, said)
        shown = self.folder / "out_defects.vtp"
        self.assertEqual(shown.exists(), defects)
        shown.unlink(missing_ok=True)
        self.assertEqual(self.files(), before)

    def test_missing_file(self):
        self.expect_refused("nothere.stl", says="nothere.stl")

    def test_a_folder(self):
        (self.folder / "folder.stl").mkdir()
        self.expect_refused("folder.stl", says="folder.stl")

    def test_empty_files_of_every_type(self):
        for extension in ("stl", "obj", "ply", "off", "vtu", "vtp", "msh", "mesh", "su2"):
            with self.subTest(extension):
                self.expect_refused(self.write(f"empty.{extension}", b""), says="empty")

    def test_truncated_binary_stl(self):
        data = case.stl_binary(case.sphere_triangles(2))
        for keep in (84 + 50 * 200 + 13, 84, 83, 80, 5):
            with self.subTest(keep):
                self.expect_refused(self.write("cut.stl", data[:keep]))
        self.write("cut.stl", data[: 84 + 50 * 200 + 13])
        self.expect(3, "info", "cut.stl", says=["320", "200"])

    def test_header_that_claims_four_billion_triangles(self):
        data = case.stl_binary(case.box_triangles(), count=0xFFFFFFFF)
        self.expect_refused(self.write("claims.stl", data), says="4294967295")

    def test_nan_and_infinity(self):
        for value in (float("nan"), float("inf"), float("-inf")):
            with self.subTest(value):
                data = bytearray(case.stl_binary(case.box_triangles()))
                data[84 + 12 : 84 + 16] = struct.pack("<f", value)
                self.expect_refused(self.write("nan.stl", bytes(data)), says="finite", defects=True)

    def test_obj_with_an_index_out_of_range(self):
        for face in ("f 1 2 4", "f 1 2 -4", "f 1 2 0", "f 1 2 99999999999999999999"):
            with self.subTest(face):
                self.expect_refused(self.write("bad.obj", f"v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n"), says="4")

    def test_one_triangle(self):
        self.write("one.stl", case.stl_ascii([((0, 0, 0), (1, 0, 0), (0, 1, 0))]))
        self.expect_refused("one.stl", says="open_edges", defects=True)

    def test_box_with_a_hole(self):
        self.write("open.stl", case.stl_ascii(case.box_triangles()[:-1]))
        self.expect_refused("open.stl", says=["open_edges", "out_defects.vtp"], defects=True)

    def test_defects_are_drawn_as_edges_and_triangles(self):
        self.write("open.stl", case.stl_ascii(case.box_triangles()[:-1]))
        self.expect(3, "check", "open.stl", "--defects", "open.vtp")
        self.assertIn('NumberOfLines="3"', (self.folder / "open.vtp").read_text(errors="replace"))
        crossing = case.box_triangles() + case.box_triangles((0.5, 0.4, 0.3), (1.5, 1.4, 1.3))
        self.write("cross.stl", case.stl_ascii(crossing))
        self.expect(3, "mesh", "cross.stl", "-o", "cross.vtu")
        drawn = re.search(r'NumberOfPolys="(\d+)"', (self.folder / "cross_defects.vtp").read_text(errors="replace"))
        self.assertGreater(int(drawn[1]), 6)
        self.assertLessEqual(int(drawn[1]), len(crossing))

    def test_defects_of_an_earlier_run_do_not_stay_beside_a_good_grid(self):
        self.write("body.stl", case.stl_ascii(case.box_triangles()[:-1]))
        self.expect(3, "mesh", "body.stl", "-o", "out.vtu")
        self.assertIn("out_defects.vtp", self.files())
        self.write("body.stl", case.stl_ascii(case.box_triangles()))
        self.expect(0, "mesh", "body.stl", "-o", "out.vtu")
        self.assertEqual(self.files(), ["body.stl", "out.vtu"])
        self.write("out_defects.vtp", "mine, not yours")
        self.expect(0, "mesh", "body.stl", "-o", "out.vtu")
        self.assertEqual((self.folder / "out_defects.vtp").read_text(), "mine, not yours")

    def test_boxes_that_cross(self):
        crossing = case.box_triangles() + case.box_triangles((0.5, 0.4, 0.3), (1.5, 1.4, 1.3))
        self.write("cross.stl", case.stl_ascii(crossing))
        self.expect_refused("cross.stl", says="self_intersection", defects=True)

    def test_klein_bottle(self):
        self.write("klein.stl", case.stl_ascii(case.klein_bottle_triangles()))
        self.expect_refused("klein.stl", says="self_intersection", defects=True)
        self.expect(3, "check", "klein.stl", says=["self_intersection", "non_orientable_shell"])

    def test_text_that_is_no_geometry(self):
        for extension in ("stl", "obj", "ply", "off", "vtu", "vtp", "msh", "mesh", "su2"):
            with self.subTest(extension):
                self.expect_refused(self.write(f"text.{extension}", "The quick brown fox\n" * 20))

    def test_a_failed_run_is_reported(self):
        self.write("open.stl", case.stl_ascii(case.box_triangles()[:-1]))
        self.expect(3, "mesh", "open.stl", "-o", "out.vtu", "--report", "r.json", "--defects", "d.vtp")
        report = self.report("r.json")
        self.assertEqual(report["exit_code"], 3)
        self.assertEqual(report["outcome"], "bad_input")
        self.assertEqual(report["defects_file"], "d.vtp")
        kinds = {f["kind"]: f for f in report["surface"]["findings"]}
        self.assertEqual(kinds["open_edges"]["count"], 3)
        self.assertTrue(report["places"])
        self.assertEqual(self.files(), ["d.vtp", "open.stl", "r.json"])


class OddInput(case.Case):
    """Valid, if unusual: gridded, with the volume it must have."""

    def grid(self, triangles, volume, *flags, regions=1, relative=1e-9):
        self.write("odd.stl", case.stl_ascii(triangles))
        self.expect(0, "mesh", "odd.stl", "-o", "odd.vtu", "--report", "odd.json", *flags)
        report = self.report("odd.json")
        self.assertAlmostEqual(report["quality"]["volume"] / volume, 1, delta=relative)
        self.assertEqual(len(report["regions"]), regions)
        self.expect(0, "check", "odd.vtu")
        return report

    def test_one_tetrahedron(self):
        report = self.grid(case.tetrahedron_triangles((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)), 1 / 6)
        self.assertEqual(report["recovery"]["steiner_left"], 0)

    def test_two_tetrahedra_that_share_a_vertex(self):
        triangles = case.tetrahedron_triangles((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
        triangles += case.tetrahedron_triangles((0, 0, 0), (-1, 0, 0), (0, 0, -1), (0, -1, 0))
        self.grid(triangles, 2 / 6, regions=2)

    def test_inside_out(self):
        self.grid(case.box_triangles(inside_out=True), 1)

    def test_nested_shells_are_holes_or_regions(self):
        outer = case.box_triangles()
        inner = (0.25, 0.25, 0.25), (0.75, 0.75, 0.75)
        self.grid(outer + case.box_triangles(*inner, inside_out=True), 0.875)
        self.grid(outer + case.box_triangles(*inner), 1, regions=2)

    def test_far_from_the_origin(self):
        self.grid(case.box_triangles((1e6, 1e6, 1e6), (1e6 + 1, 1e6 + 1, 1e6 + 1)), 1)

    def test_a_grid_in_place_of_a_surface_is_said(self):
        self.write("box.stl", case.stl_ascii(case.box_triangles()))
        self.expect(0, "mesh", "box.stl", "-o", "box.vtu")
        self.expect(0, "mesh", "box.vtu", "-o", "again.vtu",
                    says="box.vtu is a grid of 6 cells: they are not used, its 12 stored faces are gridded anew")
        self.assertNotIn("grid of", self.expect(0, "mesh", "box.stl", "-o", "again.vtu").stderr)

    def test_tiny(self):
        self.grid(case.box_triangles((0, 0, 0), (1e-6, 1e-6, 1e-6)), 1e-18)

    def test_scaling_by_a_power_of_two_keeps_the_connectivity(self):
        cells = []
        for scale in (1.0, 2.0**20, 2.0**-20):
            triangles = [[[scale * x for x in p] for p in t] for t in case.sphere_triangles(2)]
            self.write("ball.obj", obj_of(triangles))
            self.expect(0, "mesh", "ball.obj", "-o", "ball.mesh", "--growth", "1.3", "--hmax", repr(0.4 * scale))
            text = (self.folder / "ball.mesh").read_text(errors="replace")
            cells.append(text[text.index("Tetrahedra") :])
        self.assertEqual(cells[0], cells[1])
        self.assertEqual(cells[0], cells[2])


def obj_of(triangles):
    lines = [f"v {p[0]!r} {p[1]!r} {p[2]!r}" for t in triangles for p in t]
    lines += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(triangles))]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    unittest.main()
