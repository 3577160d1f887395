# SPDX-License-Identifier: Apache-2.0
"""The workloads of bench/front.py, and every tool's words for them.

All tools are given the same surface. "gridding" is what fills the volume, without improvement: ours is the stages
recover, front and refine of the report; Netgen's its GenerateVolumeMesh without optimisation, Gmsh's "Done meshing 3D",
TetGen's all but its output and optimisation. "improve" is what follows it.
"""

import hashlib
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from . import fill, grids, peers, shapes
from .running import Tool

NAMES = ("sphere", "graded", "ahmed")
METHODS = ("front", "front-delaunay", "delaunay")
GROWTH = 1.2
SLOPE = (GROWTH - 1) / GROWTH  # of sizes with growth, a unit of distance
GRIDDING = {"recover", "front", "refine"}
FAR_FIELD = 10  # half its side or its radius, in sides of the body
NETGEN_GRADING = 0.3  # its default, for uniform sizes
ABOUT = {
    "sphere": "geodesic unit sphere, inside, sizes of the surface",
    "graded": f"outside of a geodesic unit sphere, far field of radius {2 * FAR_FIELD}, growth {GROWTH}",
    "ahmed": f"air round the Ahmed body (examples/ahmed), growth {GROWTH}",
}
# For about so many tets, between them interpolated: Ahmed's side on the body (9 times that far away), and the sphere's
# sides on an edge of the icosahedron.
AHMED_SIDES = {1e5: 0.058, 1e6: 0.0101, 1e7: 0.0039}
GRADED_SPHERES = {4e4: 3, 7e4: 5, 1.6e5: 12, 7.7e5: 38, 2.7e6: 80, 1e7: 162}
KINDS = {"raw": ["--set", "improve.enabled=false"], "improved": []}


def words_of_case(name: str) -> list[str]:
    """Ours, for the surface and its sizes."""
    growth = ["--growth", str(GROWTH)]
    if name == "graded":
        return ["body.off", "--farfield", f"sphere:{FAR_FIELD}c", *growth]
    return ["s.off", *growth, "--hmax", "{far}"] if name == "ahmed" else ["s.off"]


# --- surfaces ---------------------------------------------------------------------------------------------------------


def interpolate(table: dict[float, float], at: float) -> float:
    """Along lines in logarithms; the ends hold beyond."""
    return float(np.exp(np.interp(np.log(at), np.log(list(table)), np.log(list(table.values())))))


def make_surface(name: str, size: int, folder: Path, program: str):
    """Writes what the tools read. @return points, triangles, and the far side length of Ahmed's
    @throws NotBuilt where the surface cannot be made"""
    if name == "sphere":
        surface = fill.make_surface("sphere", size, folder, None)
        shapes.write_surface(folder, *surface)
        return *surface, 0.0
    if name == "ahmed":
        side = interpolate(AHMED_SIDES, size)
        script = peers.ROOT / "examples" / "ahmed" / "make_ahmed.py"
        command = [sys.executable, str(script), "ahmed.stl", "--size", f"{side:.6g}", "--far", f"{9 * side:.6g}"]
        run_or_say(command, folder)
        surface = shapes.read_surface(folder / "ahmed.stl")
        shapes.write_surface(folder, *surface)
        return *surface, 9 * side
    inner = shapes.geodesic_sphere(round(interpolate(GRADED_SPHERES, size)))
    shapes.write_surface(folder, *inner)
    (folder / "s.off").replace(folder / "body.off")
    run_or_say([program, "mesh", *words_of_case(name), "-o", "s.off", "--stop-after", "surface", "-q"], folder)
    points, triangles = shapes.read_surface(folder / "s.off")
    is_body = np.linalg.norm(points[triangles[:, 0]], axis=1) < FAR_FIELD
    for part, wanted in ((is_body, -1), (~is_body, 1)):  # facing out of the volume
        a, b, c = (points[triangles[part][:, i]] for i in range(3))
        if np.einsum("ij,ij->i", np.cross(a, b), c).sum() * wanted < 0:
            triangles[part] = triangles[part][:, ::-1]
    shapes.write_surface(folder, points, triangles, is_body.astype(int))
    return points, triangles, 0.0


def run_or_say(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["?"])[-1][:120]
        raise peers.NotBuilt(f"{' '.join([Path(command[0]).name, *command[1:]])}: {last}")


