#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the stores of the front in the volume cost a step, beside those of the literature; into docs/front.md.

    front_search.py [--program build/bench/bench/front_search_bench] [--repeat 3] [--write-docs]

Runs front_search_bench, whose head says what it does, and takes medians.
"""
import argparse
import statistics
import subprocess
import sys
from pathlib import Path

from compare import machine, script, tables

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "front.md"
MAKER = "front_search.py"


def rows_of(program):
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    return [[cell.strip() for cell in line.strip("| \n").split("|")] for line in done.stdout.splitlines()[2:]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=ROOT / "build" / "bench" / "bench" / "front_search_bench")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--write-docs", action="store_true")
    options = parser.parse_args()
    lines = []
    for same in zip(*(rows_of(options.program) for _ in range(options.repeat))):
        there, here = (statistics.median(float(row[k]) for row in same) for k in (2, 3))
        lines.append([f"{int(same[0][0]):,}", same[0][1], f"{there:.0f}", f"{here:.0f}", f"{there / here:.1f}"])
    head = ["faces of the front", "found a step", "heap, octree of points: ns a step", "rounds, octree of boxes: ns"]
    text = (f"{machine.describe()}; one core, medians of {options.repeat}, by `bench/front_search.py --write-docs`.\n\n"
            + "\n".join(tables.table([*head, "gain"], lines)))
    return script.publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
