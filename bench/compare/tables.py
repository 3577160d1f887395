# SPDX-License-Identifier: Apache-2.0
"""Results to the tables of docs/performance.md."""

import statistics
from pathlib import Path

from . import fill, planar, points
from .script import replace_between

MODULES = {"points": points, "fill": fill, "planar": planar}
VOLUME_TOLERANCE = 1e-8  # relative: sums of millions of rounded terms
OURS = "delfront"


def median(row: dict, key: str) -> float | None:
    values = [run[key] for run in row["runs"] if run.get(key) is not None]
    return statistics.median(values) if values else None


def spread(row: dict, key: str) -> str:
    values = [run[key] for run in row["runs"] if run.get(key) is not None]
    if not values:
        return "–"
    digits = 2 if min(values) >= 1 else 4
    text = f"{statistics.median(values):.{digits}f}"
    return text if len(values) == 1 else f"{text} ({min(values):.{digits}f}–{max(values):.{digits}f})"


def short(number: float) -> str:
    return f"{number / 1e6:.2f} M" if number >= 1e6 else f"{number / 1e3:.0f} k" if number >= 1e4 else f"{number:.0f}"


def work(case: dict, row: dict) -> float | None:
    return row["facts"].get(case["facts"]["work"], case["facts"].get(case["facts"]["work"]))


def rate(case: dict, row: dict, key: str = "phase") -> float | None:
    """Points, tets or triangles a second, as the workload counts."""
    seconds, count = median(row, key), work(case, row)
    return count / seconds if seconds and count else None


def named(row: dict) -> str:
    version = f" {row['version']}" if row["version"] else ""
    return f"{row['tool']}{version}, {row['threads']} thread{'s' if row['threads'] > 1 else ''}"


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    return [f"| {' | '.join(head)} |", "|" + "---|" * len(head), *(f"| {' | '.join(row)} |" for row in rows), ""]


# --- one case ---------------------------------------------------------------------------------------------------------


def doubts(workload: str, case: dict, row: dict) -> str:
    """What does not agree with the others; "" where all does."""
    facts, rows = row["facts"], [r for r in case["rows"] if r["runs"]]
    key = "area" if workload == "planar" else "volume"
    given = case["facts"].get(key) or statistics.median([r["facts"][key] for r in rows if key in r["facts"]] or [0])
    if key in facts and given and abs(facts[key] / given - 1) > VOLUME_TOLERANCE:
        return f"{key} off by {abs(facts[key] / given - 1):.1e}"
    if workload == "points" and case["name"] != "lattice" and "tets" in facts:
        usual = statistics.median([r["facts"]["tets"] for r in rows if "tets" in r["facts"]])
        if facts["tets"] != usual:
            return f"{facts['tets'] - usual:+,.0f} tets"
    return ""


QUALITY = {
    "points": [("walk", "walk_steps", "{:.1f}"), ("insphere", "insphere_tests", "{:.1f}")]
    + [("made", "tets_created", "{:.1f}")],
    "fill": [("worst °", "min_dihedral", "{:.2f}"), ("largest °", "max_dihedral", "{:.1f}")]
    + [("below 10°", "below_10", "{:.4%}"), ("mean eta", "eta", "{:.3f}")],
    "planar": [("worst °", "min_angle", "{:.2f}")],
}


