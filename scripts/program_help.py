# SPDX-License-Identifier: Apache-2.0
"""What the program says of itself, and pages that are made from it (man_page.py, options_page.py)."""
import argparse
import os
import re
import subprocess
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
OPTION = re.compile(r"^  (-\S+(?: \S+)*?)(?:  +(.*))?$")


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True).stdout.splitlines()


def commands_of(lines):
    inside = False
    for line in lines:
        if line == "Subcommands:":
            inside = True
        elif inside and not line.strip():
            return
        elif inside:
            yield line.split()[0]


def entries(lines):
    """Of a help: (flags, what they say) of each option, however many lines it has; (None, line) of all else."""
    i = 0
    while i < len(lines):
        match = OPTION.match(lines[i])
        if match:
            said = match[2] or ""
            while i + 1 < len(lines) and lines[i + 1].startswith(" " * 20):
                i += 1
                said += " " + lines[i].strip()
            yield match[1], said.strip()
        else:
            yield None, lines[i]
        i += 1


def write_page(doc, page, *out):
    """The main of a script that makes a page: its text is page(program), its usual place is `out` below the root."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", default=os.path.join(ROOT, "build", "release", "delfront"))
    parser.add_argument("--out", default=os.path.join(ROOT, *out))
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    made = page(options.delfront)
    if options.check:
        with open(options.out, encoding="utf-8") as file:
            if file.read() != made:
                script = os.path.basename(sys.argv[0])
                print(f"{script}: {options.out} is out of date; run scripts/{script}", file=sys.stderr)
                return 1
        return 0
    os.makedirs(os.path.dirname(options.out) or ".", exist_ok=True)
    with open(options.out, "w", encoding="utf-8") as file:
        file.write(made)
    return 0
