# SPDX-License-Identifier: Apache-2.0
"""What is to be gridded: files and arrays that are held in memory, with their units and a far field."""

from __future__ import annotations

import copy
import html
from functools import cached_property
from typing import Any, Sequence, Union

import numpy as np

from . import _core
from ._hooks import Hooks, ProgressHook
from ._mesh import Mesh, PathLike, indices, path_text
from .source import Length

_FACES = ("triangle", "quad", "polygon")


class Geometry:
    """One or several inputs that are gridded together; :func:`load` makes it, :func:`enclose` adds a far field.

    It does not change: enclose and ``+`` give new ones, which share what was read.
    """

    def __init__(self, inputs: dict[str, _core.Input], job: dict[str, Any]) -> None:
        self._inputs = inputs
        self._job = job

    @property
    def names(self) -> tuple[str, ...]:
        """Paths, and names of what came as arrays."""
        return tuple(self._inputs)

    @property
    def units(self) -> str:
        """Unit of the coordinates: "m", "mm", "in", "ft", or "auto" where neither the user nor the file said it."""
        asked = self._job.get("input", {}).get("units", "auto")
        said = {held.unit for held in self._inputs.values()}
        return said.pop() if asked == "auto" and len(said) == 1 and said != {""} else asked

    @property
    def is_smooth(self) -> bool:
        """Whether all of it is smooth geometry (CAD, .geom.toml), whose triangles here are a first, coarse grid."""
        return all(held.is_smooth for held in self._inputs.values())

    @cached_property
    def meshes(self) -> dict[str, Mesh]:
        """What each input holds, as it was given, by name; of smooth geometry a first, coarse grid."""
        return {name: Mesh._of(held.mesh) for name, held in self._inputs.items()}

    @property
    def points(self) -> np.ndarray:
        """(n, 3) of all inputs; of one input a view."""
        return _joined([mesh.points for mesh in self.meshes.values()])

    @property
    def triangles(self) -> np.ndarray:
        """(m, 3) numbers of points; of one input a view. Quads and polygons are not among them."""
        parts, first = [], 0
        for mesh in self.meshes.values():
            cells = mesh.cells.get("triangle", np.zeros((0, 3), np.uint32))
            parts.append(cells + np.uint32(first) if first else cells)
            first += mesh.num_points
        return _joined(parts)

    @property
    def patches(self) -> tuple[str, ...]:
        """Names of patches (in the plane: of lines) that the inputs have, each once."""
        names: dict[str, None] = {}
        for name, mesh in self.meshes.items():
            dimension = 2 if any(t in mesh.cells for t in _FACES) and mesh.dimension == 3 else 1
            of_mesh = [g.name for g in mesh.groups if g.dimension == dimension]
            names.update(dict.fromkeys(of_mesh or [self._inputs[name].stem]))
        return tuple(names)

    @cached_property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """The least and the greatest coordinates of the surface, without any far field."""
        used = [_surface_points(mesh) for mesh in self.meshes.values()]
        at = np.concatenate([points for points in used if len(points)] or [np.full((1, 3), np.nan)])
        return at.min(axis=0), at.max(axis=0)

    @property
    def chord(self) -> float:
        """The longest side of the box: the length that "c" stands for."""
        low, high = self.box
        return float((high - low).max())

    @property
    def diagonal(self) -> float:
        """The diagonal of the box: the length that "%" is of."""
        low, high = self.box
        return float(np.linalg.norm(high - low))

    @property
    def job(self) -> dict[str, Any]:
        """What the job file would have for it; a copy."""
        return merged({"input": {"files": list(self._inputs)}}, self._job)

    def info(self) -> Any:
        """The same as ``df.info(geometry)``."""
        from ._look import info

        return info(self)

    def check(self) -> Any:
        """The same as ``df.check(geometry)``."""
        from ._look import check

        return check(self)

    def __add__(self, other: "Geometry") -> "Geometry":
        if not isinstance(other, Geometry):
            return NotImplemented
        inputs = dict(self._inputs)
        for name, held in other._inputs.items():
            if inputs.get(name) is not held:
                inputs[_free_name(name, inputs)] = held
        return Geometry(inputs, merged(self._job, other._job))

    def __repr__(self) -> str:
        counts = sum(mesh.num_cells for mesh in self.meshes.values())
        kind = "smooth" if self.is_smooth else "discrete"
        enclosed = self._job.get("domain", {}).get("enclose")
        outer = f", in a {enclosed['shape']}" if enclosed else ""
        return f"<delfront.Geometry {', '.join(self.names)}: {kind}, {counts} cells, chord {self.chord:g}{outer}>"

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(repr(m))}</td></tr>" for name, m in self.meshes.items())
        patches = html.escape(", ".join(self.patches))
        return f"<b>delfront.Geometry</b><table>{rows}<tr><td>patches</td><td>{patches}</td></tr></table>"


