# SPDX-License-Identifier: Apache-2.0
"""Exceptions: one class for each way in which a run can end, with the places where something is wrong."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._mesh import Mesh


@dataclass
class Finding:
    """One kind of thing found in a surface or a grid: how many, which, where, what to try."""

    kind: str  #: stable key: "open_edges", "self_intersection", "flat_cell", ...
    severity: str  #: "error", "warning" or "note"
    count: int
    message: str  #: a sentence with the count and the first place
    remedy: str  #: what to try; may be empty
    places: np.ndarray = field(repr=False)  #: (n, 3) where, the first 1000
    ids: list[list[int]] = field(repr=False)  #: of the entities at each place

    def __str__(self) -> str:
        return f"{self.severity}: {self.message}" + (f"; try: {self.remedy}" if self.remedy else "")


class Error(Exception):
    """Base of all errors that a caller can do something about. The message says what, where, and what to try.

    ``exit_code`` is that of the command line. ``places`` is (n, 3), ``ids`` has one list for each place. ``findings``
    are all defects, each with its own places. ``report`` is the whole report of the run as a dict, where there was one.
    ``mesh`` is the grid (of a :class:`GateError`), ``partial`` the grid as far as it came (of a
    :class:`GriddingError`), else None.
    """

    exit_code = 1

    def __init__(self, message: str, places: Any = None, ids: list[list[int]] | None = None) -> None:
        super().__init__(message)
        self.places: np.ndarray = np.zeros((0, 3)) if places is None else np.asarray(places, dtype=float).reshape(-1, 3)
        self.ids: list[list[int]] = [] if ids is None else ids
        self.findings: list[Finding] = []
        self.report: dict[str, Any] | None = None
        self.mesh: Mesh | None = None
        self.partial: Mesh | None = None


class InternalError(Error):
    """A defect of delfront itself (exit code 1): please report it."""

    exit_code = 1


class UsageError(Error, ValueError):
    """A wrong key or value (exit code 2): the key, what is allowed, the nearest right name."""

    exit_code = 2


class InputError(Error):
    """Input that cannot be read, is invalid, or cannot bound what was asked for (exit code 3)."""

    exit_code = 3


class GriddingError(Error):
    """Gridding failed after all recovery steps (exit code 4)."""

    exit_code = 4


class GateError(Error):
    """The grid does not meet a gate of ``output.require`` (exit code 5); ``mesh`` is the grid."""

    exit_code = 5


class LimitError(Error):
    """A limit of time, memory or cells was reached (exit code 6)."""

    exit_code = 6


class WriteError(Error):
    """A file cannot be written: permission, missing folder, disk full (exit code 7)."""

    exit_code = 7


class Interrupted(Error):
    """The run was stopped (exit code 130)."""

    exit_code = 130


_BY_CODE = {
    kind.exit_code: kind
    for kind in (InternalError, UsageError, InputError, GriddingError, GateError, LimitError, WriteError, Interrupted)
}


def make_error(code: int, message: str, places: Any = None, ids: list[list[int]] | None = None) -> Error:
    """The exception of an exit code; the extension calls this."""
    return _BY_CODE.get(code, InternalError)(message, places, ids)


def make_findings(raw: list[dict[str, Any]]) -> list[Finding]:
    return [Finding(**finding) for finding in raw]
