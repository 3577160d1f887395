#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Grid CAD files as they are, in another unit, turned, larger and smaller: the grids must be as good, and as large.

    cad_turned.py --delfront build/release/delfront --cad-tool build/release/tests/cad_tool [--only NAME ...]
                  [--out docs/cad-turned.md] [--keep FOLDER]

Each file of the shared data that bounds a volume is written anew by OpenCASCADE: as it is, as STEP, in another unit (the
same part, STEP), turned by 40 degrees round (1, 2, 3), times 1000 and times 0.001 (BREP), and gridded with no sizes
given by `mesh FILE --volume-method front-delaunay`. Triangles and tetrahedra may differ by 1 % from those of the file
itself, in another unit from those as STEP (which holds no tolerances and has its own ones), check_mesh.py, which shares no code with delfront, must find nothing, and the goals of the surface must be met where they
are met in the file itself. The file itself is gridded twice: the same bytes. The data lie at $DELFRONT_SHARED (else
../shared). Exit 1 where something is not as it should be, 77 without the data.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
HEAD = """<!-- made by scripts/cad_turned.py -->
# CAD files in another unit, turned and scaled

`mesh FILE --volume-method front-delaunay` with no sizes given, of the file, and of what OpenCASCADE writes of it: as it is, as
STEP, in another unit (the same part; STEP), turned by 40 degrees round (1, 2, 3), times 1000 and times 0.001 (BREP). Beside the
counts, by how much they differ from those of the file; in another unit from those as STEP, whose edges OpenCASCADE makes anew, as
the format holds no tolerances. {limit} % is allowed; `check_mesh.py` must find nothing.

| file | | triangles | | tetrahedra | | smallest angle | smallest dihedral | verdict |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |
"""
MOST = 0.01
SAME_VOLUME = 1e-3
CODES = {"mm": "MM", "m": "M", "in": "INCH", "": "MM"}
MILLIMETRES = {"MM": 1.0, "M": 1000.0, "INCH": 25.4}


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", default=os.path.join(ROOT, "build", "release", "delfront"))
    parser.add_argument("--cad-tool", default=os.path.join(ROOT, "build", "release", "tests", "cad_tool"))
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--out")
    parser.add_argument("--keep", help="folder for the files that are written")
    parser.add_argument("--timeout", type=int, default=200)
    parser.add_argument("--python", default="/usr/bin/python3")
    options = parser.parse_args()
    shared = os.path.realpath(os.environ.get("DELFRONT_SHARED") or os.path.join(ROOT, "..", "shared"))
    options.data = os.path.join(shared, "data", "cad")
    options.checker = os.path.join(shared, "tools", "check_mesh.py")
    if not os.path.isdir(options.data):
        print(f"cad_turned.py: no {options.data}; set DELFRONT_SHARED", file=sys.stderr)
        sys.exit(77)
    if not os.path.exists(options.cad_tool):
        print(f"cad_turned.py: no {options.cad_tool}; it is built where OpenCASCADE is found", file=sys.stderr)
        sys.exit(77)
    return options


class Problem(Exception):
    pass


def run(command, timeout):
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=timeout, check=False)
    except subprocess.TimeoutExpired as e:
        raise Problem(f"{os.path.basename(command[0])}: more than {timeout} s") from e
    if done.returncode != 0:
        said = done.stderr.strip().splitlines() or done.stdout.strip().splitlines() or [""]
        told = [line for line in said if "error:" in line] or said[-1:]
        raise Problem(f"exit {done.returncode}: {told[0].split('error: ')[-1]}")


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def grid(path, options, folder, name):
    """Facts of its grid, which is checked."""
    out, report = os.path.join(folder, name + ".vtu"), os.path.join(folder, name + ".json")
    run([options.delfront, "mesh", path, "-o", out, "--report", report, "--volume-method", "front-delaunay"],
        options.timeout)
    made = read_json(report)
    last = made["geometry"][0]["rounds"][-1]
    done = subprocess.run([options.python, options.checker, out, "--allow-nonmanifold-edges"], capture_output=True,
                          text=True, check=False)
    wrong = [line for line in (done.stdout + done.stderr).splitlines() if "rror" in line]
    return {"volume": made["quality"]["volume"], "triangles": last["triangles"], "cells": made["quality"]["num_cells"], "angle": last["min_angle"],
            "dihedral": made["quality"]["measures"]["min_dihedral"]["min"], "grid": out,
            "stopped": made["geometry"][0]["stopped"],
            "problem": "" if done.returncode == 0 else "checker: " + (wrong[0] if wrong else "refused")}


