# SPDX-License-Identifier: Apache-2.0
"""Write a swept, tapered half wing as smooth geometry: splines through its sections, flat root and tip.

    make_wing.py OUT.geom.toml [--points 81] [--thickness 0.1]

Planform of the ONERA M6 wing: V. Schmitt, F. Charpin, Pressure distributions on the ONERA-M6-wing at transonic Mach
numbers, AGARD AR-138, 1979. Section: NACA four-digit thickness (NACA Report 460, 1933) with its blunt trailing edge,
not the ONERA D, whose ordinates that report lists. x runs downstream, y along the span, z up; metres.
"""

import argparse
import math

ROOT_CHORD, TIP_CHORD, SEMISPAN, SWEEP = 0.8059, 0.4561, 1.1963, math.radians(30)
COEFFICIENTS = (0.2969, -0.1260, -0.3516, 0.2843, -0.1015)  # of sqrt(x), x, x^2, x^3, x^4


def half_thickness(x, thickness):
    a0, a1, a2, a3, a4 = COEFFICIENTS
    return 5 * thickness * (a0 * math.sqrt(x) + x * (a1 + x * (a2 + x * (a3 + x * a4))))


def section(chord, nose, y, points, thickness):
    """From the lower trailing edge round the nose to the upper one, dense at both."""
    places = []
    for i in range(points):
        t = math.pi * (2 * i / (points - 1) - 1)  # 0 at the nose
        x = math.sin(t / 2) ** 2
        z = math.copysign(half_thickness(x, thickness), t) if i != points // 2 else 0.0
        places.append((nose + chord * x, y, chord * z))
    return places


def place(p):
    return "[" + ", ".join(repr(round(c, 15)) for c in p) + "]"


def table(what, **fields):
    return "\n".join([f"[[{what}]]"] + [f"{key} = {value}" for key, value in fields.items()]) + "\n"


def wing(points, thickness):
    yield from between(section(ROOT_CHORD, 0.0, 0.0, points, thickness),
                       section(TIP_CHORD, SEMISPAN * math.tan(SWEEP), SEMISPAN, points, thickness))


def between(root, tip):
    """The wing straight from one section to the other, flat at both ends and behind."""
    rows = [",\n".join("    " + place(p) for p in places) for places in (root, tip)]
    slant = tip[0][0] - root[0][0]  # of the trailing edge
    yield table("surface", name='"skin"', type='"interpolated"', sections="[\n  [\n" + "\n  ],\n  [\n".join(rows) + "\n  ]\n]")
    yield table("surface", name='"root plane"', type='"plane"', axis="[0, -1, 0]")
    yield table("surface", name='"tip plane"', type='"plane"', origin=place((0.0, SEMISPAN, 0.0)), axis="[0, 1, 0]")
    yield table("surface", name='"end plane"', type='"plane"', origin=place(root[0]), axis=place((SEMISPAN, -slant, 0.0)))
    for name, uv in {"root": "[[0, 0], [1, 0]]", "tip": "[[0, 1], [1, 1]]", "lower end": "[[0, 0], [0, 1]]",
                     "upper end": "[[1, 0], [1, 1]]"}.items():
        yield table("edge", name=f'"{name}"', type='"on"', surface='"skin"', uv=uv)
    for name, places in {"root end": root, "tip end": tip}.items():
        yield table("corner", name=f'"{name} low"', at=place(places[0]))
        yield table("corner", name=f'"{name} high"', at=place(places[-1]))
        yield table("edge", name=f'"{name}"', type='"line"', **{"from": f'"{name} low"', "to": f'"{name} high"'})
    for name, surface, loop in (("wing", "skin", ["root", "upper end", "-tip", "-lower end"]),
                                ("trailing_edge", "end plane", ["lower end", "tip end", "-upper end", "-root end"]),
                                ("root", "root plane", ["root", "-root end"]),
                                ("tip", "tip plane", ["tip", "-tip end"])):
        yield table("face", name=f'"{name}"', kind='"wall"', surface=f'"{surface}"', loops=str([loop]).replace("'", '"'))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--points", type=int, default=81, help="of each section, odd")
    parser.add_argument("--thickness", type=float, default=0.1)
    args = parser.parse_args()
    with open(args.out, "w", encoding="utf-8") as out:
        out.write("\n".join(wing(args.points | 1, args.thickness)))


if __name__ == "__main__":
    main()
