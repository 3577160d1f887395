#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Grid every surface of the corpus and write a table of the results; fail where tests/corpus.toml expects otherwise.

    corpus_table.py --delfront build/release/delfront [--only PATTERN] [--out docs/corpus.md] [--timeout 600] [-j 1]

Each file is gridded at its own resolution and again with --growth 1.3. A file expected to be valid must give exit 0 and
a grid that the independent checker accepts with the given triangles kept; one expected to be refused must give exit 3
and name the expected defects with a place. The data lie at $DELFRONT_SHARED (else ../shared).
Exit: 0 all as expected, 1 not, 77 the data are not there.
"""

import argparse
import concurrent.futures
import fnmatch
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
INTRODUCTION = """# The corpus

Made by `scripts/corpus_table.py`; what each file must give stands in `tests/corpus.toml`, the files are those of
`$DELFRONT_SHARED/data` (else `../shared/data`). Every valid surface is gridded at its own resolution and again with
`--growth 1.3`, and each grid is checked by `check_mesh.py GRID --surface FILE --keep-surface`, which shares no code
with delfront. Times are wall seconds of the whole command. Steiner: points put on the surface on the way, and left
there. Goal: for surfaces whose angles and dihedral angles are all over 20 degrees, a worst dihedral angle over 8
degrees and under 0.01 % of the cells below 10 (the third condition, gaps wider than half the local edge, is not looked
at here).

"""
RUNS = (("plain", ()), ("growth 1.3", ("--growth", "1.3")))


def shared_folder():
    return os.path.realpath(os.environ.get("DELFRONT_SHARED") or os.path.join(ROOT, "..", "shared"))


def read_corpus(path, pattern):
    """Rows of tests/corpus.toml, whose head says what they hold."""
    with open(path, "rb") as file:
        rows = tomllib.load(file)["file"]
    return [row for row in rows if fnmatch.fnmatch(row["path"], f"*{pattern}*")]


class Run:
    """One run of delfront on one file: exit code, report, checker's verdict, what was not as expected."""

    def __init__(self, row, arguments, options, folder):
        self.row = row
        self.problems = []
        self.report = {}
        self.verdict = ""
        surface = os.path.join(options.data, row["path"])
        stem = row["path"].replace("/", "_") + "_".join(arguments).replace("-", "")
        grid, report = os.path.join(folder, stem + ".vtu"), os.path.join(folder, stem + ".json")
        command = [options.delfront, "mesh", surface, "-o", grid, "--report", report, *arguments]
        start = time.monotonic()
        try:
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=options.timeout)
            self.exit, self.text = done.returncode, done.stderr.strip()
        except subprocess.TimeoutExpired:
            self.exit, self.text = None, f"more than {options.timeout} s"
        self.seconds = time.monotonic() - start
        if os.path.exists(report):
            with open(report, encoding="utf-8") as file:
                self.report = json.load(file)
        if row["valid"]:
            self._judge_grid(grid, surface, options)
        else:
            self._judge_refusal(grid)
        if os.path.exists(grid):
            os.remove(grid)

    def get(self, *keys):
        value = self.report
        for key in keys:
            value = value.get(key) if isinstance(value, dict) else None
        return value

    def found(self):
        """Kinds of the errors that were found."""
        findings = self.get("surface", "findings") or []
        return sorted({f["kind"] for f in findings if f["severity"] == "error"})

    def _judge_grid(self, grid, surface, options):
        if self.exit != 0:
            last = self.text.splitlines()[-1] if self.text else "no message"
            last = last.replace(os.path.dirname(grid) + os.sep, "")
            self.problems.append(f"exit {self.exit} instead of 0: {last}")
            return
        volume, expected = self.get("quality", "volume"), self.row.get("volume")
        if expected is not None and (volume is None or abs(volume - expected) > 1e-4 * abs(expected)):
            self.problems.append(f"the cells fill {volume} instead of {expected}")
        command = [options.python, options.checker, grid, "--surface", surface, "--keep-surface"]
        if self.get("surface", "is_manifold") is False:
            command.append("--allow-nonmanifold-edges")
        if self.row.get("polygons"):  # the checker compares triangles only
            command.append("--allow-extra-boundary")
        done = subprocess.run(command, capture_output=True, text=True)
        self.verdict = "clean" if done.returncode == 0 else "errors"
        if done.returncode:
            self.problems.append("checker: " + first_error(done.stdout + done.stderr))

    def _judge_refusal(self, grid):
        if self.exit != 3:
            self.problems.append(f"exit {self.exit} instead of 3")
        if os.path.exists(grid):
            self.problems.append("a grid was written all the same")
        defects, named = self.row.get("defects", []), self.found()
        missing = sorted(set(defects) - set(named))
        if missing:
            self.problems.append(f"not named: {', '.join(missing)}; named: {', '.join(named) or 'none'}")
        for finding in self.get("surface", "findings") or []:
            if finding["kind"] in defects and finding["severity"] == "error" and not finding["places"]:
                self.problems.append(f"{finding['kind']} has no place")
        words = self.row.get("unreadable", "")
        if words not in self.text + str(self.get("error")):
            self.problems.append(f"the message does not say '{words}': {self.text or 'no message'}")


