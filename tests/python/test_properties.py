# SPDX-License-Identifier: Apache-2.0
"""Properties over many inputs: nothing crashes, what goes in comes out."""

import tomllib

import delfront as df
import numpy as np
import pytest
from conftest import CUBE_PATCHES, CUBE_TRIANGLES, box_points
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

LENGTHS = st.floats(0.3, 4, allow_nan=False)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)
KEYS = ["input", "domain", "size", "surface", "volume", "planar", "improve", "refine", "limits", "output", "boundaries",
        "hmax", "growth", "source", "box", "on", "enclose", "select", "kind", "delta0", "at", "files", "method"]  # fmt: skip
TREES = st.recursive(
    JSON, lambda inner: st.dictionaries(st.sampled_from(KEYS), inner, max_size=4) | st.lists(inner, max_size=2), max_leaves=6
)


@given(st.tuples(LENGTHS, LENGTHS, LENGTHS), st.permutations(range(12)), st.floats(0.3, 1))
def test_boxes_of_any_shape_keep_volume_and_areas(sides, order, hmax):
    geo = df.load(box_points(sides), CUBE_TRIANGLES[order], patches=np.array(CUBE_PATCHES)[order], names=["a", "b", "c"])
    mesh = df.mesh(geo, hmax * min(sides), surface="front")
    assert mesh.quality.volume == pytest.approx(np.prod(sides))
    a, b, c = (mesh.points[mesh.boundaries["a"].cells["triangle"][:, k]] for k in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(sides[1] * sides[2])
    assert mesh.check() == []


@given(st.dictionaries(st.sampled_from(KEYS), TREES, max_size=4))
def test_any_tree_is_taken_or_refused_with_words(tree):
    try:
        text = df.config(tree)
    except df.UsageError as error:
        assert str(error)
    else:
        assert tomllib.loads(text)


@given(hnp.arrays(np.float64, (8, 3)), hnp.arrays(np.int64, (12, 3), elements=st.integers(-2, 9)))
def test_any_arrays_are_gridded_or_refused_with_words(points, triangles):
    try:
        mesh = df.mesh(df.load(points, triangles), limits={"max_cells": 10000, "time": 20})
    except (df.Error, ValueError) as error:
        assert str(error)
    else:
        assert mesh.check() == []


@given(st.floats(1e-3, 1e3), st.floats(1.01, 3), st.integers(3, 100), st.text("abcXYZ _-*", min_size=1, max_size=6))
def test_values_come_back_exactly(hmax, growth, curvature, name):
    size = df.Size(hmax=hmax, growth=np.float64(growth), curvature=np.int64(curvature), on={name: hmax})
    read = tomllib.loads(df.config(size=size.job))["size"]
    assert (read["hmax"], read["growth"], read["curvature"]) == (hmax, growth, curvature)
    assert read["on"][name]["h"] == hmax


@given(hnp.arrays(np.float64, st.tuples(st.integers(1, 20), st.just(3)), elements=st.floats(-1e6, 1e6)), st.data())
def test_meshes_give_back_their_arrays(points, data):
    n = len(points)
    cells = data.draw(hnp.arrays(np.int64, (5, 4), elements=st.integers(0, n - 1)))
    mesh = df.Mesh(points, {"tetra": cells}, groups=[("r", 3)], cell_groups={"tetra": np.zeros(5)})
    assert np.array_equal(mesh.points, points) and np.array_equal(mesh.cells["tetra"], cells)
    assert isinstance(mesh.check(), list) and mesh.regions["r"].num_cells == 5
