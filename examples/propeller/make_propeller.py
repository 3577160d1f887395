# SPDX-License-Identifier: Apache-2.0
"""Write a propeller as smooth geometry: twisted blades on a hub, joined, so that it bounds a volume.

    make_propeller.py [OUT.geom.toml] [--blades 3]

Blade sections lie on cylinders round the axis, as propellers are drawn: the first one on the hub, the last one on the
cylinder through the tips. So the hub is one surface with a hole for each blade, and edges are shared.
"""

import argparse
import math
import sys

RADIUS, HUB = 1.0, 0.2           # of the tips, of the hub
FRONT, BACK = 0.25, 0.3          # the hub reaches so far before and behind the blades; half a ball is before it
PITCH = 2.2                      # of the helices that sections lie along, a turn
ROOT_CHORD, THICK, THIN = 0.3, 0.2, 0.1   # chord at the hub, thickness of sections there and at the tip, of the chord
SKEW = 20.0                      # degrees that the tip is behind the root
SECTIONS, PLACES = 12, 64


def place(p):
    return "[" + ", ".join(repr(round(c, 15)) for c in p) + "]"


def table(what, **fields):
    return "\n".join([f"[[{what}]]"] + [f"{key.strip('_')} = {value}" for key, value in fields.items()]) + "\n"


def text(word):
    return f'"{word}"'


def radius_of(f):
    return HUB + f * (RADIUS - HUB)


def chord(f):
    """Widest in the middle, and round towards the tip."""
    return ROOT_CHORD * (1 + 1.4 * f) * math.sqrt(1 - 0.9 * f ** 3)


def thickness(f):
    """Of the section, by its chord."""
    return THICK + f * (THIN - THICK)


def section_area(f):
    """Of the closed curve in section(): y has the factor (1 - 0.3 cos a), which adds nothing to the area."""
    return math.pi * 0.5 * chord(f) * 0.5 * thickness(f) * chord(f)


def volume(blades=3, steps=2000):
    """Exact but for splines between sections: sections lie on cylinders, so areas times dr add up."""
    blade = sum(section_area((i + 0.5) / steps) for i in range(steps)) / steps * (RADIUS - HUB)
    return math.pi * HUB ** 2 * (FRONT + BACK) + 2 / 3 * math.pi * HUB ** 3 + blades * blade


def section(f, turned):
    """Places of the section at a share of the span, on the cylinder of its radius; along z and round it."""
    r = radius_of(f)
    climb = math.atan2(PITCH, 2 * math.pi * r)  # of the helix, over the plane of rotation
    places = []
    for i in range(PLACES):
        a = 2 * math.pi * i / PLACES
        x = 0.5 * chord(f) * math.cos(a)
        y = 0.5 * thickness(f) * chord(f) * math.sin(a) * (1 - 0.3 * math.cos(a))
        along, up = x * math.cos(climb) - y * math.sin(climb), x * math.sin(climb) + y * math.cos(climb)
        angle = turned + math.radians(SKEW) * f * f + along / r
        places.append((r * math.cos(angle), r * math.sin(angle), up))
    return places


def blade(k, turned):
    """Skin, tip, the edges between; the hole in the hub is made by its root."""
    name = f"blade {k}"
    rows = [section(s / (SECTIONS - 1), turned) for s in range(SECTIONS)]
    yield table("surface", name=text(name), type=text("interpolated"), closed="true",
                sections="[\n  " + ",\n  ".join("[" + ", ".join(map(place, row)) + "]" for row in rows) + "\n]")
    for end, at in (("root", rows[0][0]), ("tip", rows[-1][0])):
        yield table("corner", name=text(f"{end} corner {k}"), at=place(at))
    for edge, uv, first, last in (("root", "[[0, 0], [1, 0]]", "root", "root"), ("tip", "[[0, 1], [1, 1]]", "tip", "tip"),
                                  ("seam", "[[0, 0], [0, 1]]", "root", "tip")):
        yield table("edge", name=text(f"{edge} {k}"), type=text("on"), surface=text(name), uv=uv,
                    from_=text(f"{first} corner {k}"), to=text(f"{last} corner {k}"))
    yield table("face", name=text("blades"), kind=text("wall"), surface=text(name),
                loops=f'[["root {k}", "seam {k}", "-tip {k}", "-seam {k}"]]')
    yield table("face", name=text("tips"), kind=text("wall"), surface=text("tip cylinder"), loops=f'[["tip {k}"]]')


def hub(blades):
    """A cylinder with a hole for each blade, half a ball before it, flat behind."""
    yield table("surface", name=text("hub cylinder"), type=text("cylinder"), radius=HUB)
    yield table("surface", name=text("tip cylinder"), type=text("cylinder"), radius=RADIUS)
    yield table("surface", name=text("nose"), type=text("sphere"), origin=place((0, 0, FRONT)), radius=HUB)
    yield table("surface", name=text("back"), type=text("plane"), origin=place((0, 0, -BACK)), axis="[0, 0, -1]")
    for name, z in (("front", FRONT), ("back", -BACK)):
        yield table("corner", name=text(f"{name} corner"), at=place((HUB, 0, z)))
        yield table("edge", name=text(f"{name} ring"), type=text("circle"), origin=place((0, 0, z)), radius=HUB,
                    from_=text(f"{name} corner"), to=text(f"{name} corner"))
    yield table("corner", name=text("nose tip"), at=place((0, 0, FRONT + HUB)))
    yield table("edge", name=text("nose seam"), type=text("on"), surface=text("nose"),
                uv=f"[[0, 0], [0, {math.pi / 2!r}]]", from_=text("front corner"), to=text("nose tip"))
    yield table("edge", name=text("hub seam"), type=text("line"), from_=text("back corner"), to=text("front corner"))
    outer = '["back ring", "hub seam", "-front ring", "-hub seam"]'
    holes = [f'["root {k}"]' for k in range(1, blades + 1)]
    yield table("face", name=text("hub"), kind=text("wall"), surface=text("hub cylinder"),
                loops="[" + ", ".join([outer, *holes]) + "]")
    yield table("face", name=text("hub"), kind=text("wall"), surface=text("nose"),
                loops='[["front ring", "nose seam", "-nose seam"]]')
    yield table("face", name=text("hub"), kind=text("wall"), surface=text("back"), loops='[["back ring"]]')


def propeller(blades=3):
    yield "tolerance = 1e-6\n"
    for k in range(1, blades + 1):
        yield from blade(k, 2 * math.pi * (k - 0.5) / blades)  # the hub's seam is where no blade is
    yield from hub(blades)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="?")
    parser.add_argument("--blades", type=int, default=3)
    options = parser.parse_args()
    lines = "\n".join(propeller(options.blades))
    if options.out:
        with open(options.out, "w", encoding="utf-8") as file:
            file.write(lines)
    else:
        sys.stdout.write(lines)


if __name__ == "__main__":
    main()
