# SPDX-License-Identifier: Apache-2.0
"""Surface of a CAD file of one solid, by Gmsh with one size: the given surface of a benchmark.

    gmsh_surface.py MODEL.step TETS OUT.npz        points (n, 3), triangles (m, 3) from 0, turned alike

The size is the edge for which a uniform filling of the solid has about so many tets: h^3 = 6 sqrt(2) volume / tets.
"""

import math
import sys

import gmsh
import numpy as np


def make_alike(triangles: np.ndarray) -> np.ndarray:
    """Turn triangles of a closed surface so that both of an edge run along it in opposite directions."""
    directed = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    order = np.lexsort((directed.max(axis=1), directed.min(axis=1)))
    pairs = order.reshape(-1, 2)  # the two sides of each edge
    is_same = directed[pairs[:, 0], 0] == directed[pairs[:, 1], 0]
    beside = np.empty(len(directed), int)
    differs = np.empty(len(directed), bool)
    for one, other in ((0, 1), (1, 0)):
        beside[pairs[:, one]] = pairs[:, other] // 3
        differs[pairs[:, one]] = is_same
    beside, differs = beside.tolist(), differs.tolist()
    turned: list[bool | None] = [None] * len(triangles)
    for start in range(len(triangles)):
        if turned[start] is not None:
            continue
        turned[start], front = False, [start]
        while front:
            t = front.pop()
            for side in (3 * t, 3 * t + 1, 3 * t + 2):
                if turned[beside[side]] is None:
                    turned[beside[side]] = turned[t] != differs[side]
                    front.append(beside[side])
    return np.where(np.array(turned)[:, None], triangles[:, ::-1], triangles)


def main() -> int:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    gmsh.model.occ.importShapes(sys.argv[1])
    gmsh.model.occ.synchronize()
    solids = gmsh.model.getEntities(3)
    if len(solids) != 1:
        print(f"{len(solids)} solids instead of one", file=sys.stderr)
        return 1
    size = (gmsh.model.occ.getMass(*solids[0]) * 6 * math.sqrt(2) / float(sys.argv[2])) ** (1 / 3)
    for name in ("Mesh.MeshSizeMin", "Mesh.MeshSizeMax"):
        gmsh.option.setNumber(name, size)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, int)
    place[tags.astype(int)] = np.arange(len(tags))
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    used, triangles = np.unique(place[nodes.astype(int)], return_inverse=True)
    points = np.asarray(coordinates).reshape(-1, 3)[used]
    np.savez(sys.argv[3], points=points, triangles=make_alike(triangles.reshape(-1, 3)))
    gmsh.finalize()
    return 0


if __name__ == "__main__":
    sys.exit(main())
