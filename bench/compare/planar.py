# SPDX-License-Identifier: Apache-2.0
"""Workload "planar": constrained triangulation and refinement in the plane.

The unit square at one size, and sections of the shared data as holes in a square of three chords, with a bound on the
size everywhere. Triangle (of PyPI) is timed around its call; Gmsh by the time it prints for its 2-D stage (its curves
are split by the size that it is given). Ours is planar_bench, which makes its own cases of the same kind: the square by
1.43 million triangles whatever the size asked for, the sections in a circular far field of 50 chords with growth 1.01;
its time is that of triangulation, splitting, refinement and improvement. So rates are compared, not times; its whole
time and peak memory are those of all its cases together.
"""

import json
import re
from pathlib import Path

import numpy as np

from . import grids, peers
from .points import facts_of_json, phase_of_json
from .running import Tool

TITLE = "In the plane"
SIZES = (1_400_000,)
NAMES = ("square", "naca0012", "rae2822", "s1223")
MIN_ANGLE = {"square": 20.0, "naca0012": 25.0, "rae2822": 25.0, "s1223": 25.0}  # asked of Triangle


def read_section(path: Path) -> np.ndarray:
    """Points of a .dat in Selig's order, without the closing one."""
    rows = [line.split()[:2] for line in path.read_text().splitlines()[1:] if len(line.split()) >= 2]
    points = np.array(rows, float)
    return points[:-1] if np.array_equal(points[0], points[-1]) else points


def ours_of_case(name: str, log: str) -> dict | None:
    """Sum of the gridding stages that planar_bench prints for this case, and its last grid."""
    lines = [json.loads(line) for line in log.splitlines() if line.startswith("{")]
    lines = [line for line in lines if line["case"] == name and line["stage"] not in ("whole", "measure")]
    if not lines:
        return None
    angles = [line["min_angle_deg"] for line in lines if line["min_angle_deg"] is not None]
    facts = {"triangles": lines[-1]["triangles"]} | ({"min_angle": angles[-1]} if angles else {})
    return {"seconds": sum(line["seconds"] for line in lines), **facts}


def phase_of_gmsh(folder: Path, log: str) -> float | None:
    found = re.findall(r"Done meshing 2D \(Wall ([\d.eE+-]+)s", log)
    return float(found[-1]) if found else None


def facts_of_gmsh(folder: Path, log: str) -> dict:
    return grids.measure_triangles(*grids.read_medit(folder / "o.mesh", b"Triangles", 3))


def find_tools(options) -> list[Tool]:
    ours, missing = peers.find_ours("planar_bench", options.planar_bench)
    missing = f"not built; {missing}" if missing else ""
    # The case is known only when it is prepared: what stands in braces is filled in there.
    tools = [Tool("delfront", 1, [ours, "1000", "{section}"], options.version, missing)]
    version = peers.pypi_version("triangle")
    lacks = "" if version else f"PyPI triangle; {peers.SETUP}"
    command = [
        str(peers.VENV_PYTHON),
        str(peers.SOURCES / "triangle_refine.py"),
        "case.json",
        "p{keep}q{angle}a{area}Q",
    ]
    version = f"1.6 (PyPI {version})"
    tools.append(Tool("Triangle", 1, command, version, lacks, phase_of_json, facts_of_json))
    _, words, version, lacks = peers.find_gmshs()[0]
    for number, algorithm, name in ((5, "del2d", "Delaunay"), (6, "front2d", "Frontal-Delaunay")):
        command = [*words, "-2", "case.geo", "-algo", algorithm, "-nt", "1", "-o", "o.mesh", "-format", "mesh"]
        label = f"Gmsh 2-D {number} {name}"
        tools.append(Tool(label, 1, command, version, lacks, phase_of_gmsh, facts_of_gmsh, ["o.mesh"]))
    return tools


def write_geo(path: Path, loops: list[np.ndarray], size: float) -> None:
    lines, first = [f"size = {size!r};"], 1
    for number, loop in enumerate(loops, 1):
        n = len(loop)
        lines += [f"Point({first + i}) = {{{x!r}, {y!r}, 0, size}};" for i, (x, y) in enumerate(loop.tolist())]
        lines += [f"Line({first + i}) = {{{first + i}, {first + (i + 1) % n}}};" for i in range(n)]
        lines.append(f"Curve Loop({number}) = {{{first}:{first + n - 1}}};")
        first += n
    lines.append(f"Plane Surface(1) = {{{', '.join(str(i + 1) for i in range(len(loops)))}}};")
    path.write_text("\n".join(lines) + "\n")


def prepare(name: str, size: int, folder: Path, tools: list[Tool], options) -> dict:
    loops, hole = [np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)], None
    if name != "square":
        path = options.shared_data / "airfoil" / f"{name}.dat"
        if not path.exists():
            raise peers.NotBuilt(f"airfoil/{name}.dat is not in the shared data; set DELFRONT_SHARED")
        section = read_section(path)
        middle = len(section) // 4
        hole = (section[middle] + section[len(section) - 1 - middle]) / 2
        loops = [loops[0] * 3 - [1.0, 1.5], section]
    area = abs(sum(shoelace(loop) * (-1 if i else 1) for i, loop in enumerate(loops)))
    bound = 1.552 * area / size  # Triangle's triangles are on average 0.64 of the bound
    edge = (2.31 * area / size) ** 0.5
    pslg = {"loops": [loop.tolist() for loop in loops], "hole": None if hole is None else hole.tolist()}
    pslg["split"] = edge
    (folder / "case.json").write_text(json.dumps(pslg))
    write_geo(folder / "case.geo", loops, edge)
    fill_in = {
        "section": "" if name == "square" else str(path),
        "keep": "Y" if name == "square" else "",
        "angle": f"{MIN_ANGLE[name]:g}",
        "area": f"{bound:.15f}",
    }
    for tool in tools:
        filled = [word.format(**fill_in) if "{" in word else word for word in tool.command]
        tool.command = [word for word in filled if word]
        if tool.name == "delfront":
            tool.phase = lambda folder, log: (ours_of_case(name, log) or {}).get("seconds")
            tool.facts = lambda folder, log: ours_of_case(name, log) or {}
    about = "unit square" if name == "square" else f"airfoil/{name}.dat as a hole in a square of three chords"
    return {"area": area, "about": about, "work": "triangles"}


def shoelace(loop: np.ndarray) -> float:
    x, y = loop.T
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2
