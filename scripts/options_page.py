#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the page of all options from what the program says of itself (--print-config and --help).

    options_page.py [--delfront build/release/delfront] [--out docs/options.md] [--check]

--check: exit 1 where the page that is there is another one.
"""
import re
import subprocess
import sys

from program_help import commands_of, entries, help_of, write_page

TABLE = re.compile(r"^(# )?(\[\[?)([\w.]+)\]\]?$")
KEY = re.compile(r"^(# )?(\w+) = (.*?) +# (.*)$")
TITLE = re.compile(r"^(\S.*):$")
RANGE = re.compile(r"(.*):INT in \[(\d+) - (\d+)\] (.*)$")  # too long for the column of flags

OPENING = """# All options

Made by `scripts/options_page.py` from what the program says of itself.

Every key of a job file is also an option of the command line, `--set TABLE.KEY=VALUE`, and a key of the dict in Python; the
usual ones have flags of their own. `delfront mesh … --print-config` prints the whole effective configuration. What a command's
flags say wins over the job file, `--set` over both. Lengths are `0.5` (model units), `5%` (of the bounding box's diagonal),
`20c` (longest sides of the body), or `2 mm`, `1 in` (with `input.units`); angles are in degrees. An empty default: nothing is
asked for, or the text says what holds.
"""


def cell(text):
    """A text that stays in its cell of a table, with nothing in it that Markdown would take for its own."""
    text = re.sub(r"([\\*<>\[\]_|])", r"\\\1", text)
    return text.replace("\\<", "&lt;").replace("\\>", "&gt;").replace("\\|", "&#124;")


def code(text):
    if "|" in text:  # ends a cell, even in code
        return "<code>" + text.replace("&", "&amp;").replace("<", "&lt;").replace("|", "&#124;") + "</code>"
    return f"`{text}`" if text else ""


def table(titles, rows):
    return ["| " + " | ".join(titles) + " |", "| " + " | ".join("---" for _ in titles) + " |",
            *("| " + " | ".join(row) + " |" for row in rows), ""]


def config_of(program):
    """The tables of the configuration, each (name, is a list of tables, [(key, default, text), …])."""
    done = subprocess.run([program, "mesh", "--print-config"], capture_output=True, text=True, check=True)
    tables = [("", False, [])]
    for line in done.stdout.splitlines():
        head, key = TABLE.match(line), KEY.match(line)
        if head:
            tables.append((head[3], head[2] == "[[", []))
        elif key:
            tables[-1][2].append((key[2], key[3].strip(), key[4].strip()))
        elif line.strip() and not line.startswith("# Effective configuration"):
            raise ValueError(f"options_page.py: a line of --print-config that it does not know: {line}")
    return tables


def config_section(tables):
    out = ["## Job file", ""]
    for name, repeats, rows in tables:
        shown = f"[[{name}]]" if repeats else f"[{name}]"
        out += [f"### {code(shown) if name else 'Before the first table'}", ""]
        if repeats:
            out += ["As many of these tables as there are such things.", ""]
        out += table(("key", "default", "what it says"), [(code(k), code(d), cell(t)) for k, d, t in rows])
    return out


def flag_row(flag, said):
    """The flag with what it takes, and its text."""
    within = RANGE.match(f"{flag} {said}")
    if within:
        flag, said = within[1], f"{within[4].strip()}; {within[2]} to {within[3]}"
    if flag.endswith(" REQUIRED"):
        flag, said = flag[: -len(" REQUIRED")], f"{said}; required"
    return flag, said


def flags_of(lines):
    """Options of a command's help by their headings: {heading: [(flags, text), …]}."""
    groups, heading = {}, "Options"
    for flags, line in entries(lines):
        title = None if flags else TITLE.match(line)
        if title:
            heading = title[1]
        elif flags:
            groups.setdefault(heading, []).append(flag_row(flags, line))
    return groups


def command_section(program, command):
    lines = help_of(program, command)
    usage = next(line for line in lines if line.startswith("Usage: "))
    out = [f"## delfront {command}", "", f"{cell(lines[0])}.", "", "```", usage[len("Usage: "):], "```", ""]
    for heading, rows in flags_of(lines).items():
        out += [f"**{heading}**", "", *table(("flag", "what it says"), [(code(f), cell(t)) for f, t in rows])]
    return out


def page(program):
    out = [OPENING, *config_section(config_of(program))]
    for command in commands_of(help_of(program)):
        out += command_section(program, command)
    return "\n".join(out).rstrip() + "\n"


if __name__ == "__main__":
    sys.exit(write_page(__doc__, page, "docs", "options.md"))
