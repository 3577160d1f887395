# SPDX-License-Identifier: Apache-2.0
"""Write a straight NACA 0012 wing with a blunt trailing edge in a box: the surface of the air, two closed shells.

    make_wing.py OUT.stl [--span 3] [--size 0.06] [--nose 0.006] [--far 1.5] [--growth 0.3]

x runs downstream, y along the span, z up; lengths in chords, the leading edge at x = 0. Names: wing, tip,
trailing_edge, inlet, outlet, farfield. Thickness: I. H. Abbott and A. E. von Doenhoff, Theory of Wing Sections, 1959,
section 6.4 (also E. N. Jacobs, K. E. Ward, R. M. Pinkerton, NACA Report 460, 1933). Triangles face outwards, seen
from the air.
"""

import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from facet_surface import Plane, Surface, curve, line, loop  # noqa: E402

THICKNESS = 0.12
COEFFICIENTS = (0.2969, -0.1260, -0.3516, 0.2843, -0.1015)  # of sqrt(x), x, x^2, x^3, x^4: blunt at x = 1
BOX_X, BOX_SIDE = (-10.0, 11.0), 10.0


def half_thickness(x):
    a0, a1, a2, a3, a4 = COEFFICIENTS
    return 5 * THICKNESS * (a0 * np.sqrt(x) + x * (a1 + x * (a2 + x * (a3 + x * a4))))


def section_area():
    """Exact area of the section, chord 1."""
    powers = (1.5, 2, 3, 4, 5)
    return 2 * 5 * THICKNESS * sum(a / p for a, p in zip(COEFFICIENTS, powers))


def air_volume(span):
    return (BOX_X[1] - BOX_X[0]) * (2 * BOX_SIDE) ** 2 - section_area() * span


def section(t, y):
    """Points of the section at span station y: t = 0 upper trailing edge, pi leading edge, 2 pi lower trailing edge."""
    t = np.asarray(t, dtype=float)
    x = np.cos(t / 2) ** 2
    z = np.where(t <= np.pi, 1.0, -1.0) * half_thickness(x)
    return np.stack([x, np.broadcast_to(y, x.shape), np.where(x == 0, 0.0, z)], axis=1)


class Skin:
    """Unrolls upper and lower side from trailing edge to trailing edge; true lengths."""

    def __init__(self):
        self.t = np.linspace(0.0, 2 * np.pi, 40001)
        points = section(self.t, 0.0)
        self.arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])

    def flat(self, points):
        root = np.sqrt(np.clip(points[:, 0], 0.0, 1.0)) * np.where(points[:, 2] < 0, -1.0, 1.0)
        return np.stack([np.interp(2 * np.arccos(root), self.t, self.arc), points[:, 1]], axis=1)

    def space(self, uv):
        return section(np.interp(uv[:, 0], self.arc, self.t), uv[:, 1])


class Sizes:
    """Wanted side lengths on the wing: `nose` at the leading edge, 1.6 times the height of the trailing edge there,
    growing to `size` between them."""

    def __init__(self, size, nose, growth):
        self.size, self.nose, self.growth = size, nose, growth
        self.tail = 1.6 * 2 * half_thickness(1.0)

    def __call__(self, at):
        from_nose = np.maximum(at[:, 0], np.abs(at[:, 2]))
        result = np.minimum(self.nose + self.growth * from_nose, self.size)
        return np.minimum(result, self.tail + self.growth * np.abs(1.0 - at[:, 0]))


def add_trailing_edge(surface, upper, lower):
    """One strip of triangles between the two edges, whose points alternate along the span."""
    points = np.concatenate([upper, lower])
    above = len(upper)
    i, j = 0, 0
    triangles = []
    while i + 1 < above or j + 1 < len(lower):
        if j + 1 == len(lower) or (i + 1 < above and upper[i + 1][1] <= lower[j + 1][1]):
            triangles.append((i, i + 1, above + j))
            i += 1
        else:
            triangles.append((i, above + j + 1, above + j))
            j += 1
    surface.add_triangles("trailing_edge", points, triangles)


def add_wing(surface, span, sizes):
    half = span / 2
    height = half_thickness(1.0)
    ends = {y: curve(lambda t, y=y: section(t, y), 0.0, 2 * np.pi, sizes) for y in (-half, half)}
    for y, points in ends.items():  # the corners bit for bit as the trailing edge has them
        points[0], points[-1] = (1.0, y, height), (1.0, y, -height)
    upper = line([1.0, -half, height], [1.0, half, height], sizes)
    middles = 0.5 * (upper[1:] + upper[:-1]) * [1, 1, -1]
    lower = np.concatenate([[[1.0, -half, -height]], middles, [[1.0, half, -height]]])
    surface.add_face("wing", [loop(upper, ends[half], lower, ends[-half])], Skin(), sizes)
    for y, points in ends.items():
        edge = np.stack([points[-1], points[0]])
        chart = Plane((0, y, 0), (1, 0, 0), (0, 0, 1) if y > 0 else (0, 0, -1))  # normal into the wing
        surface.add_face("tip", [loop(points, edge)], chart, sizes)
    add_trailing_edge(surface, upper, lower)


def add_box(surface, far):
    def size(at):
        return np.full(len(at), far)

    (x0, x1), s = BOX_X, BOX_SIDE
    along = {(y, z): line([x0, y, z], [x1, y, z], size) for y in (-s, s) for z in (-s, s)}
    across = {(x, z): line([x, -s, z], [x, s, z], size) for x in (x0, x1) for z in (-s, s)}
    upright = {(x, y): line([x, y, -s], [x, y, s], size) for x in (x0, x1) for y in (-s, s)}
    ahead, left, up = np.eye(3)
    for x, name, sign in ((x0, "inlet", -1), (x1, "outlet", 1)):
        ring = loop(across[x, -s], upright[x, s], across[x, s], upright[x, -s])
        surface.add_face(name, [ring], Plane((x, 0, 0), left, sign * up), size)
    for v in (-s, s):
        sign = np.sign(v)
        ring = loop(along[v, -s], upright[x1, v], along[v, s], upright[x0, v])
        surface.add_face("farfield", [ring], Plane((0, v, 0), up, sign * ahead), size)
        ring = loop(along[-s, v], across[x1, v], along[s, v], across[x0, v])
        surface.add_face("farfield", [ring], Plane((0, 0, v), ahead, sign * left), size)


def make(span=3.0, size=0.06, nose=0.006, far=1.5, growth=0.3):
    """The closed surfaces of box and wing; lengths in chords."""
    surface = Surface()
    add_wing(surface, span, Sizes(size, nose, growth))
    add_box(surface, far)
    return surface


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", help="file to write, .stl or .obj")
    parser.add_argument("--span", type=float, default=3.0, help="chords")
    parser.add_argument("--size", type=float, default=0.06, help="largest triangle side on the wing, chords")
    parser.add_argument("--nose", type=float, default=0.006, help="triangle side at the leading edge")
    parser.add_argument("--far", type=float, default=1.5, help="triangle side on the box")
    parser.add_argument("--growth", type=float, default=0.3, help="growth of sides per distance on the wing")
    options = parser.parse_args()
    surface = make(options.span, options.size, options.nose, options.far, options.growth)
    facts = surface.summary()
    surface.write(options.out)
    print("{}: {triangles} triangles, {points} points, volume {volume:.6f} (exact {:.6f}), smallest angle "
          "{min_angle:.1f} deg".format(options.out, air_volume(options.span), **facts))


if __name__ == "__main__":
    main()
