# SPDX-License-Identifier: Apache-2.0
"""Grids in files: read, convert, refine."""

from __future__ import annotations

from typing import NamedTuple, Union

from . import _core
from ._geometry import Geometry
from ._hooks import Hooks, ProgressHook
from ._mesh import Mesh, PathLike, path_text


class Format(NamedTuple):
    name: str
    title: str
    extensions: list[str]
    can_read: bool
    can_write: bool


def formats() -> list[Format]:
    """All file formats of grids and facets. (Smooth geometry, CAD and jobs are read too.)"""
    return [Format(*f) for f in _core.formats()]


def read(path: PathLike, *, format: str = "", progress: ProgressHook = None) -> Mesh:
    """A file of cells as it stands there: a grid, facets or lines. A folder is an OpenFOAM case.

    Raises InputError, which says where in the file what is wrong.
    """
    with Hooks(progress=progress) as hooks:
        return Mesh._of(_core.read_mesh(path_text(path), format, hooks))


def convert(
    source: PathLike,
    target: PathLike,
    *,
    from_format: str = "",
    format: str = "",
    ascii: bool = False,
    compress: bool = False,
    msh_version: str = "",
    solver: str = "",
    progress: ProgressHook = None,
) -> Mesh:
    """Write a file in another format; what that could not hold stands in ``name_changes`` of the result.

    ``solver`` ("su2", "openfoam"): also starter files that name every boundary, beside the grid; files that exist are
    kept. All that was written stands in ``files_written``.
    """
    with Hooks(progress=progress) as hooks:
        mesh, changes, starter = _core.convert(
            path_text(source), path_text(target), from_format, format, not ascii, msh_version, compress, solver, hooks
        )
    return Mesh._of(mesh, name_changes=changes, files_written=[path_text(target), *starter])


def refine(
    grid: Union[Mesh, PathLike],
    levels: int = 1,
    *,
    geometry: Union[Geometry, Mesh, PathLike, None] = None,
    feature_angle: float = 40,
    max_cells: int = 0,
    threads: int = 0,
    progress: ProgressHook = None,
) -> Mesh:
    """Every edge halved, so many times; new boundary points on the facets (in the plane: lines) of the geometry.

    The result's ``report`` tells what was moved, and which points had to stay in the middle of their edges. Raises
    InputError (no valid grid), GriddingError, LimitError.
    """
    mesh = grid if isinstance(grid, Mesh) else read(grid)
    name = "the grid" if isinstance(grid, Mesh) else path_text(grid)
    surface, surface_name = _surface(geometry)
    with Hooks(threads, progress) as hooks:
        core, report, warnings = _core.refine(
            mesh._core, surface, name, surface_name, levels, feature_angle, max_cells, hooks
        )
    return Mesh._of(core, report=report, warnings=warnings)


def _surface(geometry: Union[Geometry, Mesh, PathLike, None]) -> tuple[_core.Mesh | None, str]:
    if geometry is None:
        return None, ""
    if isinstance(geometry, Geometry):
        if len(geometry.names) != 1:
            raise ValueError("refine: expected a geometry of one input")
        return geometry.meshes[geometry.names[0]]._core, geometry.names[0]
    if isinstance(geometry, Mesh):
        return geometry._core, "the geometry"
    return read(geometry)._core, path_text(geometry)