def case_table(workload: str, case: dict) -> list[str]:
    unit, counted = case["facts"]["work"], "triangles" if workload == "planar" else "tets"
    head = ["tool", "threads", "runs", counted, "phase s", f"{unit}/s phase", "whole s", f"{unit}/s whole", "peak MiB"]
    head += [f"bytes/{counted[:-1]}", *(name for name, _, _ in QUALITY[workload]), "remark"]
    lines = []
    for row in case["rows"]:
        tool = f"{row['tool']} {row['version']}".strip()
        if row["failure"]:
            lines.append([tool, str(row["threads"]), row["failure"], *[""] * (len(head) - 3)])
            continue
        count, rss, rates = (
            row["facts"].get(counted),
            median(row, "rss"),
            [rate(case, row, k) for k in ("phase", "whole")],
        )
        cells = [tool, str(row["threads"]), str(len(row["runs"])), f"{count:,}" if count else "–"]
        cells.append(spread(row, "phase"))
        cells += [short(rates[0]) if rates[0] else "–", spread(row, "whole"), short(rates[1]) if rates[1] else "–"]
        cells += [f"{rss / 2**20:.0f}", f"{rss / count:.0f}" if count else "–"]
        values = [(row["facts"].get(key), form) for _, key, form in QUALITY[workload]]
        cells += [form.format(value) if value is not None else "–" for value, form in values]
        other = "" if row["stamp"] == newest(case) else f"run of {row['stamp']}"
        lines.append([*cells, "; ".join(filter(None, [doubts(workload, case, row), other]))])
    return table(head, lines)


def newest(case: dict) -> str:
    return max(row["stamp"] for row in case["rows"])


# --- ratios -----------------------------------------------------------------------------------------------------------


def pairs(workload: str, case: dict) -> list[tuple[dict, list[dict]]]:
    """Our rows, each with the peers' rows of the same run that used no more threads, gave a time and
    whose result is right."""
    timed = [row for row in case["rows"] if median(row, "phase") is not None and not row["failure"]]
    found = []
    for ours in (row for row in timed if row["tool"] == OURS):
        others = [row for row in timed if row["tool"] != OURS and row["threads"] <= ours["threads"]]
        others = [row for row in others if row["stamp"] == ours["stamp"] and not doubts(workload, case, row)]
        found.append((ours, others))
    return found


def size_of(case: dict) -> str:
    return f"{case['size']:.0e}".replace("e+0", "e")


def faster_than_one_thread(workload: str, case: dict, ours: dict) -> str:
    alone = [row for row, _ in pairs(workload, case) if row["threads"] == 1 and row["stamp"] == ours["stamp"]]
    return f"{median(alone[0], 'phase') / median(ours, 'phase'):.2f}" if alone and ours["threads"] > 1 else ""


def ratios_of_points(cases: list[dict]) -> list[str]:
    lines = []
    for case in cases:
        for ours, others in pairs("points", case):
            mine = median(ours, "phase")
            best = min(others, key=lambda row: median(row, "phase"), default=None)
            cells = ["–"] * 3
            if best:
                cells = [f"{median(best, 'phase'):.3f}", f"**{median(best, 'phase') / mine:.2f}**", named(best)]
            whole = min((median(row, "whole") for row in others), default=None)
            cells.insert(2, f"{whole / median(ours, 'whole'):.2f}" if whole else "–")
            lines.append(
                [
                    case["name"],
                    size_of(case),
                    str(ours["threads"]),
                    f"{mine:.3f}",
                    *cells,
                    faster_than_one_thread("points", case, ours),
                ]
            )
    head = ["points", "size", "threads", "delfront phase s", "fastest peer's s", "peer / ours", "whole: fastest / ours"]
    return table([*head, "fastest peer", "ours: 1 thread / this"], lines)


