# SPDX-License-Identifier: Apache-2.0
"""Results of bench/front.py to the tables of docs/front-volume.md."""

from . import tables
from .tables import median, short

ORDER = ("sphere", "graded", "ahmed")
NOTHING = "–"


def ordered(found: dict) -> list[dict]:
    return sorted(found["cases"].values(), key=lambda case: (ORDER.index(case["name"]), case["size"]))


def cpu(row: dict) -> float | None:
    """Of the process: user and system seconds."""
    user, system = median(row, "user"), median(row, "system")
    return None if user is None else user + system


def rate(row: dict | None) -> float | None:
    """Tets a second of gridding."""
    seconds = median(row, "phase") if row else None
    return row["facts"]["tets"] / seconds if seconds else None


def cpu_rate(row: dict) -> float | None:
    """The same in processor time: of one thread, as the process got its core for that share of its time."""
    share = min(1.0, cpu(row) / median(row, "whole")) if row["threads"] == 1 and row["runs"] else 0.0
    return rate(row) / share if share and rate(row) else None


def find(case: dict, start: str, threads: int = 1, stamp: str = "") -> dict | None:
    """The row that gave figures, of the run with that stamp where one is asked for."""
    for row in case["rows"]:
        if row["tool"].startswith(start) and row["threads"] == threads and row["runs"]:
            if not stamp or row["stamp"] == stamp:
                return row
    return None


def form(value, pattern: str) -> str:
    return NOTHING if value is None else pattern.format(value)


def rate_of(value: float | None) -> str:
    return short(value) if value else NOTHING


def over(a: float | None, b: float | None, pattern: str = "{:.2f}") -> str:
    return pattern.format(a / b) if a and b else NOTHING


def remark(case: dict, row: dict) -> str:
    words = [tables.doubts("fill", case, row)]
    digest = row["facts"].get("bytes")
    for other in case["rows"]:
        if not digest or other is row or not other["runs"]:
            continue
        same = other["facts"].get("bytes") == digest
        if other["tool"] == row["tool"]:
            words.append(f"{'same bytes as' if same else '**other bytes than**'} -j {other['threads']}")
        elif same and other["threads"] == row["threads"]:
            words.append(f"same bytes as {other['tool']}")
    words.append("" if row["stamp"] == tables.newest(case) else f"run of {row['stamp']}")
    return "; ".join(filter(None, words))


def speed_table(case: dict) -> list[str]:
    head = ["tool", "threads", "runs", "tets", "gridding s", "tets/s", "tets/CPU s", "1 thread / this", "improve s"]
    head += ["whole s", "CPU s of the process", "peak bytes/tet", "remark"]
    lines = []
    for row in case["rows"]:
        name, threads, facts = f"{row['tool']} {row['version']}".strip(), str(row["threads"]), row["facts"]
        if row["failure"]:
            lines.append([name, threads, row["failure"], *[""] * (len(head) - 3)])
            continue
        alone = find(case, row["tool"], 1, row["stamp"]) if row["threads"] > 1 else None
        cells = [name, threads, str(len(row["runs"])), f"{facts['tets']:,}", tables.spread(row, "phase")]
        cells += [rate_of(rate(row)), rate_of(cpu_rate(row))]
        cells += [over(median(alone, "phase"), median(row, "phase")) if alone else ""]
        cells += [form(value, "{:.2f}") for value in (median(row, "improve"), median(row, "whole"), cpu(row))]
        lines.append([*cells, form(median(row, "rss") / facts["tets"], "{:.0f}"), remark(case, row)])
    return tables.table(head, lines)


def quality_table(case: dict) -> list[str]:
    head = ["tool", "mean smallest °", "worst °", "largest °", "below 10°", "mean eta", "edges in [0.8, 1.25]"]
    head += ["mean edge/size", "edges in [0.8, 1.25] of it", "crossing test", "sweeps", "cavities"]
    head.append("closed by Delaunay")
    lines = []
    for row in case["rows"]:
        if not row["runs"] or row["threads"] != min(r["threads"] for r in case["rows"] if r["tool"] == row["tool"]):
            continue
        facts, front = row["facts"], row["facts"].get("front") or {}
        cells = [row["tool"], f"{facts['mean_min_dihedral']:.2f}", f"{facts['min_dihedral']:.3f}"]
        cells += [f"{facts['max_dihedral']:.2f}", f"{facts['below_10']:.4%}", f"{facts['eta']:.4f}"]
        told = row["tool"].startswith(tables.OURS) or case["facts"]["has_sizes"]
        edges = [f"{facts['edges_near']:.1%}", f"{facts['edge_ratio']:.3f}", f"{facts['edges_alike']:.1%}"]
        cells += edges if told else [NOTHING] * 3
        cells += [form(median(row, "crossing"), "{:.1%}"), form(front.get("sweeps"), "{}")]
        share = front["closed_by_delaunay"] / facts["tets"] if front else None
        lines.append([*cells, form(front.get("cavities"), "{}"), form(share, "{:.4%}")])
    return tables.table(head, lines)


# --- ratios -----------------------------------------------------------------------------------------------------------


