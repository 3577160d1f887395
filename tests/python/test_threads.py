# SPDX-License-Identifier: Apache-2.0
"""Several grids at once in threads, and Python goes on meanwhile."""

import threading
from concurrent.futures import ThreadPoolExecutor

import delfront as df
import numpy as np
from conftest import CUBE_TRIANGLES, box_points


def grid(k):
    geo = df.load(box_points((1, 1 + 0.1 * k, 1)), CUBE_TRIANGLES)
    size = df.Size(hmax=0.3) + (lambda x: 0.08 + 0.01 * k + 0.1 * x[:, 0])
    return df.mesh(geo, size, surface="front", threads=1 + k % 3)


def test_several_grids_at_once_are_those_of_one_after_the_other():
    one_by_one = [grid(k) for k in range(8)]
    with ThreadPoolExecutor(8) as pool:
        at_once = list(pool.map(grid, range(8)))
    for a, b in zip(one_by_one, at_once):
        assert np.array_equal(a.points, b.points) and np.array_equal(a.cells["tetra"], b.cells["tetra"])


def test_one_grid_is_read_by_many_threads():
    mesh = grid(0)
    with ThreadPoolExecutor(8) as pool:
        volumes = list(pool.map(lambda _: (mesh.quality.volume, len(mesh.check()), mesh.points.sum()), range(16)))
    assert len(set(volumes)) == 1


def test_python_goes_on_while_a_grid_is_made():
    geo = df.load(box_points(), CUBE_TRIANGLES)
    is_done = threading.Event()
    worker = threading.Thread(target=lambda: (df.mesh(geo, 0.04, surface="front", threads=1), is_done.set()))
    worker.start()
    turns = 0
    while not is_done.wait(0.001):
        turns += 1
    worker.join()
    assert turns > 20


def test_one_of_several_can_fail_alone():
    geo = df.load(box_points(), CUBE_TRIANGLES)

    def run(k):
        def size(x):
            if k == 2:
                raise KeyError(k)
            return 0.15 + 0 * x[:, 0]

        try:
            return df.mesh(geo, size, surface="front").num_cells
        except KeyError:
            return -1

    with ThreadPoolExecutor(4) as pool:
        cells = list(pool.map(run, range(4)))
    assert cells[2] == -1 and cells[0] == cells[1] == cells[3] > 0


def test_a_grid_within_a_size_function():
    """Calls may be nested: the function is called without any lock of ours held."""
    geo = df.load(box_points(), CUBE_TRIANGLES)
    inner = []

    def size(x):
        if not inner:
            inner.append(df.mesh(geo, 0.5).num_cells)
        return 0.3

    assert df.mesh(geo, size, surface="front", threads=2).num_cells > 0 and inner[0] > 0
