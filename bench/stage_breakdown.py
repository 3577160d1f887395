#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Where the time goes: stages, functions, and the kernel's work beside the arithmetic floor.

    bench/stage_breakdown.py --tets 1e6 --threads 1,2 --points 1e6 [--write-docs]

Stages are those of `delfront mesh --report` on the unit sphere; functions those that `perf record -e cpu-clock` finds
(left out by name where there is no perf); the kernel's counts those of delaunay_bench on uniform random points. The
floor: 5.6 walk steps, 48 in-sphere tests, 28 tets made and 21 deleted a point are what insertion of random points along
a space-filling curve needs whatever the code (measured, and equal to theory).
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from compare import fill, machine, peers, script, shapes, tables  # noqa: E402
from compare.running import new_stamp  # noqa: E402

FLOOR = {"walk_steps": 5.6, "insphere_tests": 48, "tets_created": 28, "tets_deleted": 21}
WORDS = {"walk_steps": "walk steps", "insphere_tests": "in-sphere tests", "tets_created": "tets made"}
WORDS["tets_deleted"] = "tets deleted"
FUNCTIONS = 25
MAKER = "stage_breakdown.py"


def mesh_command(program: str, threads: int) -> list[str]:
    return [program, "mesh", "s.off", "-o", "o.vtu", "--report", "report.json", "-q", "-j", str(threads)]


def stages_of(program: str, folder: Path, threads: int) -> tuple[dict[str, float], dict]:
    """Seconds by stage, and the whole report."""
    subprocess.run(mesh_command(program, threads), cwd=folder, check=True, stdout=subprocess.DEVNULL)
    report = json.loads((folder / "report.json").read_text())
    seconds: dict[str, float] = {}
    for stage in report["stages"]:
        seconds[stage["stage"]] = seconds.get(stage["stage"], 0) + stage["seconds"]
    seconds["the rest"] = max(0.0, report["seconds"] - sum(seconds.values()))
    return seconds, report


def count_tets(report: dict) -> int:
    return round(report["peak_memory_bytes"] / report["bytes_per_cell"])


def stage_table(program: str, folder: Path, all_threads: list[int]) -> list[str]:
    runs = [(threads, *stages_of(program, folder, threads)) for threads in all_threads]
    tets = count_tets(runs[0][2])
    head = ["stage"]
    for threads, _, _ in runs:
        words = f"{threads} thread{'s' if threads > 1 else ''}"
        head += [f"{words}: s", "share", "ns/tet"]
    rows = []
    for stage in runs[0][1]:
        row = [stage]
        for _, seconds, _ in runs:
            s, total = seconds.get(stage, 0.0), sum(seconds.values())
            row += [f"{s:.3f}", f"{s / total:.1%}", f"{1e9 * s / tets:.0f}"]
        rows.append(row)
    row = ["**all**"]
    for _, seconds, _ in runs:
        total = sum(seconds.values())
        row += [f"{total:.3f}", "100%", f"{1e9 * total / tets:.0f}"]
    lines = tables.table(head, [*rows, row])
    gridding = sum(s for stage, s in runs[0][1].items() if stage not in {*fill.OTHER_STAGES, "the rest"})
    peaks = ", ".join(f"{report['bytes_per_cell']:.0f} ({threads})" for threads, _, report in runs)
    lines += [
        f"{tets:,} tets; gridding {tets / gridding / 1e6:.2f} M tets/s on one thread" if all_threads[0] == 1 else ""
    ]
    lines[-1] += f"; peak bytes a tet (threads): {peaks}."
    return [*lines, ""]


def plain(symbol: str) -> str:
    """Without template arguments, parameters and our namespace."""
    symbol = symbol.replace("(anonymous namespace)::", "").replace("delfront::", "")
    while (shorter := re.sub(r"<[^<>]*>", "", symbol)) != symbol:
        symbol = shorter
    symbol = re.sub(r"\(.*", "", symbol).split(" [clone")[0].strip()
    return symbol.split(" ")[-1]