def first_error(text):
    """The first entry of the checker's list of errors, or its last line."""
    try:
        return json.loads(text[text.index("{") : text.rindex("}") + 1])["errors"][0]
    except (ValueError, KeyError, IndexError):
        return text.strip().splitlines()[-1] if text.strip() else "no output"


def cell(value, form="{}"):
    return "–" if value is None else form.format(value)


def quality_cells(run):
    """Tetrahedra, seconds, worst dihedral angle, share below 10 degrees, checker."""
    if run.exit != 0:
        return ["–", f"{run.seconds:.1f}", "–", "–", f"exit {run.exit}"]
    cells = run.get("quality", "num_cells")
    worst = run.get("quality", "measures", "min_dihedral", "min")
    below = run.get("quality", "cells_below_10_deg")
    share = None if not cells or below is None else 100.0 * below / cells
    return [cell(cells), f"{run.seconds:.1f}", cell(worst, "{:.2f}"), cell(share, "{:.3g}"), run.verdict]


def recovery_cells(run):
    put, left = run.get("recovery", "steiner_points"), run.get("recovery", "steiner_left")
    return [cell(put), cell(left)]


def goal_cell(runs):
    """Whether the goal for well-shaped surfaces is met: worst dihedral angle over 8, under 0.01 % below 10 degrees."""
    angle, dihedral = runs[0].get("surface", "min_angle"), runs[0].get("surface", "min_dihedral")
    if runs[0].exit != 0 or angle is None or dihedral is None or angle <= 20 or dihedral <= 20:
        return "–"
    for run in runs:
        cells, below = run.get("quality", "num_cells") or 1, run.get("quality", "cells_below_10_deg") or 0
        worst = run.get("quality", "measures", "min_dihedral", "min") or 0
        if worst <= 8 or below >= 1e-4 * cells:
            return "missed"
    return "met"