def bytes_of(path):
    with open(path, "rb") as file:
        return file.read()


def variants(unit):
    """Name, file, unit it is said to be in, factor, degrees, what to compare with of each way to write it."""
    code = CODES[unit]
    other = "MM" if code == "M" else "M"
    return [("written anew", "anew.brep", code, 1, 0, "itself"), ("as STEP", "as.step", code, 1, 0, "itself"),
            (f"in {other.lower()}", "unit.step", other, MILLIMETRES[code] / MILLIMETRES[other], 0, "as STEP"),
            ("turned", "turned.brep", code, 1, 40, "itself"), ("times 1000", "large.brep", code, 1000, 0, "itself"),
            ("times 0.001", "small.brep", code, 0.001, 0, "itself")]


def compare(made, base, scale):
    """What is not as in the file itself, which this is the scale times."""
    found = [made["problem"]] if made["problem"] else []
    if abs(made["volume"] / base["volume"] / scale**3 - 1) > SAME_VOLUME:
        found.append("another volume")
    for what in ("triangles", "cells"):
        if abs(made[what] / base[what] - 1) > MOST:
            found.append(f"{100 * (made[what] / base[what] - 1):+.1f} % {what}")
    if made["stopped"] and not base["stopped"]:
        found.append("goals not met")
    return "; ".join(found)


def row(file, name, made, base, verdict):
    def change(what):
        return "" if made is base else f"{100 * (made[what] / base[what] - 1):+.2f} %"

    cells = [file, name] + [""] * 6
    if made:
        cells[2:] = [f"{made['triangles']:,}", change("triangles"), f"{made['cells']:,}", change("cells"),
                     f"{made['angle']:.1f}", f"{made['dihedral']:.1f}"]
    return "| " + " | ".join([*cells, verdict.replace("|", "/") or "clean"]) + " |"


def judge(file, options, folder):
    """Rows of a file, and how many of them are bad; none where it bounds no volume."""
    path, facts = os.path.join(options.data, file), os.path.join(folder, "facts.json")
    try:
        run([options.delfront, "info", path, "--json", facts], options.timeout)
    except Problem:
        return [], 0
    unit = read_json(facts)["geometry"]["cad"]["unit"]
    base = grid(path, options, folder, "itself")
    verdict = base["problem"]
    if bytes_of(base["grid"]) != bytes_of(grid(path, options, folder, "again")["grid"]):
        verdict += "; other bytes the second time"
    rows, bad = [row(file, "itself", base, base, verdict)], bool(verdict)
    grids = {"itself": base}
    for name, out, to, scale, degrees, other in variants(unit):
        made, out = None, os.path.join(folder, out)
        base = grids.get(other) or grids["itself"]
        try:
            run([options.cad_tool, "turn", path, out, CODES[unit], to, repr(scale), str(degrees)], options.timeout)
            made = grid(out, options, folder, "variant")
            grids[name] = made
            verdict = compare(made, base, scale)
        except Problem as e:
            verdict = str(e).replace(folder + os.sep, "").replace(options.data + os.sep, "")
        rows.append(row("", name, made, base, verdict))
        bad += bool(verdict)
    return rows, bad


def main():
    options = read_options()
    lines, bad = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for name in sorted(os.listdir(options.data)):
            if options.only and name not in options.only:
                continue
            rows, wrong = judge(name, options, options.keep or folder)
            for line in rows:
                print(line, flush=True)
            lines += rows
            bad += wrong
    if options.out:
        with open(options.out, "w", encoding="utf-8") as file:
            file.write(HEAD.format(limit=round(100 * MOST)) + "\n".join(lines) +
                       f"\n\n{len(lines) - bad} of {len(lines)} as they should be.\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
