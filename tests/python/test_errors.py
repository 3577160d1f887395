# SPDX-License-Identifier: Apache-2.0
"""Errors: one class an exit code, places as arrays, what functions raise comes out as it is, nothing hangs."""

import os
import signal
import subprocess
import sys
import threading
import time

import delfront as df
import numpy as np
import pytest

HUGE = 0.006  # of a cube: minutes


class Boom(Exception):
    pass


def test_classes_have_the_exit_codes_of_the_command_line():
    codes = {df.InternalError: 1, df.UsageError: 2, df.InputError: 3, df.GriddingError: 4, df.GateError: 5,
             df.LimitError: 6, df.WriteError: 7, df.Interrupted: 130}
    for kind, code in codes.items():
        assert kind.exit_code == code and issubclass(kind, df.Error)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda geo: df.Size(hmx=1), "did you mean 'size.hmax'"),
        (lambda geo: df.Size(hmax=-1), "size.hmax: expected"),
        (lambda geo: df.mesh(geo, sise={}), "did you mean 'size'"),
        (lambda geo: df.mesh(geo, volume="fronk"), "volume.method: expected one of"),
        (lambda geo: df.mesh(geo, layers=[]), "not in this version"),
        (lambda geo: df.mesh(geo, boundaries={"tail": {"kind": "wall"}}), "tail"),
        (lambda geo: df.mesh(geo, limits={"time": object()}), "limits.time"),
        (lambda geo: df.mesh(geo, limits={1: 2}), "keys are texts"),
        (lambda geo: df.mesh(geo, output={"require": "min_dihedra > 3"}), "min_dihedral"),
        (lambda geo: df.mesh(geo, output={"files": ["grid.stl"]}), "surfaces only"),
        (lambda geo: df.mesh(geo, df.Size() + "0.1 +* x"), "size.expression"),
        (lambda geo: df.mesh(geo, df.Size() + "0.1 + q"), "q"),
        (lambda geo: df.load("body.xyz"), "body.xyz"),
        (lambda geo: df.run({"input": {"files": ["a.stl"]}, "sze": 1}), "did you mean 'size'"),
        (lambda geo: df.refine(df.mesh(geo), levels=0), "levels"),
        (lambda geo: df.mesh(geo).write("grid.xyz"), "xyz"),
        (lambda geo: df.mesh(geo).write("a.msh", msh_version="3"), "2.2 and 4.1"),
    ],
)
def test_usage_errors_name_the_key_and_what_is_allowed(cube_geometry, tmp_path, monkeypatch, call, match):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(df.UsageError, match=match) as caught:
        call(cube_geometry)
    assert isinstance(caught.value, ValueError) and caught.value.exit_code == 2


def test_wrong_addition_leaves_the_size_as_it_was():
    size = df.Size(hmax=1)
    for wrong in (df.source.point((0, 0), delta0=-1), 3.5):
        with pytest.raises((df.UsageError, TypeError)):
            size += wrong
    assert size.job == {"hmax": 1}


def test_open_surface_carries_places_and_findings(cube):
    points, triangles, _, _ = cube
    with pytest.raises(df.InputError, match="open edges") as caught:
        df.mesh(df.load(points, triangles[:-1]))
    error = caught.value
    assert error.places.shape[1] == 3 and len(error.places) == len(error.ids) >= 1
    finding = next(f for f in error.findings if f.kind == "open_edges")
    assert finding.count == 3 and finding.places.shape[1] == 3 and finding.severity == "error"
    assert error.report["outcome"] == "bad_input" and error.mesh is None


def test_gate_error_carries_the_grid_and_the_worst_cells(cube_geometry):
    with pytest.raises(df.GateError) as caught:
        df.mesh(cube_geometry, 0.4, output={"require": "min_dihedral > 89"})
    assert caught.value.mesh.num_cells > 0 and caught.value.findings
    with pytest.raises(df.GateError) as again:
        caught.value.mesh.require("min_dihedral > 89")
    assert len(again.value.places) > 0


def test_limits(cube_geometry):
    with pytest.raises(df.LimitError):
        df.mesh(cube_geometry, 0.05, surface="front", limits={"max_cells": 1000})
    with pytest.raises(df.LimitError):
        df.mesh(cube_geometry, 0.01, surface="front", limits={"time": "0.2s"})


def test_input_and_write_errors(cube_geometry, tmp_path):
    (tmp_path / "bad.stl").write_text("solid x\n facet normal 0 0 1\n  outer loop\n vertex 0 0 zero\n")
    with pytest.raises(df.InputError, match="bad.stl"):
        df.load(tmp_path / "bad.stl")
    with pytest.raises(df.InputError):
        df.read(tmp_path / "missing.vtu")
    with pytest.raises(df.WriteError):
        df.mesh(cube_geometry).write(tmp_path / "no" / "such" / "folder" / "grid.vtu")
    with pytest.raises(df.WriteError):
        df.mesh(cube_geometry, output={"files": [tmp_path / "no" / "grid.vtu"]})


