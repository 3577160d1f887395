# SPDX-License-Identifier: Apache-2.0
"""Surface of a CAD file by Netgen: its front on faces, with its usual two-dimensional optimiser.

    netgen_cad.py FILE OUT.npz size H SAFETY     largest side and its "curvaturesafety"
    netgen_cad.py FILE OUT.npz find N            the largest side for about N triangles first (a few runs); where its
                                                 sizes by curvature alone give more, a lower safety
    ... --places K                               deviation of so many triangles' middles, after the clock

One thread. Prints one line of JSON: seconds of gridding (curves and surfaces), size, safety, triangles, deviation.
"""

import json
import math
import sys
import time

import netgen.occ as occ
import numpy as np
import pyngcore
from netgen import meshing

TRIES = 6
NEAR = 0.08  # of the count: near enough
USUAL_SAFETY = 2.0


def grid(geometry, size: float, safety: float):
    """@return mesh, seconds"""
    start = time.perf_counter()
    mesh = geometry.GenerateMesh(
        meshing.MeshingParameters(maxh=size, curvaturesafety=safety, perfstepsend=meshing.MeshingStep.MESHSURFACE)
    )
    return mesh, time.perf_counter() - start


def find(geometry, wanted: int) -> tuple[float, float]:
    """@return size, safety"""
    area = sum(face.mass for face in geometry.shape.faces)
    usual = math.sqrt(area / wanted / (math.sqrt(3) / 4))
    size, safety, best = usual, USUAL_SAFETY, (math.inf, usual, USUAL_SAFETY)
    for _ in range(TRIES):
        mesh, _ = grid(geometry, size, safety)
        ratio = len(mesh.Elements2D()) / wanted
        best = min(best, (abs(math.log(ratio)), size, safety))
        if best[0] < NEAR:
            break
        if ratio > 1 and size > 3 * usual:  # longer sides do not lower the count any more
            safety /= 2
            size = usual
        size *= ratio
    return best[1:]


def deviation(geometry, mesh, points: np.ndarray, places: int) -> float:
    worst, elements = 0.0, list(mesh.Elements2D())
    faces = list(geometry.shape.faces)
    for element in elements[:: max(1, len(elements) // places)]:
        middle = points[[v.nr - 1 for v in element.vertices]].mean(axis=0)
        index = mesh.FaceDescriptor(element.index).surfnr - 1
        worst = max(worst, faces[index].Distance(occ.Vertex(occ.Pnt(*map(float, middle)))))
    return worst


def main() -> int:
    file, out, task, number = *sys.argv[1:4], float(sys.argv[4])
    meshing.SetMessageImportance(0)
    pyngcore.SetNumThreads(1)
    geometry = occ.OCCGeometry(file)
    size, safety = find(geometry, int(number)) if task == "find" else (number, float(sys.argv[5]))
    mesh, seconds = grid(geometry, size, safety)
    points = np.asarray(mesh.Coordinates())
    triangles = mesh.Elements2D().NumPy()["nodes"][:, :3].astype(np.int32) - 1
    np.savez(out, points=points, triangles=triangles)
    told = {"seconds": seconds, "size": size, "safety": safety, "triangles": len(triangles)}
    if "--places" in sys.argv:
        told["deviation"] = deviation(geometry, mesh, points, int(sys.argv[sys.argv.index("--places") + 1]))
    print(json.dumps(told))
    return 0 if len(triangles) else 1


if __name__ == "__main__":
    sys.exit(main())
