# SPDX-License-Identifier: Apache-2.0
"""The scripts of bench/ on tiny inputs: what stands in the tables is right."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
FOLDER = tempfile.TemporaryDirectory(prefix="delfront_bench_")
os.environ["DELFRONT_PEERS"] = FOLDER.name
sys.path.insert(0, str(ROOT / "bench"))
from compare import grids, peers, results, running, shapes, tables  # noqa: E402

DELFRONT = os.environ.get("DELFRONT", "")


def bench(script, *arguments):
    command = [sys.executable, str(ROOT / "bench" / script), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


class Measuring(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def run_tool(self, code, limit=20, **fields):
        tool = running.Tool("tool", 1, [sys.executable, "-c", code], **fields)
        return running.run_once(tool, Path(self.folder.name), peers.build_launcher(), limit)

    def test_the_memory_is_the_tools_own(self):
        ballast = np.ones(40_000_000)  # ours: 320 MB
        small = self.run_tool("pass")["rss"]
        large = self.run_tool("x = b'1' * 100_000_000")["rss"]
        self.assertLess(small, 60e6)
        self.assertAlmostEqual((large - small) / 1e8, 1, delta=0.1)
        self.assertEqual(ballast.sum(), 4e7)

    def test_a_tool_that_takes_too_long_or_fails_is_named(self):
        self.assertEqual(self.run_tool("import time; time.sleep(30)", limit=1)["failure"], "stopped after 1 s")
        self.assertIn("failed (status 3)", self.run_tool("raise SystemExit(3)")["failure"])
        self.assertIn("failed (status 0)", self.run_tool("pass", outputs=["o.mesh"])["failure"])

    def test_tools_take_turns_and_a_missing_one_keeps_its_row(self):
        log = Path(self.folder.name) / "order"
        tools = []
        for name in "AB":
            code = f"open({str(log)!r}, 'a').write('{name}')"
            tools.append(running.Tool(name, 1, [sys.executable, "-c", code], phase=lambda folder, text: 2.0))
        tools.append(running.Tool("C", 1, ["c"], missing="C cannot be had"))
        limits = running.Limits(3, 20, 100)
        rows = running.run_interleaved(
            tools, Path(self.folder.name), peers.build_launcher(), limits, "now", lambda text: None
        )
        self.assertEqual(log.read_text(), "ABABAB")
        self.assertEqual([len(row["runs"]) for row in rows], [3, 3, 0])
        self.assertEqual(rows[2]["failure"], "not installed: C cannot be had")

    def test_a_further_run_extends_the_results_and_ratios_stay_within_a_run(self):
        def row(tool, stamp, seconds):
            runs = [{"phase": seconds, "whole": seconds, "rss": 1e6}]
            row = {"tool": tool, "version": "1", "threads": 1, "command": tool, "stamp": stamp, "failure": ""}
            return row | {"runs": runs, "facts": {"tets": 60, "volume": 1.0}, "loads": [0.0]}

        facts = {"points": 10, "about": "x", "work": "points"}
        case = {"name": "uniform", "size": 10, "facts": facts, "machine": "m"}
        found = {"cases": {}}
        results.add_case(
            found, "points/uniform/10", {**case, "rows": [row("delfront", "1", 1.0), row("slow", "1", 3.0)]}
        )
        self.assertIn("| 1.000 | 3.000 | **3.00** | 3.00 | slow 1, 1 thread |", tables.section("points", found))
        results.add_case(found, "points/uniform/10", {**case, "rows": [row("fast", "2", 0.5)]})
        self.assertEqual([r["tool"] for r in found["cases"]["points/uniform/10"]["rows"]], ["delfront", "slow", "fast"])
        self.assertIn("**3.00**", tables.section("points", found))
        results.add_case(found, "points/uniform/10", {**case, "rows": [row("fast", "1", 0.5)]})
        self.assertIn("**0.50**", tables.section("points", found))
        found["cases"]["points/uniform/10"]["rows"][2]["facts"]["volume"] = 1.1
        page = tables.section("points", found)
        self.assertIn("volume off by 1.0e-01", page)
        self.assertIn("**3.00**", page)  # a wrong result is no rival


class Shapes(unittest.TestCase):
    def test_point_sets(self):
        for kind in shapes.POINT_SETS:
            points = shapes.make_points(kind, 1000)
            self.assertEqual((points.shape, len(np.unique(points, axis=0))), ((1000, 3), 1000), kind)
        radius = np.linalg.norm(shapes.make_points("graded", 20_000), axis=1)
        in_each_decade = np.histogram(np.log10(radius), bins=[-5, -4, -3, -2, -1, 0])[0]
        self.assertLess(np.abs(in_each_decade / 4000 - 1).max(), 0.1)

    def test_halving_edges_keeps_a_closed_surface_and_its_volume(self):
        points, triangles = shapes.geodesic_sphere(3)
        self.assertEqual((len(points), len(triangles)), (92, 180))
        more, finer = shapes.split_long_edges(points, triangles, 0.1)
        sides = np.sort(finer[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, uses = np.unique(sides, axis=0, return_counts=True)
        self.assertTrue((uses == 2).all())
        self.assertLessEqual(np.linalg.norm(more[edges[:, 0]] - more[edges[:, 1]], axis=1).max(), 0.1)
        volume = shapes.enclosed_volume(points, triangles)
        self.assertAlmostEqual(shapes.enclosed_volume(more, finer), volume, places=12)
        self.assertGreater(grids.triangle_angles(more, finer).min(), 25)

    def test_medit_is_read_in_small_parts(self):
        points, triangles = shapes.geodesic_sphere(4)
        with tempfile.TemporaryDirectory() as folder:
            shapes.write_surface(Path(folder), points, triangles)
            whole, grids.PART_BYTES = grids.PART_BYTES, 300
            try:
                read = grids.read_medit(Path(folder) / "s.mesh", b"Triangles", 3)
            finally:
                grids.PART_BYTES = whole
        np.testing.assert_array_equal(read[0], points)
        np.testing.assert_array_equal(read[1], triangles)

    def test_the_quality_of_a_regular_tet(self):
        points = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float)
        found = grids.measure_tets(points, np.array([[0, 1, 2, 3]]))
        angle = np.degrees(np.arccos(1 / 3))
        np.testing.assert_allclose([found["min_dihedral"], found["max_dihedral"]], angle, rtol=1e-12)
        np.testing.assert_allclose(found["mean_min_dihedral"], angle, rtol=1e-12)
        np.testing.assert_allclose([found["volume"], found["eta"], found["below_10"]], [8 / 3, 1, 0], rtol=1e-12)

    def test_edges_are_counted_once_and_sampled_evenly(self):
        points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
        tets = np.array([[0, 1, 2, 3], [4, 3, 2, 1]])  # three edges of length 1, six of sqrt 2, of which three shared
        self.assertEqual(len(grids.sample_edges(tets)), 9)
        near = grids.edges_near(points, tets, lambda places: np.ones(len(places)))
        np.testing.assert_allclose(near["edges_near"], 3 / 9)
        np.testing.assert_allclose(near["edge_ratio"], (3 + 6 * 2**0.5) / 9)
        np.testing.assert_allclose(near["edges_alike"], 6 / 9)  # 1 is 0.78 of the mean
        chain = np.arange(40_000)[:, None] + np.arange(4)
        every = {tuple(edge) for edge in grids.sample_edges(chain, 10**9)}
        some = grids.sample_edges(chain, 6_000)
        self.assertEqual(len(every), 3 * 40_000 + 3)
        self.assertTrue({tuple(edge) for edge in some} <= every)
        self.assertAlmostEqual(len(some) / (len(every) / 8), 1, delta=0.05)
        self.assertLess(abs(some.mean() / 20_000 - 1), 0.03)


@unittest.skipUnless(DELFRONT, "DELFRONT names no program")
class WholeRuns(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page, self.results = Path(folder.name) / "p.md", Path(folder.name) / "r.json"

    def test_the_table_has_our_row_and_all_volumes_agree(self):
        where = ["--delfront", DELFRONT, "--results", self.results, "--docs", self.page, "--write-docs"]
        what = ["--workload", "fill", "--cases", "sphere", "--sizes", "1e4", "--threads", "1", "--repeat", "2"]
        done = bench("compare_peers.py", *where, *what, "--tools", "delfront,tetgen,hxt")
        self.assertEqual(done.returncode, 0, done.stderr)
        (case,) = json.loads(self.results.read_text())["cases"].values()
        rows = {row["tool"]: row for row in case["rows"]}
        ours = rows["delfront"]
        self.assertEqual((ours["failure"], len(ours["runs"])), ("", 2))
        self.assertGreater(ours["facts"]["tets"], 5000)
        self.assertTrue(all(run["phase"] <= run["whole"] for run in ours["runs"]))
        for row in case["rows"]:
            if row["failure"]:
                self.assertIn("not installed", row["failure"], row["tool"])
            else:
                self.assertAlmostEqual(row["facts"]["volume"] / case["facts"]["volume"], 1, delta=1e-8, msg=row["tool"])
        page = self.page.read_text()
        self.assertIn("| delfront ", page)
        self.assertIn("| TetGen", page)
        again = bench("compare_peers.py", "--tables", *where)
        self.assertEqual((again.returncode, self.page.read_text()), (0, page), again.stderr)

    def test_refinement_beside_gmsh_on_a_small_ball(self):
        done = bench("refine_grid.py", "--delfront", DELFRONT, "--tets", "5e3", "--repeat", "1", "--threads", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [[word.strip() for word in line.split("|")[1:-1]] for line in done.stdout.splitlines() if line[:1] == "|"]
        ours = [row for row in rows if row[1].startswith("delfront")]
        self.assertEqual(len(ours), 2, done.stdout)
        for row in ours:
            self.assertGreater(float(row[2]), 0)
            self.assertLess(float(row[3]), float(row[5]))
        for row in rows:
            self.assertNotIn("tets)", row[1])  # Gmsh makes as many as we do

    def test_the_front_beside_peers_on_small_surfaces(self):
        done = bench("front.py", "--quick", "--delfront", DELFRONT, "--docs", self.page, "--write-docs")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.strip(), self.page.read_text().strip())
        tables_of_page, rows = [], []
        for line in [*done.stdout.splitlines(), ""]:
            if line.startswith("|"):
                rows.append([word.strip() for word in line.split("|")[1:-1]])
            elif rows:
                tables_of_page.append([dict(zip(rows[0], row)) for row in rows[2:]])
                rows = []
        self.assertEqual(len(tables_of_page), 6)
        for speed, quality in (tables_of_page[2:4], tables_of_page[4:6]):
            ours = [row for row in speed if row["tool"].startswith("delfront")]
            self.assertEqual(len(ours), 9)
            for row in ours:
                self.assertGreater(float(row["gridding s"]), 0)
                self.assertLess(float(row["gridding s"]), float(row["whole s"]) + 0.01)
                self.assertEqual("same bytes as -j" in row["remark"], ", raw" in row["tool"], row)
            for row in speed:
                self.assertFalse("off by" in row.get("remark", "") or "other bytes" in row.get("remark", ""), row)
            angles = {row["tool"]: float(row["worst °"]) for row in quality}
            self.assertGreater(angles["delfront front, improved"], angles["delfront front, raw"])
            fronts = [row for row in quality if row["sweeps"] != "–"]
            self.assertEqual({row["tool"] for row in fronts}, {"delfront front, raw", "delfront front, improved"})

    def test_the_stage_table_adds_up(self):
        done = bench("stage_breakdown.py", "--delfront", DELFRONT, "--tets", "1e4", "--points", "1e4", "--threads", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split("|")[1:4] for line in done.stdout.splitlines() if line.startswith("| ") and "%" in line]
        seconds = {row[0].strip(): float(row[1]) for row in rows if row[1].strip()[0].isdigit() and "%" in row[2]}
        total = seconds.pop("**all**")
        self.assertTrue({"recover", "refine", "improve", "write"} <= set(seconds), done.stdout)
        self.assertAlmostEqual(sum(seconds.values()), total, delta=0.001 * len(seconds))


if __name__ == "__main__":
    unittest.main()
