# SPDX-License-Identifier: Apache-2.0
"""Workload "fill": finished grids of given surfaces: boundary recovery, refinement, improvement.

Surfaces: the geodesic unit sphere, and models of the shared data with their edges halved (flat facets stay flat) until
a uniform filling has about the wanted number of tets; a CAD model gets its surface from Gmsh's surface mesher, the same
for all tools. Sizes come from the surface. Counts differ between tools since each reads its sizes from the surface in
its own way; so rates (tets a second) stand beside times. "phase" is what the tool prints for gridding (ours: all stages
but read, check, measure, write); "whole" the wall time of the process with these and with text in and out. Every grid's
volume must be the surface's. "size": the tets wanted of us. "below 10°": share of the tets whose smallest dihedral
angle is under 10 degrees; eta = 12 (3V)^(2/3) / sum of squared edges; peak: of the whole process.
"""

import json
import re
import subprocess
from pathlib import Path

import numpy as np

from . import grids, peers, shapes
from .running import Tool

TITLE = "Filling given surfaces"
SIZES = (1_000_000, 10_000_000, 50_000_000)
NAMES = ("sphere", "ship", "cow", "linkrods")
LARGEST = {"ship": 10_000_000, "cow": 10_000_000, "linkrods": 10_000_000}
ABOUT = {
    "sphere": "unit sphere, geodesic",
    "ship": "surface/DTC-scaled.stl, edges halved where needed",
    "cow": "surface/spot_triangulated.obj, edges halved",
    "linkrods": "cad/linkrods.step, surface by PyPI's Gmsh (-2, one size)",
}
FILES = {"ship": "surface/DTC-scaled.stl", "cow": "surface/spot_triangulated.obj", "linkrods": "cad/linkrods.step"}
OTHER_STAGES = {"read", "check", "measure", "write"}
GMSH_DELAUNAY_UP_TO = 1_000_000  # tets wanted: it takes minutes beyond


def wants(name: str, size: int) -> bool:
    return size <= LARGEST.get(name, size)


def phase_of_delfront(folder: Path, log: str) -> float | None:
    report = folder / "report.json"
    stages = json.loads(report.read_text()).get("stages", []) if report.exists() else []
    return sum(stage["seconds"] for stage in stages if stage["stage"] not in OTHER_STAGES) or None


def phase_of_tetgen(folder: Path, log: str) -> float | None:
    times = {name.strip(): float(t) for name, t in re.findall(r"^\s*([A-Za-z ]+) seconds:\s*([\d.eE+-]+)", log, re.M)}
    total = times.get("Total running")
    return None if total is None else total - times.get("Output", 0.0)


def phase_of_gmsh(folder: Path, log: str) -> float | None:
    found = re.findall(r"Done (?:meshing 3D|optimizing mesh).*?\(Wall ([\d.eE+-]+)s", log)
    return sum(map(float, found)) if found else None


def facts_of_medit(folder: Path, log: str) -> dict:
    return grids.measure_tets(*grids.read_medit(folder / "o.mesh", b"Tetrahedra", 4))


def facts_of_tetgen(folder: Path, log: str) -> dict:
    return grids.measure_tets(*grids.read_tetgen(folder / "s.1.ele"))


def find_tools(options) -> list[Tool]:
    ours, missing = peers.find_ours("delfront", options.delfront)
    tools = []
    for threads in options.threads:
        command = [
            ours,
            "mesh",
            "s.off",
            "-o",
            "o.mesh",
            "--ascii",
            "--report",
            "report.json",
            "-q",
            "-j",
            str(threads),
        ]
        tools.append(Tool("delfront", threads, command, options.version, missing, phase_of_delfront, facts_of_medit))
    for label, words, version, lacks in peers.find_gmshs():
        kinds = [("hxt", f"Gmsh HXT ({label})", options.threads)]
        kinds += [("del3d", f"Gmsh Delaunay ({label})", options.threads[:1])] if label == "PyPI" else []
        for algorithm, name, all_threads in kinds:
            for threads in all_threads:
                command = [*words, "-3", "fill.geo", "-algo", algorithm, "-nt", str(threads), "-o", "o.mesh"]
                command += ["-format", "mesh"]
                tools.append(Tool(name, threads, command, version, lacks, phase_of_gmsh, facts_of_medit))
    program, version, lacks = peers.find_tetgen()
    command = [program, "-pYq1.414a{tet_volume}V", "s.smesh"]
    tools.append(Tool("TetGen", 1, command, version, lacks, phase_of_tetgen, facts_of_tetgen, ["s.1.ele"]))
    for tool in tools:
        tool.outputs = tool.outputs or ["o.mesh"]
        tool.extra_outputs = ["report.json"]
    return tools


def surface_of_cad(path: Path, tets: float, folder: Path):
    """Meshed by PyPI's Gmsh with one size, for which a filling has about so many tets."""
    if not peers.has_pypi("gmsh"):
        raise peers.NotBuilt(f"its surface needs PyPI gmsh; {peers.SETUP}")
    program = [str(peers.VENV_PYTHON), str(peers.SOURCES / "gmsh_surface.py"), str(path), f"{tets:g}", "cad.npz"]
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise peers.NotBuilt(f"Gmsh made no surface: {(done.stderr.strip().splitlines() or ['?'])[-1][:100]}")
    surface = np.load(folder / "cad.npz")
    return surface["points"], surface["triangles"]


def make_surface(name: str, size: int, folder: Path, options):
    if name == "sphere":
        return shapes.geodesic_sphere(max(2, round(46 * (size / 1.69e6) ** (1 / 3))))
    path = options.shared_data / FILES[name]
    if not path.exists():
        raise peers.NotBuilt(f"{FILES[name]} is not in the shared data; set DELFRONT_SHARED")
    if name == "linkrods":
        return surface_of_cad(path, size, folder)
    return shapes.refine_to(*shapes.read_surface(path), size)


def prepare(name: str, size: int, folder: Path, tools: list[Tool], options) -> dict:
    """Write the surface; give TetGen its volume bound. @throws NotBuilt where the surface cannot be had"""
    points, triangles = make_surface(name, size, folder, options)
    shapes.write_surface(folder, points, triangles)
    edge = shapes.mean_edge(points, triangles)
    for tool in tools:
        tool.command = [word.format(tet_volume=f"{edge**3 / 2:.4g}") if "{" in word else word for word in tool.command]
    if size > GMSH_DELAUNAY_UP_TO:
        tools[:] = [tool for tool in tools if "Delaunay" not in tool.name]
    volume = shapes.enclosed_volume(points, triangles)
    return {"triangles": len(triangles), "volume": volume, "about": ABOUT[name], "work": "tets"}
