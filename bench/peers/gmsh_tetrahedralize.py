# SPDX-License-Identifier: Apache-2.0
"""Times gmsh.algorithm.tetrahedralize on points.

    gmsh_tetrahedralize.py POINTS.f64 ALGORITHM THREADS

ALGORITHM is Mesh.Algorithm3D: 10 takes HXT's way, 1 Gmsh's own Delaunay. Prints one line of JSON; "seconds" is the
wall time that Gmsh itself prints ("Done tetrahedrizing"), which has the copying to and from its own structures in it.
"""

import json
import re
import sys

import gmsh
import numpy as np

PART = 250_000


def main() -> int:
    points = np.fromfile(sys.argv[1]).reshape(-1, 3)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Algorithm3D", int(sys.argv[2]))
    gmsh.option.setNumber("General.NumThreads", int(sys.argv[3]))
    gmsh.option.setNumber("Mesh.MaxNumThreads3D", int(sys.argv[3]))
    gmsh.logger.start()
    nodes, steiner = gmsh.algorithm.tetrahedralize(points.ravel())
    log = "\n".join(gmsh.logger.get())
    nodes = np.asarray(nodes).reshape(-1, 4)
    found = re.findall(r"Done tetrahedrizing.*?\(Wall ([\d.eE+-]+)s", log)
    volume = 0.0
    for first in range(0, len(nodes), PART):
        corner = points[nodes[first : first + PART].astype(np.int64) - 1]
        a, b, c = (corner[:, i] - corner[:, 0] for i in (1, 2, 3))
        volume += float(np.abs(np.einsum("ij,ij->i", np.cross(a, b), c)).sum() / 6)
    seconds = float(found[-1]) if found else None
    print(json.dumps({"seconds": seconds, "points": len(points), "tets": len(nodes), "volume": volume}))
    gmsh.finalize()
    return 0


if __name__ == "__main__":
    sys.exit(main())
