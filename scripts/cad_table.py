#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Grid every CAD file of the shared data with no sizing input, check the grids, and write the table of it.

    cad_table.py --delfront build/release/delfront [--only PATTERN] [--out docs/cad-corpus.md] [--timeout 120] [--surface]

Each file is run as `mesh FILE --stop-after surface`, and where its surface is closed as `mesh FILE` to tetrahedra, whose
grid check_mesh.py looks at, which shares no code with delfront. --surface: no volumes. The data lie at $DELFRONT_SHARED
(else ../shared). Exit 1 where a run or a grid is not as it should be, 77 without the data.
"""
import argparse
import fnmatch
import json
import os
import subprocess
import sys
import tempfile
import time

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
HEAD = """<!-- made by scripts/cad_table.py -->
# CAD files, on the shared geometry

`mesh FILE` with no sizes given. Rounds of gridding until the goals are met; bridges: places narrower than hmin that are gridded
across. Away from sharp corners: without the triangles in and beside corners of faces below 30 degrees, which are as sharp
whatever is done. Deviation: the largest distance of the grid from its surface, in per cent of the diagonal. Seconds are wall time of
reading, all gridding of the surface and all checks. Volumes by `--volume-method front-delaunay` and `front`: tetrahedra, the smallest
dihedral angle, and what `check_mesh.py` says of them; open surfaces have none.

| file | unit | faces | repairs | triangles | rounds | bridges | smallest angle | away from sharp corners | below 25 | deviation, % | seconds | tetrahedra | smallest dihedral | front | smallest dihedral | verdict |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |
"""


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", default=os.path.join(ROOT, "build", "release", "delfront"))
    parser.add_argument("--only", default="")
    parser.add_argument("--out")
    parser.add_argument("--timeout", type=int, default=120)
    parser.add_argument("--surface", action="store_true")
    parser.add_argument("--python", default="/usr/bin/python3")
    options = parser.parse_args()
    shared = os.path.realpath(os.environ.get("DELFRONT_SHARED") or os.path.join(ROOT, "..", "shared"))
    options.data = os.path.join(shared, "data", "cad")
    options.checker = os.path.join(shared, "tools", "check_mesh.py")
    if not os.path.isdir(options.data):
        print(f"cad_table.py: no {options.data}; set DELFRONT_SHARED", file=sys.stderr)
        sys.exit(77)
    return options


def run(command, timeout):
    """Exit code (None: too long), the last line of what was said, seconds."""
    start = time.monotonic()
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=timeout)
    except subprocess.TimeoutExpired:
        return None, f"more than {timeout} s", time.monotonic() - start
    said = done.stderr.strip().splitlines() or done.stdout.strip().splitlines()
    return done.returncode, said[-1] if said else "", time.monotonic() - start


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def judge(path, options, folder):
    """Cells of the row after the file's name, and what was wrong."""
    facts = os.path.join(folder, "facts.json")
    if os.path.exists(facts):
        os.remove(facts)
    code, said, _ = run([options.delfront, "info", path, "--json", facts], options.timeout)
    if not os.path.exists(facts):
        return [""] * 15, f"info: exit {code}: {said}"
    looked = read_json(facts)
    cad = looked["geometry"]["cad"]
    cells = [cad["unit"] or "-", str(len(looked["geometry"]["faces"])), str(len(cad["repairs"]))]
    surface, report = os.path.join(folder, "s.vtu"), os.path.join(folder, "report.json")
    code, said, seconds = run([options.delfront, "mesh", path, "-o", surface, "--stop-after", "surface", "--report",
                               report], options.timeout)
    if code != 0:
        return cells + [""] * 12, f"surface: exit {code}: {said}"
    made = read_json(report)
    smooth = made["geometry"][0]
    last = smooth["rounds"][-1]
    cells += [f"{last['triangles']:,}", str(len(smooth["rounds"])), str(len(smooth["bridges"])),
              f"{last['min_angle']:.1f}", f"{last['min_angle_away_from_sharp_corners']['value']:.1f}",
              str(sum(last["angles"]["counts"][:5])),
              f"{100 * last['deviation']['value'] / made['scale']['diagonal']:.2g}", f"{seconds:.1f}"]
    if not made["surface"]["can_bound_volume"] or options.surface:
        return cells + [""] * 4, "" if options.surface or cad["free_edges"] else "cannot bound a volume"
    for method in ("front-delaunay", "front"):
        more, problem = fill(path, method, options, folder)
        cells += more
        if problem:
            return cells + [""] * (15 - len(cells)), problem
    return cells, ""


def fill(path, method, options, folder):
    """Cells of a volume grid by a method, and what was wrong."""
    grid, report = os.path.join(folder, "v.vtu"), os.path.join(folder, "report.json")
    code, said, _ = run([options.delfront, "mesh", path, "-o", grid, "--report", report, "--volume-method", method],
                        options.timeout)
    if code != 0:
        return ["", ""], f"{method}: exit {code}: {said}"
    made = read_json(report)
    done = subprocess.run([options.python, options.checker, grid, "--allow-nonmanifold-edges"], capture_output=True,
                          text=True, check=False)
    wrong = [line for line in (done.stdout + done.stderr).splitlines() if "rror" in line]
    cells = [f"{made['quality']['num_cells']:,}", f"{made['quality']['measures']['min_dihedral']['min']:.1f}"]
    return cells, "" if done.returncode == 0 else f"{method}, checker: " + (wrong[0] if wrong else "refused")


def main():
    options = read_options()
    lines, bad = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for name in sorted(os.listdir(options.data)):
            if not fnmatch.fnmatch(name, f"*{options.only}*"):
                continue
            cells, problem = judge(os.path.join(options.data, name), options, folder)
            verdict = problem.replace(options.data + os.sep, "").replace("|", "/") or "clean"
            lines.append("| " + " | ".join([name, *cells, verdict]) + " |")
            print(lines[-1], flush=True)
            bad += bool(problem)
    if options.out:
        with open(options.out, "w", encoding="utf-8") as file:
            file.write(HEAD + "\n".join(lines) + f"\n\n{len(lines) - bad} of {len(lines)} as they should be.\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
