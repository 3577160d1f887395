# SPDX-License-Identifier: Apache-2.0
"""Surfaces of CAD files: ours, Gmsh's and Netgen's, for bench/cad_surface.py."""

import json
import math
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

from . import grids, peers
from .running import Tool
from .script import stages

LIMIT = 240  # seconds in which a peer has to find its size
OUR_LIMIT = 60  # seconds of one run of ours that looks for one
TRIES = 8
NEAR = 0.03  # of a count
PEERS = {"Gmsh": ("gmsh_cad.py", "gmsh"), "Netgen": ("netgen_cad.py", "netgen_mesher")}
SURFACE = ["--stop-after", "surface", "--report", "report.json"]


def copy_of(file: Path, folder: Path) -> Path:
    """Peers know suffixes in small letters, and the text of EGADS files by another and without its first line."""
    if file.suffix.lower() != ".egads":
        if file.suffix.islower():
            return file
        return Path(shutil.copy(file, folder / (file.stem + file.suffix.lower())))
    copy = folder / (file.stem + ".brep")
    text = file.read_text(encoding="latin-1")
    copy.write_text(text[text.index("\n") + 1 :] if text.startswith("DBRep") else text, encoding="latin-1")
    return copy


def our_details(folder: Path, log: str) -> dict:
    """Of each run: what came before and after gridding."""
    found = stages(folder)
    return {"sizes": found.get("look", 0) + found.get("sizes", 0), "checks": found.get("crossings", 0)}


def our_facts(folder: Path, log: str) -> dict:
    """By our report; of grids that are written by the routine for all."""
    report = json.loads((folder / "report.json").read_text())
    rounds = report["geometry"][0]["rounds"]
    last, diagonal = rounds[-1], report["scale"]["diagonal"]
    facts = {
        "triangles": last["triangles"],
        "min_angle": last["min_angle"],
        "mean_angle": last["mean_min_angle"],
        "away_angle": last["min_angle_away_from_sharp_corners"]["value"],
        "deviation": 100 * last["deviation"]["value"] / diagonal,
        "rounds": len(rounds),
        "diagonal": diagonal,
        "gridded": sum(r["triangles"] for r in rounds),
        "peak": report["peak_memory_bytes"],
    }
    return facts | (measured(*grids.read_medit(folder / "o.mesh", b"Triangles", 3)) if (folder / "o.mesh").exists() else {})


def measured(points, triangles) -> dict:
    angles = grids.triangle_angles(points, triangles).min(axis=1)
    return {"triangles": len(triangles), "min_angle": float(angles.min()), "mean_angle": float(angles.mean())}


def ours(program: str, version: str, file: Path, words: list[str], threads: int = 1, writes: bool = True) -> Tool:
    output = "o.mesh" if writes else "o.stl"
    return Tool(
        name="delfront",
        threads=threads,
        command=[program, "mesh", str(file), *words, "-o", output, "--threads", str(threads), *SURFACE],
        version=version,
        phase=lambda folder, log: stages(folder)["surface"],
        facts=our_facts,
        outputs=["report.json"],
        extra_outputs=["o.mesh", "o.stl"],
        details=our_details,
    )


def our_run(program: str, file: Path, words: list[str], folder: Path) -> dict:
    """@return facts  @throws RuntimeError  what it said"""
    command = [program, "mesh", str(file), *words, "-o", "o.stl", *SURFACE]
    (folder / "o.mesh").unlink(missing_ok=True)  # of another file
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=OUR_LIMIT, check=False)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"no grid in {OUR_LIMIT} s") from None
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or ["no grid"])[-1])
    return our_facts(folder, "")


def our_size(program: str, file: Path, triangles: int, folder: Path) -> float:
    """The uniform size for about so many triangles, from a share of the diagonal that has some thousands."""
    usual = our_run(program, file, ["--hmax", "2%", "--set", "size.automatic=false"], folder)
    size = 0.02 * usual["diagonal"] * math.sqrt(usual["triangles"] / triangles)
    best = (math.inf, size)
    for _ in range(TRIES):
        ratio = our_run(program, file, uniform(size), folder)["triangles"] / triangles
        best = min(best, (abs(math.log(ratio)), size))
        if best[0] < NEAR:
            break
        size *= min(2.0, max(0.25, math.sqrt(ratio)))
    return best[1]


def uniform(size: float) -> list[str]:
    return ["--hmax", repr(size), "--set", "size.automatic=false"]


def last_json(log: str) -> dict:
    lines = [line for line in log.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {}


def peer_facts(folder: Path, log: str) -> dict:
    told = last_json(log)
    with np.load(folder / "peer.npz") as found:
        points, triangles = found["points"], found["triangles"]
    extent = np.linalg.norm(np.ptp(points[np.unique(triangles)], axis=0))  # Gmsh's unit may be another than the file's
    return measured(points, triangles) | {"deviation": 100 * told.get("deviation", math.nan) / float(extent)}


def peer(name: str, file: Path, triangles: int, places: int, folder: Path) -> Tool:
    """With its size for about so many triangles; .missing says why it has none."""
    script, package = PEERS[name]
    version = peers.pypi_version(package)
    words = [str(peers.VENV_PYTHON), str(peers.SOURCES / script), str(copy_of(file, folder)), "peer.npz"]
    tool = Tool(name=name, threads=1, command=words, version=version, outputs=["peer.npz"])
    if not version:
        tool.missing = f"PyPI {package}; {peers.SETUP}"
        return tool
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            [*words, "find", str(triangles)],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=LIMIT,
            env=environment,
            check=False,
        )
        told, said = last_json(done.stdout), (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]
    except subprocess.TimeoutExpired:
        told, said = {}, f"no size found in {LIMIT} s"
    if not told:
        tool.missing = said.strip()[:120]
        return tool
    given = [repr(told["size"])] + ([repr(told["safety"])] if "safety" in told else [])
    tool.command = [*words, "size", *given, "--places", str(places)]
    tool.environment = {"OMP_NUM_THREADS": "1"}
    tool.phase = lambda folder, log: last_json(log)["seconds"]
    tool.facts = peer_facts
    return tool


def m6(folder: Path) -> Path:
    """The example of the ONERA M6 wing, two NURBS patches and three planes."""
    python = shutil.which("python3") or "python3"
    script = peers.ROOT / "examples" / "onera_m6" / "make_m6.py"
    subprocess.run([python, str(script), "m6.geom.toml"], cwd=folder, check=True)
    return folder / "m6.geom.toml"
