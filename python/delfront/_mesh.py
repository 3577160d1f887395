# SPDX-License-Identifier: Apache-2.0
"""Grids: arrays as views, named groups, quality, and what goes to other programs."""

from __future__ import annotations

import html
import json
import os
from functools import cached_property
from typing import Any, Iterable, Mapping, NamedTuple, Union

import numpy as np

from . import _core
from ._errors import Finding, GateError, make_findings
from ._hooks import Hooks

NO_GROUP = 0xFFFFFFFF  #: in ``cell_groups``: the cell is in no group
_DIMENSION = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2, "polygon": 2}  # the rest: 3
_VTK = {"vertex": 1, "line": 3, "triangle": 5, "quad": 9, "tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14}

PathLike = Union[str, "os.PathLike[str]"]


class Ragged(NamedTuple):
    """Cells of any number of points: cell i has ``vertices[offsets[i]:offsets[i + 1]]`` (polyhedra: VTK's face stream)."""

    offsets: np.ndarray
    vertices: np.ndarray


class Entities(NamedTuple):
    """On what of the geometry each point lies: (n,) views. dimension 0 corner, 1 curve, 2 patch, 3 region."""

    dimension: np.ndarray
    id: np.ndarray
    u: np.ndarray
    v: np.ndarray


class Group:
    """A named set of cells of one dimension: a region, a patch, a curve, points."""

    def __init__(self, mesh: "Mesh", index: int, name: str, dimension: int, kind: str, two_sided: bool) -> None:
        self._mesh = mesh
        self.index = index  #: its number in ``mesh.cell_groups``
        self.name = name
        self.dimension = dimension  #: of its cells
        self.kind = kind  #: "wall", "farfield", ...; empty where nobody said
        self.two_sided = two_sided  #: faces with cells on both sides

    @property
    def ids(self) -> dict[str, np.ndarray]:
        """Numbers of its cells by type."""
        found = {t: np.flatnonzero(g == self.index) for t, g in self._mesh.cell_groups.items()}
        return {t: ids for t, ids in found.items() if len(ids)}

    @property
    def cells(self) -> dict[str, np.ndarray]:
        """Its cells by type, each (k, points of the type); copies."""
        return {t: self._mesh.cells[t][ids] for t, ids in self.ids.items()}

    @property
    def num_cells(self) -> int:
        return sum(int(np.count_nonzero(g == self.index)) for g in self._mesh.cell_groups.values())

    def __repr__(self) -> str:
        kind = f", kind={self.kind!r}" if self.kind else ""
        return f"<Group {self.name!r}, dimension {self.dimension}, {self.num_cells} cells{kind}>"


class Measure(NamedTuple):
    """One measure of quality over all cells (or faces)."""

    name: str
    unit: str
    min: float
    max: float
    mean: float
    histogram: tuple[np.ndarray, np.ndarray]  #: counts and the edges of the bins, as numpy.histogram gives them
    worst: np.ndarray  #: values of the worst, the worst first
    places: np.ndarray  #: (n, 3) their centroids
    cells: list[list[int]]  #: the cell, or the two cells of a face


class Quality(Mapping[str, Measure]):
    """Quality of a grid, angles in degrees: ``quality["min_dihedral"].min``, ``print(quality.table())``."""

    def __init__(self, core: _core.Quality) -> None:
        self._core = core

    @cached_property
    def report(self) -> dict[str, Any]:
        """All of it as a dict, as in the report of a run."""
        return json.loads(self._core.json())

    @property
    def volume(self) -> float:
        """Volume of the grid; of one in the plane its area."""
        return self.report["volume"]

    @property
    def num_cells(self) -> int:
        return self.report["num_cells"]

    @cached_property
    def _measures(self) -> dict[str, Measure]:
        return {name: _measure(name, raw) for name, raw in self.report["measures"].items()}

    def __getitem__(self, name: str) -> Measure:
        return self._measures[name]

    def __iter__(self):
        return iter(self._measures)

    def __len__(self) -> int:
        return len(self._measures)

    def table(self, worst: int = 0) -> str:
        """min, mean and max of each measure as text; with so many of the worst cells and their places."""
        return self._core.text(worst)

    def failed_gates(self, gates: str) -> list[str]:
        """Those of "min_dihedral > 8, max_nonortho < 70" that are not met, as sentences."""
        return self._core.failed_gates(gates)

    def __repr__(self) -> str:
        return f"<Quality of {self.num_cells} cells: {', '.join(self)}>"

    def __str__(self) -> str:
        return self.table()

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{m.name}</td><td>{m.min:.4g}</td><td>{m.mean:.4g}</td><td>{m.max:.4g}</td><td>{m.unit}</td></tr>"
            for m in self.values()
        )
        return f"<table><tr><th>quality</th><th>min</th><th>mean</th><th>max</th><th></th></tr>{rows}</table>"


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _measure(name: str, raw: dict[str, Any]) -> Measure:
    counts = np.asarray(raw["histogram"]["counts"], dtype=np.int64)
    low, high = _number(raw["histogram"]["low"]), _number(raw["histogram"]["high"])
    worst = raw["worst"]
    return Measure(
        name,
        raw["unit"],
        _number(raw["min"]),
        _number(raw["max"]),
        _number(raw["mean"]),
        (counts, np.linspace(low, high, len(counts) + 1)),
        np.array([_number(w["value"]) for w in worst]),
        np.array([w["at"] for w in worst], dtype=float).reshape(-1, 3),
        [w["cells"] for w in worst],
    )


