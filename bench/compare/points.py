# SPDX-License-Identifier: Apache-2.0
"""Workload "points": Delaunay tetrahedrization of point sets.

Every tool reads the same doubles. "phase" is sorting and inserting the points as the tool itself prints it (for HXT:
around the call of hxtDelaunay), "whole" the wall time of the process, reading included. The number of tets must agree
where no five points lie exactly on a sphere (all sets but the lattice), the volume always; a peer for which they do not
has a remark and is not taken for the fastest. PyPI's Gmsh hides HXT's kernel, so that of Debian's library is called;
gmsh.algorithm.tetrahedralize goes HXT's way with Mesh.Algorithm3D = 10 and Gmsh's own with 1. geogram's wheel has
Voronoi cells only, so the sources in its archive are built. "walk", "insphere", "made": walk steps, in-sphere tests and
tets made a point; 5.6, 48 and 28 are usual for random points. Peak memory: of the process, interpreter included.
"""

import json
import re
import sys
from pathlib import Path

from . import peers, shapes
from .running import Tool

TITLE = "Delaunay tetrahedrization of point sets"
SIZES = (1_000_000, 10_000_000)
NAMES = tuple(shapes.POINT_SETS)


def json_line(log: str) -> dict:
    lines = [line for line in log.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {}


def phase_of_json(folder: Path, log: str) -> float | None:
    return json_line(log).get("seconds")


def facts_of_json(folder: Path, log: str) -> dict:
    return {key: value for key, value in json_line(log).items() if key not in ("seconds", "set", "threads")}


def phase_of_tetgen(folder: Path, log: str) -> float | None:
    found = re.search(r"^Delaunay seconds:\s*([\d.eE+-]+)", log, re.M)
    return float(found.group(1)) if found else None


def facts_of_tetgen(folder: Path, log: str) -> dict:
    found = re.search(r"Mesh tetrahedra:\s*(\d+)", log)
    return {"tets": int(found.group(1))} if found else {}


def find_tools(options) -> list[Tool]:
    ours, missing = peers.find_ours("delaunay_bench", options.delaunay_bench)
    tools = []

    def add(name, threads, command, version, missing, phase=phase_of_json, facts=facts_of_json, environment=None):
        tools.append(Tool(name, threads, command, version, missing, phase, facts, environment=environment or {}))

    for threads in options.threads:
        add("delfront", threads, [ours, "--file", "p.f64", "--threads", str(threads)], options.version, missing)
    kernel = str(peers.SOURCES / "hxt_delaunay.py")
    gmsh_version = peers.debian_version("libgmsh4.8")
    lacks = "" if gmsh_version != "unknown" else f"libgmsh4.8 (gmsh); {peers.SETUP}"
    for threads in options.threads:
        add("HXT hxtDelaunay", threads, [sys.executable, kernel, "p.f64", str(threads)], gmsh_version, lacks)
    _, _, version, lacks = peers.find_gmshs()[0]
    script = str(peers.SOURCES / "gmsh_tetrahedralize.py")
    calm = {"OPENBLAS_NUM_THREADS": "1"}
    for algorithm, name, all_threads in ((10, "Gmsh HXT", options.threads), (1, "Gmsh Delaunay", options.threads[:1])):
        for threads in all_threads:
            command = [str(peers.VENV_PYTHON), script, "p.f64", str(algorithm), str(threads)]
            add(f"{name} (algorithm.tetrahedralize)", threads, command, version, lacks, environment=calm)
    cgal, lacks = peers.built(peers.build_cgal)
    version = peers.debian_version("libcgal-dev")
    add("CGAL Delaunay_triangulation_3", 1, [cgal, "p.f64", "0"], version, lacks)
    for threads in filter(lambda t: t > 1, options.threads):
        add("CGAL Delaunay_triangulation_3 TBB", threads, [cgal, "p.f64", str(threads)], version, lacks)
    geogram, lacks = peers.built(peers.build_geogram)
    version = peers.geogram_version()
    add("geogram BDEL", 1, [geogram, "p.f64", "BDEL", "1"], version, lacks)
    for threads in filter(lambda t: t > 1, options.threads):
        add("geogram PDEL", threads, [geogram, "p.f64", "PDEL", str(threads)], version, lacks)
    program, version, lacks = peers.find_tetgen()
    add("TetGen", 1, [program, "-NEFV", "p.node"], version, lacks, phase_of_tetgen, facts_of_tetgen)
    return tools


def prepare(name: str, size: int, folder: Path, tools: list[Tool], options) -> dict:
    """Write the points. @return facts of the case, for the tables"""
    points = shapes.make_points(name, size)
    points.tofile(folder / "p.f64")
    if any(tool.name == "TetGen" and not tool.missing for tool in tools):
        shapes.write_node(folder / "p.node", points)
    return {"points": len(points), "about": shapes.POINT_SETS[name], "work": "points"}
