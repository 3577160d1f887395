#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What is written: complete files or none, reports, gates, other formats, the same bytes for any number of threads."""
import os
import resource
import subprocess
import unittest

import case


class CannotWrite(case.Case):
    def setUp(self):
        super().setUp()
        self.write("ball.stl", case.stl_binary(case.sphere_triangles(3)))

    def test_places_where_no_file_can_be(self):
        self.write("file", "text")
        for out in ("file/below.vtu", "nofolder/grid.vtu", "file/case/"):
            with self.subTest(out):
                self.expect(7, "mesh", "ball.stl", "-o", out, says=out.rstrip("/"))
        self.expect(7, "mesh", "ball.stl", "-o", "grid.vtu", "--report", "nofolder/r.json", says="nofolder/r.json")
        self.expect(7, "convert", "ball.stl", "nofolder/ball.obj")
        self.assertEqual(self.files(), ["ball.stl", "file"])

    def test_read_only_folder(self):
        locked = self.folder / "locked"
        locked.mkdir(mode=0o555)
        drop = None
        if os.geteuid() == 0:  # root may write everywhere: be nobody for this
            self.folder.chmod(0o755)
            drop = lambda: os.setuid(65534)
        try:
            self.expect(7, "mesh", "ball.stl", "-o", "locked/grid.vtu", says="locked/grid.vtu", preexec_fn=drop)
        finally:
            locked.chmod(0o755)
        self.assertEqual(self.files(), ["ball.stl", "locked"])

    def test_a_file_that_must_not_grow_leaves_the_old_one(self):
        self.write("grid.vtu", "precious")

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        self.expect(7, "mesh", "ball.stl", "-o", "grid.vtu", says="grid.vtu", preexec_fn=limit)
        self.assertEqual((self.folder / "grid.vtu").read_text(), "precious")
        self.assertEqual(self.files(), ["ball.stl", "grid.vtu"])

    def test_a_device_that_is_always_full(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full here")
        self.expect(7, "mesh", "ball.stl", "-o", "/dev/full", "--format", "vtu", says="/dev/full")


class FullDisk(case.Case):
    def test_a_full_disk_leaves_nothing_half_written(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True, text=True)
        if mount.returncode:
            self.skipTest(f"cannot mount a small tmpfs (needs root): {mount.stderr.strip()}")
        self.addCleanup(subprocess.run, ["umount", disk], check=False)
        self.write("ball.stl", case.stl_binary(case.sphere_triangles(4)))
        self.write("disk/old.vtu", "precious")
        for out in ("new.vtu", "old.vtu", "foam/", "new.vtkhdf", "new.xdmf", "new.cgns", "new.e", "new.b8.ugrid"):
            with self.subTest(out):
                self.expect(7, "mesh", "ball.stl", "-o", f"disk/{out}", says=f"disk/{out.rstrip('/').split('.')[0]}")
                self.assertEqual(os.listdir(disk), ["old.vtu"])
                self.assertEqual((disk / "old.vtu").read_text(), "precious")


class FilesBeside(case.Case):
    """The .h5 of an XDMF, the .mapbc of a UGRID: never written over what a run reads, or writes else."""

    def setUp(self):
        super().setUp()
        self.write("box.stl", case.stl_ascii(case.box_triangles()))
        self.expect(0, "mesh", "box.stl", "-o", "box.xdmf", "-o", "box.vtkhdf", "-o", "box.mesh")
        self.before = {file: (self.folder / file).read_bytes() for file in self.files()}

    def check_nothing_changed(self):
        self.assertEqual({file: (self.folder / file).read_bytes() for file in self.files()}, self.before)

    def test_inputs_are_kept(self):
        for words in (("refine", "box.xdmf", "-o", "box.xmf"), ("mesh", "box.xdmf", "-o", "box.xmf"),
                      ("convert", "box.xdmf", "box.h5", "--format", "exodus"), ("convert", "box.xdmf", "box.xmf")):
            with self.subTest(words):
                self.expect(2, *words, says="box.h5")
                self.check_nothing_changed()

    def test_files_of_one_run_differ(self):
        for words in (("mesh", "box.stl", "-o", "other.xdmf", "--report", "other.h5"),
                      ("mesh", "box.stl", "-o", "other.ugrid", "--report", "other.mapbc"),
                      ("mesh", "box.stl", "-o", "other.xdmf", "-o", "other.xmf"),
                      ("convert", "box.vtkhdf", "other.h5", "--format", "xdmf")):
            with self.subTest(words):
                self.expect(2, *words, says="other.")
                self.check_nothing_changed()


class Outputs(case.Case):
    def setUp(self):
        super().setUp()
        self.write("box.stl", case.stl_ascii(case.box_triangles()))

    def test_every_format_is_written_and_read_back(self):
        names = ["box.vtu", "box.msh", "box.mesh", "box.su2", "foam/"]
        self.expect(0, "mesh", "box.stl", *[x for name in names for x in ("-o", name)], "--report", "r.json")
        self.assertEqual(self.report("r.json")["files_written"], names)
        volume = self.report("r.json")["quality"]["volume"]
        for name in names:
            with self.subTest(name):
                self.expect(0, "check", name, "--json", "check.json")
                self.assertAlmostEqual(self.report("check.json")["quality"]["volume"], volume, delta=1e-12)
                self.expect(0, "convert", name, "again.vtu")
                self.expect(0, "check", "again.vtu", says="body")
        for file in ("points", "faces", "owner", "neighbour", "boundary"):
            self.assertTrue((self.folder / "foam/constant/polyMesh" / file).exists(), file)

    def test_report_holds_what_a_front_end_needs(self):
        self.expect(0, "mesh", "box.stl", "-o", "box.vtu", "--report", "r.json", "--set", "boundaries.body.kind=wall")
        report = self.report("r.json")
        self.assertEqual((report["outcome"], report["exit_code"], report["error"]), ("done", 0, None))
        self.assertRegex(report["inputs"][0]["hash"], r"^fnv1a64:[0-9a-f]{16}$")
        [body] = report["boundaries"]
        self.assertAlmostEqual(body.pop("measure"), 6, places=9)
        self.assertEqual(body, {"name": "body", "kind": "wall", "colour": "", "num_cells": 12})
        self.assertEqual(report["surface"]["num_triangles"], 12)
        self.assertGreater(report["peak_memory_bytes"], 1e6)
        self.assertIn("write", [stage["stage"] for stage in report["stages"]])
        measure = report["quality"]["measures"]["min_dihedral"]
        self.assertEqual(sum(measure["histogram"]["counts"]), report["quality"]["num_cells"])
        self.assertEqual(report["options"]["boundaries"]["body"]["kind"], "wall")

    def test_a_gate_that_is_not_met_is_exit_5_with_the_grid_written(self):
        self.expect(5, "mesh", "box.stl", "-o", "box.vtu", "--require", "min_dihedral > 89", "--report", "r.json",
                    says="min_dihedral")
        self.assertEqual(self.report("r.json")["exit_code"], 5)
        self.assertEqual(self.report("r.json")["defects_file"], "box_defects.vtp")
        shown = (self.folder / "box_defects.vtp").read_text(errors="replace")
        self.assertIn("kind:gate_min_dihedral", shown)
        self.assertIn('NumberOfVerts="6"', shown)
        self.assertIn('NumberOfPolys="24"', shown)  # the faces of six cells
        self.expect(5, "check", "box.vtu", "--require", "min_dihedral > 89", "--defects", "check.vtp")
        self.assertIn("kind:gate_min_dihedral", (self.folder / "check.vtp").read_text(errors="replace"))
        self.expect(0, "check", "box.vtu", "--require", "min_dihedral > 1")
        self.expect(5, "check", "box.vtu", "--require", "min_dihedral > 89")

    def test_units(self):
        self.expect(0, "mesh", "box.stl", "-o", "box.vtu", "--units", "m", "--output-units", "mm")
        self.expect(0, "info", "box.vtu", "--json", "info.json")
        self.assertAlmostEqual(self.report("info.json")["quality"]["volume"], 1e9, delta=1)

    def test_stopping_early(self):
        self.expect(0, "mesh", "box.stl", "--stop-after", "geometry", says="12")
        self.assertEqual(self.files(), ["box.stl"])
        self.expect(0, "mesh", "box.stl", "-o", "far.vtp", "--farfield", "sphere:5c", "--stop-after", "surface")
        self.expect(0, "info", "far.vtp", says="farfield")

    def test_limits(self):
        self.write("ball.stl", case.stl_binary(case.sphere_triangles(4)))
        for limit in (["--max-cells", "100"], ["--time-limit", "0.001"], ["--memory-limit", "1MB"]):
            with self.subTest(limit):
                self.expect(6, "mesh", "ball.stl", "-o", "ball.vtu", *limit,
                            says=["limit of", limit[0], "--hmax", "nothing was written"])
        self.assertEqual(self.files(), ["ball.stl", "box.stl"])

    def test_what_a_format_loses_is_a_warning(self):
        self.expect(0, "mesh", "box.stl", "-o", "box.vtu", "--set", "boundaries.body.kind=inlet")
        for name in ("box.su2", "box.msh", "box.obj", "foam/"):
            with self.subTest(name):
                said = self.expect(0, "convert", "box.vtu", name).stderr
                self.assertIn("warning: ", said)
                self.assertIn("the boundary kind of 1 group is left out (inlet)", case.unbroken(said))
        self.write("square.poly", "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n4 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n0\n")
        self.expect(0, "mesh", "square.poly", "-o", "square.vtu")
        self.expect(0, "convert", "square.vtu", "square.stl", says="the boundary, ")
        self.assertEqual(self.expect(0, "convert", "box.vtu", "box.mesh").stderr, "")
        self.expect(0, "info", "box.mesh", says="body (12, inlet)")

    def test_a_case_is_not_written_over_itself(self):
        self.expect(0, "mesh", "box.stl", "-o", "foam/")
        self.expect(2, "mesh", "foam", "-o", "foam/", says="written over")
        self.expect(2, "convert", "foam/", "foam/", says="overwritten")
        self.expect(0, "info", "foam", says="body (12, patch)")

    def test_progress_does_not_look_like_a_failure(self):
        said = self.expect(0, "mesh", "box.stl", "-o", "box.vtu", "--progress", "bar").stderr
        self.assertIn("1 file", said)
        self.assertNotIn("0 of", said)

    def test_far_field(self):
        self.expect(0, "mesh", "box.stl", "-o", "out.vtu", "--farfield", "box:3c", "--report", "r.json")
        report = self.report("r.json")
        self.assertAlmostEqual(report["quality"]["volume"], 6**3 - 1, delta=1e-6)
        self.assertEqual({b["name"]: b["kind"] for b in report["boundaries"]}, {"body": "wall", "farfield": "farfield"})


class Threads(case.Case):
    def test_the_same_bytes_for_any_number_of_threads(self):
        self.write("ball.stl", case.stl_binary(case.sphere_triangles(3)))
        grids = []
        for threads in (1, 2, 8):
            self.expect(0, "mesh", "ball.stl", "-o", "ball.vtu", "--growth", "1.3", "-j", threads)
            grids.append((self.folder / "ball.vtu").read_bytes())
        self.assertEqual(grids[0], grids[1])
        self.assertEqual(grids[0], grids[2])


if __name__ == "__main__":
    unittest.main()
