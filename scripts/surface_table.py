#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Grid the surface of every valid file of the corpus anew, fill it, check both, and write the table of it.

    surface_table.py --delfront build/release/delfront [--only PATTERN] [--out docs/surface-corpus.md] [--timeout 300]

Each file is run as `mesh FILE --surface-method front`, at the mean side of its own triangles and with --hmax 2%: once
with --stop-after surface, once to tetrahedra. check_mesh.py, which shares no code with delfront, compares the boundary
of the tetrahedra with the surface written. Exit 1 where a run or a grid is not as it should be, 77 without the data.
"""
import json
import os
import subprocess
import sys
import tempfile
import time

from corpus_table import first_error, read_options, read_rows, write_page

RUNS = (("mean side", []), ("2 % of the diagonal", ["--hmax", "2%"]))
HEAD = """<!-- made by scripts/surface_table.py -->
# Surfaces gridded anew, on the shared geometry

`mesh FILE --surface-method front`, at the mean side of the given triangles, and with `--hmax 2%`. Pieces: connected
parts between feature lines. Angles are those of the new triangles: the smallest, and the mean of each one's smallest.
Off: the largest distance of a new triangle's middle from the given surface, in per cent of the diagonal. Lowered:
places where the wanted size gave no valid grid. Remeshed, kept: pieces where the front came to no end. Seconds are
those of the surface alone. Tetrahedra: of the grid inside the new surface, their smallest dihedral angle, and what
`check_mesh.py GRID --surface NEW --keep-surface` says.

| file | size | given | pieces | triangles | smallest angle | mean | off, % | lowered | remeshed | kept | seconds | tetrahedra | smallest dihedral | checker |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |
"""


def run(command, timeout):
    """Exit code and the last line of what was said."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=timeout)
    except subprocess.TimeoutExpired:
        return None, f"more than {timeout} s"
    said = done.stderr.strip().splitlines()
    return done.returncode, said[-1] if said else ""


def read_report(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def judge(row, arguments, options, folder):
    """One row of the table, without file and size, and what was wrong."""
    given = os.path.join(options.data, row["path"])
    surface, grid = os.path.join(folder, "new.off"), os.path.join(folder, "new.vtu")
    report = os.path.join(folder, "new.json")
    command = [options.delfront, "mesh", given, "--surface-method", "front", "--report", report, *arguments]
    code, said = run([*command, "-o", surface, "--stop-after", "surface"], options.timeout)
    if code != 0:
        return [""] * 12, f"surface: exit {code}: {said}"
    looked = read_report(report)
    made = looked["surface_grid"]
    seconds = sum(s["seconds"] for s in looked["stages"] if s["stage"] == "surface")
    kinds = [f["kind"] for f in made["fallbacks"]]
    cells = [f"{made['triangles_given']:,}", str(made["regions"]), f"{made['triangles']:,}",
             f"{made['min_angle']:.1f}", f"{made['mean_min_angle']:.1f}",
             f"{100 * made['largest_distance'] / looked['scale']['diagonal']:.2g}", str(made["sizes_lowered"]),
             str(kinds.count("remeshed")), str(kinds.count("kept")), f"{seconds:.2f}"]
    code, said = run([*command, "-o", grid], options.timeout)
    if code != 0:
        return [*cells, "", ""], f"grid: exit {code}: {said}"
    looked = read_report(report)
    if not (looked["surface_grid"] or {}).get("triangles"):  # the new one could not be filled
        surface, cells[-2] = given, cells[-2] + " + all"
    least = looked["quality"]["measures"]["min_dihedral"]["min"]
    cells += [f"{looked['quality']['num_cells']:,}", f"{least:.1f}"]
    command = [options.python, options.checker, grid, "--surface", surface, "--keep-surface"]
    if looked["surface"]["is_manifold"] is False:
        command.append("--allow-nonmanifold-edges")
    done = subprocess.run(command, capture_output=True, text=True)
    return cells, "" if done.returncode == 0 else "checker: " + first_error(done.stdout + done.stderr)


def main():
    options = read_options(__doc__, "surface-corpus.md")
    lines, bad = [], 0
    rows = [row for row in read_rows(options) if row["valid"]]
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for row in rows:
            for size, arguments in RUNS:
                cells, problem = judge(row, arguments, options, folder)
                verdict = problem.replace(options.data + os.sep, "").replace("|", "/") or "clean"
                lines.append("| " + " | ".join([row["path"], size, *cells, verdict]) + " |")
                print(lines[-1], flush=True)
                bad += bool(problem)
    print(f"{time.monotonic() - start:.0f} s", file=sys.stderr)
    write_page(options, HEAD + "\n".join(lines) + f"\n\n{len(lines) - bad} of {len(lines)} as they should be.\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
