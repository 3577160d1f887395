#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Surfaces of CAD files: delfront with no sizing input beside Gmsh's default and Netgen at matched element counts.

    bench/cad_surface.py --write-docs            every file of ../shared/data/cad, then the largest at more triangles, then
                                                 a NURBS model at 5e6
    bench/cad_surface.py --only linkrods --parts files
    bench/cad_surface.py --parts model --triangles 5e6 --threads 1,2

Each run is a process of its own, tools in turn, one thread each, medians. Grid: curves and surfaces; ours is the stage
"surface" of the report, all rounds of it, which checks each face against its geometry; the exact test of all triangles
against each other, which peers do not have, the first look and the sizes by curvature stand apart. Whole: wall time of
the process with reading and writing. Peers have one size (Netgen: also its usual sizes by curvature) for as many
triangles. Angles are measured by one routine for all; deviation: the largest distance of a triangle's middle from its
surface, per cent of the diagonal (peers: of up to 2000 triangles). Needs Debian's python3-numpy; peers by
`scripts/setup --peers`.
"""

import argparse
import os
import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import cad, machine, peers  # noqa: E402
from compare.running import Limits, new_stamp, run_interleaved  # noqa: E402
from compare.script import numbers, publish, words  # noqa: E402

PAGE = peers.ROOT / "docs" / "cad-speed.md"
MAKER = "cad_surface.py"
PARTS = ("files", "largest", "model")
HEAD = "| file | tool | triangles | grid, s | 1000 / s | crossings, s | look, sizes, s | whole, s | smallest angle | mean | deviation, % |\n"
HEAD += "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", help="our program; default: the newest of build/*")
    parser.add_argument("--parts", type=words, default=[*PARTS])
    parser.add_argument("--only", default="", help="files whose name contains this")
    parser.add_argument("--tools", type=words, default=[*cad.PEERS])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--largest", type=numbers, default=[100_000], help="triangles of the largest files")
    parser.add_argument("--num-largest", type=int, default=3)
    parser.add_argument("--netgen-up-to", type=float, default=1e5)
    parser.add_argument("--triangles", type=float, default=5e6, help="of the NURBS model")
    parser.add_argument("--threads", type=numbers, default=[1, 2], help="for the NURBS model")
    parser.add_argument("--time-limit", type=float, default=300)
    parser.add_argument("--write-docs", action="store_true")
    shared = Path(os.environ.get("DELFRONT_SHARED", peers.ROOT.parent / "shared"))
    parser.add_argument("--shared-data", type=Path, default=shared / "data")
    return parser.parse_args()


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def median(row: dict, key: str) -> float | None:
    values = [run[key] for run in row["runs"] if run.get(key) is not None]
    return statistics.median(values) if values else None


def text_row(label: str, row: dict) -> str:
    tool = f"{row['tool']} {row['version']}"
    if row["failure"]:
        said = row["failure"].removeprefix("not installed: " if row["version"] else "")
        return f"| {label} | {tool} | {said.replace('|', '/')[:120]} |" + " |" * 8
    facts, grid = row["facts"], median(row, "phase")
    rounds = facts.get("rounds", 1)
    cells = [label, tool, f"{facts['triangles']:,}", f"{grid:.2f}" + (f" ({rounds} rounds)" if rounds > 1 else "")]
    cells.append(f"{facts.get('gridded', facts['triangles']) / grid * 1e-3:.0f}")
    cells += [f"{v:.2f}" if (v := median(row, key)) is not None else "" for key in ("checks", "sizes", "whole")]
    cells += [f"{facts['min_angle']:.1f}", f"{facts['mean_angle']:.1f}", f"{facts['deviation']:.2g}"]
    return "| " + " | ".join(cells) + " |"


def measure(file: Path, our_words: list[str], label: str, options, folder: Path, tools: list[str]) -> list[dict]:
    """Rows of one file: ours first, peers with as many triangles."""
    limits = Limits(options.repeat, options.time_limit, options.time_limit)
    launcher, stamp = peers.build_launcher(), new_stamp()
    mine = cad.ours(options.program, options.version, file, our_words)
    first = run_interleaved([mine], folder, launcher, Limits(1, options.time_limit, options.time_limit), stamp, say)[0]
    if first["failure"]:
        return [first]
    count = first["facts"]["triangles"]
    others = [cad.peer(name, file, count, 2000, folder) for name in tools]
    say(f"{label}: {count:,} triangles")
    return run_interleaved([mine, *others], folder, launcher, limits, stamp, say)


def ratio(rows: list[dict]) -> tuple[float, float] | None:
    """Triangles a second of our gridding over those of Gmsh's, without and with our exact test and sizes."""
    gmsh = next((r for r in rows if r["tool"] == "Gmsh" and r["runs"]), None)
    if not gmsh or not rows[0]["runs"]:
        return None
    theirs = gmsh["facts"]["triangles"] / median(gmsh, "phase")
    ours, all_of_it = rows[0]["facts"]["triangles"], sum(median(rows[0], k) for k in ("phase", "checks", "sizes"))
    return ours / median(rows[0], "phase") / theirs, ours / all_of_it / theirs


