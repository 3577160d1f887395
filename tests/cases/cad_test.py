#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CAD files on the command line: a part becomes a grid, with its unit and names; without the module it is said what to do."""
import json
import os
import sys
import unittest

import case


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


if __name__ == "__main__":
    sys.exit(unittest.main())