class Mesh:
    """A grid. All arrays are read-only views of its own memory, which lives as long as any of them.

    >>> mesh = df.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], {"tetra": [[0, 1, 2, 3]]})
    >>> mesh.cells["tetra"].shape
    (1, 4)
    """

    def __init__(
        self,
        points: Any,
        cells: Mapping[str, Any],
        *,
        groups: Iterable[Any] = (),
        cell_groups: Mapping[str, Any] | None = None,
        point_data: Mapping[str, Any] | None = None,
    ) -> None:
        """A grid of arrays, which are copied.

        points: (n, 3), in the plane (n, 2). cells: by type ("tetra", "triangle", ...) the numbers of their points.
        groups: names, or (name, dimension[, kind[, two_sided]]); names alone are groups of faces (in the plane: lines).
        cell_groups: by type one number of a group a cell. point_data: by name (n,) or (n, k).
        Raises InputError for numbers of points or groups that there are not.
        """
        at = np.ascontiguousarray(points, dtype=np.float64)
        if at.ndim != 2:
            raise ValueError(f"points: expected (n, 3) or (n, 2), got the shape {at.shape}")
        of_cells = dict(cell_groups or {})
        unknown = set(of_cells) - set(cells)
        if unknown:
            raise ValueError(f"cell_groups of {', '.join(sorted(unknown))}, which there are no cells of")
        given = [(t, indices(c, t), _group_ids(of_cells.get(t))) for t, c in cells.items()]
        data = {n: _columns(n, v) for n, v in (point_data or {}).items()}
        self._set(_core.make_mesh(at, given, [_group_row(g, at.shape[1]) for g in groups], data))

    @classmethod
    def _of(cls, core: _core.Mesh, **facts: Any) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh._set(core, **facts)
        return mesh

    def _set(self, core: _core.Mesh, report: str = "null", quality: _core.Quality | None = None, **lists: Any) -> None:
        self._core = core
        self._report = report
        self._quality = quality
        self.warnings: list[str] = lists.get("warnings", [])  #: of the run that made it
        self.name_changes: list[str] = lists.get("name_changes", [])  #: names that a format could not hold
        self.files_written: list[str] = lists.get("files_written", [])

    # --- arrays -----------------------------------------------------------------------------------------------------

    @property
    def points(self) -> np.ndarray:
        """(n, 3) float64, model units; in the plane z = 0."""
        return self._core.points

    @cached_property
    def cells(self) -> dict[str, Any]:
        """By type, with the names of meshio: (m, points of the type) uint32; polygons and polyhedra: :class:`Ragged`."""
        return {t: Ragged(*c) if isinstance(c, tuple) else c for t, c in self._core.cells.items()}

    @cached_property
    def cell_groups(self) -> dict[str, np.ndarray]:
        """By type (m,) uint32: the number of each cell's group in ``groups``, NO_GROUP where it is in none."""
        return self._core.cell_groups

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """All named groups: regions, patches, curves, points."""
        return tuple(Group(self, i, *group) for i, group in enumerate(self._core.groups))

    def _groups_of(self, dimension: int) -> dict[str, Group]:
        return {g.name: g for g in self.groups if g.dimension == dimension}

    @property
    def dimension(self) -> int:
        """Of the space: 3, or 2 where all lies in the plane."""
        return self._core.dimension

    @property
    def regions(self) -> dict[str, Group]:
        """Groups of volume cells (in the plane: of faces), by name."""
        return self._groups_of(self.dimension)

    @property
    def boundaries(self) -> dict[str, Group]:
        """Groups of boundary faces (in the plane: of lines), by name."""
        return self._groups_of(self.dimension - 1)

    @property
    def curves(self) -> dict[str, Group]:
        """Groups of lines in space, by name."""
        return self._groups_of(1) if self.dimension == 3 else {}

    @cached_property
    def point_data(self) -> dict[str, np.ndarray]:
        """Fields on points: (n,) or (n, components)."""
        return self._core.point_data

    @cached_property
    def cell_data(self) -> dict[str, dict[str, np.ndarray]]:
        """Fields on cells, by name and type: (m,) or (m, components)."""
        return self._core.cell_data

    @cached_property
    def entities(self) -> Entities | None:
        """On what of the geometry each point lies; None where that is not known."""
        raw = self._core.entities
        return None if raw is None else Entities(*raw)

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """The least and the greatest coordinates."""
        low, high = self._core.box
        return np.array(low), np.array(high)

    @property
    def num_points(self) -> int:
        return len(self.points)

    @property
    def num_cells(self) -> int:
        """Cells of the highest dimension."""
        top = self._core.top_dimension
        return sum(_count(c) for t, c in self.cells.items() if _DIMENSION.get(t, 3) == top)

    # --- facts ------------------------------------------------------------------------------------------------------

    @property
    def quality(self) -> Quality:
        """Angles, aspect ratios, non-orthogonality, ... measured when first asked for."""
        if self._quality is None:
            with Hooks() as hooks:
                self._quality = self._core.quality(hooks)
        return Quality(self._quality)

    @cached_property
    def report(self) -> dict[str, Any] | None:
        """The whole report of the run that made it, as ``--report`` writes it; None where there was no run."""
        return json.loads(self._report)

    def check(self) -> list[Finding]:
        """What is wrong with it as a grid, exactly; empty for a valid one."""
        with Hooks() as hooks:
            return make_findings(self._core.check(hooks))

    def require(self, gates: str) -> "Mesh":
        """Raise GateError, with the places of the worst cells, unless all gates are met: "min_dihedral > 8"."""
        failed = self.quality.failed_gates(gates)
        if not failed:
            return self
        with Hooks() as hooks:
            findings = make_findings(self._core.gate_failures(gates, hooks))
        error = GateError("the grid does not meet: " + "; ".join(failed))
        error.mesh, error.findings = self, findings
        if findings:
            error.places = np.concatenate([f.places for f in findings])
            error.ids = [ids for f in findings for ids in f.ids]
        raise error

    def __repr__(self) -> str:
        counts = ", ".join(f"{_count(c)} {t}" for t, c in self.cells.items())
        return f"<delfront.Mesh: {self.num_points} points, {counts}>"

    def __str__(self) -> str:
        return self._core.text().rstrip()

    def _repr_html_(self) -> str:
        cells = "".join(f"<tr><td>{t}</td><td>{_count(c):,}</td></tr>" for t, c in self.cells.items())
        groups = "".join(
            f"<tr><td>{html.escape(g.name)}</td><td>{g.num_cells:,}</td><td>{html.escape(g.kind)}</td></tr>"
            for g in self.groups
        )
        return (
            f"<b>delfront.Mesh</b><table><tr><td>points</td><td>{self.num_points:,}</td></tr>{cells}</table>"
            f"<table><tr><th>group</th><th>cells</th><th>kind</th></tr>{groups}</table>"
        )

    # --- out --------------------------------------------------------------------------------------------------------

    def write(
        self,
        path: PathLike,
        *,
        format: str = "",
        ascii: bool = False,
        compress: bool = False,
        msh_version: str = "",
        solver: str = "",
    ) -> list[str]:
        """Write a file, whole or not at all; a name that ends in / is an OpenFOAM case.

        ``solver`` ("su2", "openfoam"): also starter files that name every boundary, beside the grid; files that exist
        are kept. Returns what the format could not hold and how it was changed, and what starter files take for
        granted, as sentences. Raises WriteError; InputError where the format cannot hold this grid; UsageError for an
        unknown format, or a solver that reads another one.
        """
        with Hooks() as hooks:
            return _core.write_mesh(
                self._core, path_text(path), not ascii, msh_version, compress, format, solver, hooks
            )

    def to_meshio(self) -> Any:
        """The grid as meshio.Mesh: cells, point data, groups as cell sets and as "gmsh:physical" tags.

        Polyhedra, and cell data that only some types of cells have, are left out, for meshio has no place for them.
        """
        meshio = _needed("meshio", "to_meshio()")
        types = [t for t, c in self.cells.items() if not isinstance(c, Ragged)]
        tags = {t: self.cell_groups.get(t, np.full(len(self.cells[t]), NO_GROUP, np.uint32)) for t in types}
        physical = [np.where(tags[t] == NO_GROUP, 0, tags[t].astype(np.int64) + 1) for t in types]
        data = {n: [v[t] for t in types] for n, v in self.cell_data.items() if set(v) == set(types)}
        return meshio.Mesh(
            self.points,
            [(t, self.cells[t].astype(np.int64)) for t in types],
            point_data=dict(self.point_data),
            cell_data={**data, "gmsh:physical": physical},
            cell_sets={g.name: [np.flatnonzero(tags[t] == g.index) for t in types] for g in self.groups},
            field_data={g.name: np.array([g.index + 1, g.dimension]) for g in self.groups},
        )

    def to_pyvista(self) -> Any:
        """The grid as pyvista.UnstructuredGrid, with the number of each cell's group as "group"."""
        pyvista = _needed("pyvista", "to_pyvista()")
        types = [t for t in self.cells if t in _VTK]
        cells, kinds, groups = [], [], []
        for t in types:
            c = self.cells[t]
            cells.append(np.hstack([np.full((len(c), 1), c.shape[1], np.int64), c.astype(np.int64)]).ravel())
            kinds.append(np.full(len(c), _VTK[t], np.uint8))
            ids = self.cell_groups.get(t, np.full(len(c), NO_GROUP, np.uint32))
            groups.append(np.where(ids == NO_GROUP, -1, ids.astype(np.int64)))
        grid = pyvista.UnstructuredGrid(np.concatenate(cells), np.concatenate(kinds), np.array(self.points))
        grid.cell_data["group"] = np.concatenate(groups)
        for name, values in self.point_data.items():
            grid.point_data[name] = np.array(values)
        return grid

    def view(self, **options: Any) -> Any:
        """Show the grid in a window (in a notebook: below the cell) by pyvista, whose plot() takes the options."""
        return self.to_pyvista().plot(**{"show_edges": True, **options})


