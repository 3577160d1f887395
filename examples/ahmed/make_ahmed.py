# SPDX-License-Identifier: Apache-2.0
"""Write the Ahmed body with a 25-degree slant in a wind tunnel: one closed surface round the air, in metres.

    make_ahmed.py OUT.stl [--size 0.022] [--far 0.2] [--growth 0.2]

x runs downstream from the nose, y to the left, z up from the tunnel's floor. Names: inlet, outlet, floor, top,
side_left, side_right, body, slant, base, stilts. Dimensions: S. R. Ahmed, G. Ramm, G. Faltin, Some salient features
of the time-averaged ground vehicle wake, SAE 840300, 1984. Triangles face outwards, seen from the air.
"""

import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from facet_surface import Plane, Surface, curve, line, loop  # noqa: E402

LENGTH, WIDTH, HEIGHT = 1.044, 0.389, 0.288
CLEARANCE = 0.050
RADIUS = 0.100  # of the four edges of the front
SLANT_LENGTH, SLANT_ANGLE = 0.222, np.radians(25.0)
STILT_RADIUS, STILT_SIDES = 0.015, 16
STILT_X = (0.202, 0.202 + 0.470)
STILT_Y = 0.327 / 2
# Test section 1.87 m x 1.40 m; two body lengths before the nose and 10 m in all, as in computations of the case.
TUNNEL_X, TUNNEL_Y, TUNNEL_Z = (-2.1, 7.9), (-0.935, 0.935), (0.0, 1.40)

BOTTOM, TOP = CLEARANCE, CLEARANCE + HEIGHT
MIDDLE = 0.5 * (BOTTOM + TOP)
HALF = WIDTH / 2
SLANT_X = LENGTH - SLANT_LENGTH * np.cos(SLANT_ANGLE)  # where it begins, on the roof
SLANT_Z = TOP - SLANT_LENGTH * np.sin(SLANT_ANGLE)  # where it ends, on the base


def body_volume():
    """Exact volume of the body without stilts."""
    a, b, r = WIDTH - 2 * RADIUS, HEIGHT - 2 * RADIUS, RADIUS
    nose = r * (a * b + 2 * r * (a + b) * np.pi / 4 + 4 * r * r * 2 / 3)
    wedge = 0.5 * (LENGTH - SLANT_X) * (TOP - SLANT_Z) * WIDTH
    return nose + (LENGTH - RADIUS) * WIDTH * HEIGHT - wedge


def air_volume():
    """Exact volume of the tunnel less the body and its stilts."""
    box = np.prod([high - low for low, high in (TUNNEL_X, TUNNEL_Y, TUNNEL_Z)])
    return box - body_volume() - 4 * np.pi * STILT_RADIUS**2 * CLEARANCE


class Sizes:
    """Wanted side lengths in space: `size` on the body, smaller at the stilts, growing away from both."""

    def __init__(self, size, far, growth):
        self.size, self.far, self.growth = size, far, growth
        self.stilt = 2 * STILT_RADIUS * np.sin(np.pi / STILT_SIDES)

    def __call__(self, at):
        low, high = np.array([0, -HALF, BOTTOM]), np.array([LENGTH, HALF, TOP])
        from_body = np.linalg.norm(np.maximum(np.maximum(low - at, at - high), 0.0), axis=1)
        result = np.minimum(self.size + self.growth * from_body, self.far)
        for x in STILT_X:
            for y in (-STILT_Y, STILT_Y):
                radial = np.hypot(at[:, 0] - x, at[:, 1] - y) - STILT_RADIUS
                vertical = np.maximum(at[:, 2] - BOTTOM, 0.0)
                away = np.hypot(np.maximum(radial, 0.0), vertical)
                result = np.minimum(result, self.stilt + self.growth * away)
        return result


class Nose:
    """Unrolls the rounding of one front edge: `axis` 1 for roof and bottom (they curve in z), 2 for the flanks."""

    def __init__(self, axis, side):
        self.axis, self.side = axis, side
        self.across, self.centre, half = (2, MIDDLE, HEIGHT / 2) if axis == 1 else (1, 0.0, HALF)
        self.straight = half - RADIUS
        # Seen from the air, (arc, along) must turn anticlockwise about the normal that points into the body.
        self.flip = -self.side if axis == 1 else self.side

    def flat(self, points):
        out = self.side * (points[:, self.across] - self.centre) - self.straight
        angle = np.arctan2(out, RADIUS - points[:, 0])
        return np.stack([RADIUS * angle, self.flip * points[:, self.axis]], axis=1)

    def space(self, uv):
        angle = uv[:, 0] / RADIUS
        points = np.empty((len(uv), 3))
        points[:, 0] = RADIUS - RADIUS * np.cos(angle)
        points[:, self.axis] = self.flip * uv[:, 1]
        points[:, self.across] = self.centre + self.side * (self.straight + RADIUS * np.sin(angle))
        return points