def ratios_of_speed(found: dict) -> list[str]:
    head = ["case", "tets", "method", "tets/s", "tets/CPU s", "time a tet / at the smallest size", "1 thread / 2"]
    head += ["/ Netgen pure front", "/ Netgen Delaunay + front", "/ Gmsh Delaunay", "/ TetGen", "bytes/tet", "crossing"]
    lines, first = [], {}
    for case in ordered(found):
        for method in ("front", "front-delaunay", "delaunay"):
            row = find(case, f"delfront {method}, raw")
            if not row or not rate(row):
                continue
            mine, two = cpu_rate(row), find(case, row["tool"], 2, row["stamp"])
            smallest = first.setdefault((case["name"], method), mine)
            cells = [case["name"], f"{row['facts']['tets']:,}", method, short(rate(row)), rate_of(mine)]
            cells.append(over(smallest, mine))
            cells.append(over(median(row, "phase"), median(two, "phase")) if two else NOTHING)
            peers = ("Netgen pure front, raw", "Netgen Delaunay + front, raw", "Gmsh Delaunay", "TetGen")
            for peer in peers:
                other = find(case, peer, 1, row["stamp"])
                cells.append(over(mine, cpu_rate(other), "{:.1f}") if other else NOTHING)
            cells += [f"{median(row, 'rss') / row['facts']['tets']:.0f}", form(median(row, "crossing"), "{:.1%}")]
            lines.append(cells)
    return tables.table(head, lines)


def peer_fact(case: dict, stamp: str, start: str, kind: str, key: str) -> float | None:
    """Of the tool whose name begins so, raw or improved, in that run."""
    rows = [row for row in case["rows"] if row["runs"] and row["stamp"] == stamp]
    named = [row for row in rows if row["tool"].startswith(start) and row["tool"].endswith(kind)]
    return named[0]["facts"][key] if named else None


def quality_cells(case: dict, method: str) -> list[str]:
    raw, better = (find(case, f"delfront {method}, {kind}") for kind in ("raw", "improved"))
    if not raw and not better:
        return []
    stamp, told = (raw or better)["stamp"], case["facts"]["has_sizes"]
    mean = raw["facts"]["mean_min_dihedral"] if raw else None
    cells = [case["name"], f"{(raw or better)['facts']['tets']:,}", method, form(mean, "{:.2f}")]
    for name in ("delfront delaunay, raw", "Netgen pure front, raw", "Gmsh Delaunay"):
        other = peer_fact(case, stamp, name, "raw", "mean_min_dihedral")
        is_itself = name == f"delfront {method}, raw"
        cells.append(NOTHING if None in (mean, other) or is_itself else f"{mean - other:+.2f}")
    for name in (f"delfront {method},", "Netgen Delaunay", "Gmsh"):
        cells.append(form(peer_fact(case, stamp, name, "improved", "min_dihedral"), "{:.2f}"))
    for kind in ("raw", "improved"):
        for name in (f"delfront {method},", "Gmsh"):
            values = [peer_fact(case, stamp, name, kind, key) for key in ("edges_near", "edges_alike")]
            is_known = None not in values and (told or name != "Gmsh")
            cells.append(" / ".join(f"{value:.1%}" for value in values) if is_known else NOTHING)
    return cells


def ratios_of_quality(found: dict) -> list[str]:
    """Means of the smallest angles less those of our circumcentres and of peers; worst angles; spread of edges."""
    head = ["case", "tets", "method", "mean smallest °, raw", "more than delaunay's", "more than Netgen's front's"]
    head += ["more than Gmsh's", "worst ° improved", "Netgen's worst °", "Gmsh's worst °", "edges near / alike, raw"]
    head += ["Gmsh's, raw", "edges near / alike, improved", "Gmsh's, improved"]
    methods = ("front", "front-delaunay", "delaunay")
    lines = [quality_cells(case, method) for case in ordered(found) for method in methods]
    return tables.table(head, [cells for cells in lines if cells])


def case_text(case: dict) -> list[str]:
    loads = [load for row in case["rows"] for load in row["loads"]]
    stamps = sorted({row["stamp"] for row in case["rows"] if row["runs"]})
    text = f"{tables.about(case)} Run of {', '.join(stamps)}: {case['machine']}; load average before a run "
    text += f"{min(loads, default=0):.1f} to {max(loads, default=0):.1f}."
    commands = [f"    {row['tool']}, {row['threads']}: {row['command']}" for row in case["rows"] if row["threads"] == 1]
    lines = [f"### {case['name']}, {tables.size_of(case)} tets wanted", "", text, ""]
    lines += [*speed_table(case), *quality_table(case)]
    return [*lines, "Commands:", "", *commands, ""]


def page(found: dict, command: str, about: str) -> str:
    lines = ["# The front in the volume, beside its peers", "", f"Made by `{command}`; not edited by hand.", "", about]
    lines += ["", " ".join(READING.split()), "", "## In short", "", *ratios_of_speed(found), *ratios_of_quality(found)]
    lines += ["## All figures", ""]
    for case in ordered(found):
        lines += case_text(case)
    return "\n".join(lines).rstrip() + "\n"


READING = """Ratios are of tets a second of gridding in processor time, within one run; a ratio above 1 is in our
favour. Wall times are medians with their range; a load average over the threads used means that other work ran beside.
"raw": no improvement; "improved": with each tool's own. Peak memory is of the whole process, Netgen's with its Python.
"1 thread / 2" is of wall times, and means something on a quiet machine only. Edges are "near" where length over size is
within [0.8, 1.25], "alike" where it is within that range of the grid's own mean of it."""
