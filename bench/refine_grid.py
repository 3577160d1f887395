#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Global refinement of a tetrahedral grid of the unit sphere: delfront and `gmsh -refine`, in turn, medians.

    bench/refine_grid.py [--delfront build/release/delfront] [--tets 100000,1000000] [--repeat 3] [--threads 1,2]
                         [--write-docs]

The coarse grid is ours, with about so many tetrahedra, given to Gmsh as MSH 4.1. "topology": numbering the middles of
edges and placing them, and dividing all cells (ours: the stages `refine: points` and `refine: cells` of the report);
"refine": ours with the exact check of every new cell and, where it is said, with new points put on a sphere of finer
facets; Gmsh's is what it prints for refining. "whole": wall time of the process with files in and out (ours also checks
the grid before and after). Gmsh is given no geometry, so it keeps new points in the middle. A Gmsh that is not there
keeps its row. The table goes into docs/refine.md between its markers. Needs Debian's python3-numpy.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import machine, peers, running, script, shapes, tables  # noqa: E402

PAGE = peers.ROOT / "docs" / "refine.md"
MAKER = "refine_grid.py"
TOPOLOGY = {"refine: points", "refine: cells"}


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", help="our program; default: the newest of build/*")
    parser.add_argument("--tets", default="100000,1000000", help="of the coarse grids, about")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--no-gmsh", action="store_true", help="delfront alone")
    parser.add_argument("--time-limit", type=float, default=600, help="seconds after which one run is stopped")
    parser.add_argument("--write-docs", action="store_true", help="write the table into docs/refine.md")
    return parser.parse_args()


def must(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: {done.stderr.strip()}")


def make_grids(ours: str, tets: float, folder: Path) -> None:
    """coarse.vtu, coarse.msh, and sphere.off: the sphere with facets a sixteenth as large."""
    frequency = max(2, round(46 * (tets / 1.69e6) ** (1 / 3)))
    shapes.write_surface(folder, *shapes.geodesic_sphere(4 * frequency))
    (folder / "s.off").rename(folder / "sphere.off")
    shapes.write_surface(folder, *shapes.geodesic_sphere(frequency))
    must([ours, "mesh", "s.off", "-o", "coarse.vtu", "-q"], folder)
    must([ours, "convert", "coarse.vtu", "coarse.msh", "-q"], folder)


def phase_of_delfront(folder: Path, log: str) -> float:
    return sum(time for stage, time in script.stages(folder).items() if stage.startswith("refine"))


def facts_of_delfront(folder: Path, log: str) -> dict:
    report = json.loads((folder / "report.json").read_text())
    return {"tets": report["cells"]["tetrahedron"]}


def phase_of_gmsh(folder: Path, log: str) -> float | None:
    found = re.search(r"Done refining mesh \(Wall ([\d.eE+-]+)s", log)
    return float(found[1]) if found else None


def facts_of_gmsh(folder: Path, log: str) -> dict:
    """Tetrahedra: entity blocks of dimension 3 and type 4 of the elements of an MSH 4.1 file of text."""
    tets = 0
    with (folder / "fine.msh").open("rb") as file:
        while (line := file.readline()) and not line.startswith(b"$Elements"):
            pass
        for _ in range(int(file.readline().split()[0])):
            dimension, _, kind, count = map(int, file.readline().split())
            tets += count * (dimension == 3 and kind == 4)
            for _ in range(count):
                file.readline()
    return {"tets": tets}


def find_tools(ours: str, options) -> list[running.Tool]:
    found = []
    for threads in [int(word) for word in options.threads.split(",")]:
        for name, more in {"delfront": [], "delfront, onto a sphere": ["--geometry", "sphere.off"]}.items():
            command = [ours, "refine", "coarse.vtu", "-o", "fine.vtu", *more, "--report", "report.json", "-q"]
            command += ["-j", str(threads)]
            tool = running.Tool(name, threads, command, "", "", phase_of_delfront, facts_of_delfront, ["fine.vtu"])
            tool.extra_outputs = ["report.json"]
            found.append(tool)
    for label, words, version, lacks in [] if options.no_gmsh else peers.find_gmshs():
        command = [*words, "coarse.msh", "-refine", "-o", "fine.msh", "-format", "msh41"]
        tool = running.Tool(f"Gmsh ({label})", 1, command, version, lacks, phase_of_gmsh, facts_of_gmsh, ["fine.msh"])
        found.append(tool)
    return found


def with_topology(tool: running.Tool, times: list[float]) -> running.Tool:
    """The phase of our runs, while the seconds of the topology are noted."""

    def phase(folder: Path, log: str) -> float:
        times.append(sum(time for stage, time in script.stages(folder).items() if stage in TOPOLOGY))
        return phase_of_delfront(folder, log)

    tool.phase = phase
    return tool


def measure(ours: str, tets: float, options, folder: Path) -> list[list[str]]:
    make_grids(ours, tets, folder)
    found, topology = find_tools(ours, options), {}
    for tool in found:
        if tool.name.startswith("delfront"):
            with_topology(tool, topology.setdefault((tool.name, tool.threads), []))
    limits = running.Limits(options.repeat, options.time_limit, 2 * options.time_limit)
    say = lambda text: print(text, file=sys.stderr, flush=True)  # noqa: E731
    rows = running.run_interleaved(found, folder, peers.build_launcher(), limits, running.new_stamp(), say)
    count = max([row["facts"].get("tets", 0) for row in rows] or [0])
    return [row_of(row, topology.get((row["tool"], row["threads"]), []), count) for row in rows]


def row_of(row: dict, topology: list[float], count: int) -> list[str]:
    if not row["runs"]:
        return [tables.short(count), tables.named(row), row["failure"], "", "", "", ""]
    tets, phase = row["facts"]["tets"], tables.median(row, "phase")
    doubt = "" if tets == count else f" ({tets - count:+,d} tets)"
    middle = sorted(topology)[len(topology) // 2] if topology else None
    return [
        tables.short(count),
        tables.named(row) + doubt,
        f"{tets / middle / 1e6:.1f}" if middle else "",
        tables.spread(row, "phase"),
        f"{tets / phase / 1e6:.2f}" if phase else "",
        tables.spread(row, "whole"),
        f"{tables.median(row, 'rss') / 1e6:.0f}",
    ]


def main() -> int:
    options = parse()
    ours, why = peers.find_ours("delfront", options.delfront)
    if not ours:
        print(why, file=sys.stderr)
        return 1
    rows = []
    for word in options.tets.split(","):
        folder = Path(tempfile.mkdtemp(prefix="delfront_refine_"))
        try:
            rows += measure(ours, float(word), options, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    head = ["new tets", "tool", "topology, M tets/s", "refine, s", "M tets/s", "whole, s", "peak, MB"]
    text = (
        f"{machine.describe()}; {running.new_stamp()}; medians of {options.repeat} (least–most), in turn, by "
        f"`bench/refine_grid.py --tets {options.tets} --repeat {options.repeat} --threads {options.threads}`. "
        f"Load average {machine.load():.1f}. Commands: `delfront refine coarse.vtu -o fine.vtu [--geometry sphere.off] -j N`, "
        f"`gmsh coarse.msh -refine -o fine.msh -format msh41`.\n\n" + "\n".join(tables.table(head, rows))
    )
    return script.publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
