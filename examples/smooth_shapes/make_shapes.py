# SPDX-License-Identifier: Apache-2.0
"""Write shapes of smooth geometry that have something to them, one file each.

    make_shapes.py FOLDER

ball: a sphere, with its poles. ring: a torus. spike: a cone, with its tip. patch: half of a hill, trimmed along its
diagonal, alone. tee: two pipes that meet at a right angle. blade: a twisted, tapered blade of a propeller.
"""

import argparse
import math
import os


def place(p):
    return "[" + ", ".join(repr(round(c, 15)) for c in p) + "]"


def table(what, **fields):
    return "\n".join([f"[[{what}]]"] + [f"{key} = {value}" for key, value in fields.items()]) + "\n"


def text(word):
    return f'"{word}"'


def ball():
    yield table("shape", type=text("sphere"), radius=1)


def ring():
    yield table("shape", type=text("torus"), radius=1, tube=0.3)


def spike():
    yield table("shape", type=text("cone"), radius=0.5, height=1.5)


def patch():
    """z rises to 0.3 in the middle; what is left of the diagonal."""
    n = 9
    sections = [[(i / (n - 1), j / (n - 1), 0.3 * math.sin(math.pi * i / (n - 1)) * math.sin(math.pi * j / (n - 1)))
                 for i in range(n)] for j in range(n)]
    rows = ",\n  ".join("[" + ", ".join(place(p) for p in row) + "]" for row in sections)
    yield table("surface", name=text("hill"), type=text("interpolated"), sections=f"[\n  {rows}\n]")
    corners = {"a": (0, 0), "b": (1, 0), "c": (1, 1)}
    for name, (u, v) in corners.items():
        yield table("corner", name=text(name), at=place((float(u), float(v), 0.0)))
    for name, ends in {"low": "ab", "right": "bc", "diagonal": "ca"}.items():
        uv = [list(map(float, corners[end])) for end in ends]
        yield table("edge", name=text(name), type=text("on"), surface=text("hill"), uv=str(uv),
                    **{"from": text(ends[0]), "to": text(ends[1])})
    yield table("face", name=text("patch"), surface=text("hill"), loops='[["low", "right", "diagonal"]]')


def tee(radius=0.5, branch=0.3, half=1.5, height=1.4, places=128):
    """A pipe along x and a thinner one up from it; they meet in z = sqrt(radius^2 - y^2)."""
    yield "tolerance = 1e-6\n"
    surfaces = {
        "run": dict(type=text("cylinder"), axis="[1, 0, 0]", x="[0, 0, -1]", radius=radius),
        "up": dict(type=text("cylinder"), axis="[0, 0, 1]", x="[1, 0, 0]", radius=branch),
        "low end": dict(type=text("plane"), origin=place((-half, 0, 0)), axis="[-1, 0, 0]"),
        "high end": dict(type=text("plane"), origin=place((half, 0, 0)), axis="[1, 0, 0]"),
        "top end": dict(type=text("plane"), origin=place((0, 0, height)), axis="[0, 0, 1]"),
    }
    for name, fields in surfaces.items():
        yield table("surface", name=text(name), **fields)
    corners = {"p": (-half, 0, -radius), "q": (half, 0, -radius), "m": (branch, 0, radius), "t": (branch, 0, height)}
    for name, at in corners.items():
        yield table("corner", name=text(name), at=place(at))
    ring = dict(type=text("circle"), axis="[1, 0, 0]", x="[0, 0, -1]", radius=radius)
    for name, corner, x in (("low ring", "p", -half), ("high ring", "q", half)):
        yield table("edge", name=text(name), origin=place((x, 0, 0)), **ring, **{"from": text(corner), "to": text(corner)})
    yield table("edge", name=text("top ring"), type=text("circle"), origin=place((0, 0, height)), radius=branch,
                **{"from": text("t"), "to": text("t")})
    yield table("edge", name=text("run seam"), type=text("line"), **{"from": text("p"), "to": text("q")})
    yield table("edge", name=text("up seam"), type=text("line"), **{"from": text("m"), "to": text("t")})
    turn = [2 * math.pi * i / places for i in range(places + 1)]
    uv = [[a, math.sqrt(radius ** 2 - (branch * math.sin(a)) ** 2)] for a in turn]
    yield table("edge", name=text("meeting"), type=text("on"), surface=text("up"), uv=str(uv),
                **{"from": text("m"), "to": text("m")})
    faces = {
        "run": ("run", [["low ring", "run seam", "-high ring", "-run seam"], ["meeting"]]),
        "branch": ("up", [["meeting", "up seam", "-top ring", "-up seam"]]),
        "low": ("low end", [["low ring"]]), "high": ("high end", [["high ring"]]), "top": ("top end", [["top ring"]]),
    }
    for name, (surface, loops) in faces.items():
        yield table("face", name=text(name), kind=text("wall" if name in ("run", "branch") else "patch"),
                    surface=text(surface), loops=str(loops).replace("'", '"'))


def blade(sections=9, places=48):
    """Rounded sections about z, turned from 65 to 20 degrees, with the chord of an ellipse; flat root and tip."""
    rows = []
    for s in range(sections):
        f = s / (sections - 1)
        turn, chord = math.radians(65 - 45 * f), 0.3 * math.sqrt(1 - 0.8 * f * f)
        row = []
        for i in range(places):
            a = 2 * math.pi * i / places
            x, y = 0.5 * chord * math.cos(a), chord * (0.12 - 0.04 * f) * math.sin(a) * (1 - 0.2 * math.cos(a))
            row.append((x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), 0.2 + f))
        rows.append("[" + ", ".join(place(p) for p in row) + "]")
        if s in (0, sections - 1):
            yield table("corner", name=text("root end" if s == 0 else "tip end"), at=place(row[0]))
    yield table("surface", name=text("skin"), type=text("interpolated"), closed="true",
                sections="[\n  " + ",\n  ".join(rows) + "\n]")
    for name, z, way in (("root plane", 0.2, -1), ("tip plane", 1.2, 1)):
        yield table("surface", name=text(name), type=text("plane"), origin=place((0, 0, z)), axis=f"[0, 0, {way}]")
    for name, uv, first, last in (("root", "[[0, 0], [1, 0]]", "root", "root"),
                                  ("tip", "[[0, 1], [1, 1]]", "tip", "tip"), ("seam", "[[0, 0], [0, 1]]", "root", "tip")):
        yield table("edge", name=text(name), type=text("on"), surface=text("skin"), uv=uv,
                    **{"from": text(first + " end"), "to": text(last + " end")})
    yield table("face", name=text("blade"), kind=text("wall"), surface=text("skin"),
                loops='[["root", "seam", "-tip", "-seam"]]')
    for name in ("root", "tip"):
        yield table("face", name=text(name), kind=text("wall"), surface=text(name + " plane"), loops=f'[["{name}"]]')


SHAPES = {"ball": ball, "ring": ring, "spike": spike, "patch": patch, "tee": tee, "blade": blade}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    folder = parser.parse_args().folder
    os.makedirs(folder, exist_ok=True)
    for name, shape in SHAPES.items():
        with open(os.path.join(folder, name + ".geom.toml"), "w", encoding="utf-8") as out:
            out.write("\n".join(shape()))


if __name__ == "__main__":
    main()
