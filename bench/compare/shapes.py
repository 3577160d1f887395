# SPDX-License-Identifier: Apache-2.0
"""Point sets and surfaces, and the files in which the tools are given them: the same doubles for every tool."""

import math
import struct
from pathlib import Path

import numpy as np

POINT_SETS = {
    "uniform": "uniform in the unit cube",
    "sphere": "on the unit sphere, rounded to doubles, directions uniform",
    "lattice": "a cubic lattice of integers, in random order",
    "graded": "radius 1e-5^u, u uniform in [0, 1], directions uniform: density ~ r^-3, spacing ~ r, h ratio 1e5",
}


def make_points(kind: str, count: int) -> np.ndarray:
    """One of POINT_SETS, shape (count, 3); the lattice rounds the count to a cube."""
    random = np.random.default_rng(3)
    if kind == "uniform":
        return random.random((count, 3))
    if kind == "lattice":
        side = round(count ** (1 / 3))
        lattice = np.stack(np.unravel_index(np.arange(side**3), (side,) * 3), axis=1).astype(float)
        return lattice[random.permutation(len(lattice))]
    points = random.standard_normal((count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    if kind == "graded":
        points *= (1e-5 ** random.random(count))[:, None]
    return points


def lines_of(pattern: str, table: np.ndarray, start: int | None = None):
    """The rows of a table as text, in parts; with `start`: numbered from there."""
    for first in range(0, len(table), 100_000):
        rows = table[first : first + 100_000].tolist()
        numbers = "" if start is None else "{} "
        if start is None:
            yield "".join([pattern % tuple(row) + "\n" for row in rows])
        else:
            yield "".join(
                [numbers.format(start + first + i) + pattern % tuple(row) + "\n" for i, row in enumerate(rows)]
            )


COORDINATES = "%.17g %.17g %.17g"


def write_node(path: Path, points: np.ndarray) -> None:
    """TetGen's .node."""
    with path.open("w") as file:
        file.write(f"{len(points)} 3 0 0\n")
        file.writelines(lines_of(COORDINATES, points, 0))


# --- surfaces ---------------------------------------------------------------------------------------------------------


def geodesic_sphere(frequency: int) -> tuple[np.ndarray, np.ndarray]:
    """Icosahedron with each face cut into frequency^2 triangles, on the unit sphere: points and triangles."""
    golden = (1 + 5**0.5) / 2
    corners = [[-1, golden, 0], [1, golden, 0], [-1, -golden, 0], [1, -golden, 0], [0, -1, golden], [0, 1, golden]]
    corners += [[0, -1, -golden], [0, 1, -golden], [golden, 0, -1], [golden, 0, 1], [-golden, 0, -1], [-golden, 0, 1]]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
    faces += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
    faces += [(8, 6, 7), (9, 8, 1)]
    f = frequency
    i, j = (a.ravel() for a in np.meshgrid(np.arange(f + 1), np.arange(f + 1), indexing="ij"))
    inside = i + j <= f
    i, j = i[inside], j[inside]
    number = np.full((f + 1, f + 1), -1)
    number[i, j] = np.arange(len(i))
    up = number[i, j][i + j < f], number[i + 1 - (i + j >= f), j][i + j < f], number[i, j + 1 - (i + j >= f)][i + j < f]
    low = i + j < f - 1
    down = number[i[low] + 1, j[low]], number[i[low] + 1, j[low] + 1], number[i[low], j[low] + 1]
    pattern = np.concatenate([np.stack(up, axis=1), np.stack(down, axis=1)])
    weights = np.stack([f - i - j, i, j], axis=1)
    keys, triangles = [], []
    for n, face in enumerate(faces):
        key = np.zeros((len(i), 12), int)  # integer barycentric weights of the 12 corners: equal on shared edges
        key[:, face] = weights
        keys.append(key)
        triangles.append(pattern + n * len(i))
    unique, inverse = np.unique(np.concatenate(keys), axis=0, return_inverse=True)
    points = unique @ np.array(corners, float)
    return points / np.linalg.norm(points, axis=1, keepdims=True), inverse.reshape(-1)[np.concatenate(triangles)]


def read_surface(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Binary STL, OBJ or OFF of triangles; equal points are one."""
    data = path.read_bytes()
    if path.suffix.lower() == ".stl" and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        facets = np.frombuffer(data, np.dtype([("f", "<f4", 12), ("a", "<u2")]), offset=84)
        places = facets["f"][:, 3:].reshape(-1, 3).astype(float)
        triangles = np.arange(len(places)).reshape(-1, 3)
    elif path.suffix.lower() == ".stl":
        rows = [line.split()[1:] for line in data.decode().splitlines() if line.split()[:1] == ["vertex"]]
        places, triangles = np.array(rows, float), np.arange(len(rows)).reshape(-1, 3)
    elif path.suffix.lower() == ".obj":
        words = [line.split() for line in data.decode().splitlines() if line[:2] in ("v ", "f ")]
        places = np.array([w[1:4] for w in words if w[0] == "v"], float)
        triangles = np.array([[int(corner.split("/")[0]) - 1 for corner in w[1:4]] for w in words if w[0] == "f"])
    else:
        words = data.decode().split()[1:]
        n, m = int(words[0]), int(words[1])
        places = np.array(words[3 : 3 + 3 * n], float).reshape(n, 3)
        triangles = np.array(words[3 + 3 * n : 3 + 3 * n + 4 * m], int).reshape(m, 4)[:, 1:]
    points, inverse = np.unique(places, axis=0, return_inverse=True)
    return points, inverse.reshape(-1)[triangles]


def split_long_edges(points: np.ndarray, triangles: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Halve the longest edge of triangles until no edge is longer than `length`.

    An edge is halved when it is the longest of all its triangles, so no angle gets much smaller than the smallest
    given, and needles become less thin (Rivara 1984). Halving keeps flat facets flat; the coordinates of a 32-bit STL
    are halved without rounding.
    """
    while True:
        ends = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
        edges, edge_of_side = np.unique(ends[:, 0] * len(points) + ends[:, 1], return_inverse=True)
        first, second = edges // len(points), edges % len(points)
        lengths = np.linalg.norm(points[first] - points[second], axis=1)
        rank = np.empty(len(edges), int)
        rank[np.lexsort((np.arange(len(edges)), lengths))] = np.arange(len(edges))
        sides = edge_of_side.reshape(-1, 3)
        longest = rank[sides].argmax(axis=1)
        longest_edge = sides[np.arange(len(sides)), longest]
        wanted = np.bincount(longest_edge, minlength=len(edges)) == np.bincount(edge_of_side, minlength=len(edges))
        wanted &= lengths > length
        if not wanted.any():
            return points, triangles
        middle = np.cumsum(wanted) - 1 + len(points)
        split = wanted[longest_edge]
        corner = np.take_along_axis(triangles, (longest[:, None] + np.arange(3)) % 3, axis=1)[split]
        new = middle[longest_edge[split]]
        halves = [
            np.stack([corner[:, 0], corner[:, 1], new], axis=1),
            np.stack([corner[:, 0], new, corner[:, 2]], axis=1),
        ]
        points = np.concatenate([points, (points[first[wanted]] + points[second[wanted]]) / 2])
        triangles = np.concatenate([triangles[~split], *halves])


def enclosed_volume(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (points[triangles[:, i]] - points.mean(axis=0) for i in range(3))
    return abs(float(np.einsum("ij,ij->i", np.cross(a, b), c).sum() / 6))


def mean_edge(points: np.ndarray, triangles: np.ndarray) -> float:
    return float(np.linalg.norm(points[triangles] - points[np.roll(triangles, 1, axis=1)], axis=2).mean())


def refine_to(points: np.ndarray, triangles: np.ndarray, tets: float) -> tuple[np.ndarray, np.ndarray]:
    """The surface with edges such that a uniform filling of its volume by them has about so many tets.

    A tet with edges of the surface's mean length h has about h^3 / (6 sqrt 2) of volume. A surface that is finer
    already stays as it is.
    """
    wanted = (enclosed_volume(points, triangles) * 6 * math.sqrt(2) / tets) ** (1 / 3)
    length = 1.4 * wanted
    for _ in range(4):
        refined = split_long_edges(points, triangles, length)
        length *= wanted / mean_edge(*refined)
        if len(refined[1]) == len(triangles):
            break
    return refined


def write_surface(folder: Path, points: np.ndarray, triangles: np.ndarray, parts: np.ndarray | None = None) -> None:
    """The same surface as OFF (delfront), .smesh (TetGen) and medit .mesh with a .geo (Gmsh).

    `parts`: number of each triangle's closed surface, from 0: the outer one, then those of holes (of which TetGen's
    file says nothing).
    """
    n, m = len(points), len(triangles)
    parts = np.zeros(m, int) if parts is None else parts
    with (folder / "s.off").open("w") as file:
        file.write(f"OFF\n{n} {m} 0\n")
        file.writelines(lines_of(COORDINATES, points))
        file.writelines(lines_of("3 %d %d %d", triangles))
    with (folder / "s.smesh").open("w") as file:
        file.write(f"{n} 3 0 0\n")
        file.writelines(lines_of(COORDINATES, points, 0))
        file.write(f"{m} 0\n")
        file.writelines(lines_of("3 %d %d %d", triangles))
        file.write("0\n0\n")
    with (folder / "s.mesh").open("w") as file:
        file.write(f"MeshVersionFormatted 2\nDimension\n3\nVertices\n{n}\n")
        file.writelines(lines_of(COORDINATES + " 1", points))
        file.write(f"Triangles\n{m}\n")
        file.writelines(lines_of("%d %d %d %d", np.column_stack([triangles, parts]) + 1))
        file.write("End\n")
    numbers = range(1, int(parts.max()) + 2)
    (folder / "fill.geo").write_text(
        'Merge "s.mesh";\n'
        + "".join(f"Surface Loop({k}) = {{{k}}};\n" for k in numbers)
        + f"Volume(1) = {{{', '.join(map(str, numbers))}}};\nMesh.MeshSizeExtendFromBoundary = 1;\n"
    )