def function_table(program: str, folder: Path) -> list[str]:
    perf = shutil.which("perf")
    if not perf:
        return ["Functions: perf is not installed (linux-perf).", ""]
    record = [perf, "record", "-q", "-e", "cpu-clock", "-g", "-o", "perf.data", "--", *mesh_command(program, 1)]
    done = subprocess.run(record, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return [f"Functions: perf cannot record here ({(done.stderr.strip().splitlines() or ['?'])[-1][:100]}).", ""]
    report = [
        perf,
        "report",
        "-i",
        "perf.data",
        "--stdio",
        "--no-children",
        "-g",
        "none",
        "-F",
        "overhead,dso,sym",
        "-w",
    ]
    text = subprocess.run([*report, "0,0,0", "-t", "|"], cwd=folder, capture_output=True, text=True, check=False).stdout
    shares: dict[str, float] = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.split("|", 2)]
        if line.startswith("#") or len(cells) != 3 or not cells[0].endswith("%"):
            continue
        is_ours = "delfront" in cells[1]
        name = plain(re.sub(r"^\[\S\]\s*", "", cells[2])) if is_ours else cells[1].strip("[]")
        shares[name] = shares.get(name, 0) + float(cells[0][:-1])
    top = sorted(shares.items(), key=lambda item: -item[1])[:FUNCTIONS]
    rows = [[f"`{name}`", f"{share:.1f} %"] for name, share in top]
    rows.append(["all others", f"{100 - sum(share for _, share in top):.1f} %"])
    lines = [
        f"Functions, one thread, by themselves: `{' '.join(['perf', *record[1:8]])} delfront …`. Inlined functions"
    ]
    lines[0] += " count for the one they are in; libraries and the kernel by name."
    return [*lines, "", *tables.table(["function", "share of samples"], rows)]


def floor_table(program: str, points: int, threads: int) -> list[str]:
    command = [program, "--points", "uniform", "--n", str(points), "--threads", str(threads)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    rows = [[WORDS[k], f"{found[k]:.2f}", f"{FLOOR[k]:g}", f"{found[k] / FLOOR[k]:.2f}"] for k in FLOOR]
    lines = tables.table(["a point", "ours", "floor", "ours / floor"], rows)
    rate = found["points"] / found["seconds"]
    text = f"`delaunay_bench --points uniform --n {points} --threads {threads}`: {found['seconds']:.3f} s, "
    text += f"{rate / 1e6:.3f} M points/s, {found['tets'] / found['seconds'] / 1e6:.2f} M tets/s, "
    text += f"{1e9 / rate:.0f} ns a point; {found['complex_bytes_per_tet']:.0f} bytes a tet in the complex, "
    text += f"{found['peak_bytes_per_tet']:.0f} at the peak."
    return [text, "", *lines]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", help="our programs; default: the newest of build/*")
    parser.add_argument("--delaunay-bench")
    parser.add_argument("--tets", type=float, default=1e6, help="of the sphere that is filled")
    parser.add_argument("--points", type=float, default=1e6, help="of the kernel's run")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--docs", type=Path, default=peers.ROOT / "docs" / "performance.md")
    parser.add_argument("--write-docs", action="store_true")
    options = parser.parse_args()
    threads = sorted({int(word) for word in options.threads.split(",")})
    program, missing = peers.find_ours("delfront", options.delfront)
    kernel, kernel_missing = peers.find_ours("delaunay_bench", options.delaunay_bench)
    if missing:
        print(f"delfront: {missing}", file=sys.stderr)
        return 1
    lines = ["## Where the time goes", "", __doc__.split("\n\n")[2].strip(), ""]
    lines += [f"Run of {new_stamp()}: {machine.describe()}; load average before it {machine.load():.1f}.", ""]
    with tempfile.TemporaryDirectory(prefix="delfront_stages_") as name:
        folder = Path(name)
        points, triangles = fill.make_surface("sphere", options.tets, folder, None)
        shapes.write_surface(folder, points, triangles)
        lines += ["### Stages", "", f"Unit sphere of {len(triangles):,} triangles:"]
        lines[-1] += f" `{' '.join(['delfront', *mesh_command('', 1)[1:-1]])} N`."
        lines += ["", *stage_table(program, folder, threads), *function_table(program, folder)]
    lines += ["### The kernel beside the arithmetic floor", ""]
    lines += (
        floor_table(kernel, int(options.points), threads[0]) if kernel else [f"delaunay_bench: {kernel_missing}.", ""]
    )
    text = "\n".join(lines)
    return script.publish(text, options.docs, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
