#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A folder of src/ includes only itself and folders before it in DELFRONT_PARTS of CMakeLists.txt.

include/delfront/ stands alone, cli/ may include the library's headers; mpi.h belongs to src/base/.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]', re.MULTILINE)


def read_parts():
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"set\(DELFRONT_PARTS\s+([^)]*)\)", text).group(1).split()


def allowed_parts(part, parts):
    if part == "io":  # formats know the grid and nothing of how it is made
        return {"base", "mesh", "io"}
    return set(parts[: parts.index(part) + 1])


def find_violations():
    parts = read_parts()
    for folder in sorted(p for p in (ROOT / "src").iterdir() if p.is_dir()):
        if any(folder.iterdir()) and folder.name not in parts:
            yield f"src/{folder.name}: not in DELFRONT_PARTS"
            continue
        allowed = allowed_parts(folder.name, parts)
        for file in sorted(folder.glob("*.[ch]pp")):
            for _, name in INCLUDE.findall(file.read_text()):
                top = name.split("/")[0]
                if top in parts and "/" in name and top not in allowed:
                    yield f"{file.relative_to(ROOT)}: includes {name}, a later part"
                if "/" not in name and (folder / name).exists():
                    yield f'{file.relative_to(ROOT)}: include "{folder.name}/{name}" relative to src/'
                if name == "mpi.h" and folder.name != "base":
                    yield f"{file.relative_to(ROOT)}: only src/base/ includes mpi.h"
    for file in sorted((ROOT / "include" / "delfront").glob("*.hpp")):
        for kind, name in INCLUDE.findall(file.read_text()):
            if kind == '"' and not name.startswith("delfront/"):
                yield f"{file.relative_to(ROOT)}: public header includes {name}"


if __name__ == "__main__":
    found = list(find_violations())
    print("\n".join(found), end="\n" if found else "")
    sys.exit(bool(found))
