#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""--report NAME.html: a page that stands alone, says what the JSON beside it says, and is there when a run fails."""
import base64
import html.parser
import json
import os
import re
import unittest

import case

VOID = {"meta", "br", "hr", "img", "input", "link"}
ALLOWED = set("""html head meta title style body main header h1 h2 h3 p div section span b code table tr th td ul li figure
    figcaption details summary footer br svg rect line polygon text img i""".split())
PICTURE = "data:image/png;base64,"
ODD = """a <script>alert("1")</script> & 'b'"""  # a name


class Page(html.parser.HTMLParser):
    """Every tag is closed where it has to be; texts by the tags and classes they stand in."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.attributes, self.texts = [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        assert len(dict(attrs)) == len(attrs), f"an attribute twice: {tag} {attrs}"
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in VOID:
            self.open.append((tag, dict(attrs).get("class", "").split()))

    def handle_startendtag(self, tag, attrs):
        assert any(name == "svg" for name, _ in self.open), f"<{tag}/> is for SVG alone"
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag):
        assert self.open and self.open[-1][0] == tag, f"</{tag}> in {self.open}"
        self.open.pop()

    def handle_data(self, data):
        self.texts.append((list(self.open), data))

    def text(self, tag=None, kind=None):
        """All text in elements of that tag or class."""
        return " ".join(" ".join(data for inside, data in self.texts
                                 if any((tag in (None, t)) and (kind is None or kind in k) for t, k in inside)).split())


def read_page(test, name="r.html"):
    """The page, which opens without anything else and runs nothing."""
    text = (test.folder / name).read_text(encoding="utf-8")
    test.assertTrue(text.startswith("<!DOCTYPE html>"))
    page = Page(text)
    test.assertEqual(set(page.tags) - ALLOWED, set())
    for tag, attribute, value in page.attributes:
        if (tag, attribute) == ("img", "src"):  # within the page
            test.assertTrue(value.startswith(PICTURE), value[:40])
            test.assertTrue(base64.b64decode(value[len(PICTURE):], validate=True).startswith(b"\x89PNG"))
            continue
        test.assertNotIn(attribute, ("src", "href", "srcset", "action", "data"), tag)
        test.assertFalse(attribute.startswith("on"), attribute)
        test.assertNotRegex(value, r"url\(|https?:|javascript:")
    style = page.text("style")
    test.assertNotRegex(style, r"url\(|@import|https?:")
    test.assertIn("prefers-color-scheme: dark", style)
    test.assertIn("@media print", style)
    return page


def run_with_page(test, code, *arguments):
    """The page and the report of a run; nothing temporary is left."""
    test.expect(code, *arguments, "--report", "r.html")
    test.assertEqual([f for f in test.files() if f.startswith((".", "r.")) and f not in ("r.html", "r.json")], [])
    return read_page(test), test.report("r.json")


def write_ball(test):
    test.write("ball.stl", case.stl_ascii(case.sphere_triangles(2), "ball"))


class Contents(case.Case):
    def setUp(self):
        super().setUp()
        write_ball(self)

    def test_a_volume_says_what_its_json_says(self):
        page, report = run_with_page(self, 0, "mesh", "ball.stl", "-o", "ball.vtu", "--hmax", "0.3")
        quality = report["quality"]
        tiles, verdict = page.text(kind="tiles"), page.text(kind="verdict")
        for count, what in ((quality["num_cells"], "cells"), (quality["num_points"], "points"),
                            (quality["num_boundary_faces"], "boundary faces")):
            self.assertIn(f"{count:,} {what}", tiles)
        self.assertIn(f"Valid grid: {quality['num_cells']:,} cells", verdict)
        self.assertEqual(report["grid_findings"], [])
        angles = quality["measures"]["min_dihedral"]
        self.assertIn(f"{angles['min']:.4g}°", verdict)
        cells = page.text(kind="cells")
        for rank, worst in enumerate(angles["worst"], 1):
            self.assertIn(f"{rank}. {worst['value']:.4g}° cell {worst['cells'][0]}", cells)
        self.assertEqual(sum(a == ("svg", "class", "cell") for a in page.attributes), len(angles["worst"]))
        self.assertEqual(sum(a == ("line", "class", "sharp") for a in page.attributes), len(angles["worst"]))
        self.assertEqual(page.tags.count("img"), 1)
        self.assertEqual(page.text(kind="names"), " ".join(group["name"] for group in report["boundaries"]))
        charts = sum(a == ("svg", "class", "chart") for a in page.attributes)
        self.assertEqual(charts, len(quality["measures"]) + 1)  # and sizes
        titles = [data for inside, data in page.texts if inside and inside[-1][0] == "title"][1:]
        counts = [int(title.rsplit(": ", 1)[1].replace(",", "")) for title in titles]
        drawn = [n for histogram in [report["size_fit"]["ratio"], *quality["measures"].values()]
                 for n in histogram["histogram"]["counts"]]
        self.assertEqual(counts, drawn)
        table = page.text("table")
        for group in report["boundaries"] + report["regions"]:
            self.assertIn(f"{group['name']} ", table)
            self.assertIn(f"{group['num_cells']:,} {group['measure']:.4g}", table)
        for stage in report["stages"]:
            self.assertIn(stage["stage"], table)
        self.assertIn("delfront " + report["delfront"], page.text("footer"))
        self.assertIn("size.hmax = 0.3", page.text(kind="columns"))
        self.assertIn(report["inputs"][0]["hash"], table)

    def test_areas_and_volumes_are_right(self):
        self.write("box.stl", case.stl_ascii(case.box_triangles(high=(1, 2, 3)), "box"))
        for units in ([], ["--units", "m", "--output-units", "mm"]):
            _, report = run_with_page(self, 0, "mesh", "box.stl", "-o", "box.vtu", "--hmax", "0.5", *units)
            self.assertAlmostEqual(report["boundaries"][0]["measure"], 22, places=9)
            self.assertAlmostEqual(report["regions"][0]["measure"], 6, places=9)
            self.assertAlmostEqual(report["regions"][0]["measure"], report["quality"]["volume"], places=9)

    def test_sizes_of_a_grid_fit_what_was_asked(self):
        _, report = run_with_page(self, 0, "mesh", "ball.stl", "-o", "ball.vtu", "--surface-method", "front", "--hmax", "0.15")
        fit = report["size_fit"]
        counts = fit["ratio"]["histogram"]["counts"]
        edges = sum(report["quality"]["measures"]["edge_length"]["histogram"]["counts"])
        self.assertEqual(sum(counts), edges)
        self.assertGreater(fit["share_of_right_sides"], 0.8)
        inside = sum(counts[7:14]) / edges  # 0.7 to 1.4 are bins of their own
        self.assertAlmostEqual(fit["share_of_right_sides"], inside, places=2)
        longest = report["quality"]["measures"]["edge_length"]["max"]
        self.assertLess(fit["ratio"]["max"], longest / 0.15 * 3)

    def test_names_cannot_break_out(self):
        name = f"{ODD}.stl"
        self.write(name.replace("/", "_"), case.stl_ascii(case.box_triangles(), ODD))
        page, report = run_with_page(self, 0, "mesh", name.replace("/", "_"), "-o", "box.vtu", "--hmax", "0.5")
        self.assertNotIn("script", page.tags)
        self.assertIn(name.replace("/", "_"), page.text("h1"))
        self.assertIn(report["boundaries"][0]["name"], page.text("table"))
        self.assertIn("<script>", report["boundaries"][0]["name"])

    def test_bytes_that_are_no_text(self):
        bad = "od\udcff\x01d.stl"
        with open(os.fsencode(self.folder / bad), "w") as file:
            file.write(case.stl_ascii(case.box_triangles(), "box"))
        page, _ = run_with_page(self, 0, "mesh", bad, "-o", "box.vtu")
        self.assertIn("od\ufffd\ufffdd.stl", page.text("h1"))

    def test_the_plane(self):
        self.write("square.poly", "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n4 0\n0 0 1\n1 1 2\n2 2 3\n3 3 0\n0\n")
        page, report = run_with_page(self, 0, "mesh", "square.poly", "-o", "s.vtu", "--hmax", "0.1", "--set",
                                          "planar.boundary=split")
        self.assertIn("smallest angle", page.text(kind="verdict"))
        self.assertGreater(len(report["curves"]), 0)
        self.assertAlmostEqual(sum(c["measure"] for c in report["curves"]), 4, places=9)
        self.assertAlmostEqual(sum(r["measure"] for r in report["boundaries"]), 1, places=9)
        self.assertIn(f"{report['quality']['num_cells']:,} cells", page.text(kind="tiles"))

    def test_surface_alone_estimate_and_refine(self):
        page, report = run_with_page(self, 0, "mesh", "ball.stl", "-o", "new.stl", "--stop-after", "surface")
        self.assertIn(f"Surface written: {report['boundaries'][0]['num_cells']} facets", page.text(kind="verdict"))
        page, report = run_with_page(self, 0, "estimate", "ball.stl")
        self.assertIn("cells are to be expected", page.text(kind="verdict"))
        run_with_page(self, 0, "sizes", "ball.stl", "-o", "sizes.vtu")
        self.expect(0, "mesh", "ball.stl", "-o", "ball.vtu")
        page, report = run_with_page(self, 0, "refine", "ball.vtu", "-o", "fine.vtu", "--geometry", "ball.stl")
        self.assertIn(f"Valid grid: {report['cells']['tetrahedron']:,} cells", page.text(kind="verdict"))
        self.assertEqual(report["quality"]["num_cells"], report["cells"]["tetrahedron"])

    def test_the_same_but_for_times(self):
        pages = []
        for threads in (1, 2):
            self.expect(0, "mesh", "ball.stl", "-o", "ball.vtu", "--hmax", "0.3", "--report", "r.html", "-j", threads)
            text = (self.folder / "r.html").read_text(encoding="utf-8")
            text = re.sub(r"-j \d", "", text)
            text = re.sub(r"[\d.]+( s| MB| min)\b|width:[\d.]+%|[\d,]+ bytes of memory", "", text)
            pages.append(text)
        self.assertEqual(*pages)


class Failing(case.Case):
    def setUp(self):
        super().setUp()
        write_ball(self)

    def test_an_open_surface(self):
        self.write("open.stl", case.stl_ascii(case.box_triangles()[:-1], "open"))
        page, report = run_with_page(self, 3, "mesh", "open.stl", "-o", "open.vtu")
        self.assertIn("No grid.", page.text(kind="verdict"))
        finding = next(f for f in report["surface"]["findings"] if f["kind"] == "open_edges")
        wrong = page.text("section")
        self.assertIn("open_edges", wrong)
        self.assertIn(finding["message"], wrong)
        at = ", ".join(f"{x:.6g}" for x in finding["places"][0]["at"])
        self.assertIn(f"at ({at})", wrong)
        self.assertIn("open_defects.vtp", wrong)

    def test_a_gate_that_is_not_met(self):
        page, report = run_with_page(self, 5, "mesh", "ball.stl", "-o", "ball.vtu", "--require", "max_nonortho < 1")
        self.assertIn(report["failed_gates"][0], page.text(kind="verdict"))
        worst = report["quality"]["measures"]["max_nonortho"]["worst"][0]
        self.assertIn(f"cells {worst['cells'][0]} {worst['cells'][1]}", page.text(kind="cells"))
        self.assertIn("largest non-orthogonality (gate not met)", page.text(kind="bad"))

    def test_no_input_and_a_limit(self):
        page, _ = run_with_page(self, 3, "mesh", "nowhere.stl", "-o", "a.vtu")
        self.assertIn("nowhere.stl", page.text(kind="verdict"))
        page, _ = run_with_page(self, 6, "mesh", "ball.stl", "-o", "a.vtu", "--hmax", "0.05", "--growth", "1.1",
                                     "--max-cells", 50)
        self.assertIn("limit_reached", page.text(kind="verdict"))
        page, _ = run_with_page(self, 3, "refine", "nowhere.vtu", "-o", "a.vtu")
        self.assertIn("nowhere.vtu", page.text(kind="verdict"))

    def test_places_that_cannot_be_written(self):
        before = self.files()
        self.expect(7, "mesh", "ball.stl", "-o", "a.vtu", "--report", "nofolder/r.html", says="nofolder/r.json")
        (self.folder / "r.json").mkdir()
        self.expect(7, "mesh", "ball.stl", "-o", "a.vtu", "--report", "r.html", says="r.json")
        (self.folder / "r.json").rmdir()
        self.expect(7, "refine", "ball.stl", "-o", "a.vtu", "--report", "nofolder/r.html", says="nofolder/r.json")
        self.assertEqual(self.files(), before)

    def test_files_of_the_grid_are_not_written_over(self):
        (self.folder / "case").mkdir()
        self.expect(0, "mesh", "ball.stl", "-o", "case/", "--solver", "openfoam", "--report", "case/run.html")
        for report in ("case/constant/polyMesh/points", "case/system/controlDict", "case/0/U"):
            self.expect(2, "mesh", "ball.stl", "-o", "case/", "--solver", "openfoam", "--report", report, says="one of the files of case/")
        self.expect(2, "mesh", "ball.stl", "-o", "g.su2", "--solver", "su2", "--report", "g.cfg", says="one of the files of g.su2")
        self.expect(2, "mesh", "ball.stl", "-o", "g.su2", "--report", "-", says="goes to a file")

    def test_the_job_file_is_not_written_over(self):
        job = json.dumps({"input": {"files": ["ball.stl"]}, "output": {"files": ["a.vtu"]}})
        self.write("case.json", job)
        for report in ("case.html", "case.json"):
            self.expect(2, "mesh", "case.json", "--report", report, says="case.json would be written over")
            self.assertEqual((self.folder / "case.json").read_text(), job)
        self.expect(2, "mesh", "ball.stl", "-o", "a.html", "--report", "a.html")
        self.assertEqual(self.files(), ["ball.stl", "case.json"])


if __name__ == "__main__":
    unittest.main()
