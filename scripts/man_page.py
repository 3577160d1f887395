#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the manual page of the program from what it says of itself.

    man_page.py [--delfront build/release/delfront] [--out docs/man/delfront.1] [--check]

--check: exit 1 where the page that is there is another one.
"""
import subprocess
import sys

from program_help import commands_of, entries, help_of, write_page


def roff(text):
    """A text with nothing in it that roff would take for its own."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith((".", "\\(aq")) else text


def section(lines):
    """Of a command's help: options as tagged paragraphs, all else as it stands."""
    out, plain = [], []

    def end_plain():
        while plain and not plain[-1].strip():
            plain.pop()
        if plain:
            out.extend([".PP", ".nf", *(roff(line) for line in plain), ".fi"])
        plain.clear()

    for flags, line in entries(lines):
        if flags:
            end_plain()
            out.extend([".TP", f".B {roff(flags)}", roff(line) or "\\&"])
        elif line.endswith(":") and not line.startswith(" "):
            end_plain()
            out.extend([".PP", f".B {roff(line)}"])
        elif line.strip() or plain:
            plain.append(line)
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


if __name__ == "__main__":
    sys.exit(write_page(__doc__, page, "docs", "man", "delfront.1"))
