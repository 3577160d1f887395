# SPDX-License-Identifier: Apache-2.0
"""Looking at files, geometry and grids: facts and defects."""

from __future__ import annotations

import html
import json
from functools import cached_property
from typing import Any, Union

from . import _core
from ._errors import Finding, make_findings
from ._geometry import Geometry
from ._hooks import Hooks, ProgressHook
from ._mesh import Mesh, PathLike, Quality, path_text


class Info(dict):
    """Facts as a dict, as ``delfront info --json`` writes them; ``print()`` shows them as the command does."""

    def __init__(self, facts: dict[str, Any], text: str) -> None:
        super().__init__(facts)
        self._text = text

    def __str__(self) -> str:
        return self._text.rstrip()

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self._text)}</pre>"


class Check:
    """What :func:`check` found. It is true where nothing keeps the thing from being used and all gates are met."""

    def __init__(self, name: str, core: _core.Inspected, require: str, threads: int) -> None:
        self.name = name
        self._core = core
        self._require = require
        self._threads = threads
        #: gates that are not met, as sentences
        self.failed_gates: list[str] = core.quality.failed_gates(require) if require and core.quality else []

    @property
    def is_usable(self) -> bool:
        """A surface that can bound a volume, lines that can be gridded, or a valid grid."""
        return self._core.is_usable

    @property
    def is_grid(self) -> bool:
        """Whether it is a grid; else it is what can be gridded."""
        return self._core.is_grid

    @cached_property
    def findings(self) -> list[Finding]:
        """All defects with their places, and the cells that keep gates from being met."""
        with Hooks(self._threads) as hooks:
            return make_findings(self._core.findings(self._require if self.failed_gates else "", hooks))

    @property
    def quality(self) -> Quality | None:
        """Of a valid grid."""
        return Quality(self._core.quality) if self._core.quality else None

    @cached_property
    def report(self) -> dict[str, Any]:
        """All of it as a dict, as ``delfront check --json`` writes it."""
        return {**json.loads(self._core.facts_json(self.name)), "failed_gates": self.failed_gates}

    def write_defects(self, path: PathLike) -> None:
        """Write all places, edges and faces to a file that ParaView opens (.vtp). Raises WriteError."""
        with Hooks(self._threads) as hooks:
            self._core.write_defects(self._require if self.failed_gates else "", path_text(path), hooks)

    def __bool__(self) -> bool:
        return self.is_usable and not self.failed_gates

    def __str__(self) -> str:
        verdict = f"{self.name} is usable" if self.is_usable else self._core.verdict(self.name)
        return "\n".join([self._core.check_text().rstrip(), *(f"gate not met: {g}" for g in self.failed_gates), verdict])

    def __repr__(self) -> str:
        state = "usable" if self else "not usable" if not self.is_usable else "gates not met"
        return f"<delfront.Check of {self.name}: {state}, {len(self.findings)} findings>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(str(self))}</pre>"


def _inspect(what: Any, format: str, threads: int, progress: ProgressHook) -> tuple[str, _core.Inspected]:
    with Hooks(threads, progress) as hooks:
        if isinstance(what, Mesh):
            return "the grid", _core.inspect_mesh(what._core, "mesh", hooks)
        if isinstance(what, Geometry):
            return ", ".join(what.names), _core.inspect_inputs(list(what._inputs.values()), hooks)
        return path_text(what), _core.inspect_file(path_text(what), format, hooks)


def check(
    what: Union[PathLike, Geometry, Mesh],
    require: str = "",
    *,
    format: str = "",
    threads: int = 0,
    progress: ProgressHook = None,
) -> Check:
    """Every defect of a file, a geometry or a grid, with its places; of a grid its quality and gates too.

    >>> found = df.check("body.stl")
    >>> for finding in found.findings: print(finding, finding.places[:3])
    >>> assert df.check(mesh, require="min_dihedral > 8, max_nonortho < 70")

    Defects are no exceptions. Raises InputError for what cannot be read, UsageError for a wrong gate.
    """
    name, core = _inspect(what, format, threads, progress)
    return Check(name, core, require, threads)


def info(
    what: Union[PathLike, Geometry, Mesh], *, format: str = "", threads: int = 0, progress: ProgressHook = None
) -> Info:
    """Facts about a file, a geometry or a grid: counts, names, box, units, closed or not.

    >>> print(df.info("wing.step"))
    """
    name, core = _inspect(what, format, threads, progress)
    return Info(json.loads(core.facts_json(name)), core.facts_text(name))
