# SPDX-License-Identifier: Apache-2.0
"""Time Gmsh's Min of Distance and Threshold fields at given places.

    gmsh_size_field.py SOURCES PLACES OUT       SOURCES: x y z delta0 r1 a line; PLACES: x y z a line; OUT: sizes

Gmsh's interface has no call that evaluates a field; its plugin MeshSizeFieldView does, at the points of a view of its
own mesh. The time of the plugin is that of the evaluation: each value costs one call of the field. Prints "build evaluate",
seconds of this process on its core.
"""

import sys
import time

import gmsh
import numpy as np

FAR = 1e3  # beyond all places: the threshold's ramp is delta0 (1 + r / r1) up to there


def make_view(places: np.ndarray, number: int) -> int:
    """The plugin wants a view on a mesh: one of points only."""
    entity = gmsh.model.addDiscreteEntity(0)
    first = 1 + 10**8 * number
    tags = np.arange(first, first + len(places))
    gmsh.model.mesh.addNodes(0, entity, tags, places.ravel())
    gmsh.model.mesh.addElementsByType(entity, 15, tags, tags)
    view = gmsh.view.add(f"places {number}")
    gmsh.view.addHomogeneousModelData(view, 0, gmsh.model.getCurrent(), "NodeData", tags, np.zeros(len(places)))
    return view


def run(view: int) -> np.ndarray:
    gmsh.plugin.setNumber("MeshSizeFieldView", "View", gmsh.view.getIndex(view))
    gmsh.plugin.run("MeshSizeFieldView")
    tag = gmsh.view.getTags()[-1]
    return gmsh.view.getHomogeneousModelData(tag, 0)[2]


def main() -> int:
    sources, places = np.loadtxt(sys.argv[1], ndmin=2), np.loadtxt(sys.argv[2], ndmin=2)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    started = time.process_time()
    field, thresholds = gmsh.model.mesh.field, []
    for x, y, z, delta0, r1 in sources:
        point = gmsh.model.geo.addPoint(x, y, z)
        near = field.add("Distance")
        field.setNumbers(near, "PointsList", [point])
        ramp = field.add("Threshold")
        for name, value in {
            "InField": near,
            "SizeMin": delta0,
            "SizeMax": delta0 * (1 + FAR / r1),
            "DistMin": 0,
            "DistMax": FAR,
        }.items():
            field.setNumber(ramp, name, value)
        thresholds.append(ramp)
    gmsh.model.geo.synchronize()
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", thresholds)
    gmsh.plugin.setNumber("MeshSizeFieldView", "MeshSizeField", least)
    # The first evaluation also builds what the fields keep; it is counted as building.
    run(make_view(places[:1], 1))
    built = time.process_time()
    view = make_view(places, 2)
    started_values = time.process_time()
    values = run(view)
    done = time.process_time()
    np.savetxt(sys.argv[3], values, fmt="%.17g")
    print(f"{built - started:.6f} {done - started_values:.6f}")
    gmsh.finalize()
    return 0


if __name__ == "__main__":
    sys.exit(main())
