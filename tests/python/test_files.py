# SPDX-License-Identifier: Apache-2.0
"""Grids go to files and other programs and come back the same."""

import os
import subprocess

import delfront as df
import numpy as np
import pytest
from conftest import ROOT


@pytest.fixture(scope="module")
def mesh():
    from conftest import CUBE_PATCHES, CUBE_TRIANGLES, box_points

    geo = df.load(box_points() / 3, CUBE_TRIANGLES, patches=CUBE_PATCHES, names=["left", "right", "sides"])
    return df.mesh(geo, 0.15, surface="front", output={"sizes": True})


def triangles_of(mesh, name):
    return sorted(map(tuple, np.sort(mesh.boundaries[name].cells["triangle"], axis=1).tolist()))


@pytest.mark.parametrize("name", ["a.vtu", "a.msh", "a.mesh", "a.su2", "case/"])
def test_written_grids_come_back(mesh, tmp_path, name):
    path = f"{tmp_path}/{name}"
    changes = mesh.write(path)
    assert all(isinstance(change, str) for change in changes)
    again = df.read(path)
    assert again.num_cells == mesh.num_cells and again.check() == []
    assert again.quality.volume == pytest.approx(1 / 27)
    assert set(again.boundaries) == set(mesh.boundaries)
    if name != "case/":
        assert np.array_equal(again.points, mesh.points)
        for patch in mesh.boundaries:
            assert triangles_of(again, patch) == triangles_of(mesh, patch)
    if name == "a.vtu":
        assert np.array_equal(again.point_data["h"], mesh.point_data["h"])


def test_options_of_writing(mesh, tmp_path):
    mesh.write(tmp_path / "a.vtu", ascii=True)
    mesh.write(tmp_path / "b.vtu", compress=True)
    mesh.write(tmp_path / "c.dat", format="su2")
    assert b"ascii" in (tmp_path / "a.vtu").read_bytes()[:3000]
    assert (tmp_path / "b.vtu").stat().st_size < (tmp_path / "a.vtu").stat().st_size
    assert (tmp_path / "c.dat").read_text().startswith("NDIME= 3")


def test_convert(mesh, tmp_path):
    mesh.write(tmp_path / "a.vtu")
    made = df.convert(tmp_path / "a.vtu", tmp_path / "b.msh", msh_version="2.2")
    assert made.num_cells == mesh.num_cells and df.read(tmp_path / "b.msh").num_cells == mesh.num_cells
    with pytest.raises(df.UsageError, match="overwritten"):
        df.convert(tmp_path / "a.vtu", tmp_path / "a.vtu")


def test_starter_files(mesh, tmp_path):
    said = mesh.write(tmp_path / "a.su2", solver="su2")
    assert all(name in (tmp_path / "a.cfg").read_text() for name in mesh.boundaries)
    assert any("wall" in sentence for sentence in said)  # no kinds were given
    made = df.convert(tmp_path / "a.su2", f"{tmp_path}/case/", solver="openfoam")
    assert f"{tmp_path}/case/system/controlDict" in made.files_written
    assert all(name in (tmp_path / "case" / "0" / "p").read_text() for name in mesh.boundaries)
    with pytest.raises(df.UsageError, match="openfoam"):
        mesh.write(tmp_path / "b.su2", solver="openfoam")
    assert not (tmp_path / "b.su2").exists()


def test_refine(mesh, tmp_path):
    fine = df.refine(mesh, 1)
    assert fine.num_cells == 8 * mesh.num_cells and fine.check() == []
    assert fine.report["levels"] == 1 and set(fine.boundaries) == set(mesh.boundaries)
    mesh.write(tmp_path / "a.vtu")
    assert df.refine(tmp_path / "a.vtu").num_cells == fine.num_cells
    with pytest.raises(df.LimitError):
        df.refine(mesh, 3, max_cells=1000)


def test_refine_puts_points_on_the_geometry():
    angle = np.linspace(0, 2 * np.pi, 241)[:-1]
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rim = df.load(circle, lines=np.stack([np.arange(240), np.roll(np.arange(240), -1)], axis=1), names=["rim"])
    coarse = df.load(circle[::10], lines=np.stack([np.arange(24), np.roll(np.arange(24), -1)], axis=1), names=["rim"])
    fine = df.refine(df.mesh(coarse, 0.5), geometry=rim)
    on_rim = np.unique(fine.boundaries["rim"].cells["line"])
    assert fine.report["points_on_surface"] + fine.report["points_on_features"] == 24
    assert np.linalg.norm(fine.points[on_rim], axis=1) == pytest.approx(1, rel=1e-5)


def test_meshio(mesh, tmp_path):
    meshio = pytest.importorskip("meshio")
    other = mesh.to_meshio()
    assert np.array_equal(other.cells_dict["tetra"], mesh.cells["tetra"])
    assert np.array_equal(other.point_data["h"], mesh.point_data["h"])
    kinds = [block.type for block in other.cells]
    sides = other.cell_sets["sides"][kinds.index("triangle")]
    assert sorted(sides) == sorted(mesh.boundaries["sides"].ids["triangle"])
    other.write(tmp_path / "a.vtu")
    assert len(meshio.read(tmp_path / "a.vtu").points) == mesh.num_points


