#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Run the hard families and the corpus, and write counts and times as tables into docs/robustness.md.

    robustness_table.py [--build build/release] [--cases N] [--large] [--without-large] [--out docs/robustness.md]

Families are tests of the unit test programs: each asserts a valid grid with the boundary unchanged (or the exact list
of what had to be subdivided), so that a family that passes has no crash, hang or wrong answer. Corpus: every file of
tests/corpus.toml, once. The page is made anew between its markers; what stands around them is kept.
Exit: 0 all as expected, 1 not.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import corpus_table  # noqa: E402

ROOT = corpus_table.ROOT
BEGIN, END = "<!-- robustness_table.py: begin -->", "<!-- robustness_table.py: end -->"
FAMILIES = (
    ("tests/test_volume", "HardSurfaces.*:Adversaries.*:RandomPolyhedra.*:VolumeFinds.*:Embedded.*"),
    ("tests/test_pipeline", "GenerateEmbedded.*"),
    ("tests/test_improve", "TurnedCopies.*"),
)
FIRST_PAGE = f"""# Robustness

Made by `scripts/robustness_table.py`. Three outcomes are allowed: a valid grid with the boundary unchanged, an exact
list of the faces that had to be subdivided and why, or a refusal of invalid input that names the place.

{BEGIN}
{END}
"""


def run_families(options):
    """Rows (family, passed, seconds) of the unit tests, by their own JSON reports."""
    environment = dict(os.environ)
    if options.cases:
        environment["DELFRONT_RANDOM_CASES"] = str(options.cases)
    if options.large:
        environment["DELFRONT_ADVERSARIES"] = "large"
    rows = []
    for program, tests in FAMILIES:
        path = os.path.join(options.build, program)
        with tempfile.TemporaryDirectory() as folder:
            report = os.path.join(folder, "report.json")
            command = [path, f"--gtest_filter={tests}", f"--gtest_output=json:{report}"]
            done = subprocess.run(command, env=environment, capture_output=True, text=True, errors="replace")
            if not os.path.exists(report):
                rows.append((f"{program} ended with {done.returncode}", "crashed", 0.0))
                continue
            with open(report, encoding="utf-8") as file:
                suites = json.load(file)["testsuites"]
        for suite in suites:
            for test in suite["testsuite"]:
                state = "failed" if test.get("failures") else "skipped" if test["result"] == "SKIPPED" else "passed"
                name = f"{suite['name']}: {test['name'].replace('_', ' ')}"
                rows.append((name, state, float(test["time"].rstrip("s"))))
                print(f"{state} {name}", flush=True)
    return rows


def run_corpus(options):
    """Rows (file, kind, what came out, as expected, seconds)."""
    rows = []
    for row in corpus_table.read_corpus(options.corpus, options.only):
        if options.without_large and row.get("large"):
            continue
        with tempfile.TemporaryDirectory() as folder:
            run = corpus_table.Run(row, (), options, folder)
        left = run.get("recovery", "steiner_left") or 0
        if not row["valid"]:
            outcome = "refused: " + (", ".join(run.found()) or "not readable")
        else:
            outcome = "surface unchanged" if left == 0 else f"{left} points stay, reported"
        if run.problems:
            outcome = "; ".join(run.problems).replace(options.data + "/", "")
        rows.append((row["path"], row["valid"], outcome.replace("|", "/"), not run.problems, run.seconds))
        print(f"{'ok  ' if not run.problems else 'FAIL'} {row['path']}", flush=True)
    return rows


def share(rows):
    return f"{sum(1 for r in rows if r[3])} of {len(rows)}"


def tables(families, corpus, options):
    valid, invalid = [r for r in corpus if r[1]], [r for r in corpus if not r[1]]
    passed = sum(1 for _, state, _ in families if state == "passed")
    lines = [
        f"Valid files of the corpus gridded as expected: {share(valid)}. "
        f"Invalid ones refused with the defects and a place: {share(invalid)}. Families passed: {passed} of "
        f"{len(families)}"
        + (f", {options.cases} random cases each" if options.cases else "")
        + (", in their large sizes." if options.large else "."),
        "",
        "| family | result | s |",
        "| --- | --- | ---: |",
    ]
    lines += [f"| {name} | {state} | {seconds:.2f} |" for name, state, seconds in families]
    lines += ["", "| file | outcome | s |", "| --- | --- | ---: |"]
    lines += [f"| {path} | {outcome} | {seconds:.2f} |" for path, _, outcome, _, seconds in corpus]
    return "\n".join(lines)


def write_between_markers(path, text):
    page = FIRST_PAGE
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            page = file.read()
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"{before}{BEGIN}\n{text}\n{END}{after}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"))
    parser.add_argument("--corpus", default=os.path.join(ROOT, "tests", "corpus.toml"))
    parser.add_argument("--cases", type=int, default=0, help="random cases a family; default: what each takes by itself")
    parser.add_argument("--large", action="store_true", help="the large sizes of the families, as in the nightly run")
    parser.add_argument("--without-large", action="store_true", help="leave out the files of the corpus marked large")
    parser.add_argument("--only", default="", help="files of the corpus: part of a path, may hold * and ?")
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "robustness.md"))
    parser.add_argument("--timeout", type=float, default=600, help="seconds a file")
    parser.add_argument("--python", default="/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable)
    options = parser.parse_args()
    options.delfront = os.path.join(options.build, "delfront")
    options.data = os.path.join(corpus_table.shared_folder(), "data")
    options.checker = os.path.join(corpus_table.shared_folder(), "tools", "check_mesh.py")
    families = run_families(options)
    corpus = []
    if os.path.isdir(options.data):
        corpus = run_corpus(options)
    else:
        print(f"SKIPPED corpus: no data at {options.data}; set DELFRONT_SHARED")
    write_between_markers(options.out, tables(families, corpus, options))
    return 0 if all(state != "failed" and state != "crashed" for _, state, _ in families) and all(
        r[3] for r in corpus) else 1


if __name__ == "__main__":
    sys.exit(main())