class Stilt:
    """Unrolls a stilt, cut open along one line; the chart's normal points at its axis."""

    def __init__(self, x, y):
        self.x, self.y = x, y

    def space(self, uv):
        angle = uv[:, 0] / STILT_RADIUS
        points = [self.x + STILT_RADIUS * np.cos(angle), self.y - STILT_RADIUS * np.sin(angle), uv[:, 1]]
        return np.stack(points, axis=1)


def mitre(y_side, z_side, size):
    """The edge where two front roundings meet, from the flat front to the end of the roundings."""

    def at(angle):
        grow = RADIUS * np.sin(angle)
        y = y_side * (HALF - RADIUS + grow)
        z = MIDDLE + z_side * (HEIGHT / 2 - RADIUS + grow)
        return np.stack([RADIUS * (1 - np.cos(angle)), y, z], axis=1)

    points = curve(at, 0.0, np.pi / 2, size)
    points[0] = [0.0, y_side * (HALF - RADIUS), MIDDLE + z_side * (HEIGHT / 2 - RADIUS)]
    points[-1] = [RADIUS, y_side * HALF, TOP if z_side > 0 else BOTTOM]
    return points


def circle(x, y, z):
    angle = 2 * np.pi * np.arange(STILT_SIDES) / STILT_SIDES
    ring = [x + STILT_RADIUS * np.cos(angle), y - STILT_RADIUS * np.sin(angle), np.full(STILT_SIDES, z)]
    return np.stack(ring, axis=1)


def add_stilt(surface, x, y, size):
    """Rows of nearly equilateral triangles, every second row turned by half a side; the last one is not."""
    rows = 2 * max(1, int(round(CLEARANCE / (2 * np.sqrt(3) / 2 * size.stilt))))
    step = 2 * np.pi * STILT_RADIUS / STILT_SIDES
    chart = Stilt(x, y)
    points = [circle(x, y, 0.0)]
    for row in range(1, rows):
        arc = step * (np.arange(STILT_SIDES) + 0.5 * (row % 2))
        points.append(chart.space(np.stack([arc, np.full(STILT_SIDES, BOTTOM * row / rows)], axis=1)))
    points.append(circle(x, y, BOTTOM))
    triangles = []
    for row in range(rows):
        low, high = row * STILT_SIDES, (row + 1) * STILT_SIDES
        for k in range(STILT_SIDES):
            n = (k + 1) % STILT_SIDES
            if row % 2 == 0:
                triangles += [(low + k, low + n, high + k), (low + n, high + n, high + k)]
            else:
                triangles += [(low + k, low + n, high + n), (low + k, high + n, high + k)]
    surface.add_triangles("stilts", np.concatenate(points), triangles)


