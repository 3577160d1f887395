# SPDX-License-Identifier: Apache-2.0
"""Times hxtDelaunay, the Delaunay kernel of HXT, in Debian's libgmsh 4.8 (PyPI's Gmsh hides it).

    hxt_delaunay.py POINTS.f64 THREADS

POINTS.f64: coordinates x y z as doubles. Prints one line of JSON; "seconds" is the call alone. The structures are the
beginnings of HXTMesh and HXTDelaunayOptions as that version lays them out. Debian builds it for any x86-64.
"""

import ctypes
import json
import os
import sys
import time

import numpy as np

LIBRARY = "libgmsh.so.4.8"
PART = 250_000


class Vertices(ctypes.Structure):
    _fields_ = [("coordinates", ctypes.c_void_p), ("num", ctypes.c_uint32), ("size", ctypes.c_uint32)]


class Tetrahedra(ctypes.Structure):
    _fields_ = [("node", ctypes.POINTER(ctypes.c_uint32)), ("neigh", ctypes.c_void_p), ("colour", ctypes.c_void_p)]
    _fields_ += [("flag", ctypes.c_void_p), ("num", ctypes.c_uint64), ("size", ctypes.c_uint64)]


class Mesh(ctypes.Structure):
    _fields_ = [("vertices", Vertices), ("tetrahedra", Tetrahedra)]


class Options(ctypes.Structure):
    _fields_ = [("box", ctypes.c_void_p), ("sizes", ctypes.c_void_p), ("in_mesh", ctypes.c_uint32)]
    _fields_ += [("first", ctypes.c_uint32), ("partitionability", ctypes.c_double), ("perfect", ctypes.c_int)]
    _fields_ += [("verbosity", ctypes.c_int), ("reproducible", ctypes.c_int), ("threads", ctypes.c_int)]


def main() -> int:
    points, threads = np.fromfile(sys.argv[1]).reshape(-1, 3), int(sys.argv[2])
    hxt, libc = ctypes.CDLL(LIBRARY), ctypes.CDLL(None)
    mesh = ctypes.POINTER(Mesh)()
    if hxt.hxtMeshCreate(ctypes.byref(mesh)) != 0:
        return 1
    libc.aligned_alloc.restype = ctypes.c_void_p
    place = libc.aligned_alloc(ctypes.c_size_t(64), ctypes.c_size_t((len(points) * 32 + 63) // 64 * 64))
    vertices = mesh.contents.vertices
    vertices.coordinates, vertices.num, vertices.size = place, len(points), len(points)
    coordinates = np.ctypeslib.as_array(ctypes.cast(place, ctypes.POINTER(ctypes.c_double)), (len(points), 4))
    coordinates[:, :3] = points
    options = Options(perfect=1, threads=threads)
    start = time.perf_counter()
    status = hxt.hxtDelaunay(mesh, ctypes.byref(options))
    seconds = time.perf_counter() - start
    if status != 0:
        return 1
    tetrahedra = mesh.contents.tetrahedra
    nodes = np.ctypeslib.as_array(tetrahedra.node, (tetrahedra.num, 4))
    tets, volume = 0, 0.0
    for first in range(0, len(nodes), PART):
        part = nodes[first : first + PART]
        corner = coordinates[part[part.max(axis=1) < len(points)]][:, :, :3]
        a, b, c = (corner[:, i] - corner[:, 0] for i in (1, 2, 3))
        tets += len(corner)
        volume += float(np.abs(np.einsum("ij,ij->i", np.cross(a, b), c)).sum() / 6)
    print(json.dumps({"seconds": seconds, "points": int(vertices.num), "tets": tets, "volume": volume}), flush=True)
    os._exit(0)  # the mesh is not ours to free


if __name__ == "__main__":
    sys.exit(main())
