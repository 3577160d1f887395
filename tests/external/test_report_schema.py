# SPDX-License-Identifier: Apache-2.0
"""docs/report.schema.json describes what --report writes: reports of jobs of all kinds, and nothing else.

    test_report_schema.py DELFRONT

Exit 77 where Debian's python3-jsonschema is not there.
"""
import copy
import json
import math
import os
import pathlib
import sys
import unittest

try:
    import jsonschema
except ImportError:
    jsonschema = None

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT / "tests" / "cases"))
import case  # noqa: E402
import step_boxes  # noqa: E402

SCHEMA = json.loads((ROOT / "docs" / "report.schema.json").read_text(encoding="utf-8"))
OF_REFINE = {"$ref": "#/$defs/refine_command", "$defs": SCHEMA["$defs"]}
MAY_BE_ABSENT = {("quality", "measures"), ("options",)}  # objects with keys that not every report has


def airfoil(count=30):
    """A lens of two arcs, as coordinates."""
    upper = [(1 - i / count, 1) for i in range(count)]
    lower = [(i / count, -1) for i in range(count + 1)]
    return "lens\n" + "".join(f"{x!r} {side * 0.3 * math.sin(math.pi * x)!r}\n" for x, side in upper + lower)


def objects_of(report, path=()):
    """All objects in a report, with the first of each list, by their paths."""
    if isinstance(report, dict):
        yield path
        for key, value in report.items():
            yield from objects_of(value, (*path, key))
    elif isinstance(report, list) and report:
        yield from objects_of(report[0], (*path, 0))


def part(report, path):
    for key in path:
        report = report[key]
    return report


