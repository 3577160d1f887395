#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files of other programs go in, and other programs take ours: meshio, VTK, netCDF, Gmsh, cgnscheck, OpenFOAM.

usage: test_formats.py DELFRONT [unittest arguments]; what needs a program that is missing is skipped by name.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

DELFRONT = sys.argv.pop(1)

try:
    import meshio
    import numpy as np
except ImportError:
    meshio = None

try:
    import h5py
    import netCDF4
except ImportError:
    netCDF4 = None

# VTK's own opinion of a file, or a file of its own: an OPERATION, then paths; prints cells by type and their volume.
VTK_SCRIPT = """
import sys
import vtk
operation, source, *target = sys.argv[1:]
reader = getattr(vtk, {"xdmf": "vtkXdmfReader", "vtkhdf": "vtkHDFReader", "e": "vtkExodusIIReader",
                       "vtu": "vtkXMLUnstructuredGridReader"}[source.rsplit(".")[-1]], None)
if not reader:
    sys.exit(77)
reader = reader()
reader.SetFileName(source)
if operation == "exodus":
    reader.UpdateInformation()
    for kind in (vtk.vtkExodusIIReader.ELEM_BLOCK, vtk.vtkExodusIIReader.SIDE_SET):
        for i in range(reader.GetNumberOfObjects(kind)):
            reader.SetObjectStatus(kind, i, 1)
            print("object", reader.GetObjectName(kind, i), reader.GetNumberOfEntriesInObject(kind, i))
reader.Update()
data = reader.GetOutputDataObject(0)
if operation == "write_vtkhdf":
    if not hasattr(vtk, "vtkHDFWriter"):
        sys.exit(77)
    writer = vtk.vtkHDFWriter()
    writer.SetFileName(target[0])
    writer.SetCompressionLevel(int(target[1]))
elif operation == "write_xdmf":
    writer = vtk.vtkXdmfWriter()
    writer.SetFileName(target[0])
elif operation == "write_exodus":
    writer = vtk.vtkExodusIIWriter()
    writer.SetFileName(target[0])
else:
    writer = None
if writer:
    writer.SetInputData(data)
    sys.exit(0 if writer.Write() else 1)
while data.IsA("vtkMultiBlockDataSet"):  # the first of the blocks that hold something
    data = next(data.GetBlock(i) for i in range(data.GetNumberOfBlocks())
                if data.GetBlock(i) and data.GetBlock(i).GetNumberOfElements(0) + data.GetBlock(i).GetNumberOfElements(1) > 0)
sizes = vtk.vtkCellSizeFilter()
sizes.SetInputData(data)
sizes.Update()
volumes = sizes.GetOutput().GetCellData().GetArray("Volume")
for i in range(data.GetNumberOfCells()):
    print("cell", data.GetCellType(i), round(abs(volumes.GetValue(i)), 6))
for attributes in (data.GetCellData(), data.GetFieldData()):
    for i in range(attributes.GetNumberOfArrays()):
        print("array", attributes.GetArrayName(i))
"""

