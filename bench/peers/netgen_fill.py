# SPDX-License-Identifier: Apache-2.0
"""Fills a closed surface of triangles with Netgen.

    netgen_fill.py SURFACE.off OUT.npz front|delaunay MAXH GRADING STEPS

"front" is its pure front, "delaunay" its default: points inserted by Delaunay, the front closes the rest. STEPS: of its
optimiser, 0 for none. The triangles face out of the volume. Prints one line of JSON: seconds of gridding and of
optimising, and the tets; one thread. OUT.npz has points and tets from 0.
"""

import json
import sys
import time

import netgen.meshing as netgen
import numpy as np
import pyngcore


def read_off(name: str) -> tuple[np.ndarray, np.ndarray]:
    with open(name, encoding="ascii") as file:
        words = file.read().split()[1:]
    n, m = int(words[0]), int(words[1])
    points = np.array(words[3 : 3 + 3 * n], float).reshape(n, 3)
    return points, np.array(words[3 + 3 * n : 3 + 3 * n + 4 * m], np.int32).reshape(m, 4)[:, 1:].copy()


def main() -> int:
    surface, out, method = sys.argv[1:4]
    maxh, grading, steps = float(sys.argv[4]), float(sys.argv[5]), int(sys.argv[6])
    points, triangles = read_off(surface)
    netgen.SetMessageImportance(0)
    pyngcore.SetNumThreads(1)
    mesh = netgen.Mesh(dim=3)
    mesh.AddPoints(points)
    face = mesh.Add(netgen.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    mesh.AddElements(dim=2, index=face, data=triangles, base=0)
    parameters = {"maxh": maxh, "grading": grading, "delaunay": method == "delaunay"}
    start = time.perf_counter()
    mesh.GenerateVolumeMesh(optsteps3d=0, **parameters)
    seconds = time.perf_counter() - start
    start = time.perf_counter()
    if steps:
        mesh.OptimizeVolumeMesh(netgen.MeshingParameters(optsteps3d=steps, **parameters))
    improve = time.perf_counter() - start
    tets = mesh.Elements3D().NumPy()["nodes"].astype(np.int32) - 1
    np.savez(out, points=np.asarray(mesh.Coordinates()), tets=tets)
    print(json.dumps({"seconds": seconds, "improve": improve, "tets": len(tets)}))
    return 0 if len(tets) else 1


if __name__ == "__main__":
    sys.exit(main())
