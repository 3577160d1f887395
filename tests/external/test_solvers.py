#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Solvers run on our grids and get the exact answer; and each gate rejects a grid that was damaged on purpose.

usage: test_solvers.py DELFRONT [--long] [unittest arguments]

GATES is the table: a file of ours, the program that judges it, and damages, each of which it must find and say in its
words. A gate that no longer bites fails its own test. The box of all of them is 2 x 1 x 1 with six named sides. --long
(scripts/nightly) adds the Ahmed example: checkMesh, potentialFoam and 50 iterations of simpleFoam on its starter files.
What needs a program that is missing is skipped by name (scripts/setup --peers installs all of them).
"""
import dataclasses
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import typing
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from foam import (SPEED, foam, judge_check_mesh, judge_potential_foam, judge_simple_foam, rename_a_patch,
                  root_mean_square, stop_after_50, table, throw_a_point, turn_a_face, velocities_of_fluxes)  # noqa: E402

DELFRONT = sys.argv.pop(1) if len(sys.argv) > 1 else "delfront"
IS_LONG = "--long" in sys.argv
if IS_LONG:
    sys.argv.remove("--long")

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZE = (2, 1, 1)
AREAS = {"xmin": 1, "xmax": 1, "ymin": 2, "ymax": 2, "zmin": 2, "zmax": 2}
# Uniform flow is an exact solution of a duct with slippery sides.
KINDS = {"xmin": "inlet", "xmax": "outlet", "ymin": "symmetry", "ymax": "symmetry", "zmin": "symmetry", "zmax": "symmetry"}


def run(*command, cwd=None, env=None, timeout=600):
    """Exit status and all that was said."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, errors="replace", timeout=timeout,
                          cwd=cwd, env=env)
    return done.returncode, done.stdout + done.stderr


def delfront(*arguments):
    status, text = run(DELFRONT, *arguments)
    assert status == 0, f"delfront {arguments}: {text}"
    return text


def box_surface():
    """ASCII STL, one solid a side."""
    corners = {"xmin": "000 001 011 010", "xmax": "100 110 111 101", "ymin": "000 100 101 001",
               "ymax": "010 011 111 110", "zmin": "000 010 110 100", "zmax": "001 101 111 011"}
    text = ""
    for name, side in corners.items():
        p = ["vertex {} {} {}\n".format(*(s * int(c) for s, c in zip(SIZE, corner))) for corner in side.split()]
        text += f"solid {name}\n" + "".join(f"facet normal 0 0 0\nouter loop\n{a}{b}{c}endloop\nendfacet\n"
                                            for a, b, c in ((p[0], p[1], p[2]), (p[0], p[2], p[3]))) + f"endsolid {name}\n"
    return text