def add_body(surface, size):
    corner = {(y, z): mitre(y, z, size) for y in (-1, 1) for z in (-1, 1)}
    front = {z: line(corner[-1, z][0], corner[1, z][0], size) for z in (-1, 1)}
    front_side = {y: line(corner[y, -1][0], corner[y, 1][0], size) for y in (-1, 1)}
    rim = {z: line(corner[-1, z][-1], corner[1, z][-1], size) for z in (-1, 1)}  # where roundings end
    rim_side = {y: line(corner[y, -1][-1], corner[y, 1][-1], size) for y in (-1, 1)}
    roof_side = {y: line(corner[y, 1][-1], [SLANT_X, y * HALF, TOP], size) for y in (-1, 1)}
    slant_side = {y: line([SLANT_X, y * HALF, TOP], [LENGTH, y * HALF, SLANT_Z], size) for y in (-1, 1)}
    base_side = {y: line([LENGTH, y * HALF, SLANT_Z], [LENGTH, y * HALF, BOTTOM], size) for y in (-1, 1)}
    sill = {y: line(corner[y, -1][-1], [LENGTH, y * HALF, BOTTOM], size) for y in (-1, 1)}
    across = {
        key: line([x, -HALF, z], [x, HALF, z], size)
        for key, x, z in (("roof", SLANT_X, TOP), ("slant", LENGTH, SLANT_Z), ("bottom", LENGTH, BOTTOM))
    }
    holes = [circle(x, y, BOTTOM) for x in STILT_X for y in (-STILT_Y, STILT_Y)]
    left, up, down_slope = (0, 1, 0), (0, 0, 1), (np.cos(SLANT_ANGLE), 0, -np.sin(SLANT_ANGLE))

    add = surface.add_face
    add("body", [loop(front[-1], front_side[1], front[1], front_side[-1])], Plane((0, 0, 0), left, up), size)
    for z in (-1, 1):
        add("body", [loop(front[z], corner[1, z], rim[z], corner[-1, z])], Nose(1, z), size)
    for y in (-1, 1):
        add("body", [loop(front_side[y], corner[y, 1], rim_side[y], corner[y, -1])], Nose(2, y), size)
        flank = loop(rim_side[y], roof_side[y], slant_side[y], base_side[y], sill[y])
        add("body", [flank], Plane((0, y * HALF, 0), (y, 0, 0), (0, 0, 1)), size)
    roof = loop(rim[1], roof_side[1], across["roof"], roof_side[-1])
    add("body", [roof], Plane((0, 0, TOP), left, (1, 0, 0)), size)
    bottom = loop(rim[-1], sill[1], across["bottom"], sill[-1])
    add("body", [bottom] + holes, Plane((0, 0, BOTTOM), (1, 0, 0), left), size)
    slant = loop(across["roof"], slant_side[1], across["slant"], slant_side[-1])
    add("slant", [slant], Plane((SLANT_X, 0, TOP), left, down_slope), size)
    base = loop(across["slant"], base_side[1], across["bottom"], base_side[-1])
    add("base", [base], Plane((LENGTH, 0, 0), up, left), size)


def add_tunnel(surface, size):
    (x0, x1), (y0, y1), (z0, z1) = TUNNEL_X, TUNNEL_Y, TUNNEL_Z
    along = {(y, z): line([x0, y, z], [x1, y, z], size) for y in (y0, y1) for z in (z0, z1)}
    across = {(x, z): line([x, y0, z], [x, y1, z], size) for x in (x0, x1) for z in (z0, z1)}
    upright = {(x, y): line([x, y, z0], [x, y, z1], size) for x in (x0, x1) for y in (y0, y1)}

    def level(z):
        return loop(along[y0, z], across[x1, z], along[y1, z], across[x0, z])

    def flank(y):
        return loop(along[y, z0], upright[x1, y], along[y, z1], upright[x0, y])

    def section(x):
        return loop(across[x, z0], upright[x, y1], across[x, z1], upright[x, y0])

    ahead, left, up = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    imprints = [circle(x, y, 0.0) for x in STILT_X for y in (-STILT_Y, STILT_Y)]
    surface.add_face("inlet", [section(x0)], Plane((x0, 0, 0), up, left), size)
    surface.add_face("outlet", [section(x1)], Plane((x1, 0, 0), left, up), size)
    surface.add_face("floor", [level(z0)] + imprints, Plane((0, 0, z0), left, ahead), size)
    surface.add_face("top", [level(z1)], Plane((0, 0, z1), ahead, left), size)
    surface.add_face("side_left", [flank(y1)], Plane((0, y1, 0), up, ahead), size)
    surface.add_face("side_right", [flank(y0)], Plane((0, y0, 0), ahead, up), size)


def make(size=0.022, far=0.2, growth=0.2):
    """The closed surface of the air in the tunnel; lengths in metres."""
    sizes = Sizes(size, far, growth)
    surface = Surface()
    add_tunnel(surface, sizes)
    add_body(surface, sizes)
    for x in STILT_X:
        for y in (-STILT_Y, STILT_Y):
            add_stilt(surface, x, y, sizes)
    return surface


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", help="file to write, .stl or .obj")
    parser.add_argument("--size", type=float, default=0.022, help="triangle side on the body, m")
    parser.add_argument("--far", type=float, default=0.2, help="largest triangle side, m")
    parser.add_argument("--growth", type=float, default=0.2, help="growth of sides per distance")
    options = parser.parse_args()
    surface = make(options.size, options.far, options.growth)
    facts = surface.summary()
    surface.write(options.out)
    print("{}: {triangles} triangles, {points} points, volume {volume:.6f} m3 (exact {:.6f}), smallest angle "
          "{min_angle:.1f} deg".format(options.out, air_volume(), **facts))


if __name__ == "__main__":
    main()
