# SPDX-License-Identifier: Apache-2.0
"""Jobs: grids, estimates and sizes. All options are those of the job file; the library's table of them decides."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Union

from . import _core
from ._errors import Error, InternalError, make_error, make_findings
from ._geometry import Geometry, as_geometry, merged
from ._hooks import Hooks, ProgressHook
from ._mesh import Mesh, PathLike, path_text
from ._size import Size, SizeFunction, vectorised

Job = Union[dict, str, "os.PathLike[str]"]
AnySize = Union[Size, SizeFunction, dict, str, float, None]


def mesh(
    geometry: Union[Geometry, Mesh, PathLike],
    size: AnySize = None,
    *,
    threads: int = 0,
    progress: ProgressHook = None,
    **job: Any,
) -> Mesh:
    """Grid what a geometry bounds.

    geometry: what :func:`load` gave, or what it takes. size: a :class:`Size`, or what one can be made of: a dict, a
    function, a formula, a number (hmax). threads: 0 is all; the grid is the same for any number. progress: True shows
    a bar, a function is called with a :class:`Progress`. All other words are tables of the job file, as dicts; where a
    table has a main key, its value will do: volume="front" for volume={"method": "front"}, surface=, planar=,
    improve=False, refine=1.

    >>> mesh = df.mesh(geo, size, volume="front", boundaries={"wing": {"kind": "wall"}}, limits={"time": "10min"})

    Nothing is written unless output={"files": [...]} asks for it.

    Raises UsageError (an unknown key, a wrong value), InputError (places of what cannot be gridded), GriddingError,
    GateError (output={"require": ...}; it carries the grid), LimitError, WriteError; what a function raised.
    """
    return _grid(_run("grid", "delfront.mesh", geometry, size, job, threads, progress))


def run(
    job: Job,
    size: AnySize = None,
    *,
    threads: int = 0,
    progress: ProgressHook = None,
    **more: Any,
) -> Mesh:
    """Run a whole job: a job file (TOML or JSON), or the same tree as a dict. Words beside it win over it.

    Paths in a job file are relative to its folder, in a dict to where the program is. The grid is returned, and
    written to output.files, which may be left out. Raises as :func:`mesh`.

    >>> mesh = df.run({"input": {"files": ["wing.stl"]}, "size": {"growth": 1.3}, "output": {"files": ["wing.vtu"]}})
    >>> mesh = df.run("case.toml", output={"files": ["wing.su2"]})
    """
    return _grid(_run("grid", "delfront.run", job, size, more, threads, progress))


@dataclass(frozen=True)
class Estimate:
    """What a grid will take, before the run."""

    cells: float
    points: float
    measure: float  #: volume or area that is gridded
    least_size: float
    greatest_size: float
    memory_bytes: float  #: at the peak
    seconds: float  #: of the whole run
    is_at_least: bool  #: sizes are finer in places than was looked at


def estimate(
    geometry: Union[Geometry, Mesh, Job],
    size: AnySize = None,
    *,
    threads: int = 0,
    progress: ProgressHook = None,
    **job: Any,
) -> Estimate:
    """Cells, memory and time of what :func:`mesh` (or, for a job, :func:`run`) would make with the same arguments."""
    outcome = _run("estimate", "delfront.estimate", geometry, size, job, threads, progress)
    _raise(outcome)
    return Estimate(**json.loads(outcome["report"])["estimate"])


def sizes(
    geometry: Union[Geometry, Mesh, Job],
    size: AnySize = None,
    *,
    threads: int = 0,
    progress: ProgressHook = None,
    **job: Any,
) -> Mesh:
    """The sizes that are asked for, to look at: an octree of hexahedra with ``point_data["h"]``."""
    return _grid(_run("sizes", "delfront.sizes", geometry, size, job, threads, progress))


def config(job: Job = {}, **more: Any) -> str:  # noqa: B006 (it is not changed)
    """The whole configuration of a job as a job file (TOML), defaults included, with a comment a key.

    >>> print(df.config(size={"hmax": "5%"}))
    """
    file, tree = ("", job) if isinstance(job, dict) else (path_text(job), {})
    return _core.config(file, merged(tree, more))


def _as_size(size: AnySize) -> Size:
    if isinstance(size, Size):
        return size
    if isinstance(size, dict):
        return Size(**size)
    if size is None:
        return Size()
    if callable(size) or isinstance(size, str) and not size.strip()[-1:] in "%cmnt" and not _is_number(size):
        return Size() + size
    return Size(hmax=size)


def _is_number(text: str) -> bool:
    try:
        float(text)
        return True
    except ValueError:
        return False


def _is_job(source: Any) -> bool:
    if isinstance(source, dict):
        return True
    if not isinstance(source, str) and not hasattr(source, "__fspath__"):
        return False
    path = path_text(source)
    return path.endswith((".toml", ".json")) and not _core.is_smooth_file(path)


def _run(
    kind: str, command: str, source: Any, size: AnySize, job: dict[str, Any], threads: int, progress: ProgressHook
) -> dict[str, Any]:
    asked = _as_size(size)
    tree: dict[str, Any] = {}
    file, held = "", {}
    if isinstance(source, dict):
        tree = source
    elif _is_job(source):
        file = path_text(source)
    else:
        geometry = as_geometry(source)
        tree, held = geometry.job, geometry._inputs
    if asked.job:
        tree = merged(tree, {"size": asked.job})
    tree = merged(tree, job)
    functions = [vectorised(function) for function in asked._functions]
    with Hooks(threads, progress) as hooks:
        return _core.run_job(file, tree, held, functions, kind, command, hooks)


def _facts(outcome: dict[str, Any]) -> dict[str, Any]:
    names = ("report", "quality", "warnings", "name_changes", "files_written")
    return {name: outcome[name] for name in names}


def _raise(outcome: dict[str, Any]) -> None:
    if outcome["exit_code"] == 0:
        return
    error: Error = make_error(outcome["exit_code"], outcome["error"], outcome["places"], outcome["ids"])
    error.report = json.loads(outcome["report"])
    error.findings = make_findings(outcome["findings"])
    if outcome["mesh"] is not None:
        error.mesh = Mesh._of(outcome["mesh"], **_facts(outcome))
    if outcome["partial"] is not None:
        error.partial = Mesh._of(outcome["partial"])
    raise error


def _grid(outcome: dict[str, Any]) -> Mesh:
    _raise(outcome)
    if outcome["mesh"] is None:
        raise InternalError("the run ended without a grid and without an error; please report this")
    return Mesh._of(outcome["mesh"], **_facts(outcome))
