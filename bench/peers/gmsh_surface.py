# SPDX-License-Identifier: Apache-2.0
"""Surface of a CAD file of one solid, by Gmsh with one size: the given surface of a benchmark.

    gmsh_surface.py MODEL.step TETS OUT.npz        points (n, 3), triangles (m, 3) from 0, normals outwards

The size is the edge for which a uniform filling of the solid has about so many tets: h^3 = 6 sqrt(2) volume / tets.
"""

import math
import sys

import gmsh
import numpy as np


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
    triangles = []
    for _, signed in gmsh.model.getBoundary(solids, oriented=True):
        _, nodes = gmsh.model.mesh.getElementsByType(2, abs(signed))
        part = place[nodes.astype(int)].reshape(-1, 3)
        triangles.append(part if signed > 0 else part[:, ::-1])
    triangles = np.concatenate(triangles)
    used, triangles = np.unique(triangles, return_inverse=True)
    points = np.asarray(coordinates).reshape(-1, 3)[used]
    np.savez(sys.argv[3], points=points, triangles=triangles.reshape(-1, 3))
    gmsh.finalize()
    return 0


if __name__ == "__main__":
    sys.exit(main())
