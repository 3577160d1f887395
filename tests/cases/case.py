# SPDX-License-Identifier: Apache-2.0
"""What the whole-run tests share: a folder of their own, the program, small surfaces. Standard library only."""
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tempfile
import unittest

DELFRONT = os.environ.get("DELFRONT", "delfront")
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SHARED = pathlib.Path(os.environ.get("DELFRONT_SHARED", ROOT.parent / "shared")) / "data"


class Case(unittest.TestCase):
    """A test in an empty folder; `self.folder` is also where the program runs."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="delfront_case_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return name

    def run_delfront(self, *arguments, timeout=120, **options):
        return subprocess.run([DELFRONT, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=timeout, errors="replace", **options)

    def expect(self, code, *arguments, says=(), **options):
        """Run; the exit code and what must stand in its messages."""
        result = self.run_delfront(*arguments, **options)
        shown = f"\n$ delfront {' '.join(map(str, arguments))}\n{result.stdout}{result.stderr}"
        self.assertEqual(result.returncode, code, shown)
        said = result.stdout + unbroken(result.stderr)
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, said, shown)
        if code in (2, 3, 4, 6, 7, 130):
            self.assertIn("delfront: error: ", result.stderr, shown)
        return result

    def files(self):
        """Everything in the folder, also what temporary files would be called."""
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob("*"))

    def make_cad(self, *words):
        """A CAD file that OpenCASCADE makes, by the words of tests/unit/cad_files/cad_tool.cpp. @return its name"""
        tool = os.environ.get("DELFRONT_CAD_TOOL", "")
        if not tool or not os.path.exists(tool):
            self.skipTest("the module for CAD files was not built: nothing writes a file here")
        subprocess.run([tool, *words], cwd=self.folder, check=True)
        return words[-1]

    def shared(self, name):
        path = SHARED / name
        if not path.exists():
            self.skipTest(f"shared data not found: {name}; set DELFRONT_SHARED or put it at ../shared")
        return path

    def report(self, name):
        return json.loads((self.folder / name).read_text())


def unbroken(text):
    """Messages as they were before the terminal broke them into lines."""
    return re.sub(r"\n +", " ", text)


def box_triangles(low=(0, 0, 0), high=(1, 1, 1), inside_out=False):
    """Twelve triangles of a box, as triples of points; outward unless asked otherwise."""
    corner = [[(low, high)[(i >> k) & 1][k] for k in range(3)] for i in range(8)]
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = []
    for a, b, c, d in quads:
        triangles += [(corner[a], corner[b], corner[c]), (corner[a], corner[c], corner[d])]
    return [t[::-1] for t in triangles] if inside_out else triangles


def sphere_triangles(levels, centre=(0, 0, 0), radius=1.0):
    """An icosphere of 20 * 4**levels triangles, outward."""
    phi = (1 + math.sqrt(5)) / 2
    points = [(-1, phi, 0), (1, phi, 0), (-1, -phi, 0), (1, -phi, 0), (0, -1, phi), (0, 1, phi), (0, -1, -phi),
              (0, 1, -phi), (phi, 0, -1), (phi, 0, 1), (-phi, 0, -1), (-phi, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]

    def unit(p):
        length = math.sqrt(sum(x * x for x in p))
        return tuple(x / length for x in p)

    triangles = [tuple(unit(points[i]) for i in face) for face in faces]
    for _ in range(levels):
        finer = []
        for a, b, c in triangles:
            # the midpoint of an edge is the same from both its sides: the sum is commutative
            ab, bc, ca = (unit(tuple(x + y for x, y in zip(p, q))) for p, q in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return [tuple(tuple(m + radius * x for m, x in zip(centre, p)) for p in t) for t in triangles]


def klein_bottle_triangles(n=16):
    """The figure-eight immersion: closed, cannot be oriented, crosses itself."""
    def point(i, j):
        u, v = 2 * math.pi * i / n, 2 * math.pi * (j + 0.5) / n  # no vertex on the curve where it crosses itself
        r = 2 + math.cos(u / 2) * math.sin(v) - math.sin(u / 2) * math.sin(2 * v)
        return (r * math.cos(u), r * math.sin(u), math.sin(u / 2) * math.sin(v) + math.cos(u / 2) * math.sin(2 * v))

    grid = [[point(i, j) for j in range(n)] for i in range(n)]

    def vertex(i, j):
        # after one turn the section comes back turned by half: v -> -v
        return grid[i][j % n] if i < n else grid[0][(-j - 1) % n]

    triangles = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def tetrahedron_triangles(a, b, c, d):
    """Outward faces of a positive tetrahedron."""
    return [(a, c, b), (a, b, d), (b, c, d), (c, a, d)]


def stl_ascii(triangles, name="body"):
    lines = [f"solid {name}"]
    for t in triangles:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {p[0]!r} {p[1]!r} {p[2]!r}" for p in t]
        lines += ["endloop", "endfacet"]
    return "\n".join(lines + [f"endsolid {name}", ""])


def stl_binary(triangles, count=None):
    data = b"delfront".ljust(80) + struct.pack("<I", len(triangles) if count is None else count)
    for t in triangles:
        data += struct.pack("<12fH", 0, 0, 0, *[x for p in t for x in p], 0)
    return data
