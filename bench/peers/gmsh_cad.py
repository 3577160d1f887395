# SPDX-License-Identifier: Apache-2.0
"""Surface of a CAD file by Gmsh with its default surface mesher.

    gmsh_cad.py FILE OUT.npz size H       triangles of one size
    gmsh_cad.py FILE OUT.npz find N       the size for about N triangles first (uniform, a few runs), then as above
    ... --places K                        deviation of so many triangles' middles from their surface, after the clock

One thread. Prints one line of JSON: seconds of gridding (curves and surfaces), size, triangles, deviation.
"""

import json
import math
import sys
import time

import gmsh
import numpy as np

TRIES = 6
NEAR = 0.07  # of the count: near enough


def grid(size: float) -> float:
    """@return seconds"""
    gmsh.model.mesh.clear()
    for name in ("Mesh.MeshSizeMin", "Mesh.MeshSizeMax"):
        gmsh.option.setNumber(name, size)
    start = time.perf_counter()
    gmsh.model.mesh.generate(2)
    return time.perf_counter() - start


def count() -> int:
    return len(gmsh.model.mesh.getElementsByType(2)[0])


def find_size(wanted: int) -> float:
    """Counts go with 1 / h^2, the less so the more the edges of the model are shorter than that."""
    area = sum(gmsh.model.occ.getMass(2, tag) for _, tag in gmsh.model.getEntities(2))
    size = math.sqrt(area / wanted / (math.sqrt(3) / 4))
    best = (math.inf, size)
    for _ in range(TRIES):
        grid(size)
        ratio = count() / wanted
        best = min(best, (abs(math.log(ratio)), size))
        if best[0] < NEAR:
            break
        size *= math.sqrt(ratio)
    return best[1]


def deviation(places: int) -> float:
    """The largest distance of middles from their face, of up to so many a model, evenly taken."""
    worst, total = 0.0, count()
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    at = np.zeros((int(tags.max()) + 1, 3))
    at[tags.astype(int)] = np.asarray(coordinates).reshape(-1, 3)
    for _, face in gmsh.model.getEntities(2):
        _, nodes = gmsh.model.mesh.getElementsByType(2, face)
        middles = at[nodes.astype(int).reshape(-1, 3)].mean(axis=1)[:: max(1, total // places)]
        if len(middles):
            closest, _ = gmsh.model.getClosestPoint(2, face, middles.ravel())
            away = np.linalg.norm(np.asarray(closest).reshape(-1, 3) - middles, axis=1)
            worst = max(worst, float(away.max()))
    return worst


def main() -> int:
    file, out, task, number = *sys.argv[1:4], float(sys.argv[4])
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.model.occ.importShapes(file)
    gmsh.model.occ.synchronize()
    size = find_size(int(number)) if task == "find" else number
    seconds = grid(size)
    triangles = count()
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, int)
    place[tags.astype(int)] = np.arange(len(tags))
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    np.savez(out, points=np.asarray(coordinates).reshape(-1, 3), triangles=place[nodes.astype(int)].reshape(-1, 3))
    told = {"seconds": seconds, "size": size, "triangles": triangles}
    if "--places" in sys.argv:
        told["deviation"] = deviation(int(sys.argv[sys.argv.index("--places") + 1]))
    gmsh.finalize()
    print(json.dumps(told))
    return 0 if triangles else 1


if __name__ == "__main__":
    sys.exit(main())
