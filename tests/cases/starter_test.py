# SPDX-License-Identifier: Apache-2.0
"""Starter files of --solver: every boundary named once by its kind, files of the user kept. tests/external/test_solvers.py
runs the solvers themselves."""
import re
import unittest

import case

KINDS = {"xmin": "inlet", "xmax": "outlet", "ymin": "symmetry", "ymax": "wall", "zmin": "patch"}
FIELDS = ("U", "p", "k", "omega", "nut")
CASE_FILES = [f"0/{name}" for name in FIELDS] + ["constant/transportProperties", "constant/turbulenceProperties"] + \
    [f"system/{name}" for name in ("controlDict", "fvSchemes", "fvSolution")]
# What su2 takes as a condition; each marker stands in one of them. (MONITORING and PLOTTING repeat names.)
CONDITIONS = ("MARKER_EULER", "MARKER_HEATFLUX", "MARKER_FAR", "MARKER_SYM", "MARKER_INLET", "MARKER_OUTLET")
# Keys of SU2's config_template.cfg that a starter may use.
SU2_KEYS = set(CONDITIONS) | set("""SOLVER KIND_TURB_MODEL MATH_PROBLEM RESTART_SOL SYSTEM_MEASUREMENTS MACH_NUMBER AOA
    SIDESLIP_ANGLE FREESTREAM_PRESSURE FREESTREAM_TEMPERATURE INLET_TYPE INC_DENSITY_MODEL INC_ENERGY_EQUATION
    INC_DENSITY_INIT INC_VELOCITY_INIT INC_TEMPERATURE_INIT INC_INLET_TYPE INC_OUTLET_TYPE REF_ORIGIN_MOMENT_X
    REF_ORIGIN_MOMENT_Y REF_ORIGIN_MOMENT_Z REF_LENGTH REF_AREA MARKER_MONITORING MARKER_PLOTTING NUM_METHOD_GRAD
    CFL_NUMBER CFL_ADAPT MGLEVEL CONV_NUM_METHOD_FLOW JST_SENSOR_COEFF MUSCL_FLOW SLOPE_LIMITER_FLOW
    VENKAT_LIMITER_COEFF TIME_DISCRE_FLOW LINEAR_SOLVER LINEAR_SOLVER_PREC LINEAR_SOLVER_ERROR LINEAR_SOLVER_ITER ITER
    CONV_FIELD CONV_RESIDUAL_MINVAL CONV_STARTITER MESH_FILENAME MESH_FORMAT TABULAR_FORMAT OUTPUT_FILES SCREEN_OUTPUT
    """.split())


def box_of_patches(size=(2, 1, 1)):
    """ASCII STL of a box with one solid a side."""
    a, b, c = size
    corners = {"xmin": "000 001 011 010", "xmax": "100 110 111 101", "ymin": "000 100 101 001",
               "ymax": "010 011 111 110", "zmin": "000 010 110 100", "zmax": "001 101 111 011"}
    text = ""
    for name, side in corners.items():
        p = [f"vertex {a * int(i)} {b * int(j)} {c * int(k)}\n" for i, j, k in side.split()]
        facets = ((p[0], p[1], p[2]), (p[0], p[2], p[3]))
        text += f"solid {name}\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join(facet) + "endloop\nendfacet\n"
                                            for facet in facets) + f"endsolid {name}\n"
    return text


def kinds_flags(kinds):
    return [word for name, kind in kinds.items() for word in ("--set", f"boundaries.{name}.kind={kind}")]


def su2_settings(text):
    """{key: value}; what is no comment must be KEY= VALUE, each key once, parentheses closed."""
    settings = {}
    for line in text.splitlines():
        if not line.strip() or line.startswith("%"):
            continue
        match = re.fullmatch(r"([A-Z0-9_]+)= (\S.*)", line)
        assert match, f"no setting: {line!r}"
        key, value = match.groups()
        assert key not in settings, f"{key} is set twice"
        assert key in SU2_KEYS, f"{key} is not known"
        assert value.count("(") == value.count(")") <= 1, line
        settings[key] = value
    return settings


def su2_list(value):
    return [word.strip() for word in value.strip("() ").split(",")]


def boundary_entries(text):
    """{patch: its entries} of the boundaryField of an OpenFOAM field."""
    assert text.count("{") == text.count("}")
    body = re.sub(r"//.*", "", text.split("boundaryField", 1)[1])
    names = re.findall(r"([\w.-]+)\s*\{([^{}]*)\}", body)
    assert len({name for name, _ in names}) == len(names), "a patch is named twice"
    return {name: entries.strip() for name, entries in names}


