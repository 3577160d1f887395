# SPDX-License-Identifier: Apache-2.0
"""Geometry that the project makes itself, for the tests of the Python package."""

import pathlib
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import settings

ROOT = pathlib.Path(__file__).resolve().parents[2]
settings.register_profile("delfront", derandomize=True, deadline=None, database=None, max_examples=40)
settings.load_profile("delfront")

CUBE_TRIANGLES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip
CUBE_PATCHES = [0, 0, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2]


def box_points(sides=(1, 1, 1)):
    return np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * sides


@pytest.fixture
def cube():
    """Points, triangles, patch of each and names: left (x = 0), right and the rest."""
    return box_points(), CUBE_TRIANGLES, CUBE_PATCHES, ["left", "right", "sides"]


@pytest.fixture
def cube_geometry(cube):
    import delfront as df

    points, triangles, patches, names = cube
    return df.load(points, triangles, patches=patches, names=names, name="cube")


@pytest.fixture(scope="session")
def wing_file(tmp_path_factory):
    """A swept wing as smooth geometry, of few points."""
    file = tmp_path_factory.mktemp("wing") / "wing.geom.toml"
    script = ROOT / "examples" / "swept_wing" / "make_wing.py"
    subprocess.run([sys.executable, str(script), str(file), "--points", "41"], check=True, capture_output=True)
    return file
