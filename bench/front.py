#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""delfront's front in the volume beside front and Delaunay peers: one run, one page of tables.

    bench/front.py --tets 1e5 --repeat 3 --write-docs        beside Netgen, Gmsh and TetGen
    bench/front.py --tets 1e6,1e7 --threads 1,2 --write-docs  further sizes
    bench/front.py --workloads sphere --methods front --tools delfront --tets 1e6
    bench/front.py --tables --write-docs                      the page again from the results there are
    bench/front.py --quick                                    does it all work: small, once

Workloads: "sphere" (a surface of one size, filled), "graded" (the outside of a sphere up to a far field, sizes growing
with the distance), "ahmed" (the example, refined); sizes are about so many tets of ours. Methods of ours: the pure
front, front placement with Delaunay connection, circumcentres; each without improvement (raw) and with it. Peers run as
processes of their own on the same surface, in turn with ours, each up to a size of its own: Netgen's pure front and its
Delaunay with front, Gmsh's Delaunay, TetGen (`scripts/setup --peers`); a missing one is named.

Measured of each grid, by one routine for all: the smallest dihedral angle of each tet (mean, worst, share under 10
degrees), and the share of edges whose length over the wanted size is within [0.8, 1.25], of up to 400 000 edges. Wanted
sizes are the same for all tools: the surface's mean edge where they are uniform, else those that delfront has at the
nodes of a grid, interpolated. In "graded" Gmsh is told the law of sizes and Netgen its slope; in "ahmed" Gmsh takes the
sizes of the surface, so that peers' edges are not compared there.

Results are kept in bench/results/front.json; a further run extends them. Ratios are taken only between rows of one run.
Needs Debian's python3-numpy and python3-scipy.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import front, front_tables, machine, peers, results  # noqa: E402
from compare.running import Limits, new_stamp, run_interleaved  # noqa: E402
from compare.script import numbers, words  # noqa: E402


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", help="our program; default: the newest of build/*")
    parser.add_argument("--workloads", type=words, default=[*front.NAMES])
    parser.add_argument("--methods", type=words, default=[*front.METHODS])
    parser.add_argument("--tets", type=numbers, default=[100_000, 1_000_000, 10_000_000], help="about so many, of ours")
    parser.add_argument("--tools", type=words, default=[], help="only tools whose name contains one of these")
    parser.add_argument("--threads", type=numbers, default=[1, 2], help="of ours; peers use one")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--netgen-up-to", type=float, default=1e5, help="tets: its pure front is slow")
    parser.add_argument("--gmsh-up-to", type=float, default=1e6)
    parser.add_argument("--tetgen-up-to", type=float, default=1e6)
    parser.add_argument("--time-limit", type=float, default=900, help="seconds after which one run is stopped")
    parser.add_argument("--budget", type=float, default=300, help="seconds of a tool in a case that end its repeats")
    parser.add_argument("--results", type=Path, default=peers.ROOT / "bench" / "results" / "front.json")
    parser.add_argument("--fresh", action="store_true", help="forget earlier results")
    parser.add_argument("--docs", type=Path, default=peers.ROOT / "docs" / "front-volume.md")
    parser.add_argument("--write-docs", action="store_true", help="also write the page")
    parser.add_argument("--tables", action="store_true", help="run nothing: tables of the results there are")
    parser.add_argument("--quick", action="store_true", help="sphere and graded at 3000 tets, once; keeps no results")
    options = parser.parse_args()
    options.threads = sorted(set(options.threads)) or [1]
    if unknown := set(options.workloads) - set(front.NAMES):
        parser.error(f"no workload {', '.join(sorted(unknown))}; there are {', '.join(front.NAMES)}")
    if options.quick:
        options.workloads, options.tets, options.repeat = ["sphere", "graded"], [3000], 1
    return options


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def run_case(name: str, size: int, program: str, stamp: str, options) -> dict | None:
    """Measure one case. @return None where its surface cannot be had"""
    say(f"{name}, about {size:,} tets")
    with tempfile.TemporaryDirectory(prefix="delfront_front_") as folder:
        try:
            facts, tools = front.prepare(name, size, Path(folder), program, options)
            launcher = peers.build_launcher()
        except peers.NotBuilt as reason:
            say(f"  left out: {reason}")
            return None
        if options.tools:
            tools = [t for t in tools if any(w.lower() in t.name.lower() for w in options.tools)]
        limits = Limits(options.repeat, options.time_limit, options.budget)
        rows = run_interleaved(tools, Path(folder), launcher, limits, stamp, say)
    return {"name": name, "size": size, "facts": facts, "machine": machine.describe(), "rows": rows}


def main() -> int:
    options = parse()
    program, missing = peers.find_ours("delfront", options.delfront)
    if missing and not options.tables:
        print(f"delfront: {missing}", file=sys.stderr)
        return 1
    options.version = peers.first_version(peers.output_of([program, "--version"])) if program else ""
    found = {"cases": {}} if options.fresh or options.quick else results.load(options.results)
    stamp = new_stamp()
    for size in [] if options.tables else options.tets:
        for name in options.workloads:
            case = run_case(name, size, program, stamp, options)
            if case:
                results.add_case(found, f"{name}/{size}", case)
            if case and not options.quick:
                results.save(options.results, found)
    about = " ".join(" ".join(__doc__.split("\n\n")[2:4]).split())
    page = front_tables.page(found, "bench/front.py --write-docs", about)
    print(page)
    if options.write_docs:
        options.docs.parent.mkdir(parents=True, exist_ok=True)
        options.docs.write_text(page)
    return 0 if found["cases"] else 1


if __name__ == "__main__":
    sys.exit(main())
