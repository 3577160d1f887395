# SPDX-License-Identifier: Apache-2.0
"""Grids, jobs, estimates: the same options, the same grids and the same errors as the command line has."""

import json
import os
import subprocess

import delfront as df
import numpy as np
import pytest


def test_grid_is_the_same_for_any_number_of_threads(cube_geometry):
    size = df.Size(hmax=0.15) + (lambda x: 0.05 + 0.1 * x[:, 0])
    grids = [df.mesh(cube_geometry, size, surface="front", threads=n) for n in (1, 2, 8)]
    for grid in grids[1:]:
        assert np.array_equal(grid.points, grids[0].points)
        assert np.array_equal(grid.cells["tetra"], grids[0].cells["tetra"])


def test_grid_is_that_of_the_command_line(cube_geometry, tmp_path):
    cube_geometry.meshes["cube"].write(tmp_path / "cube.vtp")
    job = {"surface": {"method": "front"}, "size": {"hmax": 0.2, "growth": 1.3}}
    flags = ["--surface-method", "front", "--hmax", "0.2", "--growth", "1.3"]
    if "DELFRONT" not in os.environ:
        pytest.skip("the command line was not built: DELFRONT names it")
    command = [os.environ["DELFRONT"], "mesh", "cube.vtp", "-o", "grid.vtu", "-q", *flags]
    subprocess.run(command, cwd=tmp_path, check=True)
    ours = df.run({"input": {"files": [tmp_path / "cube.vtp"]}, **job})
    theirs = df.read(tmp_path / "grid.vtu")
    assert np.array_equal(ours.points, theirs.points)
    assert np.array_equal(ours.cells["tetra"], theirs.cells["tetra"])
    assert set(ours.boundaries) == set(theirs.boundaries)


def test_job_as_dict_as_file_and_as_words(cube_geometry, tmp_path):
    cube_geometry.meshes["cube"].write(tmp_path / "cube.vtp")
    tree = {"input": {"files": ["cube.vtp"]}, "size": {"hmax": 0.3}, "surface": {"method": "front"},
            "output": {"files": ["grid.vtu", "foam/"], "report": "report.json"}}
    (tmp_path / "case.json").write_text(json.dumps(tree))
    (tmp_path / "case.toml").write_text(df.config({k: v for k, v in tree.items() if k != "input"}) +
                                        '\n')
    from_file = df.run(tmp_path / "case.json")
    assert from_file.files_written == [str(tmp_path / "grid.vtu"), str(tmp_path / "foam") + "/"]
    assert json.loads((tmp_path / "report.json").read_text())["outcome"] == "done"
    assert from_file.report["quality"]["num_cells"] == from_file.num_cells
    words = df.mesh(cube_geometry, 0.3, surface="front")
    assert np.array_equal(from_file.points, words.points)
    coarser = df.run(tmp_path / "case.json", size=0.5, output={"files": [tmp_path / "other.vtu"]})
    assert coarser.num_cells < from_file.num_cells and (tmp_path / "other.vtu").exists()


def test_config_is_a_job_file_that_gives_the_same_options(tmp_path):
    text = df.config(size={"hmax": "5%", "source": [df.source.point((0, 0, 0), delta0=0.1, r1=2.0).entry]}, volume="front")
    file = tmp_path / "job.toml"
    file.write_text(text)
    assert df.config(file) == text
    assert 'hmax = "5%"' in text and 'method = "front"' in text


