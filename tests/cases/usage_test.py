#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a user types: commands, flags, job files, and the answer to slips (exit 2)."""
import unittest

import case


class Help(case.Case):
    def test_help_shows_commands_examples_formats_and_exit_codes(self):
        self.expect(0, "--help", says=["delfront mesh", ".stl", ".vtu", "OpenFOAM", "Exit codes"])
        self.expect(0, "mesh", "--help", says=["Examples:", "--farfield", "the kind wall", "--hmax,--clmax", "--set",
                                               "LENGTH:", "Model units are those of the coordinates"])
        for command in ("check", "info", "convert"):
            self.expect(0, command, "--help", says="xample")

    def test_version(self):
        self.assertRegex(self.expect(0, "--version").stdout, r"^delfront \d+\.\d+\.\d+\n$")

    def test_without_a_command_help_is_printed(self):
        self.assertIn("First steps", self.run_delfront().stdout)


class Slips(case.Case):
    def test_unknown_words_name_the_nearest(self):
        self.expect(2, "mehs", says="did you mean 'mesh'?")
        self.expect(2, "mesh", "a.stl", "--hmxa", "5", says="did you mean '--hmax'?")
        self.expect(2, "mesh", "a.stl", "--set", "size.hmxa=5", says="did you mean 'size.hmax'?")
        self.expect(2, "mesh", "a.stl", "--set", "hmax", says="KEY=VALUE")
        self.expect(2, "mesh", "a.stl", "--progress", "loud", says="auto, bar, plain, json, none")

    def test_words_of_later_versions_are_said_to_be_so(self):
        self.expect(2, "adapt", "a.vtu", says="not in this version")
        self.expect(2, "mesh", "a.stl", "--layers", "18", says="not in this version")

    def test_wrong_values_say_what_is_allowed(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        for flag, value, says in [("--hmax", "5parsec", "unknown unit"), ("--hmax", "-1", "not positive"),
                                  ("--growth", "1", "a number over 1"), ("--growth", "fast", "a number over 1"),
                                  ("--units", "cm", "auto, m, mm, in, ft"), ("--max-cells", "-3", "whole number"),
                                  ("--farfield", "cube:3", "sphere:20c"), ("--keep", "larges", "did you mean 'largest'"),
                                  ("--stop-after", "surf", "geometry, surface, volume"), ("-j", "x", "")]:
            self.expect(2, "mesh", "a.stl", "-o", "a.vtu", flag, value, says=says)
        self.assertEqual(self.files(), ["a.stl"])

    def test_what_is_missing_is_named(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        self.expect(2, "mesh", says="no input")
        self.expect(2, "mesh", "a.stl", says="-o grid.vtu")
        self.expect(2, "mesh", "a.stl", "-o", "a.xyz", says=".vtu")
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--hmin", "1", "--hmax", "0.5", says="above size.hmax")
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--hmax", "2mm", says="--units")
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--output-units", "mm", says="--units")

    def test_one_file_too_many_is_said(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        self.expect(2, "check", "a.stl", "b.stl", says="'b.stl' is one argument too many: one FILE only")
        self.expect(2, "info", "a.stl", "a.stl", says="one FILE only")
        self.expect(2, "convert", "a.stl", "b.stl", "c.stl", says="one IN, one OUT only")

    def test_the_file_that_is_looked_at_is_not_written_over(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        self.expect(2, "check", "a.stl", "--defects", "a.stl", says="overwritten")
        self.expect(2, "check", "a.stl", "--json", "./a.stl", says="overwritten")
        self.expect(2, "info", "a.stl", "--json", "a.stl", says="overwritten")
        self.expect(2, "convert", "a.stl", "./a.stl", says="overwritten")
        self.expect(2, "mesh", "a.stl", "-o", "./a.stl", "--stop-after", "surface", says="written over")
        self.expect(0, "info", "a.stl")

    def test_a_far_field_is_there_where_it_is_spoken_of(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--farfield-h", "1", says="there is no far field")
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--keep", "outside", says="there is no far field")
        self.assertEqual(self.files(), ["a.stl"])

    def test_gates_are_read_before_the_work(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--require", "mindihedral > 3", says="did you mean 'min_dihedral'?")
        self.expect(2, "mesh", "a.stl", "-o", "a.vtu", "--require", "min_dihedral >")
        self.assertEqual(self.files(), ["a.stl"])


class Order(case.Case):
    def test_an_option_takes_one_word_and_the_file_may_stand_anywhere(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        self.write("b.stl", case.stl_ascii(case.box_triangles((3, 0, 0), (4, 1, 1))))
        for words in (["-o", "o.vtu", "a.stl"], ["--require", "min_dihedral>8", "a.stl", "-o", "o.vtu"],
                      ["--hmax", "5%", "a.stl", "-o", "o.vtu"], ["--set", "size.growth=1.3", "a.stl", "-o", "o.vtu"],
                      ["--stop-after", "geometry", "a.stl"], ["--farfield", "box:3", "a.stl", "-o", "o.vtu"]):
            result = self.expect(0, "mesh", *words, "--print-config")
            self.assertIn('files = ["a.stl"]', result.stdout)
        result = self.expect(0, "mesh", "-o", "o.vtu", "a.stl", "-o", "o.su2", "b.stl", "--print-config")
        self.assertIn('files = ["a.stl", "b.stl"]', result.stdout)
        self.assertIn('files = ["o.vtu", "o.su2"]', result.stdout)
        self.expect(0, "mesh", "-o", "o.vtu", "a.stl")


class JobFiles(case.Case):
    def test_unknown_key_names_line_and_nearest(self):
        self.write("case.toml", "[input]\nfiles = ['a.stl']\n[size]\nhmxa = 5\n")
        self.expect(2, "mesh", "case.toml", "-o", "a.vtu", says="case.toml:4: unknown key 'size.hmxa' (did you mean 'size.hmax'?)")

    def test_wrong_type_names_line_and_what_is_allowed(self):
        self.write("case.toml", "[size]\n# a comment\nhmax = [1, 2]\n")
        self.expect(2, "mesh", "case.toml", says=["case.toml:3: size.hmax: expected a length", "got a list of 2"])
        self.write("case.json", '{\n "size": {\n  "growth": "1.2"\n }\n}')
        self.expect(2, "mesh", "case.json", says=["case.json:3: size.growth: expected a number over 1"])

    def test_what_shows_only_later_names_key_and_line_too(self):
        self.write("a.stl", case.stl_ascii(case.box_triangles()))
        lines = {"files": "'a.vtu'", "hmin": "0.1", "hmax": "1", "require": "'min_dihedral > 1'", "kind": "'wall'"}

        def job(**changed):
            value = {**lines, **changed}
            return self.write("case.toml", f"[input]\nfiles = ['a.stl']\n[output]\nfiles = [\n  {value['files']},\n]\n"
                              f"require = {value['require']}\n[size]\nhmin = {value['hmin']}\nhmax = {value['hmax']}\n"
                              f"[boundaries.a]\nselect = 'bo*'\nkind = {value['kind']}\n")

        self.expect(0, "mesh", job())
        for changed, says in (({"require": "'mindihedral > 1'"}, "case.toml:7: output.require: gate 'mindihedral'"),
                              ({"require": "'min_dihedral'"}, "case.toml:7: output.require: gate 'min_dihedral'"),
                              ({"files": "'a.xyz'"}, "case.toml:5: output.files[0]: a.xyz: unknown type"),
                              ({"files": "'no/a.vtu'"}, "case.toml:5: cannot write no/a.vtu"),
                              ({"files": "'a.stl'"}, "case.toml:5: output.files[0]: a.stl: stl holds surfaces only"),
                              ({"hmin": "2"}, "case.toml:9: size.hmin: 2 is above size.hmax, which is 1 (case.toml:10)"),
                              ({"hmax": "'5 mm'"}, "case.toml:10: size.hmax: length '5 mm' needs the unit")):
            with self.subTest(says):
                self.expect(7 if "no/" in str(changed) else 2, "mesh", job(**changed), says=says)
        self.expect(2, "mesh", job(), "--hmin", "3", says="--hmin: 3 is above size.hmax, which is 1 (case.toml:10)")
        text = (self.folder / "case.toml").read_text()
        self.write("case.toml", text.replace("bo*", "nobody"))
        self.expect(2, "mesh", "case.toml", says="case.toml:12: boundaries.a: no patch is called 'nobody'")

    def test_long_messages_are_broken_into_lines(self):
        self.write("case.toml", "[size]\nhmax = true\n")
        for words in (["case.toml"], ["a.stl", "-o", "a.xyz"], ["a.stl", "-o", "a.vtu", "--require", "no > 1"]):
            said = self.expect(2, "mesh", *words).stderr.splitlines()
            self.assertGreater(len(said), 1)
            self.assertLessEqual(max(map(len, said)), 100)
            self.assertTrue(all(line.startswith("  ") for line in said[1:]))

    def test_not_toml_names_the_line(self):
        self.write("case.toml", "[size]\nhmax = \n")
        self.expect(2, "mesh", "case.toml", says=["case.toml:2", "not valid TOML"])

    def test_missing_job_file(self):
        self.expect(2, "mesh", "nothere.toml", says="nothere.toml")

    def test_a_job_file_and_a_surface_are_not_mixed(self):
        self.write("case.toml", "[input]\nfiles = ['a.stl']\n[output]\nfiles = ['a.vtu']\n")
        self.expect(2, "mesh", "case.toml", "b.stl", says=["'b.stl'", "job file already names its input"])
        self.write("sizes.toml", "[size]\nhmax = 2\n")
        self.expect(0, "mesh", "sizes.toml", "b.stl", "--print-config", says='files = ["b.stl"]')

    def test_later_words_win(self):
        self.write("case.toml", "[input]\nfiles = ['a.stl']\n[size]\nhmax = 1\nhmin = 0.1\ngrowth = 1.2\n")
        result = self.expect(0, "mesh", "case.toml", "--hmax", "2", "--growth", "1.3", "--set", "size.growth=1.4",
                             "--print-config")
        for line in ("hmax = 2 ", "hmin = 0.1 ", "growth = 1.4 ", 'files = ["a.stl"]'):
            self.assertIn(line, result.stdout)

    def test_printed_configuration_reads_back_the_same(self):
        flags = ["--farfield", "box:-1,-1,-1,2,2,2.5", "--keep", "-0.5,0,0", "--hmin", "1e-7", "--clmax", "5%",
                 "--growth", "1.15", "--no-improve", "--time-limit", "2h", "--memory-limit", "3GiB", "--max-cells",
                 "5e6", "-o", "x.su2", "-o", "foam/", "--units", "mm", "--output-units", "in", "--ascii",
                 "--require", "min_dihedral > 8", "--set", "boundaries.wing.select=OML*", "--set",
                 "boundaries.wing.kind=wall", "--report", "r.json", "--stop-after", "volume"]
        first = self.expect(0, "mesh", "a b.stl", "c.obj", *flags, "--print-config").stdout
        self.write("effective.toml", first)
        self.assertEqual(self.expect(0, "mesh", "effective.toml", "--print-config").stdout, first)
        self.assertEqual(self.files(), ["effective.toml"])

    def test_paths_are_relative_to_the_job_file(self):
        (self.folder / "sub").mkdir()
        self.write("sub/box.stl", case.stl_ascii(case.box_triangles()))
        self.write("sub/case.toml", "[input]\nfiles = ['box.stl']\n[output]\nfiles = ['box.vtu']\nreport = 'box.json'\n")
        self.expect(0, "mesh", "sub/case.toml")
        self.assertEqual(self.files(), ["sub", "sub/box.json", "sub/box.stl", "sub/box.vtu", "sub/case.toml"])


if __name__ == "__main__":
    unittest.main()
