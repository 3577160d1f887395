# SPDX-License-Identifier: Apache-2.0
"""One measured run of a tool, and interleaved repeats of several."""

import json
import os
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from . import machine


@dataclass
class Tool:
    """A program with its words for one case, and how to read what it printed and wrote."""

    name: str
    threads: int
    command: list[str]
    version: str = ""
    missing: str = ""  # why it cannot be run; "" if it can
    phase: Callable[[Path, str], float | None] = lambda folder, log: None  # (folder, log) -> seconds
    facts: Callable[[Path, str], dict] = lambda folder, log: {}  # after the first run: counts, volume, quality
    outputs: list[str] = field(default_factory=list)  # removed before each run; must be there afterwards
    extra_outputs: list[str] = field(default_factory=list)  # removed before each run
    environment: dict[str, str] = field(default_factory=dict)
    details: Callable[[Path, str], dict] = lambda folder, log: {}  # further figures of each run

    def shown_command(self) -> str:
        """Without folders: what a reader would type."""
        words = [Path(word).name if word.startswith("/") else word for word in self.command]
        settings = [f"{name}={value}" for name, value in self.environment.items()]
        return " ".join(settings + words)


@dataclass
class Limits:
    repeats: int
    time_limit: float  # seconds of one run
    budget: float  # seconds of all runs of one tool in one case: no further repeat is begun after that


def run_once(tool: Tool, folder: Path, launcher: Path, time_limit: float) -> dict:
    """Run in `folder`. @return phase and whole seconds, rss bytes, and "failure" ("" if none)"""
    for name in [*tool.outputs, *tool.extra_outputs, "measured.json"]:
        (folder / name).unlink(missing_ok=True)
    log_path = folder / "log.txt"
    with log_path.open("w") as sink:
        command = [str(launcher), "measured.json", str(max(1, round(time_limit))), *tool.command]
        environment = {**os.environ, **tool.environment}
        subprocess.run(command, cwd=folder, stdout=sink, stderr=subprocess.STDOUT, env=environment, check=True)
    run = json.loads((folder / "measured.json").read_text())
    log = log_path.read_text(errors="replace")
    failure = ""
    if run.pop("stopped"):
        failure = f"stopped after {time_limit:g} s"
    elif run["status"] != 0 or not all((folder / name).exists() for name in tool.outputs):
        last = (log.strip().splitlines() or [""])[-1]
        failure = f"failed (status {run['status']}): {last[:90]}"
    run["failure"] = failure
    run["phase"] = None if failure else tool.phase(folder, log)
    return run if failure else run | tool.details(folder, log)


def run_interleaved(tools: list[Tool], folder: Path, launcher: Path, limits: Limits, stamp: str, say) -> list[dict]:
    """Tool A, tool B, … and again, so that a drift of the machine hits all alike. @return a row a tool"""
    rows = [
        {"tool": t.name, "version": t.version, "threads": t.threads, "command": t.shown_command(), "stamp": stamp}
        | {"failure": f"not installed: {t.missing}" if t.missing else "", "runs": [], "facts": {}, "loads": []}
        for t in tools
    ]
    for _ in range(limits.repeats):
        for tool, row in zip(tools, rows):
            if row["failure"] or sum(run["whole"] for run in row["runs"]) > limits.budget:
                continue
            row["loads"].append(machine.load())
            run = run_once(tool, folder, launcher, limits.time_limit)
            row["failure"] = run.pop("failure")
            if row["failure"]:
                say(f"  {tool.name}, {tool.threads} threads: {row['failure']}")
                continue
            row["runs"].append(run)
            if len(row["runs"]) == 1:
                row["facts"] = tool.facts(folder, (folder / "log.txt").read_text(errors="replace"))
            phase = "-" if run["phase"] is None else f"{run['phase']:.3f} s"
            say(f"  {tool.name}, {tool.threads} threads: phase {phase}, whole {run['whole']:.2f} s")
    for row in rows:
        if row["runs"] and row["failure"]:
            row["runs"] = []  # fails now and then: no time is given for it
    return rows


def new_stamp() -> str:
    return time.strftime("%Y-%m-%d %H:%M")
