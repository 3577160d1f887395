# SPDX-License-Identifier: Apache-2.0
"""The scripts that draw, compare and call other programs, on tiny inputs."""

import os
import subprocess
import sys
import tempfile
import textwrap
import unittest

import matplotlib.image
import meshio
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SCRIPTS = os.path.join(ROOT, "scripts")


def cube_grid(n):
    """n^3 cubes of the unit cube, six tetrahedra each, with its boundary as patch 0."""
    lattice = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    corner = lattice[(lattice < n).all(axis=1)]
    tets = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        path = [corner]
        for axis in order:
            path.append(path[-1] + np.eye(3, dtype=int)[axis])
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        path = path if even else [path[1], path[0], path[2], path[3]]
        tets.append(np.stack([p @ [(n + 1) ** 2, n + 1, 1] for p in path], axis=1))
    tets = np.concatenate(tets)
    faces = np.sort(tets[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3), axis=1)
    faces, count = np.unique(faces, axis=0, return_counts=True)
    boundary = faces[count == 1]
    patch = [np.full(len(tets), -1), np.zeros(len(boundary), int)]
    return meshio.Mesh(lattice / n, [("tetra", tets), ("triangle", boundary)], cell_data={"patch_id": patch})


def run(script, *arguments, **environment):
    program = ["bash"] if script.endswith(".sh") else [sys.executable]
    command = [*program, os.path.join(SCRIPTS, script), *arguments]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **environment})