def find_sizes(name: str, edge: float, words: list[str], program: str, folder: Path):
    """The size at places, one definition for all tools: the surface's mean edge where sizes are uniform, else the
    sizes that delfront has at the nodes of a grid of its own, interpolated from the eight nearest."""
    if name == "sphere":
        return lambda places: edge
    from scipy.spatial import cKDTree

    more = [*KINDS["raw"], "--set", "output.sizes=true", "-o", "sizes.vtu", "-q"]
    run_or_say([program, "mesh", *words, *more], folder)
    points, _, fields = grids.read_vtu(folder / "sizes.vtu")
    (folder / "sizes.vtu").unlink()
    tree, h = cKDTree(points), fields["h"]

    def size_at(places: np.ndarray) -> np.ndarray:
        distance, node = tree.query(places, k=8)
        weight = 1 / np.maximum(distance, 1e-12) ** 2
        return (weight * h[node]).sum(axis=1) / weight.sum(axis=1)

    return size_at


# --- tools ------------------------------------------------------------------------------------------------------------


def stages_of(folder: Path) -> dict[str, float]:
    path = folder / "report.json"
    seconds: dict[str, float] = {}
    for stage in json.loads(path.read_text()).get("stages", []) if path.exists() else []:
        seconds[stage["stage"]] = seconds.get(stage["stage"], 0.0) + stage["seconds"]
    return seconds


def front_of(folder: Path) -> dict:
    """What the report says of the pure front; nothing for other methods."""
    front = json.loads((folder / "report.json").read_text()).get("front") or {}
    return front if front.get("sides_processed") else {}


def our_details(folder: Path, log: str) -> dict:
    return {"improve": stages_of(folder).get("improve", 0.0), "crossing": front_of(folder).get("crossing_share")}