def ratios_of_fill(cases: list[dict]) -> list[str]:
    lines = []
    for case in cases:
        for ours, others in pairs("fill", case):
            hxt = [r for r in others if r["tool"].startswith("Gmsh HXT (PyPI") and r["threads"] == ours["threads"]]
            best = max(others, key=lambda row: rate(case, row), default=None)
            mine, facts = rate(case, ours), ours["facts"]
            cells = [case["name"], size_of(case), str(ours["threads"]), f"{facts['tets']:,}", short(mine)]
            cells += [
                f"{1e6 / mine:.2f}",
                f"{median(ours, 'rss') / facts['tets']:.0f}",
                faster_than_one_thread("fill", case, ours),
            ]
            if hxt:
                h = hxt[0]
                cells += [short(rate(case, h)), f"**{mine / rate(case, h):.2f}**"]
                cells.append(f"{median(h, 'phase') / median(ours, 'phase'):.2f}")
                cells.append(f"{facts['min_dihedral']:.1f} / {h['facts']['min_dihedral']:.1f}")
                cells.append(f"{facts['below_10']:.4%} / {h['facts']['below_10']:.4%}")
            else:
                cells += ["–"] * 5
            cells.append(f"{mine / rate(case, best):.2f} ({named(best)})" if best else "–")
            lines.append(cells)
    head = ["surface", "size", "threads", "our tets", "tets/s", "µs/tet", "bytes/tet", "1 thread / this", "HXT tets/s"]
    head += ["ours / HXT, tets/s", "HXT's time / ours", "worst ° ours / HXT", "below 10° ours / HXT"]
    return table([*head, "ours / fastest peer, tets/s"], lines)


def ratios_of_planar(cases: list[dict]) -> list[str]:
    lines = []
    for case in cases:
        for ours, others in pairs("planar", case):
            mine = rate(case, ours)
            cells = [case["name"], size_of(case), short(mine)]
            for start in ("Triangle", "Gmsh 2-D 5", "Gmsh 2-D 6"):
                row = next((r for r in others if r["tool"].startswith(start)), None)
                cells.append(f"**{mine / rate(case, row):.2f}**" if row else "–")
            lines.append(cells)
    head = ["case", "size", "delfront triangles/s", "ours / Triangle", "ours / Gmsh 5", "ours / Gmsh 6"]
    return table(head, lines)


RATIOS = {"points": ratios_of_points, "fill": ratios_of_fill, "planar": ratios_of_planar}

# --- the page ---------------------------------------------------------------------------------------------------------


def commands_of(cases: list[dict]) -> list[str]:
    seen: dict[str, str] = {}
    for case in cases:
        for row in case["rows"]:
            if row["threads"] == 1 or row["tool"] not in seen:
                seen.setdefault(row["tool"], row["command"])
    return [f"- {tool}: `{command}`" for tool, command in seen.items()]


def section(workload: str, results: dict) -> str:
    """All of one workload, without its markers."""
    module = MODULES[workload]
    cases = [case for key, case in results["cases"].items() if key.startswith(workload + "/")]
    order = {name: i for i, name in enumerate(module.NAMES)}
    cases.sort(key=lambda case: (case["size"], order.get(case["name"], 99)))
    lines = [f"## {module.TITLE}, beside the peers", "", module.__doc__.split("\n\n", 1)[1].strip(), ""]
    runs = sorted({(row["stamp"], case["machine"]) for case in cases for row in case["rows"]})
    lines += [f"Run of {stamp}: {text}." for stamp, text in runs]
    loads = [load for case in cases for row in case["rows"] for load in row["loads"]]
    repeats = [len(row["runs"]) for case in cases for row in case["rows"] if row["runs"]]
    if loads and repeats:
        lines += ["", f"Medians of up to {max(repeats)} runs, tools in turn (smallest and largest in brackets); load "]
        lines[-1] += f"average before a run {min(loads):.1f} to {max(loads):.1f}."
    lines += ["", *RATIOS[workload](cases)]
    for case in cases:
        lines += [
            f"### {case['name']}, size {size_of(case)}",
            "",
            f"Input: {about(case)}",
            "",
            *case_table(workload, case),
        ]
    return "\n".join([*lines, "Commands, of the smallest size and one thread:", "", *commands_of(cases), ""])


def about(case: dict) -> str:
    facts = case["facts"]
    counts = [f"{facts[key]:,} {key}" for key in ("points", "triangles") if key in facts]
    return facts["about"] + (f": {', '.join(counts)}." if counts else ".")


def write_docs(path: Path, results: dict) -> None:
    for workload in MODULES:
        if any(key.startswith(workload + "/") for key in results["cases"]):
            replace_between(path, f"compare_peers.py: {workload}", section(workload, results))