class Scripts(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.grid = os.path.join(self.folder.name, "cube.vtu")

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def test_picture_shows_the_cut_in_the_colour_of_the_quality(self):
        cube_grid(3).write(self.grid)
        done = run("picture.py", self.grid, self.path("cube.png"), "--normal", "-1,0,0", DISPLAY="")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("162 tetrahedra, smallest dihedral angle 45.00", done.stdout)
        image = matplotlib.image.imread(self.path("cube.png"))[:, :, :3]
        self.assertEqual(image.shape, (900, 1600, 3))
        middle = image[350:550, 600:800].reshape(-1, 3).mean(axis=0)
        self.assertGreater(middle[1], 1.15 * middle[0])  # 45 degrees: greenish blue, neither paper nor grey boundary

    def test_picture_of_a_surface(self):
        grid = cube_grid(2)
        meshio.Mesh(grid.points, [("triangle", grid.cells_dict["triangle"])]).write(self.grid)
        for by in ("quality", "region"):
            done = run("picture.py", self.grid, self.path("cube.png"), "--by", by, DISPLAY="")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("48 triangles, smallest angle 45.00", done.stdout)
            middle = matplotlib.image.imread(self.path("cube.png"))[400:500, 750:850, :3].reshape(-1, 3).mean(axis=0)
            self.assertEqual(middle[2] > 1.15 * middle[0], by == "quality", middle)  # bluish, or grey

    def test_picture_of_a_plane(self):
        """A square of 8 equal triangles, and one flat triangle beside it: red among blue, or all of one colour."""
        n = np.arange(9)
        points = np.c_[n % 3, n // 3, 0 * n].astype(float)
        points = np.concatenate([points, [[4, 1, 0]]])
        square = [(i, i + 1, i + 4) for i in (0, 1, 3, 4)] + [(i, i + 4, i + 3) for i in (0, 1, 3, 4)]
        cells = [("triangle", np.array(square + [(2, 9, 5), (5, 9, 8)])), ("line", np.array([(0, 1), (1, 2)]))]
        meshio.Mesh(points, cells).write(self.grid)
        shares = {}
        for by, zoom in (("quality", "0,0,4,2"), ("region", "0,0,4,2"), ("quality", "-1,-1,2,2")):
            done = run("picture.py", self.grid, self.path("p.png"), "--by", by, "--zoom", zoom, DISPLAY="")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("10 cells, smallest angle 26.57", done.stdout)
            image = matplotlib.image.imread(self.path("p.png"))[:, :, :3]
            shares[by, zoom] = (image[:, :, 0] > image[:, :, 2] + 0.1).mean()  # red over blue
        self.assertGreater(shares["quality", "0,0,4,2"], 0.2)
        self.assertLess(shares["region", "0,0,4,2"], 0.05)
        self.assertLess(shares["quality", "-1,-1,2,2"], 0.05)
        self.assertNotEqual(run("picture.py", self.grid, self.path("p.png"), "--zoom", "0,0,0,1,1,1").returncode, 0)

    def test_picture_refuses_what_has_nothing_to_draw(self):
        meshio.Mesh(np.eye(3), [("vertex", np.array([[0], [1]]))]).write(self.grid)
        done = run("picture.py", self.grid, self.path("cube.png"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("neither tetrahedra nor triangles", done.stderr)

    def test_missing_programs_are_skipped_by_name(self):
        cube_grid(1).write(self.grid)
        nothing = self.path("empty")
        os.makedirs(os.path.join(nothing, "constant", "polyMesh"))
        open(os.path.join(nothing, "constant", "polyMesh", "boundary"), "w").close()
        bash = subprocess.run(["bash", "-c", "command -v bash"], capture_output=True, text=True).stdout.strip()
        script = os.path.join(SCRIPTS, "openfoam_check.sh")
        done = subprocess.run([bash, script, nothing], capture_output=True, text=True, env={"PATH": nothing})
        self.assertEqual((done.returncode, done.stdout[:24]), (77, "SKIPPED openfoam_check: "))
        done = run("gmsh_check.py", self.grid, PATH=nothing)
        self.assertEqual((done.returncode, done.stdout[:20]), (77, "SKIPPED gmsh_check: "))

    def corpus(self, expectation, behaviour):
        """corpus_table.py on one file, with a stand-in for delfront."""
        data = self.path("shared/data")
        os.makedirs(data, exist_ok=True)
        open(os.path.join(data, "a.stl"), "w").close()
        with open(self.path("corpus.toml"), "w") as file:
            file.write(f'[[file]]\npath = "a.stl"\n{expectation}\n')
        with open(self.path("delfront"), "w") as file:
            file.write(f"#!{sys.executable}\nimport json, sys\nreport = sys.argv[sys.argv.index('--report') + 1]\n")
            file.write(textwrap.dedent(behaviour))
        os.chmod(self.path("delfront"), 0o755)
        return run("corpus_table.py", "--delfront", self.path("delfront"), "--corpus", self.path("corpus.toml"),
                   "--out", self.path("corpus.md"), DELFRONT_SHARED=self.path("shared"))

    REFUSAL = """
        place = {"at": [0, 0, 0], "ids": [1]}
        finding = {"kind": "open_edges", "severity": "error", "count": 3, "places": [place]}
        json.dump({"surface": {"findings": [finding]}, "error": "open"}, open(report, "w"))
        sys.exit(3)
        """

    def test_corpus_table_accepts_the_expected_refusal(self):
        done = self.corpus('valid = false\ndefects = ["open_edges"]', self.REFUSAL)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(self.path("corpus.md")) as file:
            page = file.read()
        self.assertIn("| a.stl | 3 | open_edges | open_edges |", page)
        self.assertIn("1 files: 1 as expected, 0 not.", page)

    def test_corpus_table_fails_where_the_defect_is_another(self):
        done = self.corpus('valid = false\ndefects = ["self_intersection"]', self.REFUSAL)
        self.assertEqual(done.returncode, 1)
        self.assertIn("not named: self_intersection; named: open_edges", done.stdout)

    def test_corpus_table_fails_where_a_valid_file_is_refused(self):
        done = self.corpus("valid = true", self.REFUSAL)
        self.assertEqual(done.returncode, 1)
        self.assertIn("exit 3 instead of 0", done.stdout)

    def test_corpus_table_fails_where_a_bad_file_is_gridded(self):
        done = self.corpus("valid = false", "json.dump({}, open(report, 'w'))")
        self.assertEqual(done.returncode, 1)
        self.assertIn("exit 0 instead of 3", done.stdout)

    def test_corpus_table_says_that_the_data_are_missing(self):
        done = run("corpus_table.py", DELFRONT_SHARED=self.path("nowhere"))
        self.assertEqual((done.returncode, done.stdout[:7]), (77, "SKIPPED"))


if __name__ == "__main__":
    unittest.main()
