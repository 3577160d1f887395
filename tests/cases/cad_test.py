#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CAD files on the command line: a part becomes a grid, with its unit and names; without the module it is said what to do."""
import json
import os
import re
import sys
import unittest
from pathlib import Path

import case
import step_boxes

sys.path.append(str(Path(__file__).resolve().parents[2] / "scripts"))
import damage_cad  # noqa: E402


class CadFiles(case.Case):
    def needs_module(self):
        """Where OpenCASCADE was not there at build time, nothing here can be read."""
        path = self.shared("cad/cube-in.step")
        result = self.run_delfront("info", path)
        if "libdelfront_cad.so is not there" in case.unbroken(result.stderr):
            self.skipTest("the module for CAD files was not built")
        return path

    def test_a_cube_in_inches(self):
        path = self.needs_module()
        self.expect(0, "mesh", path, "-o", "cube.su2", "-o", "cube.vtu", "--report", "cube.json")
        report = self.report("cube.json")
        side = 1000 / 25.4
        self.assertAlmostEqual(report["quality"]["volume"] / side**3, 1, delta=1e-9)
        self.assertEqual([group["name"] for group in report["boundaries"]], ["Cube"])
        self.assertEqual(report["scale"]["metres_per_unit"], 0.0254)
        self.expect(0, "check", "cube.vtu")

    def test_info_says_unit_and_faces(self):
        path = self.needs_module()
        self.expect(0, "info", path, "--json", "cube.json", says=["STEP, 1 solid", "unit           in", "6 faces"])
        geometry = json.loads((self.folder / "cube.json").read_text())["geometry"]
        self.assertEqual(geometry["cad"]["unit"], "in")
        self.assertEqual([face["surface"] for face in geometry["faces"]], ["plane"] * 6)

    def test_angles_are_fair_away_from_sharp_corners(self):
        folder = self.needs_module().parent
        for path in sorted(folder.iterdir()):
            with self.subTest(path.name):
                self.expect(0, "mesh", path, "-o", "grid.vtu", "--stop-after", "surface", "--report", "grid.json")
                last = self.report("grid.json")["geometry"][0]["rounds"][-1]
                self.assertGreater(last["min_angle_away_from_sharp_corners"]["value"], 20)

    def test_a_blade_of_a_loft_is_gridded_round_its_noses(self):
        self.expect(0, "mesh", self.make_cad("propeller", "blade.step"), "-o", "grid.vtu", "--stop-after", "surface",
                    "--report", "grid.json")
        last = self.report("grid.json")["geometry"][0]["rounds"][-1]
        self.assertGreater(last["min_angle_away_from_sharp_corners"]["value"], 20)

    def test_lengths_in_units_need_no_more_said(self):
        path = self.needs_module()
        self.expect(0, "mesh", path, "-o", "cube.stl", "--stop-after", "surface", "--hmax", "100mm", "--report", "cube.json")
        self.assertLess(self.report("cube.json")["surface"]["max_edge"], 1.6 * 100 / 25.4)

    def test_the_files_unit_becomes_that_of_the_output(self):
        path = self.needs_module()
        self.expect(0, "mesh", path, "-o", "cube.obj", "--stop-after", "surface", "--output-units", "m")
        lines = (self.folder / "cube.obj").read_text().splitlines()
        x = [float(line.split()[1]) for line in lines if line.startswith("v ")]
        self.assertAlmostEqual(max(x) - min(x), 1, delta=1e-9)
        pump = self.shared("cad/Pump_TopCover.brep")  # says none
        self.expect(2, "mesh", pump, "-o", "pump.obj", "--stop-after", "surface", "--output-units", "m", says="--units")
        self.assertEqual(self.files(), ["cube.obj"])

    def test_an_open_sheet_is_said_and_gridded(self):
        self.needs_module()
        path = self.shared("cad/tigl_nacelle.stp")
        result = self.run_delfront("mesh", path, "-o", "sheet.vtu", "--stop-after", "surface")
        self.assertIn("4 edges bound one face only", case.unbroken(result.stderr))
        self.assertEqual(result.returncode, 0)

    def test_without_the_module(self):
        path = self.write("part.step", "ISO-10303-21;\n")
        nowhere = dict(os.environ, DELFRONT_CAD_MODULE="/nowhere/libdelfront_cad.so")
        self.expect(3, "info", path, env=nowhere, says=["part.step is a CAD file", "/nowhere/libdelfront_cad.so cannot be"])
        self.expect(3, "mesh", path, "-o", "part.su2", env=nowhere, says="cannot be loaded")
        self.assertEqual(self.files(), ["part.step"])

    def test_damaged_files(self):
        self.needs_module()
        for name, content, says in (("cut.step", "ISO-10303-21;\nHEADER;\n", "not whole"),
                                    ("text.step", "hello", "no STEP file"), ("empty.igs", "", "empty"),
                                    ("text.igs", "hello", "no IGES file"), ("text.brep", "hello", "no BREP file")):
            self.write(name, content)
            self.expect(3, "mesh", name, "-o", "part.su2", says=[name, says])
        self.expect(3, "mesh", "nowhere.step", "-o", "part.su2", says="no such file")

    def test_an_assembly_has_its_parts_as_regions(self):
        self.needs_module()
        parts = [("shaft", [(0, 0, 0)]), ("nut", [(1, 0, 0), (2, 0, 0)]), ("box (2) of", [(0, 1, 0)])]
        step_boxes.write_assembly(self.folder / "parts.step", parts)
        for hmax in ("0.5", "0.23"):
            self.expect(0, "mesh", "parts.step", "-o", "parts.vtu", "-o", "parts.msh", "--hmax", hmax, "--report", "r.json")
            regions = self.report("r.json")["regions"]
            self.assertEqual([group["name"] for group in regions], ["shaft", "nut", "nut_2", "box (2) of"])
            self.expect(0, "check", "parts.vtu")
            names = re.findall(r'^3 \d+ "(.*)"$', (self.folder / "parts.msh").read_bytes().decode("latin-1"), re.M)
            self.assertEqual(names, [group["name"] for group in regions])
        self.expect(0, "info", "parts.step", says=["4 solids", "imprinted", "nut"])

    def test_damaged_copies_are_read_or_refused_by_name(self):
        self.needs_module()
        source = self.folder / "whole.step"
        step_boxes.write_assembly(source, [("left", [(0, 0, 0)]), ("right", [(1, 0, 0)])])
        for k in range(40):
            self.write("damaged.step", damage_cad.damaged(source.read_bytes(), k))
            result = self.run_delfront("info", "damaged.step", "-q")
            self.assertIn(result.returncode, (0, 3, 6), (k, result.stderr))
            self.assertTrue(result.returncode == 0 or "damaged.step" in result.stderr, (k, result.stderr))

    def test_info_of_an_open_sheet_is_quick_and_says_where(self):
        self.needs_module()
        path = self.shared("cad/tigl_nacelle.stp")
        result = self.run_delfront("info", path, "--json", "sheet.json")
        self.assertEqual(result.returncode, 3)
        self.assertIn("is an open sheet with 4 free edges", case.unbroken(result.stderr))
        cad = json.loads((self.folder / "sheet.json").read_text())["geometry"]["cad"]
        self.assertEqual(len(cad["open_at"]), 4)
        self.assertEqual(cad["coordinates"], "in mm, as the file says")


if __name__ == "__main__":
    sys.exit(unittest.main())
