#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does VTK (and so ParaView) open a .vtu file, with its names and right-handed cells?

    vtk_check.py GRID.vtu [--names inlet,outlet,body]

Exit: 0 passed, 1 not, 77 VTK's Python module is not installed (Debian package python3-vtk9).
"""

import argparse
import collections
import sys

TYPES = {3: "lines", 5: "triangles", 7: "polygons", 9: "quads", 10: "tetrahedra", 12: "hexahedra", 13: "prisms",
         14: "pyramids", 42: "polyhedra"}


def read(path):
    """The grid, and what VTK complained about."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput(), window.GetOutput().strip()


def names_in(grid):
    """{name: (id, dimension)} of the groups: field data arrays called role:name that hold [id, dimension]."""
    fields = grid.GetFieldData()
    result = {}
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetArray(k)
        if array is not None and ":" in array.GetName() and array.GetNumberOfValues() == 2:
            result[array.GetName()] = (int(array.GetValue(0)), int(array.GetValue(1)))
    return result


def count_groups(grid, names):
    """Cells of each named group."""
    counts = {}
    for name, (number, _) in names.items():
        ids = grid.GetCellData().GetArray(name.split(":", 1)[0] + "_id")
        counts[name] = 0 if ids is None else sum(ids.GetValue(c) == number for c in range(grid.GetNumberOfCells()))
    return counts


def left_handed_tets(grid):
    from vtkmodules.vtkCommonDataModel import vtkTetra

    points = grid.GetPoints()
    count = 0
    for cell in range(grid.GetNumberOfCells()):
        if grid.GetCellType(cell) == 10:
            ids = grid.GetCell(cell).GetPointIds()
            count += vtkTetra.ComputeVolume(*(points.GetPoint(ids.GetId(k)) for k in range(4))) <= 0
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("grid")
    parser.add_argument("--names", default="", help="patches that must hold cells, commas between")
    options = parser.parse_args()
    try:
        import vtkmodules.vtkIOXML  # noqa: F401
    except ImportError:
        print("SKIPPED vtk_check: VTK's Python module is not installed (Debian package python3-vtk9)")
        return 77
    grid, complaints = read(options.grid)
    problems = complaints.splitlines()
    types = collections.Counter(grid.GetCellType(c) for c in range(grid.GetNumberOfCells()))
    print(f"{grid.GetNumberOfPoints()} points, "
          + ", ".join(f"{count} {TYPES.get(kind, f'type {kind}')}" for kind, count in sorted(types.items())))
    counts = count_groups(grid, names_in(grid))
    for name, count in sorted(counts.items()):
        print(f"  {name}: {count} cells")
    problems += [f"no cells of a patch called '{name}'" for name in filter(None, options.names.split(","))
                 if not counts.get(f"patch:{name}")]
    if not types:
        problems.append("no cells")
    turned = left_handed_tets(grid)
    if turned:
        problems.append(f"{turned} tetrahedra have no positive volume")
    for problem in problems:
        print(f"vtk_check: {problem}")
    print("vtk_check: FAILED" if problems else "vtk_check: OK")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