class ReportSchema(case.Case):
    def setUp(self):
        super().setUp()
        self.check = jsonschema.Draft202012Validator(SCHEMA)
        self.write("ball.stl", case.stl_ascii(case.sphere_triangles(1), "ball"))

    def job(self, *arguments, code=0, check=None, name="r.json"):
        """The report of a job, which is as the schema says."""
        self.expect(code, *arguments, "--report", name)
        report = self.report("r.json")
        problems = [f"{list(e.absolute_path)}: {e.message}"[:300] for e in (check or self.check).iter_errors(report)]
        self.assertEqual(problems, [], arguments)
        self.assertEqual(report["exit_code"], code)
        return report

    def refuse(self, changed, what):
        self.assertFalse(self.check.is_valid(changed), what)

    def test_it_is_a_schema(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)

    def test_a_volume(self):
        report = self.job("mesh", "ball.stl", "-o", "ball.vtu")
        self.assertGreater(report["quality"]["num_cells"], 0)
        self.assertEqual([group["name"] for group in report["boundaries"]], ["ball"])

    def test_a_surface_gridded_anew(self):
        report = self.job("mesh", "ball.stl", "-o", "new.stl", "--surface-method", "front", "--hmax", "0.3",
                          "--stop-after", "surface")
        self.assertGreater(report["surface_grid"]["triangles"], 80)

    def test_smooth_geometry(self):
        self.write("ball.geom.toml", '[[shape]]\ntype = "sphere"\nradius = 1\n')
        report = self.job("mesh", "ball.geom.toml", "-o", "ball.su2", "--accuracy", "coarse")
        self.assertEqual([grid["file"] for grid in report["geometry"]], ["ball.geom.toml"])

    def test_a_cad_file(self):
        step_boxes.write_boxes(self.folder / "box.step", 1)
        if "libdelfront_cad.so is not there" in case.unbroken(self.run_delfront("info", "box.step").stderr):
            self.skipTest("the module for CAD files was not built")
        report = self.job("mesh", "box.step", "-o", "box.su2", "--accuracy", "coarse")
        self.assertGreater(report["scale"]["metres_per_unit"], 0)

    def test_an_airfoil_in_the_plane(self):
        self.write("foil.dat", airfoil())
        report = self.job("mesh", "foil.dat", "-o", "foil.su2", "--farfield", "circle:5c")
        self.assertIn("min_angle", report["quality"]["measures"])

    def test_levels(self):
        report = self.job("mesh", "ball.stl", "-o", "ball.vtu", "--levels", 1)
        self.assertEqual(report["levels"]["levels"], 1)

    def test_the_front(self):
        report = self.job("mesh", "ball.stl", "-o", "ball.vtu", "--volume-method", "front", "--growth", "1.2")
        self.assertGreater(report["front"]["cells"], 0)

    def test_beside_a_page(self):
        report = self.job("mesh", "ball.stl", "-o", "ball.vtu", "--require", "min_dihedral > 60", code=5, name="r.html")
        self.assertEqual(report["grid_findings"], [])
        self.assertGreater(report["size_fit"]["ratio"]["max"], 0)
        self.job("mesh", "ball.stl", "-o", "ball.vtu", "--levels", 1, name="r.html")
        report = self.job("refine", "ball.vtu", "-o", "fine.vtu", name="r.html",
                          check=jsonschema.Draft202012Validator(OF_REFINE))
        self.assertEqual(report["grid_findings"], [])
        changed = copy.deepcopy(report)
        changed["grid_findings"] = [{"kind": "flat_cell"}]
        self.assertFalse(jsonschema.Draft202012Validator(OF_REFINE).is_valid(changed))

    def test_runs_that_fail(self):
        self.write("open.stl", case.stl_ascii(case.box_triangles()[:-1]))
        report = self.job("mesh", "open.stl", "-o", "open.vtu", code=3)
        self.assertIn("open_edges", [finding["kind"] for finding in report["surface"]["findings"]])
        self.job("mesh", "nowhere.stl", "-o", "a.vtu", code=3)
        self.job("mesh", "ball.stl", "-o", "a.vtu", "--hmax", "0.05", "--growth", "1.1", "--max-cells", 50, code=6)
        self.assertEqual(self.job("mesh", "ball.stl", "-o", "a.vtu", "--require", "min_dihedral > 60", code=5)["outcome"],
                         "gate_not_met")

    def test_other_commands(self):
        self.assertGreater(self.job("estimate", "ball.stl")["estimate"]["cells"], 0)
        self.job("sizes", "ball.stl", "-o", "sizes.vtu")
        self.job("mesh", "ball.stl", "-o", "ball.vtu")
        self.job("refine", "ball.vtu", "-o", "fine.vtu", "--geometry", "ball.stl",
                 check=jsonschema.Draft202012Validator(OF_REFINE))
        self.assertFalse(self.check.is_valid(self.report("r.json")))

    def test_what_is_missing_more_or_of_another_type_is_noticed(self):
        report = self.job("mesh", "ball.stl", "-o", "ball.vtu", "--surface-method", "front", "--hmax", "0.8")
        for measure in report["quality"]["measures"].values():
            del measure["worst"][1:]
        count = 0
        for path in objects_of(report):
            if path[:1] == ("options",) and path != ("options",):
                continue  # the job file's own table of options is the truth about these
            for key in part(report, path):
                changed = copy.deepcopy(report)
                held = part(changed, path)
                value = held.pop(key)
                if path not in MAY_BE_ABSENT:
                    self.refuse(changed, f"without {path} {key}")
                held[key] = "another type" if isinstance(value, (dict, list)) else {}
                if path != ("options",) or key in ("input", "output"):
                    self.refuse(changed, f"{path} {key} of another type")
                count += 1
            if path != ("options",):
                changed = copy.deepcopy(report)
                part(changed, path)["surplus"] = 1
                self.refuse(changed, f"more in {path}")
        self.assertGreater(count, 200)

    def test_the_outcome_goes_with_the_exit_code(self):
        report = self.job("mesh", "ball.stl", "-o", "ball.vtu")
        self.refuse({**report, "exit_code": 5}, "done with 5")
        self.refuse({**report, "error": "no"}, "done with an error")
        self.refuse({**report, "outcome": "failed"}, "no such outcome")


if __name__ == "__main__":
    if jsonschema is None:
        print("report_schema skipped: python3-jsonschema is not there; scripts/setup installs it")
        sys.exit(77)
    case.DELFRONT = os.path.abspath(sys.argv.pop(1))
    unittest.main()