def ball_surface(levels):
    """ASCII STL of a ball of radius 1: an octahedron, each triangle cut into four `levels` times."""
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    opposite = lambda p: tuple(-c for c in p)  # noqa: E731
    triangles = []
    for a in (x, opposite(x)):
        for b in (y, opposite(y)):
            for c in (z, opposite(z)):
                outward = (a == x) + (b == y) + (c == z)
                triangles.append((a, b, c) if outward % 2 else (b, a, c))

    def middle(p, q):
        m = [a + b for a, b in zip(p, q)]
        length = sum(c * c for c in m) ** 0.5
        return tuple(c / length for c in m)
    for _ in range(levels):
        triangles = [t for a, b, c in triangles for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
                     for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    facets = ("facet normal 0 0 0\nouter loop\n" + "".join("vertex {:.17g} {:.17g} {:.17g}\n".format(*p) for p in t) +
              "endloop\nendfacet\n" for t in triangles)
    return "solid ball\n" + "".join(facets) + "endsolid ball\n"


def make_box(folder, kinds=KINDS):
    """The grid as VTU and as an OpenFOAM case with starter files; the other formats are made of the VTU."""
    (folder / "box.stl").write_text(box_surface())
    kinds = [word for name, kind in kinds.items() for word in ("--set", f"boundaries.{name}.kind={kind}")]
    delfront("mesh", folder / "box.stl", "--surface-method", "front", "--hmax", "0.25", "-o", folder / "box.vtu", "-o",
             f"{folder / 'foam'}/", "--solver", "openfoam", *kinds)


# ---- Medit's format: FreeFem++ reads it, and others get their damaged grids by way of it.


def cells_of_medit(lines, keyword):
    first = lines.index(keyword) + 2
    return first, int(lines[first - 1])


def edit_medit(path, keyword, change):
    """`change` gets the lines of one section and gives them back."""
    lines = path.read_text().split("\n")
    first, count = cells_of_medit(lines, keyword)
    changed = change(lines[first:first + count])
    lines[first - 1:first + count] = [str(len(changed)), *changed]
    path.write_text("\n".join(lines))


def turned(cell):
    """A tetrahedron with its first two corners swapped."""
    a, b, *others = cell.split()
    return " ".join([b, a, *others])


def turn_a_tetrahedron(path):
    """Two corners of the middle tetrahedron swapped."""
    edit_medit(path, "Tetrahedra", lambda cells: [*cells[:len(cells) // 2], turned(cells[len(cells) // 2]),
                                                  *cells[len(cells) // 2 + 1:]])


def lose_a_tetrahedron(path):
    """A tetrahedron without points on the boundary (which come first) left out."""
    def lose(cells):
        innermost = max(cells, key=lambda cell: min(int(v) for v in cell.split()[:4]))
        return [cell for cell in cells if cell is not innermost]
    edit_medit(path, "Tetrahedra", lose)


def double_a_tetrahedron(path):
    """The middle tetrahedron twice."""
    edit_medit(path, "Tetrahedra", lambda cells: cells + [cells[len(cells) // 2]])


def put_a_triangle_into_another_patch(path):
    """The first boundary triangle gets the reference of the next patch."""
    edit_medit(path, "Triangles", lambda cells: [" ".join([*cells[0].split()[:3], "2"]), *cells[1:]])


FREEFEM = """
mesh3 Th = readmesh3("GRID");
cout.precision(16);
cout << "volume " << int3d(Th)(1.) << endl;
for (int l = 1; l <= 6; ++l) cout << "area" << l << " " << int2d(Th, l)(1.) << endl;
func real exact(real a, real b, real c) { return a*a + 2*b*b - 4*c*c + a*b - 3*b*c + 0.5*a*c + a - 2*b + c; }
fespace Vh(Th, P2);
Vh u, v;
solve poisson(u, v, solver=CG, eps=1e-24) = int3d(Th)(dx(u)*dx(v) + dy(u)*dy(v) + dz(u)*dz(v)) - int3d(Th)(2.*v)
  + on(1, 2, 3, 4, 5, 6, u=exact(x, y, z));
Vh e = u - exact(x, y, z);
cout << "error " << e[].linfty << endl;
"""


def judge_free_fem(path):
    """Volume, each patch's area, and -div grad u = 2 with a quadratic u, which elements of second order hold exactly."""
    script = path.with_suffix(".edp")
    script.write_text(FREEFEM.replace("GRID", str(path)))
    status, text = run("FreeFem++-nw", "-nw", "-v", "0", "-ne", script, cwd=path.parent)
    if status != 0:
        return [f"FreeFem++ ends with {status}: {text[-500:]}"]
    found = {name: float(value) for name, value in re.findall(r"^(volume|area\d|error) (\S+)$", text, re.M)}
    exact = {"volume": 2, **{f"area{k + 1}": area for k, area in enumerate(AREAS.values())}, "error": 0}
    return [f"{name} is {found.get(name)}, exactly {value}" for name, value in exact.items()
            if not abs(found.get(name, float("nan")) - value) < 1e-9]


# ---- CalculiX


CCX = """
*NSET, NSET=EVERY, GENERATE
1, {points}
*MATERIAL, NAME=STEEL
*ELASTIC
2e11, 0.25
*SOLID SECTION, ELSET={region}, MATERIAL=STEEL
*STEP
*STATIC
*BOUNDARY
xmin, 1, 1
ymin, 2, 2
zmin, 3, 3
*DSLOAD
xmax, P, -2e8
*NODE PRINT, NSET=EVERY
U
*EL PRINT, ELSET={region}
S
*END STEP
"""


def judge_calculix(path):
    """A bar pulled at xmax: stress 2e8 along x and none else, displacements linear, both exact in these elements.

    Our node sets hold the bar at three sides, our surface carries the load.
    """
    text = path.read_text()
    nodes = re.search(r"^\*NODE\n((?:\d.*\n)+)", text, re.M).group(1)
    points = {int(n): tuple(map(float, xyz)) for n, *xyz in (line.split(",") for line in nodes.splitlines())}
    region = re.search(r"^\*ELSET, ELSET=([^,\n]+)", text, re.M).group(1)
    job = path.with_name("job_" + path.stem)
    job.with_suffix(".inp").write_text(text + CCX.format(points=max(points), region=region))
    status, said = run("ccx", job.name, cwd=path.parent, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if status != 0 or "*ERROR" in said:
        return [f"ccx ends with {status}: " + " ".join(re.findall(r"\*ERROR.*\n.*", said)[:3])]
    rows = [line.split() for line in job.with_suffix(".dat").read_text().splitlines()]
    moved = {int(r[0]): [float(w) for w in r[1:]] for r in rows if len(r) == 4 and r[0].isdigit()}
    stresses = [[float(w) for w in r[2:]] for r in rows if len(r) == 8 and r[0].isdigit()]
    if moved.keys() != points.keys() or not stresses:
        return [f"{len(moved)} of {len(points)} points have a displacement, {len(stresses)} cells a stress"]
    off = max(abs(u - factor * x) for n, p in points.items() for u, factor, x in zip(moved[n], (1e-3, -2.5e-4, -2.5e-4), p))
    stress = max(abs(s - e) / 2e8 for cell in stresses for s, e in zip(cell, (2e8, 0, 0, 0, 0, 0)))
    # Its output has seven digits.
    bounds = (("displacement off by", off, 1e-6 * 1e-3 * SIZE[0]), ("stress off by", stress, 1e-6))
    return [f"{name} {value:.3g}" for name, value, bound in bounds if not value < bound]


def turn_an_element(path):
    """Two corners of the middle element swapped."""
    lines = path.read_text().split("\n")
    first = next(i for i, line in enumerate(lines) if line.startswith("*ELEMENT")) + 1
    count = next(i for i, line in enumerate(lines[first:]) if line.startswith("*"))
    n, a, b, *others = lines[first + count // 2].split(",")
    lines[first + count // 2] = ",".join([n, b, a, *others])
    path.write_text("\n".join(lines))


def lose_a_loaded_face(path):
    """The first face of the surface xmax left out."""
    lines = path.read_text().split("\n")
    del lines[next(i for i, line in enumerate(lines) if line.startswith("*SURFACE, NAME=xmax")) + 1]
    path.write_text("\n".join(lines))


# ---- Programs that check


def judge_cgns(path):
    status, text = run("cgnscheck", "-w3", path)
    return [line for line in text.splitlines() if "ERROR" in line or "WARNING" in line] or ([text[-500:]] if status else [])


def lengthen_the_elements(path):
    """The range of the section of tetrahedra ends one too late."""
    data = path.read_bytes()
    listed = path.with_suffix(".mesh")
    delfront("convert", path, listed)
    _, tetrahedra = cells_of_medit(listed.read_text().split("\n"), "Tetrahedra")
    for letter in "iq":  # the library chooses the width of its integers
        wanted = struct.pack(f"<2{letter}", 1, tetrahedra)
        if data.count(wanted) == 1:
            path.write_bytes(data.replace(wanted, struct.pack(f"<2{letter}", 1, tetrahedra + 1)))
            return
    raise AssertionError(f"{path}: the range 1 to {tetrahedra} does not stand in it once")


def name_a_missing_point(path):
    """The first tetrahedron's first point gets a number that no point has."""
    listed = path.with_suffix(".mesh")
    delfront("convert", path, listed)
    lines = listed.read_text().split("\n")
    corners = [int(v) for v in lines[cells_of_medit(lines, "Tetrahedra")[0]].split()[:4]]
    data = path.read_bytes()
    for letter in "iq":
        wanted = struct.pack(f"<4{letter}", *corners)
        if data.count(wanted) == 1:
            path.write_bytes(data.replace(wanted, struct.pack(f"<4{letter}", 999999, *corners[1:])))
            return
    raise AssertionError(f"{path}: the corners {corners} do not stand in it once")


def judge_script(script, *options):
    """One of ours that calls another program."""
    def judge(path):
        status, text = run(sys.executable, ROOT / script, path, *options)
        return [] if status == 0 else [f"exit {status}: {text[-1000:]}"]
    return judge


def by_way_of_medit(damage):
    """The damage of a .mesh, for a grid in another format."""
    def apply(path):
        medit = path.with_suffix(".mesh")
        delfront("convert", path, medit)
        damage(medit)
        delfront("convert", medit, path)
    apply.__doc__ = damage.__doc__
    apply.__name__ = damage.__name__
    return apply


@dataclasses.dataclass
class Gate:
    name: str
    needs: str  # program or Python module
    package: str  # Debian's
    file: str  # a grid of ours; a folder is an OpenFOAM case
    judge: typing.Callable  # what is wrong, as sentences
    damages: dict  # what is done to the file, and what one of the sentences must say (a regular expression)


GATES = (
    Gate("checkMesh", "checkMesh", "openfoam", "foam", judge_check_mesh,
         {turn_a_face: "Open cells", throw_a_point: "negative volume|incorrectly oriented"}),
    Gate("potentialFoam", "potentialFoam", "openfoam", "foam", judge_potential_foam,
         {turn_a_face: "net flux", throw_a_point: "net flux", rename_a_patch: "lid"}),
    Gate("simpleFoam", "simpleFoam", "openfoam", "foam", judge_simple_foam,
         {turn_a_face: "off the exact one", throw_a_point: "ends with -8|off the exact one", rename_a_patch: "lid"}),
    Gate("FreeFem", "FreeFem++-nw", "freefem++", "box.mesh", judge_free_fem,
         {turn_a_tetrahedron: "badly oriented", lose_a_tetrahedron: "volume is 1.9",
          double_a_tetrahedron: "volume is 2|ends with", put_a_triangle_into_another_patch: "area1 is 0.9"}),
    Gate("CalculiX", "ccx", "calculix-ccx", "box.inp", judge_calculix,
         {turn_an_element: "nonpositive jacobian", lose_a_loaded_face: "stress off by"}),
    Gate("cgnscheck", "cgnscheck", "cgns-convert", "box.cgns", judge_cgns,
         {lengthen_the_elements: "element connectivity", name_a_missing_point: "ERROR"}),
    Gate("Gmsh", "gmsh", "gmsh", "box.msh", judge_script("scripts/gmsh_check.py", "--names", ",".join(AREAS)),
         {by_way_of_medit(turn_a_tetrahedron): "has negative volume",
          by_way_of_medit(double_a_tetrahedron): "1 duplicate element"}),
    Gate("VTK", "vtkmodules", "python3-vtk9", "box.vtu",
         judge_script("scripts/vtk_check.py", "--names", ",".join(AREAS)),
         {by_way_of_medit(turn_a_tetrahedron): "1 tetrahedra have no positive volume"}),
    Gate("check_mesh", "check_mesh.py", "python3-meshio, and the shared data", "box.vtu",
         judge_script("tests/external/run_checker.py"),
         {by_way_of_medit(turn_a_tetrahedron): "1 tetra cells flat or inverted",
          by_way_of_medit(lose_a_tetrahedron): "4 boundary faces are not stored",
          by_way_of_medit(double_a_tetrahedron): "faces shared by more than two cells"}),
)


def has(program):
    if program == "vtkmodules":
        return subprocess.run([sys.executable, "-c", "import vtkmodules.vtkIOXML"], capture_output=True).returncode == 0
    if program == "check_mesh.py":
        return (pathlib.Path(os.environ.get("DELFRONT_SHARED") or ROOT.parent / "shared") / "tools" / program).exists()
    return shutil.which(program) is not None


class Solvers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.original = pathlib.Path(tempfile.mkdtemp(prefix="delfront_solvers_"))
        cls.addClassCleanup(shutil.rmtree, cls.original)
        make_box(cls.original)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="delfront_gate_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def grid_of(self, gate):
        if not has(gate.needs):
            self.skipTest(f"{gate.needs} is not installed (Debian {gate.package}; scripts/setup --peers)")
        path = self.folder / gate.file
        if gate.file == "foam":
            shutil.copytree(self.original / "foam", path)
        elif path.suffix == ".cgns" and "cgns" not in run(DELFRONT, "--help")[1]:
            self.skipTest("built without the CGNS library")
        else:
            delfront("convert", self.original / "box.vtu", path)
        return path

    def test_potentialFoam_flows_round_a_ball_in_a_far_field(self):
        """The starter files as they stand, against the exact flow round a ball: the far field lets the flow through."""
        if not has("potentialFoam"):
            self.skipTest("potentialFoam is not installed (Debian openfoam; scripts/setup --peers)")
        (self.folder / "ball.stl").write_text(ball_surface(3))
        case = self.folder / "ball"
        delfront("mesh", self.folder / "ball.stl", "--farfield", "sphere:5c", "-o", f"{case}/", "--solver", "openfoam")
        self.assertEqual(foam("potentialFoam", case, "-writephi")[1], [])
        velocities, x, net = velocities_of_fluxes(case)
        r = np.linalg.norm(x, axis=1)[:, None]
        exact = (1 + 0.5 / r ** 3) * np.array([[1, 0, 0]]) - 1.5 * x[:, :1] * x / r ** 5
        self.assertLess(net, 1e-3)
        self.assertLess(root_mean_square(velocities - exact), 0.15)
        self.assertAlmostEqual(np.median(np.linalg.norm(velocities, axis=1)), 1, delta=0.02)

    def test_starter_files_run_as_they_stand(self):
        """Turbulent between walls, and what the files are without any kind: everything a wall, nothing moves."""
        if not has("simpleFoam"):
            self.skipTest("simpleFoam is not installed (Debian openfoam; scripts/setup --peers)")
        sides = ("ymin", "ymax", "zmin", "zmax")
        for kinds, fastest in (({"xmin": "inlet", "xmax": "outlet", **dict.fromkeys(sides, "wall")}, 2 * SPEED), ({}, 0)):
            with self.subTest(kinds):
                make_box(self.folder, kinds)
                case = self.folder / "foam"
                start = (case / "0" / "U").read_text()
                self.assertEqual(foam("potentialFoam", case)[1], [])
                (case / "0" / "U").write_text(start)
                stop_after_50(case)
                text, problems = foam("simpleFoam", case)
                self.assertEqual(problems, [])
                self.assertEqual("kOmegaSST" in text, bool(kinds))
                ended = max((f for f in case.iterdir() if f.name.isdigit()), key=lambda f: int(f.name))  # 50, or at rest
                if kinds:
                    speeds = np.linalg.norm(table(ended / "U", 3), axis=1)
                    self.assertTrue(0.8 * SPEED < speeds.max() < fastest, speeds.max())
                shutil.rmtree(case)

    @unittest.skipUnless(IS_LONG, "only with --long")
    def test_simpleFoam_runs_on_the_ahmed_example(self):
        """50 iterations, turbulent, on the starter files as they stand."""
        if not has("simpleFoam"):
            self.skipTest("simpleFoam is not installed (Debian openfoam; scripts/setup --peers)")
        case = self.ahmed_case()
        self.assertEqual(judge_check_mesh(case), [])
        start = (case / "0" / "U").read_text()
        self.assertEqual(foam("potentialFoam", case, "-writephi")[1], [])
        self.assertLess(velocities_of_fluxes(case)[2], 1e-2)
        (case / "0" / "U").write_text(start)
        (case / "0" / "phi").unlink()
        stop_after_50(case)
        text, problems = foam("simpleFoam", case)  # from rest
        self.assertEqual(problems, [])
        residuals = {name: [float(r) for r in re.findall(rf"Solving for {name}, Initial residual = (\S+),", text)]
                     for name in ("Ux", "p", "k", "omega")}
        print({name: values[-1] for name, values in residuals.items()})
        for name, values in residuals.items():
            self.assertGreaterEqual(len(values), 50, name)
            self.assertLess(values[-1], 0.1, name)  # all begin with 1
        continuity = re.findall(r"sum local = \S+, global = (\S+),", text)
        self.assertLess(abs(float(continuity[-1])), 1e-3)
        speeds = np.linalg.norm(table(case / "50" / "U", 3), axis=1)
        print(f"continuity {continuity[-1]}, fastest {speeds.max():.3g} m/s, median {np.median(speeds):.3g} m/s")
        self.assertLess(speeds.max(), 2.5 * SPEED)
        self.assertGreater(np.median(speeds), 0.7 * SPEED)

    def ahmed_case(self):
        """The example as its page has it: the job's paths are relative to its folder."""
        job = self.folder / "examples" / "ahmed" / "ahmed.toml"
        surface = self.folder / "out" / "demo" / "ahmed.stl"
        for path in (job, surface):
            path.parent.mkdir(parents=True)
        shutil.copy(ROOT / "examples" / "ahmed" / "ahmed.toml", job)
        self.assertEqual(run(sys.executable, ROOT / "examples" / "ahmed" / "make_ahmed.py", surface)[0], 0)
        delfront("mesh", job, "--solver", "openfoam")
        return surface.parent / "ahmed"


def add_tests(gate):
    def passes(self):
        self.assertEqual(gate.judge(self.grid_of(gate)), [])
    setattr(Solvers, f"test_{gate.name}_is_content_with_ours", passes)
    for damage, words in gate.damages.items():
        def rejects(self, damage=damage, words=words):
            path = self.grid_of(gate)
            damage(path)
            problems = gate.judge(path)
            self.assertTrue(problems, f"{gate.name} did not notice: {damage.__doc__}")
            self.assertRegex("\n".join(problems), words)
        rejects.__doc__ = f"{gate.name}: {damage.__doc__.splitlines()[0]}"
        setattr(Solvers, f"test_{gate.name}_rejects_{damage.__name__}", rejects)


for row in GATES:
    add_tests(row)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"] + sys.argv[1:])