def markdown(results, options):
    """The whole page."""
    valid = [(row, runs) for row, runs in results if row["valid"]]
    refused = [(row, runs) for row, runs in results if not row["valid"]]
    failed = [(row, runs) for row, runs in results if any(run.problems for run in runs)]
    lines = [
        *INTRODUCTION.splitlines(),
        f"{len(results)} files: {len(results) - len(failed)} as expected, {len(failed)} not.",
        "",
        "## Gridded",
        "",
        "| file | triangles | Steiner put | left | tets | s | worst ° | below 10°, % | checker "
        "| growth 1.3: tets | s | worst ° | below 10°, % | checker | goal |",
        "| --- |" + " ---: |" * 7 + " --- |" + " ---: |" * 4 + " --- | --- |",
    ]
    for row, runs in valid:
        triangles = cell(runs[0].get("surface", "num_triangles"))
        cells = [row["path"], triangles, *recovery_cells(runs[0])]
        cells += quality_cells(runs[0]) + quality_cells(runs[1]) + [goal_cell(runs)]
        lines.append("| " + " | ".join(cells) + " |")
    lines += ["", "## Refused", ""]
    lines += ["| file | exit | defects found | expected | s |", "| --- | ---: | --- | --- | ---: |"]
    for row, runs in refused:
        found = ", ".join(runs[0].found()) or cell(runs[0].get("error"))
        expected = ", ".join(row.get("defects", [])) or f"message with '{row.get('unreadable', '')}'"
        cells = [row["path"], str(runs[0].exit), found.replace("|", "/").replace("\n", " "), expected]
        lines.append("| " + " | ".join(cells).replace(options.data + "/", "") + f" | {runs[0].seconds:.1f} |")
    if failed:
        lines += ["", "## Not as expected", ""]
        for row, runs in failed:
            for run, (name, _) in zip(runs, RUNS):
                text = [problem.replace(options.data + "/", "") for problem in run.problems]
                lines += [f"- {row['path']} ({name}): {problem}" for problem in text]
    return "\n".join(lines) + "\n"


def read_options(doc, page):
    """What the tables of the corpus ask on the command line; out is the page or "-". Exits with 77 without the data."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--delfront", default=os.path.join(ROOT, "build", "release", "delfront"))
    parser.add_argument("--corpus", default=os.path.join(ROOT, "tests", "corpus.toml"))
    parser.add_argument("--out", help=f"default: docs/{page}, or with --only '-', standard output")
    parser.add_argument("--only", default="", help="part of a path, may hold * and ?")
    parser.add_argument("--without-large", action="store_true", help="leave out the files marked large, by name")
    parser.add_argument("--timeout", type=float, default=600, help="seconds a run")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="files at a time; more than 1 disturbs the times")
    parser.add_argument("--python", default="/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable,
                        help="runs the checker; needs meshio and scipy")
    options = parser.parse_args()
    options.data = os.path.join(shared_folder(), "data")
    options.checker = os.path.join(shared_folder(), "tools", "check_mesh.py")
    options.out = options.out or ("-" if options.only else os.path.join(ROOT, "docs", page))
    if not os.path.isdir(options.data):
        print(f"SKIPPED {parser.prog}: no data at {options.data}; set DELFRONT_SHARED")
        sys.exit(77)
    if not os.access(options.delfront, os.X_OK):
        parser.error(f"{options.delfront} is not there; build it or give --delfront")
    return options


def read_rows(options):
    """Those rows of the corpus that the options name."""
    rows = read_corpus(options.corpus, options.only)
    for row in [r for r in rows if options.without_large and r.get("large")]:
        print(f"left out: {row['path']}")
        rows.remove(row)
    if not rows:
        sys.exit(f"no file of {options.corpus} matches '{options.only}'")
    return rows


def write_page(options, text):
    if options.out == "-":
        print(text)
    else:
        with open(options.out, "w", encoding="utf-8") as file:
            file.write(text)


def main():
    options = read_options(__doc__, "corpus.md")

    def grid_one(row):
        wanted = RUNS if row["valid"] else RUNS[:1]
        with tempfile.TemporaryDirectory() as folder:
            runs = [Run(row, arguments, options, folder) for _, arguments in wanted]
        state = "ok  " if not any(run.problems for run in runs) else "FAIL"
        print(f"{state} {row['path']}", flush=True)
        for problem in (p for run in runs for p in run.problems):
            print(f"       {problem}", flush=True)
        return row, runs

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(grid_one, read_rows(options)))
    write_page(options, markdown(results, options))
    return 1 if any(run.problems for _, runs in results for run in runs) else 0


if __name__ == "__main__":
    sys.exit(main())
