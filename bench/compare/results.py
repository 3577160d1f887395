# SPDX-License-Identifier: Apache-2.0
"""The file of results: {"cases": {"workload/case/size": {title, size, facts, machine, rows}}}.

A further run replaces the rows of the same tool, threads and version in the same case and keeps the rest, so that a
run can be extended with workloads, sizes and tools. Each row carries the time stamp of its run; ratios are taken only
between rows of one run.
"""

import json
from pathlib import Path


def load(path: Path) -> dict:
    return json.loads(path.read_text()) if path.exists() else {"cases": {}}


def row_key(row: dict) -> tuple:
    return row["tool"], row["threads"], row["version"] if row["tool"].startswith("Gmsh") else ""


def add_case(results: dict, key: str, case: dict) -> None:
    """Put the case in; rows that this run did not measure are kept from earlier ones."""
    old = results["cases"].get(key, {"rows": []})
    new = {row_key(row): row for row in case["rows"]}
    rows = [new.pop(row_key(row), row) for row in old["rows"]]
    results["cases"][key] = {**case, "rows": rows + list(new.values())}


def save(path: Path, results: dict) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    temporary.write_text(json.dumps(results, indent=1))
    temporary.replace(path)
