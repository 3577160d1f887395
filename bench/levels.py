#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Gridding with levels (`refine.levels`) beside gridding directly: the unit sphere, by each front, in turn, medians.

    bench/levels.py [--delfront build/release/delfront] [--tets 1000000] [--levels 1] [--repeat 3] [--threads 1]
                    [--methods front,front-delaunay] [--write-docs]

"direct": the sphere with triangles of side d, gridded at d. "levels": the sphere with triangles of 2^levels d, gridded at
their size, then every edge halved; new points on the sphere of "onto a sphere" are put on one of finer facets. "gridding":
all stages but reading, measuring and writing, with reading of the finer facets left out too; "whole": wall time of the
process. "gain": direct over levels. Edges: length over d, the mean side of the direct grid's triangles. The table goes into
docs/refine.md between its markers. Needs Debian's python3-numpy and python3-meshio.
"""

import argparse
import json
import shutil
import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import machine, peers, running, script, shapes, tables  # noqa: E402

PAGE = peers.ROOT / "docs" / "refine.md"
MAKER = "levels.py"
LEFT_OUT = ("read", "measure", "write")
PAIRS = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", help="our program; default: the newest of build/*")
    parser.add_argument("--tets", type=float, default=1e6, help="of the direct grid, about")
    parser.add_argument("--levels", type=int, default=1)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--methods", default="front,front-delaunay")
    parser.add_argument("--time-limit", type=float, default=600, help="seconds after which one run is stopped")
    parser.add_argument("--write-docs", action="store_true", help="write the table into docs/refine.md")
    return parser.parse_args()


def make_surfaces(tets: float, levels: int, folder: Path) -> float:
    """fine.off, coarse.off, sphere.off (facets half as long as the fine ones'). @return mean side of the fine ones"""
    coarse = max(2, round(46 * (tets / 1.69e6) ** (1 / 3) / 2**levels))
    frequencies = {"sphere": coarse * 2 ** (levels + 1), "coarse": coarse, "fine": coarse * 2**levels}
    for name, frequency in frequencies.items():
        surface = shapes.geodesic_sphere(frequency)
        shapes.write_surface(folder, *surface)
        (folder / "s.off").rename(folder / f"{name}.off")
    return shapes.mean_edge(*surface)


def report_of(folder: Path) -> dict:
    return json.loads((folder / "report.json").read_text())


def phase(folder: Path, log: str) -> float:
    return sum(stage["seconds"] for stage in report_of(folder)["stages"] if stage["stage"] not in LEFT_OUT)


def facts(side: float):
    def read(folder: Path, log: str) -> dict:
        mesh = meshio.read(folder / "grid.vtu")
        tets = next(block.data for block in mesh.cells if block.type == "tetra")
        edges = np.concatenate([np.sort(tets[:, pair], 1) for pair in map(list, PAIRS)])
        keys = np.unique(edges[:, 0].astype(np.int64) * len(mesh.points) + edges[:, 1])
        ends = mesh.points[keys // len(mesh.points)] - mesh.points[keys % len(mesh.points)]
        ratio = np.linalg.norm(ends, axis=1) / side
        measures = report_of(folder)["quality"]["measures"]
        return {
            "tets": len(tets),
            "ratio": np.percentile(ratio, [1, 50, 99]).tolist(),
            "near": float(np.mean((ratio >= 0.8) & (ratio <= 1.25))),
            "worst": measures["min_dihedral"]["min"],
            "mean": measures["min_dihedral"]["mean"],
            "largest": measures["max_dihedral"]["max"],
        }

    return read


def find_tools(ours: str, options, side: float) -> list[running.Tool]:
    tools = []
    ways = {
        "direct": ["fine.off"],
        "levels": ["coarse.off", "--levels", str(options.levels)],
        "levels, onto a sphere": ["coarse.off", "--levels", str(options.levels), "--geometry", "sphere.off"],
    }
    for method in options.methods.split(","):
        for way, words in ways.items():
            command = [ours, "mesh", *words, "-o", "grid.vtu", "--set", f"volume.method={method}", "-q"]
            command += ["--report", "report.json", "-j", str(options.threads)]
            outputs = ["grid.vtu", "report.json"]
            tools.append(running.Tool(f"{method}: {way}", options.threads, command, "", "", phase, facts(side), outputs))
    return tools


def row_of(row: dict, direct: dict) -> list[str]:
    if not row["runs"]:
        return [row["tool"], row["failure"], *[""] * 10]
    found, seconds, whole = row["facts"], tables.median(row, "phase"), tables.median(row, "whole")
    gain = ["", ""]
    if row is not direct and direct["runs"]:
        gain = [f"{tables.median(direct, 'phase') / seconds:.1f}", f"{tables.median(direct, 'whole') / whole:.1f}"]
    return [
        row["tool"],
        f"{found['tets']:,}",
        tables.spread(row, "phase"),
        tables.short(found["tets"] / seconds),
        gain[0],
        tables.spread(row, "whole"),
        gain[1],
        " / ".join(f"{value:.2f}" for value in found["ratio"]),
        f"{100 * found['near']:.1f} %",
        f"{found['worst']:.1f}",
        f"{found['mean']:.1f}",
        f"{found['largest']:.1f}",
    ]


def main() -> int:
    options = parse()
    ours, why = peers.find_ours("delfront", options.delfront)
    if not ours:
        print(why, file=sys.stderr)
        return 1
    folder = Path(tempfile.mkdtemp(prefix="delfront_levels_"))
    try:
        side = make_surfaces(options.tets, options.levels, folder)
        limits = running.Limits(options.repeat, options.time_limit, 4 * options.time_limit)
        say = lambda text: print(text, file=sys.stderr, flush=True)  # noqa: E731
        tools = find_tools(ours, options, side)
        rows = running.run_interleaved(tools, folder, peers.build_launcher(), limits, running.new_stamp(), say)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    head = ["method: way", "tets", "gridding, s", "tets/s", "gain", "whole, s", "gain"]
    head += ["edges/d: 1 / 50 / 99 %", "0.8–1.25", "worst °", "mean least °", "largest °"]
    lines = [row_of(row, rows[i // 3 * 3]) for i, row in enumerate(rows)]
    text = (
        f"{machine.describe()}; {running.new_stamp()}; medians of {options.repeat} (least–most), in turn, by "
        f"`bench/levels.py --tets {options.tets:g} --levels {options.levels} --repeat {options.repeat} "
        f"--threads {options.threads}`. Load average {machine.load():.1f}.\n\n" + "\n".join(tables.table(head, lines))
    )
    return script.publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