def load(
    source: Union[PathLike, Sequence[PathLike], Mesh, Any],
    triangles: Any = None,
    *,
    lines: Any = None,
    patches: Any = None,
    names: Sequence[str] | None = None,
    units: str = "auto",
    name: str = "body",
    format: str = "",
    progress: ProgressHook = None,
) -> Geometry:
    """What is to be gridded: a file or several, a Mesh, or arrays.

    Files: facets (STL, OBJ, PLY, OFF, ...), grids (their stored faces), lines in the plane (.dat, .poly), smooth
    geometry (.geom.toml) and CAD (STEP, IGES, BREP, EGADS). Arrays: ``source`` has the points, (n, 3); ``triangles``
    (m, 3), or quads (m, 4); ``lines`` (k, 2) are kept as edges; points (n, 2) and lines are a boundary in the plane.
    ``patches`` has one number a triangle (in the plane: a line), ``names`` the names of these numbers.
    ``units`` says what a model unit is, for lengths such as "2 mm" and for output.units.

    >>> geo = df.load(points, triangles, patches=[0, 0, 1, 1], names=["wing", "root"], units="m")

    Raises InputError for what cannot be read; UsageError for an unknown kind of file.
    """
    _core.config("", {"input": {"units": units}})
    job: dict[str, Any] = {} if units == "auto" else {"input": {"units": units}}
    if triangles is not None or lines is not None:
        return Geometry({name: _held_arrays(source, triangles, lines, patches, names, name)}, job)
    if isinstance(source, Mesh):
        return Geometry({name: _core.hold_mesh(source._core, name)}, job)
    if isinstance(source, np.ndarray):
        raise TypeError("load(points): give triangles or lines too")
    paths = [source] if isinstance(source, str) or hasattr(source, "__fspath__") else list(source)
    with Hooks(progress=progress) as hooks:
        inputs = {path_text(path): _core.read_input(path_text(path), format, hooks) for path in paths}
    return Geometry(inputs, job)


def enclose(
    geometry: Union[Geometry, PathLike],
    *,
    sphere: Length | None = None,
    circle: Length | None = None,
    box: Union[Length, Sequence[float], None] = None,
    name: str = "farfield",
    h: Length | None = None,
) -> Geometry:
    """The geometry with an outer boundary around it: what lies between is gridded, unless domain.keep says otherwise.

    sphere, circle (in the plane): its radius. box: half its side, or its corners (xmin, ymin, zmin, xmax, ymax, zmax).
    Lengths are numbers in model units or texts, "20c": 20 times the longest side. h: side of its triangles.
    """
    given = {shape: size for shape, size in (("sphere", sphere), ("circle", circle), ("box", box)) if size is not None}
    if len(given) != 1:
        raise TypeError("enclose: give one of sphere, circle and box")
    ((shape, size),) = given.items()
    is_length = isinstance(size, str) or np.ndim(size) == 0
    keys: dict[str, Any] = {"shape": shape, "size" if is_length else "corners": size, "name": name}
    if h is not None:
        keys["h"] = h
    keys = {k: list(v) if k == "corners" else v for k, v in keys.items()}
    _core.config("", {"domain": {"enclose": keys}})
    geo = as_geometry(geometry)
    job = copy.deepcopy(geo._job)
    job.setdefault("domain", {})["enclose"] = keys
    return Geometry(geo._inputs, job)


def as_geometry(source: Any) -> Geometry:
    return source if isinstance(source, Geometry) else load(source)


def merged(base: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """Both trees as one, a new one; where both say something, the second."""
    result = dict(base)
    for key, value in more.items():
        both = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = merged(result[key], value) if both else copy.copy(value)
    return result


def _joined(arrays: list[np.ndarray]) -> np.ndarray:
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def _free_name(name: str, taken: dict[str, Any]) -> str:
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    return free


def _surface_points(mesh: Mesh) -> np.ndarray:
    cells = mesh.cells
    used = [cells[t].vertices if t == "polygon" else cells[t].ravel() for t in _FACES if t in cells]
    return mesh.points[np.unique(np.concatenate(used))] if used else mesh.points


def _held_arrays(
    points: Any, triangles: Any, lines: Any, patches: Any, names: Sequence[str] | None, name: str
) -> _core.Input:
    at = np.ascontiguousarray(points, dtype=np.float64)
    cells: dict[str, np.ndarray] = {}
    if triangles is not None:
        faces = indices(triangles, "triangles")
        if faces.shape[1] not in (3, 4):
            raise ValueError(f"triangles: expected (m, 3), or (m, 4) for quads, got {faces.shape}")
        cells["triangle" if faces.shape[1] == 3 else "quad"] = faces
    if lines is not None:
        cells["line"] = indices(lines, "lines")
    first = next(iter(cells))
    dimension = 1 if first == "line" else 2
    if patches is None:
        called = list(names or ([name] if dimension == 1 else []))  # lines without a name would be "curves"
        groups = [(n, dimension) for n in called[:1]]
        numbers = {first: np.zeros(len(cells[first]), np.int64)} if groups else {}
    else:
        of_cell = np.asarray(patches, dtype=np.int64)
        most = int(of_cell.max(initial=-1)) + 1
        called = list(names) if names is not None else [f"{name}_{i + 1}" for i in range(most)]
        if most > len(called):
            raise ValueError(f"patches: number {most - 1} has no name; there are {len(called)} names")
        groups, numbers = [(n, dimension) for n in called], {first: of_cell}
    mesh = Mesh(at, cells, groups=groups, cell_groups=numbers)
    return _core.hold_mesh(mesh._core, name)