class Su2(case.Case):
    def make(self, *flags, kinds=KINDS, says=()):
        self.write("box.stl", box_of_patches())
        self.expect(0, "mesh", "box.stl", "-o", "box.su2", "--solver", "su2", *kinds_flags(kinds), *flags, says=says)
        return (self.folder / "box.cfg").read_text()

    def check_names_each_marker_once(self, text):
        settings = su2_settings(text)
        named = []
        for key in CONDITIONS:
            if key in settings:
                step = {"MARKER_INLET": 6, "MARKER_OUTLET": 2, "MARKER_HEATFLUX": 2}.get(key, 1)
                named += su2_list(settings[key])[::step]
        markers = re.findall(r"MARKER_TAG= (\S+)", (self.folder / settings["MESH_FILENAME"]).read_text())
        self.assertEqual(sorted(named), sorted(markers))
        return settings

    def test_each_marker_has_the_condition_of_its_kind(self):
        settings = self.check_names_each_marker_once(self.make(says="box.cfg"))
        self.assertEqual(settings["SOLVER"], "INC_EULER")
        self.assertEqual(settings["MARKER_EULER"], "( ymax, zmin, zmax )")
        self.assertEqual(settings["MARKER_SYM"], "( ymin )")
        self.assertEqual(su2_list(settings["MARKER_INLET"]), ["xmin", "288.15", "10", "1", "0", "0"])
        self.assertEqual(su2_list(settings["MARKER_OUTLET"])[0], "xmax")

    def test_walls_that_are_assumed_are_said(self):
        text = self.make(says=["zmin, zmax", "a wall is assumed"])
        self.assertIn("% zmin:  CHANGE, its kind, patch, says no condition: assumed a wall", text)
        self.assertIn("% zmax:  CHANGE, no kind was given: assumed a wall", text)

    def test_the_way_in_is_the_inlets(self):
        settings = self.check_names_each_marker_once(self.make(kinds={"xmax": "inlet", "ymin": "inlet", "zmin": "outlet"}))
        self.assertEqual(su2_list(settings["MARKER_INLET"])[3:6], ["-1", "0", "0"])
        self.assertEqual(su2_list(settings["MARKER_INLET"])[9:], ["0", "1", "0"])
        self.assertEqual(settings["INC_INLET_TYPE"], "VELOCITY_INLET, VELOCITY_INLET")

    def test_the_way_in_from_a_body_is_away_from_it(self):
        settings = self.check_names_each_marker_once(self.make("--farfield", "sphere:5c", kinds={"xmin": "inlet"}))
        self.assertEqual(su2_list(settings["MARKER_INLET"])[3:], ["-1", "0", "0"])

    def test_a_far_field_makes_it_compressible(self):
        settings = self.check_names_each_marker_once(self.make("--farfield", "sphere:5c", kinds={}))
        self.assertEqual((settings["SOLVER"], settings["MARKER_FAR"]), ("EULER", "( farfield )"))
        self.assertEqual(len(su2_list(settings["MARKER_EULER"])), 6)

    def test_grid_in_the_plane(self):
        circle = "\n".join(f"{x} {y}" for x, y in ((1, 0), (0.5, 0.1), (0, 0), (0.5, -0.1), (1, 0)))
        self.write("foil.dat", "foil\n" + circle + "\n")
        self.expect(0, "mesh", "foil.dat", "-o", "foil.su2", "--farfield", "circle:5c", "--solver", "su2")
        settings = self.check_names_each_marker_once((self.folder / "foil.cfg").read_text())
        self.assertEqual((settings["MARKER_EULER"], settings["MARKER_FAR"]), ("( foil )", "( farfield )"))

    def test_a_file_that_exists_is_kept(self):
        self.write("box.cfg", "% mine\nMARKER_EULER= ( xmin, xmax )\n")
        text = self.make("--report", "r.json", says=["kept           box.cfg", "does not name ymin, ymax, zmin, zmax"])
        self.assertEqual(text, "% mine\nMARKER_EULER= ( xmin, xmax )\n")
        self.assertEqual(self.report("r.json")["starter_files"], {"written": [], "kept": ["box.cfg"]})
        self.assertEqual(self.report("r.json")["files_written"], ["box.su2"])

    def test_words_of_su2_are_no_names(self):
        self.write("box.stl", box_of_patches().replace("xmin", "NONE").replace("ymin", "NONE_"))
        self.expect(0, "mesh", "box.stl", "-o", "my box.su2", "--solver", "su2",
                    says=["is written as 'NONE__'", "'my box.su2': SU2 takes blanks"])
        settings = self.check_names_each_marker_once((self.folder / "my box.cfg").read_text())
        self.assertEqual(set(su2_list(settings["MARKER_EULER"])), {"NONE_", "NONE__", "xmax", "ymax", "zmin", "zmax"})

    def test_convert(self):
        self.write("box.stl", box_of_patches())
        self.expect(0, "mesh", "box.stl", "-o", "box.vtu", *kinds_flags(KINDS))
        self.expect(0, "convert", "box.vtu", "other.su2", "--solver", "su2", says="starter files  other.cfg")
        settings = self.check_names_each_marker_once((self.folder / "other.cfg").read_text())
        self.assertEqual(su2_list(settings["MARKER_INLET"])[0], "xmin")

    def test_other_units_are_said(self):
        self.make("--units", "mm", says="coordinates are in mm, and the solver takes them as metres")
        self.assertNotIn("as metres;", self.run_delfront("mesh", "box.stl", "-o", "m.su2", "--solver", "su2", "--units", "mm",
                                                         "--output-units", "m").stderr)


