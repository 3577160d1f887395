#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What many size sources cost in gridding: the same job with them, and with their sizes kept on an adaptive grid.

    bench/gridding_with_sources.py [--ours build/release/delfront] [--sources 100000] [--scale 1.15] [--repeat 3]
                                   [--threads 1,2] [--write-docs]

A cube with point sources along ten curves. Kept on a grid (`[size.adaptive]`), a size costs the same however many
sources there are, so that the two runs differ in how sizes are asked for: by about a tenth of a microsecond a place, or
by a search. The grids are not the same, since the kept sizes are interpolated; times of gridding (stage `refine`) are
given for a million tetrahedra. Runs take turns; medians. The table goes into docs/sizes/sources.md between its markers.
"""

import argparse
import json
import math
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import machine, peers, script  # noqa: E402

PAGE = peers.ROOT / "docs" / "sizes" / "sources.md"
MAKER = "gridding_with_sources.py"
WALL = 24  # squares along a side of the cube
WAYS = {"sources": [], "kept on a grid": ["--set", "size.adaptive.cells=8"]}


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ours", help="our program; default: the newest of build/*")
    parser.add_argument("--sources", type=int, default=100_000)
    parser.add_argument("--scale", type=float, default=1.15, help="all sizes times this")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--time-limit", type=float, default=300, help="seconds after which one run is stopped")
    parser.add_argument("--write-docs", action="store_true", help="write the table into docs/sizes/sources.md")
    return parser.parse_args()


def write_cube(path: Path) -> None:
    at = [k / WALL for k in range(WALL + 1)]
    with path.open("w", encoding="ascii") as file:
        file.write("solid walls\n")
        for axis in range(3):
            for side in (0, 1):
                for i in range(WALL):
                    for j in range(WALL):
                        square = []
                        for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                            p = [0.0, 0.0, 0.0]
                            p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = float(side), at[u], at[v]
                            square.append(p)
                        if side == 0:
                            square.reverse()
                        for corners in ((0, 1, 2), (0, 2, 3)):
                            file.write("facet normal 0 0 0\nouter loop\n")
                            for c in corners:
                                file.write("vertex " + " ".join(repr(x) for x in square[c]) + "\n")
                            file.write("endloop\nendfacet\n")
        file.write("endsolid walls\n")


def write_job(path: Path, count: int, scale: float) -> None:
    """Ten curves; sizes vary along each and from one to the next."""
    with path.open("w", encoding="ascii") as job:
        job.write('[input]\nfiles = ["cube.stl"]\n[size]\ngrowth = 1.25\n')
        for i in range(count):
            curve, t = i % 10, 10 * (i // 10) / count
            turn, radius = 2 * math.pi * t, 0.1 + 0.03 * curve
            x, y = 0.5 + radius * math.cos(turn + 2.4 * curve), 0.5 + radius * math.sin(turn + 2.4 * curve)
            z = 0.1 + 0.08 * curve + 0.05 * math.sin(3 * turn)
            delta0 = scale * 0.006 * (1 + 0.5 * math.sin(20 * t)) * (1 + 0.2 * curve)
            job.write(f'[[size.source]]\ntype = "point"\nat = [{x:.6f}, {y:.6f}, {z:.6f}]\n')
            job.write(f"delta0 = {delta0:.6g}\nr1 = {scale * (0.05 + 0.02 * (curve % 3)):.4g}\n")


def run(program: str, folder: Path, words: list[str], time_limit: float) -> dict:
    report = folder / "report.json"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [program, "mesh", str(folder / "job.toml"), "-o", str(folder / "out.vtu"), "--report", str(report), *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=time_limit, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: {done.stderr.strip()[-400:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = json.loads(report.read_text(encoding="utf-8"))
    seconds = {stage["stage"]: stage["seconds"] for stage in text["stages"]}
    cpu, whole = after.ru_utime - before.ru_utime, sum(seconds.values())
    return {"cells": text["quality"]["num_cells"], "refine": seconds["refine"] * cpu / whole, "whole": whole, "cpu": cpu}


def main() -> int:
    options = parse()
    program, why = peers.find_ours("delfront", options.ours)
    if not program:
        print(why, file=sys.stderr)
        return 1
    lines = ["| threads | sizes from | million tets | gridding, CPU s | of a million tets | ratio | whole, s | whole, CPU s |"]
    lines += ["| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    with tempfile.TemporaryDirectory(prefix="delfront_sources_") as name:
        folder = Path(name)
        write_cube(folder / "cube.stl")
        write_job(folder / "job.toml", options.sources, options.scale)
        for threads in options.threads.split(","):
            runs: dict[str, list[dict]] = {way: [] for way in WAYS}
            for _ in range(options.repeat):
                for way, words in WAYS.items():
                    runs[way].append(run(program, folder, [*words, "--threads", threads], options.time_limit))
                    print(threads, way, runs[way][-1], file=sys.stderr, flush=True)
            per_million = {}
            for way, found in runs.items():
                middle = {key: statistics.median(r[key] for r in found) for key in found[0]}
                per_million[way] = middle["refine"] / middle["cells"] * 1e6
                lines.append(
                    f"| {threads} | {way} | {middle['cells'] * 1e-6:.2f} | {middle['refine']:.2f} | "
                    f"{per_million[way]:.2f} | {per_million['sources'] / per_million[way]:.2f} | "
                    f"{middle['whole']:.2f} | {middle['cpu']:.2f} |"
                )
    text = (
        f"{machine.describe()}; {options.sources:,} point sources along ten curves, medians of {options.repeat}, by "
        "`bench/gridding_with_sources.py --write-docs`. Ratio: gridding of a million with the sources themselves against "
        "this row; whole: all stages, with what builds the tree or the grid of sizes.\n\n" + "\n".join(lines) + "\n"
    )
    return script.publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