def test_defects_are_found_without_exceptions(cube, tmp_path):
    points, triangles, _, _ = cube
    found = df.check(df.load(points, triangles[:-1]))
    assert not found and not found.is_usable and "open_edges" in {f.kind for f in found.findings}
    found.write_defects(tmp_path / "defects.vtp")
    assert df.read(tmp_path / "defects.vtp").num_points > 0
    assert "cannot bound a volume" in str(found) and "not usable" in repr(found)
    mesh = df.mesh(df.load(points, triangles), 0.4, surface="front")
    assert df.check(mesh) and df.check(mesh, require="min_dihedral > 1")
    failed = df.check(mesh, require="min_dihedral > 89")
    assert not failed and failed.is_usable and failed.failed_gates and failed.findings
    inverted = df.Mesh(mesh.points, {"tetra": mesh.cells["tetra"][:, ::-1]})
    assert inverted.check() and not df.check(inverted)


@pytest.mark.parametrize("threads", [1, 4])
def test_what_a_size_function_raises_comes_out_as_it_is(cube_geometry, threads):
    boom = Boom("here")

    def size(x):
        if x[:, 0].max() > 0.9:
            raise boom
        return 0.1 + 0 * x[:, 0]

    with pytest.raises(Boom) as caught:
        df.mesh(cube_geometry, size, threads=threads)
    assert caught.value is boom
    assert any(entry.name == "size" for entry in caught.traceback)


@pytest.mark.parametrize("where", ["progress", "late"])
def test_what_a_progress_function_raises_comes_out_as_it_is(cube_geometry, where):
    boom = Boom("here")

    def progress(p):
        if where == "progress" or p.stage == "improve":
            raise boom

    with pytest.raises(Boom) as caught:
        df.mesh(cube_geometry, 0.05, surface="front", progress=progress)
    assert caught.value is boom


@pytest.mark.parametrize(
    ("function", "error", "match"),
    [
        (lambda x: np.zeros((len(x), 3)), ValueError, "expected"),
        (lambda x: "small", ValueError, "small"),
        (lambda x: None, TypeError, "gave None"),
        (lambda x: -1.0 + 0 * x[:, 0], df.UsageError, "gives -1"),
        (lambda x: 0.0, df.UsageError, "gives 0"),
        (lambda x: np.nan * x[:, 0], df.UsageError, "gives nan"),
    ],
)
def test_wrong_values_of_a_size_function(cube_geometry, function, error, match):
    with pytest.raises(error, match=match) as caught:
        df.mesh(cube_geometry, function)
    if error is df.UsageError:
        assert caught.value.places.shape == (1, 3)


def test_infinite_sizes_have_no_opinion(cube_geometry):
    plain = df.mesh(cube_geometry, 0.3, surface="front")
    same = df.mesh(cube_geometry, df.Size(hmax=0.3) + (lambda x: np.inf), surface="front")
    assert np.array_equal(plain.points, same.points)


def interrupt_soon(seconds):
    timer = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    return timer


@pytest.fixture
def python_handler():
    """Python's own, which it does not set up where a shell started it in the background with the signal ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("python_handler")
@pytest.mark.parametrize("volume", ["front-delaunay", "front"])
def test_keyboard_interrupt_stops_a_run(cube_geometry, volume):
    before = signal.getsignal(signal.SIGINT)
    timer = interrupt_soon(0.5)
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        df.mesh(cube_geometry, HUGE, surface="front", volume=volume)
    timer.join()
    assert time.monotonic() - start < 20
    assert signal.getsignal(signal.SIGINT) is before
    assert df.mesh(cube_geometry, 0.4).num_cells > 0  # and the next one works


@pytest.mark.usefixtures("python_handler")
def test_keyboard_interrupt_in_a_size_function(cube_geometry):
    timer = interrupt_soon(0.3)
    with pytest.raises(KeyboardInterrupt):
        df.mesh(cube_geometry, lambda x: HUGE + 0 * x[:, 0], surface="front")
    timer.join()


def test_import_loads_no_graphics_and_sets_no_handlers():
    code = (
        "import signal; before = [signal.getsignal(s) for s in (2, 11, 15)]; import delfront, sys\n"
        "assert before == [signal.getsignal(s) for s in (2, 11, 15)]\n"
        "maps = open('/proc/self/maps').read()\n"
        "assert not any(word in maps for word in ('libGL', 'libvtk', 'libX11', 'libTK')), maps\n"
        "assert not {'vtk', 'pyvista', 'meshio', 'matplotlib'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