def test_pyvista(mesh):
    try:
        import pyvista  # noqa: F401
    except ImportError:
        with pytest.raises(ImportError, match="needs the package pyvista.*pip install pyvista"):
            mesh.to_pyvista()
        with pytest.raises(ImportError, match="pyvista"):
            mesh.view()
        pytest.skip("pyvista is not installed; that this is said is tested")
    grid = mesh.to_pyvista()
    assert grid.n_cells == sum(len(c) for c in mesh.cells.values()) and grid.n_points == mesh.num_points
    assert np.array_equal(grid.point_data["h"], mesh.point_data["h"])
    assert grid.volume == pytest.approx(1 / 27)


def test_pyvista_gets_each_cell_in_its_place(mesh, monkeypatch):
    """What pyvista is called with, where it is not there."""
    import sys
    import types

    class Grid:
        def __init__(self, cells, types, points):
            self.cells, self.types, self.points = cells, types, points
            self.cell_data, self.point_data = {}, {}

    monkeypatch.setitem(sys.modules, "pyvista", types.SimpleNamespace(UnstructuredGrid=Grid))
    grid = mesh.to_pyvista()
    at = 0
    for kind, count, vtk in (("triangle", 3, 5), ("tetra", 4, 10)):
        assert np.count_nonzero(grid.types == vtk) == len(mesh.cells[kind])
    for kind in mesh.cells:
        for cell in mesh.cells[kind]:
            assert grid.cells[at] == len(cell) and np.array_equal(grid.cells[at + 1 : at + 1 + len(cell)], cell)
            at += 1 + len(cell)
    assert at == len(grid.cells) and len(grid.cell_data["group"]) == len(grid.types)


def test_mixed_cells(tmp_path):
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [2, 0, 0], [2, 0, 1]]
    hexa = df.Mesh(points, {"hexahedron": [[0, 1, 2, 3, 4, 5, 6, 7]], "wedge": [[1, 8, 2, 5, 9, 6]]})
    hexa.write(tmp_path / "a.vtu")
    again = df.read(tmp_path / "a.vtu")
    assert again.num_cells == 2 and again.cells["wedge"].tolist() == [[1, 8, 2, 5, 9, 6]]
    assert hexa.quality.volume == pytest.approx(1.5)


def test_facts_of_a_file(mesh, tmp_path):
    mesh.write(tmp_path / "a.vtu")
    facts = df.info(tmp_path / "a.vtu")
    assert facts["is_grid"] and facts["cells"]["tetrahedron"] == mesh.num_cells and "tetrahedron" in str(facts)
    assert df.info(mesh)["num_points"] == mesh.num_points
    surface = df.info(df.load(tmp_path / "a.vtu"))
    assert surface["surface"]["is_closed"] and not surface["is_grid"]
    assert "vtu" in {f.name for f in df.formats()}


def test_cad(tmp_path):
    """Where OpenCASCADE was there: the STEP file of the examples, made by their own program."""
    maker = os.environ.get("DELFRONT_MAKE_CAD", "")
    if not df.has_cad()[0] or not os.path.exists(maker):
        pytest.skip(f"CAD: {df.has_cad()[1]}; {maker or 'no program that makes shapes'}")
    subprocess.run([maker, str(tmp_path)], check=True, capture_output=True, timeout=120)
    geo = df.load(tmp_path / "ahmed.step")
    assert geo.is_smooth and geo.units == "mm" and {"inlet", "slant", "stilts"} <= set(geo.patches)
    faces = df.info(tmp_path / "ahmed.step")["geometry"]["faces"]
    stilts = [face for face in faces if face["surface"] == "cylinder" and face["name"] == "stilts"]
    assert [face["radius"] for face in stilts] == pytest.approx([15] * 4, rel=1e-12)
    assert all(np.abs(face["axis"]) == pytest.approx([0, 0, 1], abs=1e-12) for face in stilts)
    assert all(face["radius"] is None for face in faces if face["surface"] == "plane")
    surface = df.mesh(geo, df.Size(accuracy="coarse"), stop_after="surface", output={"units": "m"})
    assert set(surface.boundaries) == set(geo.patches) and "triangle" in surface.cells
    assert surface.box[1][0] == pytest.approx(geo.box[1][0] / 1000)  # the file's own unit serves for output


def test_cad_that_cannot_be_read(tmp_path):
    (tmp_path / "bad.step").write_text("ISO-10303-21;\nnonsense\n")
    with pytest.raises(df.InputError, match="bad.step"):
        df.load(tmp_path / "bad.step")


def test_job_files_of_the_examples():
    for job in sorted((ROOT / "examples").glob("*/*.toml")):
        if not job.name.endswith(".geom.toml"):
            assert "[input]" in df.config(job)
