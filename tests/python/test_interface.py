# SPDX-License-Identifier: Apache-2.0
"""The lines that every page begins with, and every example of the page about Python."""

import re

import delfront as df
import numpy as np
import pytest
from conftest import ROOT


def test_the_lines_of_the_interface(wing_file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    geo = df.load(wing_file, units="auto")
    geo = df.enclose(geo, sphere=4 * geo.chord, name="farfield")
    size = df.Size(hmax=1.0, hmin=2e-2, growth=1.4, curvature=6, gap=1)
    size += df.source.line((1, 0, 0), (3, 0, 0.2), delta0=0.2, r0=0.1, r1=1.0, law="power", gamma=1.5)
    size += lambda x: 0.5 + 0.2 * np.abs(x[:, 2])  # vectorised, (n,3) -> (n,)
    mesh = df.mesh(geo, size, volume="front", threads=8, progress=True)
    print(mesh, mesh.quality.table())
    for name in ("wing.su2", "foam/", "wing.vtu"):
        mesh.write(name)
    pts, tets = mesh.points, mesh.cells["tetra"]  # numpy views, no copy
    assert np.shares_memory(pts, mesh.points) and tets.max() < len(pts)
    assert set(mesh.boundaries) == {"wing", "root", "tip", "trailing_edge", "farfield"}
    assert mesh.check() == [] and (tmp_path / "foam" / "constant" / "polyMesh" / "points").exists()
    for name in ("wing.su2", "foam/", "wing.vtu"):
        assert df.read(name).num_cells == mesh.num_cells


def blocks(page):
    text = (ROOT / "docs" / page).read_text()
    return re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)


def test_examples_of_the_page_run_in_their_order(wing_file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wing.geom.toml").write_bytes(wing_file.read_bytes())
    examples, names = blocks("python.md"), {}
    assert len(examples) >= 8
    for number, example in enumerate(examples):
        exec(compile(example, f"docs/python.md, example {number + 1}", "exec"), names)


def test_everything_public_has_a_docstring_and_hints():
    for name in df.__all__:
        thing = getattr(df, name)
        if callable(thing) and not isinstance(thing, type):
            assert thing.__doc__, name
        if isinstance(thing, type) and name not in ("Format",):
            assert thing.__doc__, name


def test_stubs_are_there():
    import pathlib

    folder = pathlib.Path(df.__file__).parent
    assert (folder / "py.typed").exists()
    stub = (folder / "_core.pyi").read_text()
    assert "class Mesh" in stub and "def run_job" in stub


def test_house_word_is_one_for_one_thing():
    with pytest.raises(df.UsageError):
        df.Size(growth_rate=1.2)
