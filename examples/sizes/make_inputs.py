#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write what the job files of this folder read: a room with a ball in it, the same in the plane, grids with fields.

    make_inputs.py [FOLDER]     # default: this folder; needs numpy and meshio
"""
import os
import sys

import meshio
import numpy as np

CENTRE, RADIUS = np.array([0.5, 0.0, 0.0]), 0.3  # of the ball; 0.2 from the wall at x = 1
WALL, SECTION = 20, 96  # squares along a wall; points round the circle


def icosphere(levels):
    """Points on the unit sphere and outward triangles."""
    t = (1 + 5**0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t),
              (0, -1, -t), (0, 1, -t), (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
                 (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    for _ in range(levels):
        middle, finer = {}, []

        def half(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                p = points[a] + points[b]
                middle[key] = len(points)
                points.append(p / np.linalg.norm(p))
            return middle[key]

        for a, b, c in triangles:
            ab, bc, ca = half(a, b), half(b, c), half(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return np.array(points), np.array(triangles)


def cube_walls(n):
    """Triangles of the cube [-1, 1]^3, outward: (m, 3, 3). Diagonals turn from square to square."""
    at = np.linspace(-1, 1, n + 1)
    corners = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            for i in range(n):
                for j in range(n):
                    square = np.zeros((4, 3))
                    square[:, axis] = side
                    square[:, u] = at[[i, i + 1, i + 1, i]]
                    square[:, v] = at[[j, j, j + 1, j + 1]]
                    if side < 0:
                        square = square[::-1]
                    cuts = [(0, 1, 2), (0, 2, 3)] if (i + j) % 2 else [(0, 1, 3), (1, 2, 3)]
                    corners += [square[list(cut)] for cut in cuts]
    return np.array(corners)


def write_stl(path, solids):
    with open(path, "w", encoding="ascii") as file:
        for name, triangles in solids.items():
            file.write(f"solid {name}\n")
            for triangle in triangles:
                file.write("facet normal 0 0 0\nouter loop\n")
                for p in triangle:
                    file.write("vertex " + " ".join(repr(float(x)) for x in p) + "\n")
                file.write("endloop\nendfacet\n")
            file.write(f"endsolid {name}\n")


def write_section(path):
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    turn = 2 * np.pi * np.arange(SECTION) / SECTION
    circle = np.c_[CENTRE[0] + RADIUS * np.cos(turn), CENTRE[1] + RADIUS * np.sin(turn)]
    with open(path, "w", encoding="ascii") as file:
        file.write(f"{4 + SECTION} 2 0 0\n")
        for i, (x, y) in enumerate([*square, *circle]):
            file.write(f"{i} {float(x)!r} {float(y)!r}\n")
        file.write(f"{4 + SECTION} 1\n")
        for i in range(4):
            file.write(f"{i} {i} {(i + 1) % 4} 1\n")
        for i in range(SECTION):
            file.write(f"{4 + i} {4 + i} {4 + (i + 1) % SECTION} 2\n")
        file.write(f"1\n0 {CENTRE[0]} {CENTRE[1]}\n")  # the circle is a hole


def lattice(n, dimension):
    """A grid of the square or cube of half side 1.25 in n^d cells, each cut into simplices along its diagonal."""
    axes = [np.linspace(-1.25, 1.25, n + 1)] * dimension
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, dimension)
    number = np.arange((n + 1) ** dimension).reshape([n + 1] * dimension)
    cells = []
    for order in ([(0, 1), (1, 0)] if dimension == 2 else
                  [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]):
        at = [0] * dimension
        path = []
        for axis in (None, *order):
            if axis is not None:
                at[axis] = 1
            path.append(number[tuple(slice(a, n + a) for a in at)].ravel())
        cells.append(np.stack(path, 1))
    cells = np.concatenate(cells)
    p = points[cells]
    sign = np.linalg.det(p[:, 1:] - p[:, :1])
    cells[sign < 0] = cells[sign < 0][:, [1, 0, *range(2, dimension + 1)]]
    if dimension == 2:
        points = np.c_[points, np.zeros(len(points))]
    return points, ("triangle" if dimension == 2 else "tetra"), cells


def write_fields(folder, dimension, suffix):
    points, kind, cells = lattice(16, dimension)
    x, y = points[:, 0], points[:, 1]
    h = 0.05 + 0.1 * np.hypot(x + 0.5, y)
    meshio.Mesh(points, [(kind, cells)], {"h": h}).write(os.path.join(folder, f"background{suffix}.vtu"))
    points, kind, cells = lattice(40, dimension)
    x, y = points[:, 0], points[:, 1]
    mach = np.tanh(10 * (x + 0.3 + 0.2 * np.sin(3 * y)))  # a bent shock
    meshio.Mesh(points, [(kind, cells)], {"Mach": mach}).write(os.path.join(folder, f"flow{suffix}.vtu"))


def write_many_sources(path, count):
    """A job with that many sources along a spiral: what takes a list in the job file."""
    t = np.linspace(0, 1, count)
    at = np.c_[-0.5 + 0.3 * np.cos(12 * t), 0.3 * np.sin(12 * t), 1.6 * t - 0.8]
    with open(path, "w", encoding="ascii") as job:
        job.write(f"# S5: {count} sources along a spiral; written by make_inputs.py.\n")
        job.write('[input]\nfiles = ["room.stl"]\n[size]\ngrowth = 1.25\n')
        for p in at:
            job.write('[[size.source]]\ntype = "point"\n'
                      f"at = [{p[0]:.6f}, {p[1]:.6f}, {p[2]:.6f}]\ndelta0 = 0.03\nr1 = 0.3\n")


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    os.makedirs(folder, exist_ok=True)
    points, triangles = icosphere(3)
    ball = (CENTRE + RADIUS * points)[triangles][:, ::-1]  # towards the ball: out of the room
    write_stl(os.path.join(folder, "room.stl"), {"walls": cube_walls(WALL), "ball": ball})
    wing = np.array([[[-0.9, -0.5, -0.5], [-0.5, -0.5, -0.45], [-0.6, 0.5, -0.5]]])
    write_stl(os.path.join(folder, "wing.stl"), {"wing": wing})
    points, triangles = icosphere(2)
    write_stl(os.path.join(folder, "blob.stl"), {"blob": ([-0.4, 0, 0.4] + 0.3 * points)[triangles]})
    write_many_sources(os.path.join(folder, "s05_many_sources.toml"), 2000)
    write_section(os.path.join(folder, "section.poly"))
    write_fields(folder, 3, "")
    write_fields(folder, 2, "_2d")


if __name__ == "__main__":
    main()
