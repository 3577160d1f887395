#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does Gmsh open a .msh file with its names?

    gmsh_check.py GRID.msh [--names inlet,outlet,body]

Gmsh checks the file (cells turned over, points and elements that stand in it twice), and writes it again as MSH 2.2
text: what it wrote says which elements and physical names it understood. Exit: 0 passed, 1 not, 77 Gmsh is not installed (Debian package gmsh).
"""

import argparse
import collections
import os
import shutil
import subprocess
import sys
import tempfile

ELEMENTS = {1: "lines", 2: "triangles", 3: "quads", 4: "tetrahedra", 5: "hexahedra", 6: "prisms", 7: "pyramids",
            15: "points"}


def read_msh2(path):
    """Physical names {(dimension, tag): name} and elements counted by (type, physical tag)."""
    names, counts, section, head = {}, collections.Counter(), None, False
    with open(path, encoding="utf-8") as file:
        for text in file:
            text = text.rstrip("\n")
            if text.startswith("$"):
                section, head = (None if text.startswith("$End") else text), True
            elif section == "$PhysicalNames" and not head:
                dimension, tag, name = text.split(maxsplit=2)
                names[int(dimension), int(tag)] = name.strip('"')
            elif section == "$Elements" and not head:
                words = text.split()
                counts[int(words[1]), int(words[3])] += 1
            else:
                head = False
    return names, counts


def dimension_of(element):
    return {1: 1, 2: 2, 3: 2, 15: 0}.get(element, 3)


def gmsh(*arguments):
    """Exit status and what it said."""
    environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
    run = subprocess.run(["gmsh", *arguments, "-nopopup", "-v", "4"], capture_output=True, text=True, env=environment)
    return run.returncode, run.stdout + run.stderr


def find_problems(text):
    return [line.strip() for line in text.splitlines() if line.strip().startswith(("Error", "Warning"))]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("grid")
    parser.add_argument("--names", default="", help="physical names that must hold elements, commas between")
    options = parser.parse_args()
    if shutil.which("gmsh") is None:
        print("SKIPPED gmsh_check: gmsh is not installed (Debian package gmsh)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        again = os.path.join(folder, "again.msh")
        # -save in the same run would take the place of -check.
        status, checked = gmsh(options.grid, "-check")
        written, output = gmsh(options.grid, "-save", "-format", "msh2", "-o", again)
        problems = find_problems(checked) + [p for p in find_problems(output) if p not in checked]
        if written or not os.path.exists(again) or "Done checking" not in checked:
            print(checked + output)
            print(f"gmsh_check: Gmsh cannot open {options.grid}")
            return 1
        if status and not problems:
            problems.append(f"gmsh -check ends with {status}")
        names, counts = read_msh2(again)
    totals = collections.Counter()
    for (element, _), count in counts.items():
        totals[ELEMENTS.get(element, f"type {element}")] += count
    print(", ".join(f"{count} {name}" for name, count in sorted(totals.items())))
    filled = collections.Counter()
    for (element, tag), count in counts.items():
        name = names.get((dimension_of(element), tag))
        if name is not None:
            filled[dimension_of(element), name] += count
    for (dimension, name), count in sorted(filled.items()):
        print(f"  {name}: {count} elements of dimension {dimension}")
    problems += [f"no elements are called '{name}'" for name in filter(None, options.names.split(","))
                 if name not in {n for _, n in filled}]
    if not totals:
        problems.append("no elements")
    for problem in problems:
        print(f"gmsh_check: {problem}")
    print("gmsh_check: FAILED" if problems else "gmsh_check: OK")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
