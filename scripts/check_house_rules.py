#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rules of the house that a text search can see: licence lines, names, length of files, words and paths to avoid."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CODE = {".cpp", ".hpp", ".py", ".sh", ".cmake", ".toml", ".ts", ".mjs", ".js", ".css"}
LONGEST = 600  # lines of a C++ file
# Put together here so that this file does not find itself.
FORBIDDEN_WORDS = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "X" * 3, "HA" + "CK"]) + r")\b")
MACHINE_PATHS = re.compile(r"(?<![\w.])/(?:wo" + r"rk|home|root|Users|tmp/b-)/?\b")
COPYLEFT = re.compile(r"#\s*include\s*[<\"](?:CGAL|gmsh|tetgen|vtk|gts)", re.IGNORECASE)
# A header's constants, and types at namespace level; the rest of the naming rules is clang-tidy's (.clang-tidy).
BAD_CONSTANT = re.compile(r"^\s*(?:static |inline )*constexpr (?:static )?[\w:<>, ]+ (?!k[A-Z])([a-z]\w*)\s*(?:=|\{)", re.MULTILINE)
BAD_TYPE = re.compile(r"^(?:struct|class|enum class|enum) ([a-z]\w*)\s*(?:\{|:(?!:)|$)", re.MULTILINE)


def list_files():
    command = ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard"]
    for name in sorted(set(subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines())):
        path = ROOT / name
        if path.is_file() and not path.is_symlink():
            yield name, path


def is_code(name, text):
    return pathlib.Path(name).suffix in CODE or name.endswith("CMakeLists.txt") or text.startswith("#!")


def check_code(name, text):
    if "SPDX-License-Identifier: Apache-2.0" not in text[:400]:
        yield "no SPDX-License-Identifier: Apache-2.0 in the first lines"
    for match in FORBIDDEN_WORDS.finditer(text):
        yield f"'{match.group(0)}' in line {text.count(chr(10), 0, match.start()) + 1}"
    if COPYLEFT.search(text) and not name.startswith("bench/peers/"):
        yield "includes a peer's header; drivers of peers live in bench/peers/"


def check_cpp(name, text):
    if text.count("\n") > LONGEST:
        yield f"{text.count(chr(10))} lines, {LONGEST} at most"
    if name.endswith(".hpp") and "#pragma once" not in text:
        yield "no #pragma once"
    if not re.fullmatch(r"[a-z0-9_]+\.[ch]pp", pathlib.Path(name).name):
        yield "file names are snake_case"
    for match in BAD_CONSTANT.finditer(text):
        if name.endswith(".hpp"):
            yield f"constant '{match.group(1)}' should be called k{match.group(1).title().replace('_', '')}"
    for match in BAD_TYPE.finditer(text):
        yield f"type '{match.group(1)}' should be in CamelCase"
    if name.startswith("src/") and re.search(r"std::(?:cout|cerr)\b|\bprintf\(|fmt::print\(", text):
        yield "the library prints nothing"


def check_file(name, path):
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return  # data
    if MACHINE_PATHS.search(text):
        line = text.count("\n", 0, MACHINE_PATHS.search(text).start()) + 1
        yield f"a path of one machine in line {line}"
    if is_code(name, text):
        yield from check_code(name, text)
    if name.endswith((".cpp", ".hpp")):
        yield from check_cpp(name, text)


def check_version():
    cmake = re.search(r"project\(delfront VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    header = re.search(r'kVersion = "([\d.]+)"', (ROOT / "include/delfront/version.hpp").read_text()).group(1)
    if cmake != header:
        yield f"version {cmake} in CMakeLists.txt, {header} in include/delfront/version.hpp"


def main():
    found = [f"{name}: {what}" for name, path in list_files() for what in check_file(name, path)]
    found += list(check_version())
    print("\n".join(found), end="\n" if found else "")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