def ratio_text(found: list[tuple[str, tuple[float, float]]]) -> str:
    lines = ["", "Triangles a second over those of Gmsh: gridding alone, all rounds; and with look, sizes and exact test:", ""]
    return "\n".join(lines + [f"- {label}: {a:.1f}, {b:.1f}" for label, (a, b) in found]) + "\n"


def part_files(options, folder: Path) -> str:
    text, found = "## Every file, no sizes given\n\n" + HEAD, []
    for file in sorted((options.shared_data / "cad").iterdir()):
        if options.only.lower() not in file.name.lower():
            continue
        rows = measure(file, [], file.name, options, folder, options.tools)
        text += "\n".join(text_row(file.name if i == 0 else "", row) for i, row in enumerate(rows)) + "\n"
        if value := ratio(rows):
            found.append((file.name, value))
    return text + ratio_text(found)


def part_largest(options, folder: Path) -> str:
    """The largest by bytes that have a grid."""
    text, found, done = f"## The {options.num_largest} largest files, one size\n\n" + HEAD, [], 0
    for file in sorted((options.shared_data / "cad").iterdir(), key=lambda f: -f.stat().st_size):
        if options.only.lower() not in file.name.lower() or done == options.num_largest:
            continue
        for count in options.largest:
            try:
                size = cad.our_size(options.program, file, count, folder)
            except RuntimeError as reason:
                say(f"{file.name}: {reason}")
                text += f"| {file.name} | delfront {options.version} | {str(reason)[:120].replace('|', '/')} |" + " |" * 8 + "\n"
                break
            tools = [t for t in options.tools if t != "Netgen" or count <= options.netgen_up_to]
            rows = measure(file, cad.uniform(size), f"{file.name}, {count:,}", options, folder, tools)
            text += "\n".join(text_row(file.name if i == 0 else "", row) for i, row in enumerate(rows)) + "\n"
            if value := ratio(rows):
                found.append((f"{file.name}, {rows[0]['facts']['triangles']:,} triangles", value))
        else:
            done += 1
    return text + ratio_text(found)


def part_model(options, folder: Path) -> str:
    file = cad.m6(folder)
    size = cad.our_size(options.program, file, round(options.triangles / 16), folder) / 4
    launcher, rows = peers.build_launcher(), []
    limits = Limits(options.repeat, options.time_limit, 2 * options.time_limit)
    tools = [cad.ours(options.program, options.version, file, cad.uniform(size), n, False) for n in options.threads]
    rows = run_interleaved(tools, folder, launcher, limits, new_stamp(), say)
    text = "## A NURBS model: the ONERA M6 wing of `examples/onera_m6`\n\n| threads | triangles | grid, s | 1000 / s | "
    text += "crossings, s | 1000 / s with that | whole, s | smallest angle | mean | away from corners | bytes a triangle |\n"
    text += "| ---: " * 11 + "|\n"
    for row in rows:
        if row["failure"]:
            text += f"| {row['threads']} | {row['failure']} |\n"
            continue
        facts, grid, checks = row["facts"], median(row, "phase"), median(row, "checks")
        cells = [str(row["threads"]), f"{facts['triangles']:,}", f"{grid:.2f}", f"{facts['triangles'] / grid * 1e-3:.0f}"]
        cells += [f"{checks:.2f}", f"{facts['triangles'] / (grid + checks) * 1e-3:.0f}", f"{median(row, 'whole'):.1f}"]
        cells += [f"{facts[k]:.1f}" for k in ("min_angle", "mean_angle", "away_angle")]
        text += "| " + " | ".join([*cells, f"{facts['peak'] / facts['triangles']:.0f}"]) + " |\n"
    return text


def main() -> int:
    options = parse()
    options.program, missing = peers.find_ours("delfront", options.delfront)
    if missing:
        print(f"delfront: {missing}", file=sys.stderr)
        return 1
    options.version = peers.first_version(peers.output_of([options.program, "--version"]))
    parts = {"files": part_files, "largest": part_largest, "model": part_model}
    with tempfile.TemporaryDirectory(prefix="delfront_cad_") as folder:
        for part in options.parts:
            when = f"{machine.describe()}; medians of {options.repeat}, {new_stamp()}, load average {machine.load():.1f} before it "
            when += "(over 1: other work ran beside it).\n\n"
            title, text = parts[part](options, Path(folder)).split("\n\n", 1)
            publish(f"{title}\n\n{when}{text}", PAGE, f"{MAKER} --parts {part}", options.write_docs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
