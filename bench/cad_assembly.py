#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Assemblies of many boxes: reading and joining them, and the surface grid, for growing numbers.

    bench/cad_assembly.py --write-docs
    bench/cad_assembly.py --boxes 512,1000 --before /elsewhere/delfront      # beside another build

Boxes of side 1 in a cubic lattice, instances of one product in a STEP file, that touch or stand 0.5 apart; sides as long
as the boxes, so that the grid is about two triangles a face. Each run is a process of its own. Read: the stage of that
name (OpenCASCADE's reading, checking, joining); look and sizes: the first grid and the sizes by its shape; CPU: seconds
of the whole process, which other work on the machine does not change much; peak: its resident memory.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "bench"), str(ROOT / "tests" / "cases")]
from compare import machine  # noqa: E402
from compare.script import numbers, publish, stages  # noqa: E402
from step_boxes import write_boxes  # noqa: E402

PAGE = ROOT / "docs" / "cad.md"
MAKER = "cad_assembly.py"
HEAD = "| boxes | | program | faces in the file | joined | triangles | read, s | look, sizes, s | surface, s | whole, s | CPU, s | peak, MB |\n"
HEAD += "| ---: | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", type=Path, default=ROOT / "build" / "release" / "delfront")
    parser.add_argument("--before", type=Path, help="another build to run beside it")
    parser.add_argument("--boxes", type=numbers, default=[512, 1000, 4096, 15_625, 16_667])
    parser.add_argument("--before-up-to", type=int, default=1000, help="boxes that the other build is given")
    parser.add_argument("--time-limit", type=float, default=1200)
    parser.add_argument("--write-docs", action="store_true")
    return parser.parse_args()


def run(program: Path, source: Path, folder: Path, limit: float) -> dict:
    command = [str(program), "mesh", str(source), "-o", str(folder / "grid.vtu"), "--stop-after", "surface", "--hmax", "1",
               "--report", str(folder / "report.json"), "--time-limit", f"{limit:g}", "-q"]
    start = time.monotonic()
    child = subprocess.Popen(command, stderr=subprocess.PIPE)
    said = child.stderr.read().decode("utf-8", "replace")
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    facts = {"whole": time.monotonic() - start, "cpu": usage.ru_utime + usage.ru_stime, "peak": usage.ru_maxrss / 1024}
    if child.returncode:
        return facts | {"failure": f"exit {child.returncode}: {' '.join(said.split())[:160]}"}
    report = json.loads((folder / "report.json").read_text())
    info = subprocess.run([str(program), "info", str(source), "--json", "-"], capture_output=True, check=False)
    return facts | {"stages": stages(folder), "faces": len(json.loads(info.stdout)["geometry"]["faces"]),
                    "triangles": report["surface"]["num_triangles"]}


def row(boxes: int, gap: float, word: str, facts: dict) -> str:
    head = f"| {boxes:,} | {'apart' if gap else 'touch'} | {word} | {6 * boxes:,} | "
    tail = f"{facts['whole']:.1f} | {facts['cpu']:.1f} | {facts['peak']:,.0f} |"
    if "failure" in facts:
        return head + f"{facts['failure'].replace('|', '/')} | | | | | {tail}"
    at = facts["stages"]
    look = at.get("look", 0) + at.get("sizes", 0)
    return head + f"{facts['faces']:,} | {facts['triangles']:,} | {at['read']:.1f} | {look:.1f} | {at['surface']:.1f} | {tail}"


def main() -> int:
    options = parse()
    lines = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for boxes in options.boxes:
            for gap in (0.0, 0.5):
                source = folder / "boxes.step"
                write_boxes(source, boxes, gap)
                programs = [("now", options.delfront)]
                if options.before and boxes <= options.before_up_to:
                    programs.insert(0, ("before", options.before))
                for word, program in programs:
                    lines.append(row(boxes, gap, word, run(program, source, folder, options.time_limit)))
                    print(lines[-1], file=sys.stderr, flush=True)
    text = f"{machine.describe()}; one run each.\n\n" + HEAD + "\n".join(lines)
    return publish(text, PAGE, MAKER, options.write_docs)


if __name__ == "__main__":
    sys.exit(main())