def test_nothing_is_written_unless_asked(cube, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    points, triangles, _, _ = cube
    df.mesh(df.load(points, triangles), 0.5)
    with pytest.raises(df.InputError):
        df.mesh(df.load(points, triangles[:-1]))
    with pytest.raises(df.GateError):
        df.mesh(df.load(points, triangles), output={"require": "min_dihedral > 80"})
    assert list(tmp_path.iterdir()) == []


BALL = '[[shape]]\ntype = "sphere"\nname = "{}"\nradius = {}\n'


def test_hole_that_lies_in_no_body_is_refused(tmp_path):
    (tmp_path / "hole.geom.toml").write_text(BALL.format("hole", 1) + "reversed = true\n")
    (tmp_path / "body.geom.toml").write_text(BALL.format("body", 3))
    hole, body = (df.load(tmp_path / f"{name}.geom.toml") for name in ("hole", "body"))
    with pytest.raises(df.InputError, match="lies in no body"):
        df.mesh(hole, 1.0)
    shell = df.mesh(hole + body, 1.0)
    assert 85 < shell.quality.volume < 4 / 3 * np.pi * 26  # not with the hole filled: 113


def test_far_field_and_boundaries(cube_geometry):
    geo = df.enclose(cube_geometry, sphere=4 * cube_geometry.chord, name="outside")
    mesh = df.mesh(geo, df.Size(growth=1.5), boundaries={"body": {"select": "*s", "kind": "symmetry"}})
    assert {n: g.kind for n, g in mesh.boundaries.items()} == {
        "left": "wall", "right": "wall", "body": "symmetry", "outside": "farfield"}
    assert mesh.quality.volume > 200
    assert "outside" in {g for g in mesh.boundaries} and cube_geometry._job == {}


def test_box_far_field_by_corners(cube_geometry):
    mesh = df.mesh(df.enclose(cube_geometry, box=(-1, -1, -1, 2, 3, 2)), df.Size(growth=1.5))
    assert mesh.quality.volume == pytest.approx(3 * 4 * 3 - 1)
    with pytest.raises(TypeError):
        df.enclose(cube_geometry, box=1, sphere=2)
    with pytest.raises(df.UsageError):
        df.enclose(cube_geometry, sphere="20 miles")


def test_geometries_together(cube):
    points, triangles, _, _ = cube
    inner = df.load(0.2 * points + 0.4, triangles[:, ::-1], name="inner")
    both = df.load(points, triangles, name="outer") + inner
    mesh = df.mesh(both, 0.3, surface="front")
    assert mesh.quality.volume == pytest.approx(1 - 0.2**3) and set(mesh.boundaries) == {"outer", "inner"}
    assert both.points.shape == (16, 3) and both.triangles.max() == 15


def test_units(cube):
    points, triangles, _, _ = cube
    geo = df.load(points, triangles, units="m")
    assert df.mesh(geo, "200 mm", surface="front").num_cells == df.mesh(geo, 0.2, surface="front").num_cells
    rescaled = df.mesh(geo, output={"units": "mm"})
    assert rescaled.box[1].tolist() == [1000, 1000, 1000]
    with pytest.raises(df.UsageError, match="needs the unit"):
        df.mesh(df.load(points, triangles), "200 mm")
    with pytest.raises(df.UsageError):
        df.load(points, triangles, units="parsec")


def test_plane(tmp_path):
    angle = np.linspace(0, 2 * np.pi, 41)[:-1]
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    lines = np.stack([np.arange(40), np.roll(np.arange(40), -1)], axis=1)
    geo = df.load(circle, lines=lines, names=["rim"])
    mesh = df.mesh(geo, 0.2)
    assert mesh.dimension == 2 and set(mesh.boundaries) == {"rim"} and geo.patches == ("rim",)
    assert mesh.quality.volume == pytest.approx(20 * np.sin(2 * np.pi / 40))
    around = df.mesh(df.enclose(geo, circle=5), df.Size(growth=1.3), planar="front")
    assert set(around.boundaries) == {"rim", "farfield"}


def test_estimate_is_near_what_comes(cube_geometry):
    guess = df.estimate(cube_geometry, 0.1, surface="front")
    cells = df.mesh(cube_geometry, 0.1, surface="front").num_cells
    assert 0.5 * cells < guess.cells < 2 * cells and guess.memory_bytes > 0


def test_sizes_to_look_at(cube_geometry):
    grid = df.sizes(cube_geometry, lambda x: 0.1 + 0.2 * x[:, 1])
    h = grid.point_data["h"]
    assert np.all(h <= 0.1 + 0.2 * grid.points[:, 1] + 1e-9) and h.min() == pytest.approx(0.1, rel=0.05)
    assert set(grid.cells) == {"hexahedron"}


COARSE = df.Size(curvature=6, hmin=0.02, hmax=0.2)


def test_smooth_geometry(wing_file):
    geo = df.load(wing_file)
    assert geo.is_smooth and geo.chord == pytest.approx(1.1963) and "wing" in geo.patches
    mesh = df.mesh(geo, COARSE)
    assert set(mesh.boundaries) == {"wing", "root", "tip", "trailing_edge"} and mesh.check() == []
    again = df.run({"input": {"files": [wing_file]}, "size": COARSE.job})
    assert np.array_equal(again.points, mesh.points)  # what is held is gridded as what is read
    selected = df.mesh(geo, COARSE, boundaries={"first": {"select": {"id": 1}}}, stop_after="surface")
    assert "first" in selected.boundaries


def test_lines_in_a_volume(cube):
    points, triangles, _, _ = cube
    inside = np.array([[0.3, 0.5, 0.5], [0.5, 0.5, 0.5], [0.7, 0.5, 0.5]])
    wire = df.load(inside, lines=[[0, 1], [1, 2]], name="wire")
    mesh = df.mesh(df.load(points, triangles) + wire, 0.3, surface="front")
    assert mesh.curves["wire"].num_cells >= 2 and mesh.check() == []


def test_size_takes_what_is_documented(cube_geometry):
    def cells(size):
        return df.mesh(cube_geometry, size, surface="front").num_cells

    coarse = cells(0.4)
    for more in (
        df.source.point((0, 0, 0), (1, 1, 1), delta0=0.05),
        df.source.line((0, 0, 0), (1, 1, 1), delta0=0.05, r1=1.0, law="power", gamma=1.5),
        df.source.line((0, 0, 0), (1, 1, 1), delta0="5%", r1=1.0, law="polynomial", coefficients=[0, 1]),
        df.source.polyline(np.eye(3), delta0=0.05, r0=0.1, r1=1.0, law="exponential"),
        df.source.triangle((0, 0, 0), (1, 0, 0), (0, 1, 0), delta0=0.1, r1=1.0),
        df.source.box((0, 0, 0), (0.5, 0.5, 0.5), 0.1),
        df.source.sphere((0.5, 0.5, 0.5), 0.3, 0.1),
        df.source.cylinder((0, 0, 0), (1, 1, 1), 0.2, 0.1),
        df.source.cone((0, 0, 0), (1, 1, 1), 0.2, 0.0, 0.1),
        "0.1 + 0.2*x",
        lambda x: 0.1 + 0.2 * x[:, 0],
        df.Size(on={"left": 0.1}),
        df.Size(hmax=0.2),
    ):
        assert cells(df.Size(hmax=0.4) + more) > coarse, more
    both = df.Size(hmax=0.4)
    both += "0.1 + 0.2*x"
    both += "0.1 + 0.2*y"
    assert cells(both) > cells(df.Size(hmax=0.4) + "0.1 + 0.2*x")
    assert cells({"hmax": 0.2}) == cells(0.2) == cells("0.2") and cells("0.1 + 0.2*x") > coarse


def test_formula_and_function_give_the_same_grid(cube_geometry):
    size = df.Size(growth=1.3)
    formula = df.mesh(cube_geometry, size + "0.1 + 0.2*x", surface="front")
    function = df.mesh(cube_geometry, size + (lambda x: 0.1 + 0.2 * x[:, 0]), surface="front")
    assert abs(function.num_cells - formula.num_cells) <= 0.05 * formula.num_cells


def test_report_texts_and_html(cube_geometry):
    mesh = df.mesh(cube_geometry, 0.4, surface="front")
    assert f"{mesh.num_cells}" in repr(mesh) and "tetrahedron" in str(mesh) and "left" in mesh._repr_html_()
    assert "min_dihedral" in mesh.quality.table(3) and "cell" in mesh.quality.table(3)
    assert mesh.quality["min_dihedral"].min == mesh.report["quality"]["measures"]["min_dihedral"]["min"]
    counts, edges = mesh.quality["min_dihedral"].histogram
    assert counts.sum() == mesh.num_cells and len(edges) == len(counts) + 1
    assert "min_dihedral" in mesh.quality._repr_html_() and "cube" in repr(cube_geometry)
    assert mesh.quality.failed_gates("min_dihedral > 89") and mesh.require("min_dihedral > 1") is mesh


def test_progress_and_messages(cube_geometry, caplog, capsys):
    seen = []
    df.mesh(cube_geometry, 0.1, surface="front", progress=seen.append)
    assert {"check", "refine", "improve"} <= {p.stage for p in seen} and all(p.done >= 0 for p in seen)
    with caplog.at_level("WARNING", logger="delfront"):
        mesh = df.mesh(cube_geometry, 0.1)
    assert mesh.warnings and mesh.warnings[0] in caplog.text
    df.mesh(cube_geometry, 0.4, progress=True)
    with pytest.raises(TypeError):
        df.mesh(cube_geometry, progress=3)