class OpenFoam(case.Case):
    def make(self, *flags, kinds=KINDS, says=()):
        self.write("box.stl", box_of_patches())
        return self.expect(0, "mesh", "box.stl", "-o", "foam/", "--solver", "openfoam", *kinds_flags(kinds), *flags,
                           says=says)

    def fields(self, names=FIELDS):
        patches = re.findall(r"^    ([\w.-]+)\n    \{", (self.folder / "foam/constant/polyMesh/boundary").read_text(), re.M)
        self.assertGreater(len(patches), 1)
        result = {}
        for name in names:
            result[name] = boundary_entries((self.folder / "foam/0" / name).read_text())
            self.assertEqual(list(result[name]), patches, name)
        return result

    def test_kinds_of_flat_cases_are_said_to_be_refused(self):
        self.make(kinds={"ymin": "empty", "ymax": "wedge"}, says="OpenFOAM has the kinds empty and wedge for grids one cell thick, and refuses ymin, ymax")

    def test_every_field_names_every_patch_by_its_kind(self):
        self.make(says="starter files  foam/0/U")
        for name in CASE_FILES:
            text = (self.folder / "foam" / name).read_text()
            self.assertTrue(text.startswith("FoamFile"), name)
            self.assertEqual(text.count("{"), text.count("}"), name)
        fields = self.fields()
        self.assertEqual(fields["U"]["xmin"], "type fixedValue; value uniform (10 0 0);")
        self.assertIn("inletOutlet", fields["U"]["xmax"])
        self.assertEqual(fields["p"]["xmax"], "type fixedValue; value uniform 0;")
        self.assertIn("nutkWallFunction", fields["nut"]["ymax"])
        for name in FIELDS:
            self.assertEqual(fields[name]["ymin"], "type symmetry;")
        for assumed in ("zmin", "zmax"):  # type patch, which wall functions refuse
            self.assertEqual(fields["U"][assumed], "type noSlip;")
            self.assertIn("calculated", fields["nut"][assumed])
        self.assertRegex((self.folder / "foam/0/U").read_text(),
                         r"zmax +\{ type noSlip; \}  // CHANGE, no kind was given: assumed a wall\n")
        self.assertIn("kOmegaSST", (self.folder / "foam/constant/turbulenceProperties").read_text())
        self.assertIn("simpleFoam", (self.folder / "foam/system/controlDict").read_text())

    def test_far_field(self):
        self.make("--farfield", "sphere:5c", kinds={})
        fields = self.fields(FIELDS + ("Phi",))
        self.assertEqual(fields["U"]["farfield"], "type freestreamVelocity; freestreamValue uniform (10 0 0);")
        self.assertIn("freestreamPressure", fields["p"]["farfield"])

    def test_without_a_wall_the_flow_is_laminar(self):
        self.make(kinds={"xmin": "inlet", "xmax": "outlet"})
        self.fields(("U", "p"))
        self.assertFalse((self.folder / "foam/0/omega").exists())
        self.assertRegex((self.folder / "foam/constant/turbulenceProperties").read_text(), r"simulationType\s+laminar;")

    def test_baffles_are_named_on_both_sides(self):
        sheet = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {v}\n" for v in facet) + "endloop\nendfacet\n"
                        for facet in (("0.7 0.3 0.3", "0.7 0.7 0.3", "0.7 0.7 0.7"),
                                      ("0.7 0.3 0.3", "0.7 0.7 0.7", "0.7 0.3 0.7")))
        self.write("box.stl", box_of_patches() + f"solid plate\n{sheet}endsolid plate\n")
        self.expect(0, "mesh", "box.stl", "-o", "foam/", "--solver", "openfoam", *kinds_flags(KINDS))
        fields = self.fields()
        for side in ("plate_master", "plate_slave"):
            self.assertIn("nutkWallFunction", fields["nut"][side])

    def test_files_of_the_user_are_kept(self):
        self.make()
        mine = {"system/controlDict": "mine", "0/U": "xmin xmax ymin ymax zmin zmax", "0/p": "xmin"}
        for name, text in mine.items():
            (self.folder / "foam" / name).write_text(text)
        (self.folder / "foam/0/k").unlink()
        self.make("--report", "r.json", says=["kept           ", "foam/0/p was there and is kept, but does not name xmax"])
        for name, text in mine.items():
            self.assertEqual((self.folder / "foam" / name).read_text(), text)
        self.assertEqual(self.report("r.json")["starter_files"],
                         {"written": ["foam/0/k"], "kept": [f"foam/{name}" for name in CASE_FILES if name != "0/k"]})

    def test_what_every_case_gets_is_replaced_while_it_is_untouched(self):
        """A grid alone brings a system/ that checkMesh can start with; it is not the user's until it is changed."""
        self.write("box.stl", box_of_patches())
        self.expect(0, "mesh", "box.stl", "-o", "foam/")
        (self.folder / "foam/system/fvSchemes").write_text("mine")
        self.make("--report", "r.json")
        self.assertEqual(self.report("r.json")["starter_files"]["kept"], ["foam/system/fvSchemes"])
        self.assertIn("simpleFoam", (self.folder / "foam/system/controlDict").read_text())

    def test_the_grid_is_written_as_without_a_solver(self):
        self.make()
        self.expect(0, "mesh", "box.stl", "-o", "plain/", *kinds_flags(KINDS))
        for file in (self.folder / "plain/constant/polyMesh").iterdir():
            self.assertEqual(file.read_bytes(), (self.folder / "foam/constant/polyMesh" / file.name).read_bytes())


