#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Smooth geometry as text: looked at, gridded, with sizes, names and a far field; bad files are refused with a line."""
import json
import math
import sys
import unittest

import case

BALL = '[[shape]]\ntype = "sphere"\nradius = 1\n'
SHELL = """[[shape]]
type = "box"
name = "room"
min = [-3, -3, -3]
max = [3, 3, 3]

[[shape]]
type = "torus"
name = "ring"
kind = "wall"
radius = 1.5
tube = 0.5
reversed = true
"""


class SmoothGeometry(case.Case):
    def grid(self, *arguments, code=0):
        self.expect(code, "mesh", *arguments, "-o", "out.vtu", "--report", "out.json")
        return self.report("out.json")

    def test_three_lines_make_a_grid(self):
        self.write("ball.geom.toml", BALL)
        self.expect(0, "mesh", "ball.geom.toml", "-o", "ball.su2", "-o", "ball.vtu", "--report", "ball.json")
        report = self.report("ball.json")
        self.assertTrue(report["surface"]["is_closed"])
        self.assertEqual([group["name"] for group in report["boundaries"]], ["sphere"])
        self.assertAlmostEqual(report["quality"]["volume"] / (4 * math.pi / 3), 1, delta=0.02)
        self.expect(0, "check", "ball.vtu")
        # no side longer than a twentieth of the extent
        self.assertAlmostEqual(report["surface"]["mean_edge"], 2 / 20, delta=0.01)
        grid = report["geometry"][0]
        self.assertEqual((grid["file"], grid["stopped"]), ("ball.geom.toml", ""))
        last = grid["rounds"][-1]
        self.assertEqual(sum(last["angles"]["counts"]), last["triangles"])
        self.assertEqual(last["min_angle_away_from_sharp_corners"]["value"], last["min_angle"])
        self.assertEqual([patch["name"] for patch in last["patches"]], ["sphere"])
        self.assertLess(last["deviation"]["value"], 0.004 * 2)

    def test_info_lists_what_there_is(self):
        self.write("room.geom.toml", SHELL)
        result = self.expect(0, "info", "room.geom.toml", "--json", "room.json",
                             says=["room_x_low", "ring", "9 corners", "7 faces"])
        geometry = json.loads((self.folder / "room.json").read_text())["geometry"]
        self.assertEqual(len(geometry["faces"]), 7)
        self.assertEqual(len(geometry["edges"]), 14)
        self.assertEqual(geometry["faces"][6]["kind"], "wall")
        self.assertIn("closed", result.stdout)

    def test_more_than_a_grid_can_hold_is_a_limit(self):
        self.write("ball.geom.toml", '[[shape]]\ntype = "sphere"\nradius = 1\n')
        for size in ("1e-5", "1e-9", "1e-300"):
            self.expect(6, "mesh", "ball.geom.toml", "-o", "ball.vtu", "--hmax", size, says="stopped before gridding")
        self.expect(6, "mesh", "ball.geom.toml", "-o", "ball.vtu", "--hmax", "0.01", "--max-cells", "1e4",
                    says=["stopped before gridding", "--max-cells"])
        for limit, says in (("--time-limit", "1"), "time limit"), (("--memory-limit", "150MB"), "memory limit"):
            self.expect(6, "mesh", "ball.geom.toml", "-o", "ball.vtu", "--hmax", "1e-3", *limit, says=says)
        self.assertEqual(self.files(), ["ball.geom.toml"])

    def test_a_boundary_whose_faces_later_ones_take_is_said(self):
        self.write("room.geom.toml", '[[shape]]\ntype = "box"\nmin = [0, 0, 0]\nmax = [1, 2, 3]\n')
        self.write("job.toml", '[input]\nfiles = ["room.geom.toml"]\n[boundaries.first]\nselect = { id = [1, 2] }\n'
                   '[boundaries.later]\nselect = { id = [2, 1, 3] }\n[output]\nfiles = ["room.vtu"]\n')
        self.expect(2, "mesh", "job.toml", says=["job.toml:", "boundaries.first", "come later", "later"])

    def polygon(self, name, corners):
        """A plane face with that border."""
        text = '[[surface]]\nname = "plane"\ntype = "plane"\n'
        for k, (x, y) in enumerate(corners):
            text += f'[[corner]]\nname = "c{k}"\nat = [{x}, {y}, 0]\n'
        edges = []
        for k in range(len(corners)):
            edges.append(f"e{k}")
            text += f'[[edge]]\nname = "e{k}"\ntype = "line"\nfrom = "c{k}"\nto = "c{(k + 1) % len(corners)}"\n'
        loop = ", ".join(f'"{edge}"' for edge in edges)
        self.write(name, f'{text}[[face]]\nname = "f"\nsurface = "plane"\nloops = [[{loop}]]\n')

    def test_borders_that_run_over_themselves_are_refused(self):
        self.polygon("back.geom.toml", [(0, 0), (2, 0), (1, 0), (1, 1), (0, 1)])
        self.expect(3, "mesh", "back.geom.toml", "-o", "back.vtp", "--stop-after", "surface",
                    says=["face 'f'", "runs back over itself"])
        star = [(math.cos(4 * math.pi * k / 5), math.sin(4 * math.pi * k / 5)) for k in range(5)]
        self.polygon("star.geom.toml", star)
        self.expect(3, "mesh", "star.geom.toml", "-o", "star.vtp", "--stop-after", "surface",
                    says=["face 'f'", "crosses itself"])
        self.assertFalse({"back.vtp", "star.vtp"} & set(self.files()))

    def test_boxes_that_share_a_face_are_refused_at_once(self):
        box = '[[shape]]\ntype = "box"\nname = "{}"\nmin = [{}, 0, 0]\nmax = [{}, 1, 1]\n'
        self.write("boxes.geom.toml", box.format("left", 0, 1) + box.format("right", 1, 2))
        self.expect(3, "mesh", "boxes.geom.toml", "-o", "boxes.vtu", says=["left", "right", "cross or touch"])

    def test_names_that_are_no_text_are_said(self):
        self.write("bell.geom.toml", '[[shape]]\ntype = "sphere"\nname = "a\\u0007b"\nradius = 1\n')
        done = self.expect(0, "mesh", "bell.geom.toml", "-o", "bell.su2", says=["bell.geom.toml: 1 name holds"])
        self.assertNotIn("\a", done.stdout + done.stderr)
        self.assertIn("MARKER_TAG= a_b", (self.folder / "bell.su2").read_text())

    def test_a_hole_in_no_body_is_refused(self):
        ball = '[[shape]]\ntype = "sphere"\nname = "hole"\nradius = 1\nreversed = true\norigin = [{}, 0, 0]\n'
        body = '[[shape]]\ntype = "box"\nmin = [-2, -2, -2]\nmax = [2, 2, 2]\n'
        self.write("hole.geom.toml", ball.format(0))
        self.expect(3, "mesh", "hole.geom.toml", "-o", "hole.vtu", says=["hole.geom.toml:1", "lies in no body"])
        self.write("hole.geom.toml", body + ball.format(5))
        self.expect(3, "mesh", "hole.geom.toml", "-o", "hole.vtu", says=["hole.geom.toml:5", "lies in no body"])
        self.write("hole.geom.toml", body + ball.format(0))
        self.expect(0, "mesh", "hole.geom.toml", "-o", "hole.vtu")

    def test_a_hole_in_the_body_of_another_file_is_taken(self):
        self.write("body.geom.toml", '[[shape]]\ntype = "box"\nmin = [-2, -2, -2]\nmax = [2, 2, 2]\n')
        self.write("hole.geom.toml", '[[shape]]\ntype = "box"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nreversed = true\n')
        self.expect(0, "mesh", "body.geom.toml", "hole.geom.toml", "-o", "body.vtu", "--report", "body.json")
        report = json.loads((self.folder / "body.json").read_text())
        self.assertAlmostEqual(report["quality"]["volume"], 64 - 8, places=9)

    def test_holes_in_no_body_of_several_files_are_refused(self):
        box = '[[shape]]\ntype = "box"\nname = "{}"\nmin = [{}, 0, 0]\nmax = [{}, {}, {}]\nreversed = {}\n'
        self.write("body.geom.toml", box.format("body", 0, 4, 4, 4, "false"))
        self.expect(0, "mesh", "body.geom.toml", "-o", "body.stl", "--stop-after", "surface", "--hmax", "2")
        self.write("beside.geom.toml", box.format("hole", 10, 11, 1, 1, "true"))
        self.write("round.geom.toml", box.format("hole", -1, 5, 5, 5, "true"))
        for body in ("body.geom.toml", "body.stl"):
            for hole in ("beside.geom.toml", "round.geom.toml"):
                self.expect(3, "mesh", body, hole, "-o", "grid.vtu", "--hmax", "1", says=[f"{hole}:1", "lies in no body"])
        self.write("twice.geom.toml", "".join('[[shape]]\ntype = "box"\nmin = [%d, %d, %d]\nmax = [%d, %d, %d]\nreversed = %s\n' %
                                              (3 * (a,) + 3 * (9 - a,) + (r,)) for a, r in ((0, "false"), (1, "true"), (3, "true"))))
        self.expect(3, "mesh", "twice.geom.toml", "-o", "grid.vtu", says=["twice.geom.toml:11", "lies in no body"])

    def test_a_hole_in_a_far_field_is_taken(self):
        self.write("hole.geom.toml", '[[shape]]\ntype = "box"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nreversed = true\n')
        self.expect(0, "mesh", "hole.geom.toml", "-o", "flow.vtu", "--farfield", "box:3c", "--accuracy", "coarse")

    def test_very_many_names_do_not_fill_the_terminal(self):
        self.write("boxes.geom.toml", "".join(
            f'[[shape]]\ntype = "box"\nname = "box{i}"\nmin = [{2 * i}, 0, 0]\nmax = [{2 * i + 1}, 1, 1]\n' for i in range(20)))
        result = self.expect(0, "mesh", "boxes.geom.toml", "-o", "boxes.vtp", "--stop-after", "surface", "--hmax", "1",
                             "--report", "boxes.json")
        self.assertIn("and 20 more, which a report lists", case.unbroken(result.stdout))
        names = {group["name"] for group in json.loads((self.folder / "boxes.json").read_text())["boundaries"]}
        self.assertEqual(len(names & {f"box{i}_{k}_{side}" for i in range(20) for k in "xyz" for side in ("low", "high")}), 120)

    def test_info_lists_what_gets_no_grid(self):
        sections = "".join(f"[[1,0,{z}],[0.7,0.5,{z}],[0,0,{z}],[-0.7,-0.5,{z}],[-1,0,{z}],[-0.7,0.5,{z}],[0,0,{z}],[0.7,-0.5,{z}]],"
                           for z in (0, 1))
        edges = "".join(f'[[edge]]\nname = "{name}"\ntype = "on"\nsurface = "eight"\nfrom = "{a}"\nto = "{b}"\nuv = {uv}\n'
                        for name, a, b, uv in (("low", "a", "a", [[0, 0], [1, 0]]), ("high", "b", "b", [[0, 1], [1, 1]]),
                                               ("seam", "a", "b", [[0, 0], [0, 1]])))
        self.write("eight.geom.toml",
                   '[[corner]]\nname = "a"\nat = [1, 0, 0]\n[[corner]]\nname = "b"\nat = [1, 0, 1]\n[[surface]]\nname = "eight"\n'
                   f'type = "interpolated"\nclosed = true\ndegree_across = 1\nsections = [{sections}]\n{edges}'
                   '[[face]]\nname = "skin"\nsurface = "eight"\nloops = [["low", "seam", "-high", "-seam"]]\n')
        for command in ("info", "check"):
            result = self.expect(3, command, "eight.geom.toml", "--json", "eight.json")
            self.assertIn("'skin': its triangles cross", case.unbroken(result.stdout))
            facts = json.loads((self.folder / "eight.json").read_text())
            self.assertEqual([edge["name"] for edge in facts["geometry"]["edges"]], ["low", "high", "seam"])
            self.assertEqual([face["name"] for face in facts["geometry"]["faces"]], ["skin"])
            self.assertEqual(facts["surface"]["findings"][0]["kind"], "no_grid")
        self.expect(3, "view", "eight.geom.toml", "--export", "eight.html")
        self.assertFalse((self.folder / "eight.html").exists())

    def test_info_says_where_faces_are(self):
        """What it says of a face selects that face."""
        self.write("part.geom.toml", '[[shape]]\ntype = "box"\nmin = [0, 0, 0]\nmax = [4, 2, 1]\n'
                   '[[shape]]\ntype = "cylinder"\nname = "rod"\nradius = 0.5\nheight = 3\norigin = [10, 0, 0]\n')
        result = self.expect(0, "info", "part.geom.toml", "--json", "part.json")
        self.assertIn("looks along (0, 0, 1)", result.stdout)
        faces = json.loads((self.folder / "part.json").read_text())["geometry"]["faces"]
        for face, area in zip(faces, (2, 2, 4, 4, 8, 8)):
            self.assertAlmostEqual(face["area"], area, places=12)
        for face in faces[7:]:
            self.assertTrue(0.97 * math.pi / 4 < face["area"] < math.pi / 4)
        for number, face in enumerate(faces, 1):
            low, high = face["box"]
            self.assertTrue(all(a <= x <= b for a, x, b in zip(low, face["at"], high)))
            self.write("job.toml", 'input.files = ["part.geom.toml"]\noutput.files = ["part.vtp"]\n'
                       f'[boundaries.picked]\nselect = {{ near = [{face["at"]}] }}\n')
            result = self.expect(0, "mesh", "job.toml", "-v", "--stop-after", "surface", "--accuracy", "coarse")
            self.assertIn(f"boundary 'picked': face {number}\n", result.stderr)
        flat = [face for face in faces if face["normal"]]
        self.assertEqual(len(flat), len(faces) - sum(face["name"].startswith("rod_side") for face in faces))

    def test_a_file_given_twice_is_said(self):
        self.write("ball.geom.toml", BALL)
        self.expect(2, "mesh", "ball.geom.toml", "ball.geom.toml", "-o", "ball.vtu", says="given twice")

    def test_a_far_field_round_another_is_warned_of(self):
        self.write("flow.geom.toml", '[[shape]]\ntype = "sphere"\nradius = 20\n'
                   '[[shape]]\ntype = "box"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nreversed = true\n')
        result = self.expect(0, "mesh", "flow.geom.toml", "-o", "flow.vtp", "--stop-after", "surface", "--farfield",
                             "sphere:3c", "--accuracy", "coarse")
        self.assertIn("far field of its own", case.unbroken(result.stderr))

    def test_shapes_that_cross_are_named(self):
        for x in ("0.8", "0"):  # the second: the same twice
            self.write("balls.geom.toml", '[[shape]]\ntype = "sphere"\nname = "left"\nradius = 1\n'
                       f'[[shape]]\ntype = "sphere"\nname = "right"\nradius = 1\norigin = [{x}, 0, 0]\n')
            self.expect(3, "mesh", "balls.geom.toml", "-o", "balls.vtu", says=["left", "right", "cross or touch"])
            self.assertEqual(self.files(), ["balls.geom.toml", "balls_defects.vtp"])

    def test_faces_are_selected_by_number_and_normal(self):
        self.write("room.geom.toml", '[[shape]]\ntype = "box"\nname = "room"\nmin = [0, 0, 0]\nmax = [1, 2, 3]\n')
        job = """[input]
files = ["room.geom.toml"]
[boundaries.floor]
select = { normal = [0, 0, -2] }
kind = "symmetry"
[boundaries.ends]
select = { id = [1, 2] }
[output]
files = ["room.vtu"]
report = "room.json"
"""
        self.write("room.toml", job)
        self.expect(0, "mesh", "room.toml")
        groups = {group["name"]: group for group in self.report("room.json")["boundaries"]}
        self.assertEqual(set(groups), {"floor", "ends", "room_y_low", "room_y_high", "room_z_high"})
        self.write("room.toml", job.replace("[1, 2]", "[1, 7]"))
        self.expect(2, "mesh", "room.toml", says=["room.toml:", "boundaries.ends", "has no face 7", "6"])
        self.write("room.toml", job.replace("-2]", "-2, 1]"))
        self.expect(2, "mesh", "room.toml", says=["room.toml:4"])
        self.write("room.toml", job.replace("[0, 0, -2]", "[1, 1, 1]"))
        self.expect(2, "mesh", "room.toml", says=["room.toml:4", "boundaries.floor", "no face", "looks along (1, 1, 1)"])

    def select(self, *selectors, code=0, says=()):
        """Boundaries of a room of 1 x 2 x 3, by selectors. @return names and triangles of what comes out"""
        self.write("room.geom.toml", '[[shape]]\ntype = "box"\nname = "room"\nmin = [0, 0, 0]\nmax = [1, 2, 3]\n')
        job = '[input]\nfiles = ["room.geom.toml"]\n[output]\nfiles = ["room.vtu"]\nreport = "room.json"\n'
        for name, selector in selectors:
            job += f"[boundaries.{name}]\nselect = {selector}\n"
        self.write("room.toml", job)
        self.expect(code, "mesh", "room.toml", "--stop-after", "surface", says=says)
        return {group["name"] for group in self.report("room.json")["boundaries"]} if code == 0 else None

    def test_patches_are_selected_by_a_list_of_names(self):
        self.assertEqual(self.select(("ends", '["room_z_low", "room_x_*"]'), ("side", '{ name = ["room_y_low"] }')),
                         {"ends", "side", "room_y_high", "room_z_high"})
        self.select(("ends", '["room_z_low", "roof"]'), code=2, says="boundaries.ends: no patch is called 'roof'")
        self.select(("ends", "[]"), code=2, says="an empty list selects no patch")
        self.select(("ends", '["room_z_low", 3]'), code=2, says="room.toml:7")

    def test_faces_are_selected_by_box(self):
        low = "{ box = { min = [0, 0, 0], max = [1, 2, 0] } }"  # a face in the box's sides lies in it
        self.assertEqual(self.select(("floor", low), ("ends", "{ box = { min = [-1, -1, -1], max = [0.5, 3, 4] } }")),
                         {"floor", "ends", "room_x_high", "room_y_low", "room_y_high", "room_z_high"})
        self.assertEqual(self.select(("all", "{ box = { min = [-1, -1, -1], max = [9, 9, 9] } }")), {"all"})
        self.select(("floor", "{ box = { min = [0, 0, 0], max = [1, 1.5, 0.5] } }"), code=2,
                    says=["room.toml:7", "boundaries.floor: no face of room.geom.toml lies in the box",
                          "face 5 ('room_z_low') comes nearest to that: it reaches from (0, 0, 0) to (1, 2, 0)"])
        self.select(("floor", "{ box = { min = [0, 0, 0], max = [1, -1, 0] } }"), code=2, says="0 to -1 along y")
        self.select(("floor", "{ box = { min = [0, 0, 0], mx = [1, 1, 0] } }"), code=2, says="did you mean 'max'")
        self.select(("floor", "{ box = { min = [0, 0, 0] } }"), code=2, says="a box has two corners")

    def test_faces_are_selected_by_the_nearest_place(self):
        self.assertEqual(self.select(("top", "{ near = [0.4, 1, 3.5] }"), ("ends", "{ near = [[0, 1, 1], [1.1, 1, 1]] }")),
                         {"top", "ends", "room_y_low", "room_y_high", "room_z_low"})
        self.select(("top", "{ near = [0, 1, 3] }"), code=2, says=["(0, 1, 3) is as near to face 1 ('room_x_low') as to"])
        self.select(("top", "{ near = [400, 1000, 3000] }"), code=2, says=["farther than that is wide", "unit"])

    def test_faces_are_selected_by_a_formula(self):
        self.assertEqual(self.select(("floor", '{ expression = "z < 0.1" }'), ("wide", '{ expression = "abs(x - 0.5) == 0.5" }')),
                         {"floor", "wide", "room_y_low", "room_y_high", "room_z_high"})
        self.select(("floor", '{ expression = "z < -1" }'), code=2,
                    says=["room.toml:7", "'z < -1' is true all over no face", "it is true nowhere"])
        self.select(("floor", '{ expression = "z > 1" }'), ("low", '{ expression = "z < 2 && x < 1 && y > 1" }'), code=2,
                    says=["boundaries.low", "comes nearest to that, with "])
        self.select(("floor", '{ expression = "zz < 1" }'), code=2, says=["room.toml:7", "boundaries.floor", "zz"])

    def test_ways_to_select_that_are_none(self):
        self.select(("floor", "{ bax = [0, 0, 0] }"), code=2, says=["nothing is selected by 'bax'", "did you mean 'box'"])
        self.select(("floor", '{ stl_solid = "a" }'), code=2, says="not in this version")
        self.select(("floor", '{ name = "room_z_low", id = 2 }'), code=2, says="room.toml:7")
        self.write("cube.stl", case.stl_binary(case.box_triangles()))
        self.expect(2, "mesh", "cube.stl", "-o", "a.vtu", "--set", "boundaries.a.select={ near = [0, 0, 0] }",
                    says="faces are selected in one file of smooth geometry")

    def test_convert_says_what_grids_it(self):
        self.write("ball.geom.toml", BALL)
        self.expect(2, "convert", "ball.geom.toml", "ball.stl", says="delfront mesh ball.geom.toml -o ball.stl --stop-after")

    def test_sizes_on_names_that_are_not_there_are_refused_before_gridding(self):
        self.write("room.geom.toml", SHELL)
        arguments = ["mesh", "room.geom.toml", "-o", "room.stl", "--stop-after", "surface"]
        self.expect(2, *arguments, "--set", "size.on.rinq.h=0.1", says=["size.on.rinq", "ring"])
        self.expect(2, *arguments, "--set", "size.on.farfield.h=1", says="size.on.farfield")
        self.expect(0, *arguments, "--farfield", "box:2c", "--set", "size.on.farfield.h=3")

    def test_surface_alone(self):
        self.write("ball.geom.toml", BALL)
        self.expect(0, "mesh", "ball.geom.toml", "-o", "ball.stl", "--stop-after", "surface", "--hmax", "0.1")
        self.expect(0, "info", "ball.stl", says="can bound a volume yes")

    def test_sizes_and_boundaries_of_a_job(self):
        self.write("room.geom.toml", SHELL)
        self.write("case.toml", """
[input]
files = ["room.geom.toml"]
[boundaries.outer]
select = "room_*"
kind = "farfield"
[size]
hmax = 0.8
[size.on.ring]
h = 0.12
[output]
files = ["out.vtu"]
report = "out.json"
""")
        self.expect(0, "mesh", "case.toml")
        report = self.report("out.json")
        kinds = {group["name"]: (group["kind"], group["num_cells"]) for group in report["boundaries"]}
        self.assertEqual(set(kinds), {"outer", "ring"})
        self.assertEqual(kinds["ring"][0], "wall")
        area = 4 * math.pi ** 2 * 1.5 * 0.5
        self.assertAlmostEqual(kinds["ring"][1] / (area / (0.433 * 0.12 ** 2)), 1, delta=0.25)
        self.assertAlmostEqual(report["quality"]["volume"], 216 - 2 * math.pi ** 2 * 1.5 * 0.25, delta=0.2)

    def test_far_field_and_facets_beside_it(self):
        self.write("ball.geom.toml", BALL)
        self.write("cube.stl", case.stl_binary(case.box_triangles((3, 0, 0), (4, 1, 1))))
        report = self.grid("ball.geom.toml", "cube.stl", "--farfield", "sphere:10")
        self.assertEqual({group["name"] for group in report["boundaries"]}, {"sphere", "cube", "farfield"})

    def test_the_same_bytes_for_any_number_of_threads(self):
        self.write("room.geom.toml", SHELL)
        grids = []
        for threads in (1, 2, 8):
            self.grid("room.geom.toml", "-j", threads)
            grids.append((self.folder / "out.vtu").read_bytes())
        self.assertEqual(grids[0], grids[1])
        self.assertEqual(grids[0], grids[2])

    def test_in_space_instead_of_through_parameters(self):
        self.write("ball.geom.toml", BALL)
        report = self.grid("ball.geom.toml", "--surface-method", "front")
        self.assertAlmostEqual(report["quality"]["volume"] / (4 * math.pi / 3), 1, delta=0.03)

    def test_levels_put_new_points_near_the_true_surface(self):
        self.write("ball.geom.toml", BALL)
        report = self.grid("ball.geom.toml", "--levels", "1", "--hmax", "0.1")
        plain = self.grid("ball.geom.toml", "--hmax", "0.1")
        self.assertAlmostEqual(report["quality"]["volume"] / plain["quality"]["volume"], 1, delta=0.01)

    def test_curvature_alone_changes_round_things_alone(self):
        self.write("ball.geom.toml", BALL)
        coarse = self.grid("ball.geom.toml", "--hmax", "1", "--curvature", "12")["surface"]["mean_edge"]
        fine = self.grid("ball.geom.toml", "--hmax", "1", "--curvature", "36")["surface"]["mean_edge"]
        self.assertAlmostEqual(coarse / fine, 3, delta=0.3)

    def test_accuracy_is_one_word_for_all(self):
        self.write("ring.geom.toml", '[[shape]]\ntype = "torus"\nradius = 2\ntube = 0.4\n')
        grids = [self.grid("ring.geom.toml", "--accuracy", word, "--stop-after", "surface")["geometry"][0]["rounds"][-1]
                 for word in ("coarse", "medium", "fine")]
        for coarse, fine in zip(grids, grids[1:]):
            self.assertGreater(fine["triangles"], 2 * coarse["triangles"])
            self.assertLess(fine["deviation"]["value"], 0.6 * coarse["deviation"]["value"])
        self.expect(2, "mesh", "ring.geom.toml", "-o", "a.vtu", "--accuracy", "finest", says="medium")

    def test_plates_get_cells_as_thin_as_they_are_unless_switched_off(self):
        self.write("plate.geom.toml", '[[shape]]\ntype = "box"\nmin = [0, 0, 0]\nmax = [1, 1, 0.05]\n')
        for keys, most in (((), 0.08), (("--set", "size.automatic=false"), 0.2)):
            report = self.grid("plate.geom.toml", "--stop-after", "surface", *keys)
            self.assertLess(report["surface"]["mean_edge"], most)
        self.assertGreater(report["surface"]["mean_edge"], 0.05)

    def test_deviation_is_kept_to(self):
        self.write("ball.geom.toml", BALL)
        report = self.grid("ball.geom.toml", "--hausd", "0.01", "--hmax", "1", "--stop-after", "surface")
        self.assertLessEqual(report["geometry"][0]["rounds"][-1]["deviation"]["value"], 0.01)

    def test_examples(self):
        for folder in ("swept_wing", "onera_m6", "smooth_shapes"):
            sys.path.insert(0, str(case.ROOT / "examples" / folder))
        import make_m6
        import make_shapes
        texts = {"m6": make_m6.wing(), **{name: shape() for name, shape in make_shapes.SHAPES.items() if name != "blade"}}
        for name, text in texts.items():
            with self.subTest(name):
                self.write(f"{name}.geom.toml", "\n".join(text))
                report = self.grid(f"{name}.geom.toml", "--stop-after", "surface")
                self.assertEqual(report["surface"]["is_closed"], name != "patch")
                last = report["geometry"][0]["rounds"][-1]
                self.assertGreater(last["min_angle_away_from_sharp_corners"]["value"], 20)
                self.assertEqual(report["geometry"][0]["stopped"], "")

    def test_bad_files_are_refused_with_their_line(self):
        for text, says in ((BALL.replace("radius", "raduis"), "bad.geom.toml:3"), ("[[shape]\n", "not valid TOML"),
                           ("", "empty"), (BALL.replace("1", "-1"), "above 0"), ("tolerance = 1\n", "no faces")):
            with self.subTest(text):
                self.write("bad.geom.toml", text)
                for command in (["mesh", "bad.geom.toml", "-o", "out.vtu"], ["info", "bad.geom.toml"],
                                ["check", "bad.geom.toml"]):
                    self.expect(3, *command, says=says)
                self.assertFalse((self.folder / "out.vtu").exists())

    def test_methods_that_do_not_fit(self):
        self.write("ball.geom.toml", BALL)
        self.write("cube.stl", case.stl_binary(case.box_triangles()))
        self.expect(2, "mesh", "cube.stl", "-o", "a.vtu", "--surface-method", "mapped", says="smooth geometry")
        self.expect(2, "mesh", "ball.geom.toml", "-o", "a.vtu", "--surface-method", "delaunay", says="mapped or front")

    def test_example_wing(self):
        sys.path.insert(0, str(case.ROOT / "examples" / "swept_wing"))
        import make_wing
        self.write("wing.geom.toml", "\n".join(make_wing.wing(41, 0.1)))
        self.expect(0, "info", "wing.geom.toml", says=["trailing_edge", "can bound a volume yes"])
        report = self.grid("wing.geom.toml", "--stop-after", "surface")
        self.assertTrue(report["surface"]["is_closed"])
        root, tip = make_wing.ROOT_CHORD, make_wing.TIP_CHORD
        section = 2 * 5 * 0.1 * sum(a / p for a, p in zip(make_wing.COEFFICIENTS, (1.5, 2, 3, 4, 5)))
        volume = section * make_wing.SEMISPAN * (root * root + root * tip + tip * tip) / 3
        self.assertAlmostEqual(report["surface"]["volume"] / volume, 1, delta=0.01)


if __name__ == "__main__":
    unittest.main()