GEO = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 0.5, 0.25};
Physical Volume("air") = {1};
Physical Surface("left") = {1};
Physical Surface("rest") = {2, 3, 4, 5, 6};
Mesh.MeshSizeMax = 0.2;
"""

# A hexahedron, a prism beside it and a pyramid on it, faces of two references.
POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
          [2, 0.5, 0], [2, 0.5, 1], [0.5, 0.5, 1.7]]
CELLS = [("quad", [[0, 3, 2, 1], [0, 4, 7, 3]]), ("triangle", [[1, 2, 8], [4, 5, 10]]),
         ("hexahedron", [[0, 1, 2, 3, 4, 5, 6, 7]]), ("wedge", [[1, 8, 2, 5, 9, 6]]), ("pyramid", [[4, 5, 6, 7, 10]])]
VOLUMES = {"hexahedron": 1, "wedge": 1, "pyramid": 1}


def run(*command, cwd=None):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=300, cwd=cwd)
    return done.returncode, done.stdout + done.stderr


def counts(path, file_format=None):
    mesh = meshio.read(path, file_format=file_format) if file_format else meshio.read(path)
    found = {}
    for block in mesh.cells:
        found[block.type] = found.get(block.type, 0) + len(block.data)
    return mesh, found


@unittest.skipUnless(meshio, "meshio is not installed (Debian python3-meshio)")
class Formats(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def convert(self, source, target, *more):
        status, text = run(DELFRONT, "convert", source, target, *more)
        self.assertEqual(status, 0, f"{source} -> {target}: {text}")
        return text

    def mixed(self, leave_out="", has_references=True):
        cells = [(t, c) for t, c in CELLS if t != leave_out]
        mesh = meshio.Mesh(np.array(POINTS, dtype=float), [(t, np.array(c)) for t, c in cells])
        if has_references:
            mesh.cell_data["medit:ref"] = [np.full(len(c), i + 1) for i, (_, c) in enumerate(cells)]
        return mesh

    def signed_volumes(self, mesh):
        for block in mesh.cells:
            corners = mesh.points[block.data]
            if block.type in ("hexahedron", "pyramid"):
                a, b, c = corners[:, 1], corners[:, 3], corners[:, 4]
            elif block.type in ("tetra", "wedge"):
                a, b, c = corners[:, 1], corners[:, 2], corners[:, 3]
            else:
                continue
            o = corners[:, 0]
            yield from np.einsum("ij,ij->i", np.cross(a - o, b - o), c - o)

    def check_mixed(self, path, name, file_format=None, leave_out=""):
        mesh, found = counts(path, file_format)
        for kind, number in VOLUMES.items():
            if kind == leave_out:
                continue
            self.assertEqual(found.get(kind), number, f"{name}: {kind}")
        np.testing.assert_allclose(mesh.points, POINTS, atol=1e-10, err_msg=name)
        self.assertTrue(all(v > 0 for v in self.signed_volumes(mesh)), f"{name}: a cell is turned over")

    def test_files_of_meshio_are_read(self):
        files = {"a.bdf": "nastran", "a.inp": "abaqus", "a.ugrid": "ugrid", "a.b8.ugrid": "ugrid", "a.lb8.ugrid": "ugrid",
                 "a.lb4.ugrid": "ugrid", "a.meshb": "medit"}
        for name, file_format in files.items():
            with self.subTest(name):
                path = self.folder / name
                # Its Abaqus has no pyramids, and its UGRID fails on references of two blocks.
                leave_out = "pyramid" if file_format == "abaqus" else ""
                meshio.write(path, self.mixed(leave_out, file_format in ("nastran", "medit")), file_format=file_format)
                self.convert(path, self.folder / "back.msh")
                self.check_mixed(self.folder / "back.msh", name, None, leave_out)

    def test_meshio_reads_ours(self):
        for name, file_format in {"b.bdf": "nastran", "b.ugrid": "ugrid", "b.b8.ugrid": "ugrid", "b.lb8.ugrid": "ugrid",
                                  "b.meshb": "medit", "b.inp": "abaqus"}.items():
            with self.subTest(name):
                leave_out = "pyramid" if file_format == "abaqus" else ""
                meshio.write(self.folder / "a.mesh", self.mixed(leave_out), file_format="medit")
                self.convert(self.folder / "a.mesh", self.folder / name)
                self.check_mixed(self.folder / name, name, file_format, leave_out)

    def gmsh_box(self, extension, like=None):
        """A box by the program that writes the type `like`, which must be one for grids that are compared."""
        # Debian's writes no CGNS, the one of PyPI (scripts/setup --peers) does.
        peers = pathlib.Path(os.environ.get("DELFRONT_PEERS") or pathlib.Path(__file__).parents[2] / "build" / "peers")
        own = peers / "venv" / "bin" / "gmsh"
        program = [own.parent / "python3", own] if "cgns" in (extension, like) and own.exists() else [shutil.which("gmsh")]
        if not program[0]:
            self.skipTest("gmsh is not installed (scripts/setup --peers)")
        (self.folder / "box.geo").write_text(GEO)
        path = self.folder / f"box.{extension}"
        status, text = run(*program, "-3", "-v", "1", self.folder / "box.geo", "-o", path)
        if status != 0 or not path.exists():
            self.skipTest(f"this gmsh writes no {extension}: {text[-200:]}")
        return path

    def test_hdf5_and_netcdf_files_of_meshio_are_read(self):
        if not netCDF4:
            self.skipTest("h5py and netCDF4 are not installed (Debian python3-h5py, python3-netcdf4)")
        if "xdmf" not in run(DELFRONT, "--help")[1]:
            self.skipTest("built without HDF5")
        for name, options in (("a.xdmf", {}), ("x.xdmf", {"data_format": "XML"}), ("a.e", {})):
            with self.subTest(name):
                meshio.write(self.folder / name, self.mixed(has_references=False), **options)
                self.convert(self.folder / name, self.folder / "back.msh")
                self.check_mixed(self.folder / "back.msh", name)

    def test_meshio_reads_our_hdf5_and_netcdf(self):
        if not netCDF4:
            self.skipTest("h5py and netCDF4 are not installed (Debian python3-h5py, python3-netcdf4)")
        meshio.write(self.folder / "a.mesh", self.mixed(), file_format="medit")
        for name in ("b.xdmf", "b.e"):
            with self.subTest(name):
                if name == "b.xdmf" and "xdmf" not in run(DELFRONT, "--help")[1]:
                    self.skipTest("built without HDF5")
                self.convert(self.folder / "a.mesh", self.folder / name)
                self.check_mixed(self.folder / name, name)
        mesh = meshio.read(self.folder / "b.xdmf")
        self.assertEqual(list(mesh.field_data["patch:patch_1"]), [0, 2])

    def test_exodus_in_every_netcdf(self):
        if not netCDF4:
            self.skipTest("netCDF4 is not installed (Debian python3-netcdf4)")
        meshio.write(self.folder / "a.mesh", self.mixed(), file_format="medit")
        self.convert(self.folder / "a.mesh", self.folder / "a.e")
        wanted = run(DELFRONT, "convert", self.folder / "a.e", self.folder / "wanted.vtu")
        self.assertEqual(wanted[0], 0, wanted[1])
        for version in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4", "NETCDF4_CLASSIC"):
            with self.subTest(version):
                if version.startswith("NETCDF4") and "vtkhdf" not in run(DELFRONT, "--help")[1]:
                    self.skipTest("built without HDF5")
                copy = self.folder / f"{version}.e"
                self.copy_netcdf(self.folder / "a.e", copy, version)
                self.convert(copy, self.folder / "got.vtu")
                self.assertEqual((self.folder / "got.vtu").read_bytes(), (self.folder / "wanted.vtu").read_bytes())

    def copy_netcdf(self, source, target, version):
        with netCDF4.Dataset(source) as old, netCDF4.Dataset(target, "w", format=version) as new:
            old.set_auto_maskandscale(False)
            new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
            for name, dimension in old.dimensions.items():
                new.createDimension(name, None if dimension.isunlimited() else len(dimension))
            for name, variable in old.variables.items():
                copied = new.createVariable(name, variable.dtype, variable.dimensions,
                                            **({"zlib": True} if version == "NETCDF4" else {}))
                copied.set_auto_maskandscale(False)
                copied.setncatts({key: variable.getncattr(key) for key in variable.ncattrs()})
                if len(variable):
                    copied[:] = variable[:]

    def vtk(self, operation, *paths, newer=False):
        """What VTK says; Debian's where `newer` does not ask for PyPI's (scripts/setup --peers), which has XDMF."""
        peers = pathlib.Path(os.environ.get("DELFRONT_PEERS") or pathlib.Path(__file__).parents[2] / "build" / "peers")
        python = peers / "venv" / "bin" / "python3" if newer else sys.executable
        if run(python, "-c", "import vtk")[0] != 0 if pathlib.Path(python).exists() else True:
            self.skipTest("VTK is not installed (Debian python3-vtk9; of PyPI by scripts/setup --peers)")
        status, text = run(python, "-c", VTK_SCRIPT, operation, *paths)
        if status == 77:
            self.skipTest(f"this VTK cannot {operation} {paths[0]}")
        self.assertEqual(status, 0, text)
        return text

    def check_vtk(self, text):
        found = sorted(line.split()[1:] for line in text.splitlines() if line.startswith("cell"))
        self.assertEqual(found, [["12", "1.0"], ["13", "0.5"], ["14", "0.233333"], ["5", "0.0"], ["5", "0.0"], ["9", "0.0"],
                                 ["9", "0.0"]])
        for name in ("region_id", "patch_id"):
            self.assertIn(f"array {name}", text)

    def mixed_in(self, name, leave_out=""):
        if name.endswith(("vtkhdf", "xdmf")) and "vtkhdf" not in run(DELFRONT, "--help")[1]:
            self.skipTest("built without HDF5")
        meshio.write(self.folder / "a.mesh", self.mixed(leave_out), file_format="medit")
        self.convert(self.folder / "a.mesh", self.folder / name)
        return self.folder / name

    def test_vtk_reads_our_vtkhdf(self):
        text = self.vtk("look", self.mixed_in("a.vtkhdf"))
        self.check_vtk(text)
        self.assertIn("array patch:patch_2", text)

    def test_newer_vtk_reads_our_vtkhdf_and_xdmf(self):
        self.check_vtk(self.vtk("look", self.mixed_in("a.vtkhdf"), newer=True))
        self.check_vtk(self.vtk("look", self.mixed_in("a.xdmf"), newer=True))

    def test_vtk_reads_our_exodus_with_its_names(self):
        text = self.vtk("exodus", self.mixed_in("a.e"))
        for line in ("object patch_1 2", "object patch_2 2", "object region_3 1", "object region_4 1", "object region_5 1"):
            self.assertIn(line, text)

    def test_files_of_vtk_are_read(self):
        # Its XDMF has quads of mixed grids as polygons without a count, which it cannot read either; PyPI's 9.7 falls over
        # Exodus.
        for operation, name, newer, *more in (("write_vtkhdf", "v.vtkhdf", True, "0"), ("write_vtkhdf", "z.vtkhdf", True, "5"),
                                              ("write_xdmf", "v.xdmf", True), ("write_exodus", "v.e", False)):
            with self.subTest(name):
                source = self.mixed_in("a.vtu", "quad" if name == "v.xdmf" else "")
                self.vtk(operation, source, self.folder / name, *more, newer=newer)
                self.convert(self.folder / name, self.folder / "back.msh")
                self.check_mixed(self.folder / "back.msh", name)

    def test_files_of_gmsh_are_read(self):
        for extension in ("bdf", "inp", "mesh", "cgns"):
            with self.subTest(extension):
                path = self.gmsh_box(extension)
                if extension == "cgns" and "cgns" not in run(DELFRONT, "--help")[1]:
                    self.skipTest("built without the CGNS library")
                _, wanted = counts(self.gmsh_box("msh", like=extension))
                self.convert(path, self.folder / "back.msh")
                mesh, found = counts(self.folder / "back.msh")
                self.assertEqual(found.get("tetra"), wanted["tetra"])
                self.assertTrue(all(v > 0 for v in self.signed_volumes(mesh)))
                if extension in ("inp", "cgns"):  # the others of its formats hold no names
                    self.assertLessEqual({"air", "left", "rest"}, set(mesh.field_data))

    def test_gmsh_reads_ours(self):
        path = self.gmsh_box("msh")
        _, wanted = counts(path)
        self.convert(path, self.folder / "b.bdf")
        status, text = run("gmsh", "-v", "2", self.folder / "b.bdf", "-0", "-o", self.folder / "read.msh")
        self.assertEqual(status, 0, text)
        self.assertNotIn("Error", text)
        self.assertEqual(counts(self.folder / "read.msh")[1].get("tetra"), wanted["tetra"], text)

    def cgns_files(self):
        if not netCDF4:
            self.skipTest("h5py and netCDF4 are not installed (Debian python3-h5py, python3-netcdf4)")
        if "cgns" not in run(DELFRONT, "--help")[1]:
            self.skipTest("built without the CGNS library")
        import cgns_files
        return cgns_files

    def test_cgns_with_several_types_in_a_section_and_of_later_versions_is_read(self):
        cgns_files = self.cgns_files()
        before = set(pathlib.Path(tempfile.gettempdir()).glob("delfront_??????"))
        for version, has_offsets in ((3.1, False), (3.4, True), (4.0, True), (4.5, True)):
            with self.subTest(version):
                cgns_files.write(self.folder / "a.cgns", version, has_offsets)
                written = (self.folder / "a.cgns").read_bytes()
                self.convert(self.folder / "a.cgns", self.folder / "back.msh")
                mesh, found = counts(self.folder / "back.msh")
                self.assertEqual({key: found[key] for key in ("pyramid", "tetra", "triangle")},
                                 {"pyramid": 1, "tetra": 2, "triangle": 8})
                self.assertLessEqual({"wall", "under"}, set(mesh.field_data))
                self.assertTrue(all(v > 0 for v in self.signed_volumes(mesh)))
                self.assertEqual((self.folder / "a.cgns").read_bytes(), written)
        self.assertEqual(set(pathlib.Path(tempfile.gettempdir()).glob("delfront_??????")), before)

    def test_cgns_arrays_of_a_wrong_size_are_refused_or_read_safely(self):
        cgns_files = self.cgns_files()
        lists = np.arange(1, 301, dtype="i4")
        # What is wrong, and the status: 0 where it does not matter.
        for change, wanted in (({"wall": lists.reshape(3, 100)}, 3), ({"wall": lists.reshape(100, 3)}, 3),
                               ({"volume": [10, 1, 2, 3]}, 3), ({"volume": [99] + cgns_files.VOLUME[1:]}, 3),
                               ({"volume": [-7] + cgns_files.VOLUME[1:]}, 3), ({"offsets": range(500)}, 0),
                               ({"family": "/Base/" + "x" * 30}, 0), ({"version": 4.2, "wall": lists.reshape(3, 100)}, 3)):
            with self.subTest(str(change)[:60]):
                family = change.pop("family", "wall")
                cgns_files.write(self.folder / "a.cgns", family=family.replace("/", "_")[-32:], **change)
                if "/" in family:  # the way to a family, of any length
                    with h5py.File(self.folder / "a.cgns", "a") as file:
                        node = file["Base/Zone/ZoneBC/top/FamilyName"]
                        del node[" data"]
                        node.create_dataset(" data", data=np.frombuffer((family + "/" + "y" * 500).encode(), dtype="i1"))
                status, said = run(DELFRONT, "convert", self.folder / "a.cgns", self.folder / "back.msh")
                self.assertEqual(status, wanted, said)
                if wanted:
                    self.assertIn("a.cgns", said)
                    self.assertNotIn("crash", said)

    def test_cgns_files_that_lack_something_are_refused_or_it_is_said(self):
        cgns_files = self.cgns_files()

        def without(name):
            return lambda file: file.__delitem__(f"Base/Zone/{name}")

        def changed(name, values):
            def change(file):
                file[f"Base/{name}/ data"][...] = np.array(values, "i4").reshape(file[f"Base/{name}/ data"].shape)
            return change

        for change, status, says in (
                (without("GridCoordinates"), 3, "no CoordinateX"), (without("GridCoordinates/CoordinateZ"), 3, "no CoordinateZ"),
                (changed("Zone/Volume/ElementRange", [9, 10]), 3, "numbers are left"),
                (changed("Zone/Volume/ElementRange", [9, 8]), 3, "numbers are left"),
                (changed("Zone/ZoneBC/top/PointList", [100, 101, 102, 103]), 0, "condition top: none"),
                (changed("Zone/ZoneBC/top/PointList", [1, 101, 102, 103]), 0, "condition top: only 1"),
                (changed("Zone/ZoneBC/top/PointList", [5, 6, 7, 8]), 0, "4 faces are in several conditions")):
            with self.subTest(says):
                cgns_files.write(self.folder / "a.cgns")
                with h5py.File(self.folder / "a.cgns", "a") as file:
                    change(file)
                result, said = run(DELFRONT, "convert", self.folder / "a.cgns", self.folder / "back.msh")
                self.assertEqual(result, status, said)
                self.assertIn(says, " ".join(said.split()))

    def test_a_cgns_file_of_a_later_version_needs_a_folder_for_its_copy(self):
        cgns_files = self.cgns_files()
        cgns_files.write(self.folder / "a.cgns", version=4.2)
        kept = self.folder / "delfront_XXXXXX"
        kept.write_text("mine")
        result = subprocess.run([DELFRONT, "convert", "a.cgns", "b.msh"], cwd=self.folder, capture_output=True, text=True,
                                env={**os.environ, "TMPDIR": str(self.folder / "nowhere")})
        self.assertEqual(result.returncode, 7, result.stderr)
        self.assertIn("TMPDIR", result.stderr)
        self.assertEqual(kept.read_text(), "mine")

    def test_cgnscheck_finds_nothing(self):
        if not shutil.which("cgnscheck"):
            self.skipTest("cgnscheck is not installed (Debian cgns-convert)")
        if "cgns" not in run(DELFRONT, "--help")[1]:
            self.skipTest("built without the CGNS library")
        meshio.write(self.folder / "a.mesh", self.mixed(), file_format="medit")
        for source in (self.folder / "a.mesh", self.gmsh_box("msh")):
            self.convert(source, self.folder / "a.cgns")
            status, text = run("cgnscheck", "-w3", self.folder / "a.cgns")
            self.assertEqual(status, 0, text)
            for word in ("ERROR", "WARNING"):
                self.assertNotIn(word, text)

    def test_docs_list_the_formats_that_there_are(self):
        page = (pathlib.Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")
        listed = run(DELFRONT, "--help")[1].split("File formats, by extension:\n")[1].split("\n  CAD ")[0]
        for line in listed.splitlines():
            name = line.split()[0]
            self.assertRegex(page, rf"\| `{name}`", f"docs/formats.md has no row for {name}")

    def test_openfoam_takes_our_fluent_file(self):
        if not shutil.which("fluent3DMeshToFoam") or not shutil.which("checkMesh"):
            self.skipTest("fluent3DMeshToFoam is not installed (Debian openfoam)")
        path = self.gmsh_box("msh")
        case = self.folder / "case"
        (case / "system").mkdir(parents=True)
        head = "FoamFile { version 2.0; format ascii; class dictionary; object %s; }\n"
        (case / "system" / "controlDict").write_text(
            head % "controlDict" + "application none; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; "
            "writeControl timeStep; writeInterval 1; writeFormat ascii; writePrecision 12;\n")
        (case / "system" / "fvSchemes").write_text(head % "fvSchemes" + "ddtSchemes {} gradSchemes {} divSchemes {} "
                                                   "laplacianSchemes {} interpolationSchemes {} snGradSchemes {}\n")
        (case / "system" / "fvSolution").write_text(head % "fvSolution")
        self.convert(path, case / "box.msh", "--format", "fluent")
        environment = ["env", "WM_PROJECT_DIR=/usr/share/openfoam"]
        status, text = run(*environment, "fluent3DMeshToFoam", "box.msh", cwd=case)
        self.assertEqual(status, 0, text[-2000:])
        status, text = run(*environment, "checkMesh", cwd=case)
        self.assertIn("Mesh OK.", text)
        _, wanted = counts(path)
        self.assertRegex(text, rf"tetrahedra:\s+{wanted['tetra']}\b")
        for name in ("left", "rest"):
            self.assertIn(name, text)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"] + sys.argv[1:])
