# SPDX-License-Identifier: Apache-2.0
"""CGNS files as other programs write them and ours does not: node by node, by h5py."""
import h5py
import numpy as np

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1], [0.5, 0.5, -1]])
# A pyramid on two tets, with the numbers of their types; and all faces outside.
VOLUME = [12, 1, 2, 3, 4, 5, 10, 1, 3, 2, 6, 10, 1, 4, 3, 6]
FACES = [[1, 2, 5], [2, 3, 5], [3, 4, 5], [4, 1, 5], [2, 1, 6], [3, 2, 6], [4, 3, 6], [1, 4, 6]]


def text(value, length):
    return np.bytes_(value.encode().ljust(length, b"\0"))


def add(parent, name, label, data=None):
    node = parent.create_group(name)
    kind = "MT"
    if isinstance(data, str):
        kind, data = "C1", np.frombuffer(data.encode(), dtype="i1")
    elif data is not None:
        kind = {"int32": "I4", "int64": "I8", "float32": "R4", "float64": "R8"}[data.dtype.name]
    for key, value in (("label", text(label, 33)), ("name", text(name, 33)), ("type", text(kind, 3))):
        node.attrs.create(key, value, dtype=f"S{3 if key == 'type' else 33}")
    node.attrs.create("flags", np.array([1], "i4"))
    if data is not None:
        node.create_dataset(" data", data=data)
    return node


def write(path, version=3.4, has_offsets=True, volume=VOLUME, offsets=(0, 6, 11, 16), wall=((1,), (2,), (3,), (4,)), family="wall"):
    """Cells of several types in one section; conditions by lists of faces. wall: numbers of faces, a row each."""
    ints = lambda values: np.array(values, "i4")
    with h5py.File(path, "w", libver=("earliest", "v108")) as file:
        for key, value, length in (("label", "Root Node of HDF5 File", 33), ("name", "HDF5 MotherNode", 33), ("type", "MT", 3)):
            file.attrs.create(key, text(value, length), dtype=f"S{length}")
        file.create_dataset(" format", data=np.frombuffer(b"IEEE_LITTLE_32\0", dtype="i1"))
        file.create_dataset(" hdf5version", data=np.frombuffer(b"HDF5 Version 1.8.17".ljust(33, b"\0"), dtype="i1"))
        add(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([version], "f4"))
        base = add(file, "Base", "CGNSBase_t", ints([3, 3]))
        add(add(base, family, "Family_t"), "FamBC", "FamilyBC_t", "BCWall")
        zone = add(base, "Zone", "Zone_t", ints([[len(POINTS)], [3], [0]]))
        add(zone, "ZoneType", "ZoneType_t", "Unstructured")
        coordinates = add(zone, "GridCoordinates", "GridCoordinates_t")
        for axis, values in zip("XYZ", POINTS.T):
            add(coordinates, f"Coordinate{axis}", "DataArray_t", np.ascontiguousarray(values))
        cells = add(zone, "Volume", "Elements_t", ints([20, 0]))
        add(cells, "ElementRange", "IndexRange_t", ints([9, 11]))
        add(cells, "ElementConnectivity", "DataArray_t", ints(volume))
        if has_offsets:
            add(cells, "ElementStartOffset", "DataArray_t", ints(offsets))
        faces = add(zone, "Surface", "Elements_t", ints([5, 0]))
        add(faces, "ElementRange", "IndexRange_t", ints([1, 8]))
        add(faces, "ElementConnectivity", "DataArray_t", ints(FACES).ravel())
        conditions = add(zone, "ZoneBC", "ZoneBC_t")
        for name, numbers in (("top", ints(wall)), ("under", ints([[5], [6], [7], [8]]))):
            condition = add(conditions, name, "BC_t", "FamilySpecified" if name == "top" else "BCFarfield")
            add(condition, "PointList", "IndexArray_t", numbers)
            add(condition, "GridLocation", "GridLocation_t", "FaceCenter")
            if name == "top":
                add(condition, "FamilyName", "FamilyName_t", family)
