#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Damaged copies of CAD files: each must be read, or refused with its name and a cause, within a minute.

    scripts/damage_cad.py ../shared/data/cad/*.step --copies 100
    scripts/damage_cad.py part.igs --only 17 --keep 17.igs      # one copy, written for a closer look

Copy k of a file (fixed seed) has bytes flipped, lines dropped, numbers swapped or set to odd values, lines repeated or
its end cut, by k. What is wrong is printed: exit codes other than 0, 3 and 6, errors that do not name the file, runs
that take more than a minute of the processor; then how many of each exit code, and every message once, with numbers left out.
"""

import argparse
import collections
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NUMBER = re.compile(rb"(?<![\w#.])[-+]?\d+\.?\d*(?:[EeDd][-+]?\d+)?")
REFERENCE = re.compile(rb"#\d+")
ODD = [b"0.", b"-1.", b"1.E+30", b"1.E-30", b"99999999", b"-2147483649", b"1.E", b"..", b"0", b"7"]


def flip_bytes(data: bytes, rng: random.Random) -> bytes:
    made = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        made[rng.randrange(len(made))] = rng.randrange(256)
    return bytes(made)


def drop_lines(data: bytes, rng: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    for _ in range(rng.randint(1, 3)):
        if len(lines) > 1:
            del lines[rng.randrange(len(lines))]
    return b"".join(lines)


def repeat_line(data: bytes, rng: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    line = rng.randrange(len(lines))
    return b"".join(lines[: line + 1] + lines[line:])


def swap(data: bytes, rng: random.Random, pattern: re.Pattern) -> bytes:
    found = list(pattern.finditer(data))
    if len(found) < 2:
        return data
    a, b = sorted(rng.sample(found, 2), key=lambda match: match.start())
    return data[: a.start()] + b.group() + data[a.end() : b.start()] + a.group() + data[b.end() :]


def set_number(data: bytes, rng: random.Random) -> bytes:
    found = list(NUMBER.finditer(data))
    at = rng.choice(found)
    return data[: at.start()] + rng.choice(ODD) + data[at.end() :]


def cut(data: bytes, rng: random.Random) -> bytes:
    return data[: rng.randrange(len(data))]


WAYS = (flip_bytes, drop_lines, lambda d, r: swap(d, r, NUMBER), lambda d, r: swap(d, r, REFERENCE), set_number,
        repeat_line, flip_bytes, drop_lines, set_number, cut)


def damaged(data: bytes, k: int) -> bytes:
    return WAYS[k % len(WAYS)](data, random.Random(f"damage {k}"))


def run(program: str, path: Path, limit: float) -> tuple[int, str, float]:
    """Exit code (124: killed after four times the limit), what it said, and seconds of the processor."""
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen([program, "info", str(path), "-q"], stderr=said, stdout=subprocess.DEVNULL)
        timer = threading.Timer(4 * limit, child.kill)
        timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().decode("utf-8", "replace")
    return child.returncode, " ".join(text.split()), usage.ru_utime + usage.ru_stime


def shape_of(text: str) -> str:
    return re.sub(r"[-+]?\d[\d.e+-]*", "N", text)[:240]


def look(program: str, source: Path, args: argparse.Namespace, folder: Path) -> int:
    data, bad = source.read_bytes(), 0
    codes: collections.Counter[int] = collections.Counter()
    messages: dict[str, list[int]] = collections.defaultdict(list)
    longest = (0.0, 0)
    for k in [args.only] if args.only is not None else range(args.copies):
        path = folder / f"copy{k}{source.suffix}"
        path.write_bytes(damaged(data, k))
        if args.keep:
            Path(args.keep).write_bytes(path.read_bytes())
        code, text, seconds = run(program, path, args.limit)
        codes[code] += 1
        longest = max(longest, (seconds, k))
        error = text[text.find("error") :] if "error" in text else text
        if code:
            messages[f"{code}: " + shape_of(error.replace(str(path), "FILE"))].append(k)
        wrong = code not in (0, 3, 6) or (code and path.name not in text) or seconds > args.limit
        if wrong:
            bad += 1
            print(f"WRONG {source.name} copy {k}: exit {code} after {seconds:.1f} s: {text[:400]}", flush=True)
        path.unlink()
    print(f"{source.name}: " + ", ".join(f"exit {code}: {n}" for code, n in sorted(codes.items())) +
          f"; longest {longest[0]:.1f} s (copy {longest[1]})", flush=True)
    for message, copies in sorted(messages.items(), key=lambda item: -len(item[1])):
        print(f"    {len(copies)} (copy {copies[0]}) {message}", flush=True)
    return bad


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--copies", type=int, default=100, help="of each file")
    parser.add_argument("--only", type=int, help="this copy alone")
    parser.add_argument("--keep", help="write the last copy to this file")
    parser.add_argument("--limit", type=float, default=60, help="seconds of the processor that a run may take")
    parser.add_argument("--delfront", default=str(ROOT / "build" / "release" / "delfront"))
    args = parser.parse_args()
    if not os.access(args.delfront, os.X_OK):
        sys.exit(f"{args.delfront} is not there: build it, or name it by --delfront")
    with tempfile.TemporaryDirectory() as folder:
        return 1 if sum(look(args.delfront, source, args, Path(folder)) for source in args.files) else 0


if __name__ == "__main__":
    sys.exit(main())
