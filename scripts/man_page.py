#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the manual page of the program from what it says of itself.

    man_page.py [--delfront build/release/delfront] [--out docs/man/delfront.1] [--check]

--check: exit 1 where the page that is there is another one.
"""
import argparse
import os
import re
import subprocess
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
OPTION = re.compile(r"^  (-\S+(?: \S+)*?)(?:  +(.*))?$")


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True).stdout.splitlines()


def roff(text):
    """A text with nothing in it that roff would take for its own."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith((".", "\\(aq")) else text


def commands_of(lines):
    inside = False
    for line in lines:
        if line == "Subcommands:":
            inside = True
        elif inside and not line.strip():
            return
        elif inside:
            yield line.split()[0]


def section(lines):
    """Of a command's help: options as tagged paragraphs, all else as it stands."""
    out, plain = [], []

    def end_plain():
        while plain and not plain[-1].strip():
            plain.pop()
        if plain:
            out.extend([".PP", ".nf", *(roff(line) for line in plain), ".fi"])
        plain.clear()

    i = 0
    while i < len(lines):
        match = OPTION.match(lines[i])
        if match:
            end_plain()
            said = match[2] or ""
            while i + 1 < len(lines) and lines[i + 1].startswith(" " * 20):
                i += 1
                said += " " + lines[i].strip()
            out.extend([".TP", f".B {roff(match[1])}", roff(said.strip()) or "\\&"])
        elif lines[i].endswith(":") and not lines[i].startswith(" "):
            end_plain()
            out.extend([".PP", f".B {roff(lines[i])}"])
        elif lines[i].strip() or plain:
            plain.append(lines[i])
        i += 1
    end_plain()
    return out


def page(program):
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.split()[-1]
    first = help_of(program)
    out = ['.\\" made by scripts/man_page.py', f'.TH DELFRONT 1 "" "delfront {version}" "User Commands"', ".SH NAME",
           "delfront \\- unstructured grid generation for CFD, from CAD or facets to a solver\\(aqs grid", ".SH SYNOPSIS",
           ".B delfront", ".I COMMAND", "[options]", ".SH DESCRIPTION", *section(first)]
    for command in commands_of(first):
        out += [f".SH DELFRONT {command.upper()}", *section(help_of(program, command))]
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--delfront", default=os.path.join(ROOT, "build", "release", "delfront"))
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "man", "delfront.1"))
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    made = page(options.delfront)
    if options.check:
        with open(options.out, encoding="utf-8") as file:
            if file.read() != made:
                print(f"man_page.py: {options.out} is out of date; run scripts/man_page.py", file=sys.stderr)
                return 1
        return 0
    os.makedirs(os.path.dirname(options.out), exist_ok=True)
    with open(options.out, "w", encoding="utf-8") as file:
        file.write(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
