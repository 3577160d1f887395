#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""delfront beside its peers: one run, one set of tables with ratios.

    bench/compare_peers.py --build                                   build the peers' drivers now
    bench/compare_peers.py --workload all --repeat 5 --threads 1,2 --write-docs
    bench/compare_peers.py --workload points --sizes 1e5 --cases uniform,graded
    bench/compare_peers.py --tables --write-docs                     tables again from the results there are

Workloads: "points" (Delaunay of point sets), "fill" (finished grids of given surfaces), "planar" (in the plane); each
is explained in bench/compare/<workload>.py. Tools run in turn, each as a process of its own, times are medians, a tool
that is missing, fails or passes --time-limit is named with the reason. Results are kept in bench/results/latest.json;
a further run extends them (--fresh begins anew). Ratios are taken only between rows of one run. Needs Debian's
python3-numpy.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import machine, peers, results, tables  # noqa: E402
from compare.running import Limits, new_stamp, run_interleaved  # noqa: E402
from compare.script import numbers, words  # noqa: E402


def parse() -> argparse.Namespace:
    shared = os.environ.get("DELFRONT_SHARED", peers.ROOT.parent / "shared")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workload", choices=[*tables.MODULES, "all"], default="all")
    parser.add_argument("--cases", type=words, default=[], help="only these cases, e.g. uniform,sphere")
    parser.add_argument("--sizes", type=numbers, default=[], help="points, tets or triangles wanted, e.g. 1e6,1e7")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--threads", type=numbers, default=[1, 2])
    parser.add_argument("--tools", type=words, default=[], help="only tools whose name contains one of these")
    parser.add_argument("--time-limit", type=float, default=900, help="seconds after which one run is stopped")
    parser.add_argument("--budget", type=float, default=600, help="seconds of a tool in a case that end its repeats")
    parser.add_argument("--delfront", help="our programs; default: the newest of build/*")
    parser.add_argument("--delaunay-bench")
    parser.add_argument("--planar-bench")
    parser.add_argument("--results", type=Path, default=peers.ROOT / "bench" / "results" / "latest.json")
    parser.add_argument("--fresh", action="store_true", help="forget earlier results")
    parser.add_argument("--docs", type=Path, default=peers.ROOT / "docs" / "performance.md")
    parser.add_argument("--write-docs", action="store_true", help="also write the tables into the page")
    parser.add_argument("--tables", action="store_true", help="run nothing: tables of the results there are")
    parser.add_argument("--build", action="store_true", help="build the peers' drivers and stop")
    options = parser.parse_args()
    options.threads = sorted(set(options.threads)) or [1]
    options.shared_data = Path(shared) / "data"
    program, _ = peers.find_ours("delfront", options.delfront)
    options.version = peers.first_version(peers.output_of([program, "--version"])) if program else ""
    return options


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def run_case(workload: str, name: str, size: int, stamp: str, options) -> dict | None:
    """Measure one case. @return None where its input cannot be had"""
    module = tables.MODULES[workload]
    wanted = options.tools
    tools = [t for t in module.find_tools(options) if not wanted or any(w.lower() in t.name.lower() for w in wanted)]
    with tempfile.TemporaryDirectory(prefix="delfront_peers_") as folder:
        say(f"{workload}/{name}, size {size:g}")
        try:
            facts = module.prepare(name, size, Path(folder), tools, options)
        except peers.NotBuilt as reason:
            say(f"  left out: {reason}")
            return None
        limits = Limits(options.repeat, options.time_limit, options.budget)
        rows = run_interleaved(tools, Path(folder), peers.build_launcher(), limits, stamp, say)
    return {"name": name, "size": size, "facts": facts, "machine": machine.describe(), "rows": rows}


def main() -> int:
    options = parse()
    if options.build:
        peers.build_all(say)
        return 0
    found = {"cases": {}} if options.fresh else results.load(options.results)
    stamp = new_stamp()
    for workload, module in tables.MODULES.items():
        if options.tables or options.workload not in (workload, "all"):
            continue
        for size in options.sizes or module.SIZES:
            for name in options.cases or module.NAMES:
                if name not in module.NAMES or not getattr(module, "wants", lambda *_: True)(name, size):
                    continue
                case = run_case(workload, name, size, stamp, options)
                if case:
                    results.add_case(found, f"{workload}/{name}/{size}", case)
                    results.save(options.results, found)
    for workload in tables.MODULES:
        if any(key.startswith(workload + "/") for key in found["cases"]):
            print(tables.section(workload, found))
    if options.write_docs:
        tables.write_docs(options.docs, found)
    return 0


if __name__ == "__main__":
    sys.exit(main())
