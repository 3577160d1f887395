# SPDX-License-Identifier: Apache-2.0
"""Arrays are views of the grid's own memory, which they keep alive; arrays that come in are copied and checked."""

import gc

import delfront as df
import numpy as np
import pytest


@pytest.fixture
def mesh(cube_geometry):
    return df.mesh(cube_geometry, 0.4, surface="front")


def all_arrays(mesh):
    yield mesh.points
    yield from mesh.cells.values()
    yield from mesh.cell_groups.values()
    yield from mesh.point_data.values()
    yield from mesh.entities


def test_arrays_are_views_without_copies(mesh):
    core = mesh._core
    assert np.shares_memory(mesh.points, core.points)
    assert np.shares_memory(mesh.cells["tetra"], core.cells["tetra"])
    assert np.shares_memory(mesh.cell_groups["triangle"], core.cell_groups["triangle"])
    address = mesh.points.__array_interface__["data"][0]
    assert all(mesh.points.__array_interface__["data"][0] == address for _ in range(3))


def test_arrays_have_the_promised_shapes_and_types(mesh):
    assert mesh.points.shape == (mesh.num_points, 3) and mesh.points.dtype == np.float64
    assert mesh.cells["tetra"].shape == (mesh.num_cells, 4) and mesh.cells["tetra"].dtype == np.uint32
    assert mesh.cells["triangle"].shape[1] == 3
    assert mesh.cell_groups["tetra"].shape == (mesh.num_cells,)
    assert mesh.entities is None or len(mesh.entities.dimension) == mesh.num_points


def test_arrays_are_read_only(mesh):
    with pytest.raises(ValueError):
        mesh.points[0, 0] = 7
    with pytest.raises(ValueError):
        mesh.cells["tetra"][0, 0] = 7


def test_arrays_outlive_the_grid(cube_geometry):
    def made():
        mesh = df.mesh(cube_geometry, 0.3, surface="front", output={"sizes": True})
        return mesh.points, mesh.cells["tetra"], mesh.cell_groups["triangle"], mesh.point_data["h"]

    views = made()
    copies = [view.copy() for view in views]
    gc.collect()
    waste = [np.full(200_000, 3.5) for _ in range(20)]
    for view, copy in zip(views, copies):
        assert np.array_equal(view, copy)
    assert len(waste) == 20


def test_points_of_a_geometry_are_views_that_outlive_it(cube):
    points, triangles, _, _ = cube
    geo = df.load(points, triangles)
    held = geo.points
    del geo
    gc.collect()
    assert np.array_equal(held, points)


def test_volume_and_areas_of_the_cells(mesh):
    a, b, c, d = (mesh.points[mesh.cells["tetra"][:, k]] for k in range(4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    assert volumes.min() > 0 and volumes.sum() == pytest.approx(1)
    for name, area in {"left": 1, "right": 1, "sides": 4}.items():
        a, b, c = (mesh.points[mesh.boundaries[name].cells["triangle"][:, k]] for k in range(3))
        assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(area)


def test_groups_have_names_kinds_and_their_cells(mesh):
    assert set(mesh.boundaries) == {"left", "right", "sides"} and set(mesh.regions) == {"fluid"}
    left = mesh.boundaries["left"]
    assert np.all(mesh.points[left.cells["triangle"]][:, :, 0] == 0)
    assert left.num_cells == len(left.ids["triangle"])
    assert sum(group.num_cells for group in mesh.boundaries.values()) == len(mesh.cells["triangle"])


def test_mesh_of_arrays_gives_them_back(mesh):
    again = df.Mesh(
        mesh.points,
        mesh.cells,
        groups=mesh.groups,
        cell_groups=mesh.cell_groups,
        point_data={"p": np.arange(mesh.num_points), "v": mesh.points},
    )
    assert np.array_equal(again.points, mesh.points)
    for kind, cells in mesh.cells.items():
        assert np.array_equal(again.cells[kind], cells)
        assert np.array_equal(again.cell_groups[kind], mesh.cell_groups[kind])
    assert [(g.name, g.dimension, g.kind) for g in again.groups] == [(g.name, g.dimension, g.kind) for g in mesh.groups]
    assert again.point_data["p"].shape == (mesh.num_points,) and again.point_data["v"].shape == (mesh.num_points, 3)
    assert again.check() == [] and again.report is None


def test_mesh_in_the_plane():
    mesh = df.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]], "line": [[0, 1], [1, 2], [2, 0]]}, groups=["wall"],
                   cell_groups={"line": [0, 0, -1]})
    assert mesh.dimension == 2 and mesh.points.shape == (3, 3) and mesh.num_cells == 1
    assert mesh.boundaries["wall"].num_cells == 2 and mesh.cell_groups["line"][2] == df.NO_GROUP


@pytest.mark.parametrize(
    ("points", "cells", "keys", "error"),
    [
        ([[0, 0, 0]], {"tetra": [[0, 1, 2, 3]]}, {}, df.InputError),
        ([[0, 0, 0]], {"tetra": [[0, 0, 0]]}, {}, df.UsageError),
        ([[0, 0, 0]], {"tetra": [[-1, 0, 0, 0]]}, {}, ValueError),
        ([[0, 0, 0]], {"tetra": [[0.5, 0, 0, 0]]}, {}, ValueError),
        ([[0, 0, 0]], {"tetrahedron": [[0, 0, 0, 0]]}, {}, df.UsageError),
        ([[0, 0, 0, 0]], {}, {}, df.UsageError),
        ([0, 0, 0], {}, {}, ValueError),
        ([[0, 0, 0]], {"vertex": [[0]]}, {"cell_groups": {"vertex": [3]}}, df.InputError),
        ([[0, 0, 0]], {"vertex": [[0]]}, {"cell_groups": {"line": [3]}}, ValueError),
        ([[0, 0, 0]], {"vertex": [[0]]}, {"point_data": {"p": [1, 2]}}, df.UsageError),
    ],
)
def test_wrong_arrays_are_refused(points, cells, keys, error):
    with pytest.raises(error):
        df.Mesh(points, cells, **keys)


def test_any_layout_and_integer_type_is_taken(cube):
    points, triangles, _, _ = cube
    plain = df.load(points, triangles)
    for at, faces in (
        (np.asfortranarray(points), triangles.astype(np.int32)),
        (points.astype(np.float32), np.asfortranarray(triangles.astype(np.uint64))),
        (points.tolist(), triangles.tolist()),
        (np.hstack([points, points])[:, :3], triangles[:, ::1]),
    ):
        geo = df.load(at, faces)
        assert np.array_equal(geo.points, plain.points) and np.array_equal(geo.triangles, plain.triangles)