def last_json(log: str) -> dict:
    lines = [line for line in log.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {}


class Measures:
    """The figures of a grid, taken once for the same bytes."""

    def __init__(self, size_at):
        self.size_at, self.known = size_at, {}

    def of(self, points: np.ndarray, tets: np.ndarray) -> dict:
        return grids.measure_tets(points, tets) | grids.edges_near(points, tets, self.size_at)

    def of_ours(self, folder: Path, log: str) -> dict:
        with (folder / "o.vtu").open("rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()[:16]
        if digest not in self.known:
            self.known[digest] = self.of(*grids.read_vtu(folder / "o.vtu")[:2])
        return self.known[digest] | {"bytes": digest, "front": front_of(folder)}

    def of_medit(self, folder: Path, log: str) -> dict:
        return self.of(*grids.read_medit(folder / "o.mesh", b"Tetrahedra", 4))

    def of_tetgen(self, folder: Path, log: str) -> dict:
        return self.of(*grids.read_tetgen(folder / "s.1.ele"))

    def of_npz(self, folder: Path, log: str) -> dict:
        grid = np.load(folder / "o.npz")
        return self.of(grid["points"], grid["tets"])


def our_tools(case: list[str], measures: Measures, program: str, options) -> list[Tool]:
    tools = []
    for method in options.methods:
        probe = [program, "mesh", "s.off", "--set", f"volume.method={method}", "--print-config"]
        known = subprocess.run(probe, capture_output=True, check=False).returncode == 0
        refused = "" if known else f"delfront has no volume.method = {method}"
        for kind, words in KINDS.items():
            # the second thread is about gridding, which both kinds share
            for threads in options.threads if kind == "raw" else options.threads[:1]:
                command = [program, "mesh", *case, "--set", f"volume.method={method}", *words, "-o", "o.vtu"]
                command += ["--report", "report.json", "-q", "-j", str(threads)]
                tool = Tool(f"delfront {method}, {kind}", threads, command, options.version, refused)
                tool.phase = lambda folder, log: sum(s for k, s in stages_of(folder).items() if k in GRIDDING)
                tool.details = our_details
                tool.facts, tool.outputs, tool.extra_outputs = measures.of_ours, ["o.vtu"], ["report.json"]
                tools.append(tool)
    return tools


def netgen_tools(name: str, edge: float, measures: Measures) -> list[Tool]:
    version = peers.pypi_version("netgen_mesher")
    missing = "" if version else f"PyPI netgen-mesher; {peers.SETUP}"
    maxh, grading = (edge, NETGEN_GRADING) if name == "sphere" else (1e10, SLOPE)
    tools = []
    for method, label in (("front", "pure front"), ("delaunay", "Delaunay + front")):
        for kind, steps in (("raw", 0), ("improved", 3)):
            command = [str(peers.VENV_PYTHON), str(peers.SOURCES / "netgen_fill.py"), "s.off", "o.npz", method]
            command += [f"{maxh:.6g}", f"{grading:.6g}", str(steps)]
            tool = Tool(f"Netgen {label}, {kind}", 1, command, version, missing)
            tool.phase = lambda folder, log: last_json(log).get("seconds")
            tool.details = lambda folder, log: {"improve": last_json(log).get("improve")}
            tool.facts, tool.outputs = measures.of_npz, ["o.npz"]
            tools.append(tool)
    return tools


def gmsh_log_seconds(log: str, what: str) -> float | None:
    found = re.findall(rf"Done {what}.*?\(Wall ([\d.eE+-]+)s", log)
    return sum(map(float, found)) if found else None


def gmsh_tools(name: str, edge: float, folder: Path, measures: Measures) -> list[Tool]:
    """PyPI's where it is there, else Debian's. With growth it is given the same law of sizes where there is one."""
    found = peers.find_gmshs()
    label, start, version, missing = next((g for g in found if not g[3]), found[0])
    if name == "graded":
        law = f"{edge:.6g} + {SLOPE:.6g} * (Sqrt(x*x + y*y + z*z) - 1)"
        with (folder / "fill.geo").open("a") as file:
            file.write(f'Mesh.MeshSizeExtendFromBoundary = 0;\nField[1] = MathEval;\nField[1].F = "{law}";\n')
            file.write("Background Field = 1;\n")
    tools = []
    for kind, optimise in (("raw", "0"), ("improved", "1")):
        command = [*start, "-3", "fill.geo", "-algo", "del3d", "-nt", "1", "-setnumber", "Mesh.Optimize", optimise]
        command += ["-o", "o.mesh", "-format", "mesh"]
        tool = Tool(f"Gmsh Delaunay ({label}), {kind}", 1, command, version, missing)
        tool.phase = lambda folder, log: gmsh_log_seconds(log, "meshing 3D")
        tool.details = lambda folder, log: {"improve": gmsh_log_seconds(log, "optimizing mesh") or 0.0}
        tool.facts, tool.outputs = measures.of_medit, ["o.mesh"]
        tools.append(tool)
    return tools


def tetgen_times(log: str) -> tuple[float | None, float]:
    times = dict(re.findall(r"^\s*([A-Za-z ]+?) seconds:\s*([\d.eE+-]+)", log, re.M))
    improve = float(times.get("Optimization", 0.0))
    total = fill.phase_of_tetgen(Path(), log)
    return (None if total is None else total - improve), improve


def tetgen_tools(edge: float, measures: Measures) -> list[Tool]:
    program, version, missing = peers.find_tetgen()
    command = [program, f"-pYq1.414a{edge**3 / 2:.4g}V", "s.smesh"]
    tool = Tool("TetGen, improved", 1, command, version, missing)
    tool.phase = lambda folder, log: tetgen_times(log)[0]
    tool.details = lambda folder, log: {"improve": tetgen_times(log)[1]}
    tool.facts, tool.outputs = measures.of_tetgen, ["s.1.ele"]
    return [tool]


def prepare(name: str, size: int, folder: Path, program: str, options) -> tuple[dict, list[Tool]]:
    """@return facts of the case, and its tools. @throws NotBuilt where the surface cannot be had"""
    points, triangles, far = make_surface(name, size, folder, program)
    body = shapes.read_surface(folder / "body.off") if name == "graded" else (points, triangles)
    edge = shapes.mean_edge(*body)
    case = [word.format(far=f"{far:.6g}") for word in words_of_case(name)]
    measures = Measures(find_sizes(name, edge, case, program, folder))
    tools = our_tools(case, measures, program, options)
    tools += netgen_tools(name, edge, measures) if size <= options.netgen_up_to else []
    tools += gmsh_tools(name, edge, folder, measures) if size <= options.gmsh_up_to else []
    tools += tetgen_tools(edge, measures) if size <= options.tetgen_up_to and name == "sphere" else []
    volume = shapes.enclosed_volume(points, triangles)
    facts = {"triangles": len(triangles), "volume": volume, "about": ABOUT[name], "work": "tets"}
    facts["has_sizes"] = name != "ahmed"  # peers have been told them
    return facts, tools