class SolverUsage(case.Case):
    def setUp(self):
        super().setUp()
        self.write("box.stl", box_of_patches())

    def test_a_solver_without_its_output(self):
        self.expect(2, "mesh", "box.stl", "-o", "box.vtu", "--solver", "openfoam", says=["--solver: openfoam needs", "ending in /"])
        self.expect(2, "mesh", "box.stl", "-o", "foam/", "--solver", "su2", says="-o grid.su2")
        self.expect(2, "mesh", "box.stl", "-o", "box.su2", "--solver", "su3", says="su2")
        self.expect(2, "convert", "box.stl", "box.vtu", "--solver", "su2", says="--solver su2: box.vtu")
        self.expect(2, "convert", "box.stl", "box.su2", "--solver", "fluent", says="su2, openfoam")
        self.assertEqual(self.files(), ["box.stl"])

    def test_a_place_that_cannot_be_written_is_said_and_the_grid_is_whole(self):
        (self.folder / "foam").mkdir()
        self.write("foam/0", "a file")
        self.expect(7, "mesh", "box.stl", "-o", "foam/", "--solver", "openfoam", says=["foam/0", "the grid foam/ itself is complete"])
        self.expect(0, "check", "foam/")
        self.assertFalse([name for name in self.files() if "tmp" in name])

    def test_only_its_own_outputs_get_files(self):
        self.expect(0, "mesh", "box.stl", "-o", "a.vtu", "-o", "b.su2", "-o", "foam/", "--solver", "su2")
        self.assertTrue((self.folder / "b.cfg").exists())
        self.assertFalse((self.folder / "foam/0").exists())

    def test_format_says_what_a_name_does_not(self):
        self.expect(0, "mesh", "box.stl", "-o", "grid.mine", "--format", "su2", "--solver", "su2")
        self.assertIn("MESH_FILENAME= grid.mine", (self.folder / "grid.cfg").read_text())

    def test_a_job_file_may_ask_for_it(self):
        self.write("job.toml", 'input.files = ["box.stl"]\n[output]\nfiles = ["box.su2"]\nsolver = "su2"\n')
        self.expect(0, "mesh", "job.toml")
        self.assertTrue((self.folder / "box.cfg").exists())
        self.expect(0, "estimate", "job.toml")
        self.expect(0, "mesh", "job.toml", "--stop-after", "geometry")


if __name__ == "__main__":
    unittest.main()