def path_text(path: PathLike) -> str:
    text = os.fspath(path)
    if not isinstance(text, str):
        raise TypeError(f"expected a path as text, got {path!r}")
    return text


def indices(values: Any, what: str) -> np.ndarray:
    """(m, k) uint32 in C order, of whole numbers of any kind."""
    array = np.asarray(values)
    if array.ndim != 2 or (array.size and array.dtype.kind not in "iu"):
        raise ValueError(f"{what}: expected whole numbers of the shape (m, k), got {array.dtype} of {array.shape}")
    if array.size and (array.min() < 0 or array.max() >= NO_GROUP):
        raise ValueError(f"{what}: numbers of points are from 0; got {array.min()} to {array.max()}")
    return np.ascontiguousarray(array, dtype=np.uint32)


def _group_ids(values: Any) -> np.ndarray | None:
    if values is None:
        return None
    array = np.asarray(values).astype(np.int64)
    return np.ascontiguousarray(np.where(array < 0, NO_GROUP, array), dtype=np.uint32)


def _group_row(group: Any, dimension: int) -> tuple[str, int, str, bool]:
    if isinstance(group, Group):
        return (group.name, group.dimension, group.kind, group.two_sided)
    row = (group,) if isinstance(group, str) else tuple(group)
    return (*row, *(None, dimension - 1, "", False)[len(row) :])  # type: ignore[return-value]


def _columns(name: str, values: Any) -> np.ndarray:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim not in (1, 2):
        raise ValueError(f"point data {name!r}: expected (n,) or (n, k), got {array.shape}")
    return array.reshape(len(array), -1) if array.size else array.reshape(len(array), 1)


def _count(cells: Any) -> int:
    return len(cells.offsets) - 1 if isinstance(cells, Ragged) else len(cells)


def _needed(module: str, what: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"{what} needs the package {module}, which is not installed: pip install {module}") from error
