# SPDX-License-Identifier: Apache-2.0
"""What sizes are asked for: the table [size] of a job, and functions."""

from __future__ import annotations

import copy
from typing import Any, Callable, Union

import numpy as np

from . import _core
from .source import Source

SizeFunction = Callable[[np.ndarray], Any]


class Size:
    """Wanted sizes of cells. All that is asked for counts, the smallest at each place.

    >>> size = df.Size(hmax=0.5, hmin=2e-4, growth=1.2, curvature=18, gap=3)
    >>> size += df.source.line((1, 0, 0), (6, 0, 0.4), delta0=0.02, r0=0.1, r1=1.0)
    >>> size += lambda x: 0.01 + 0.1 * np.abs(x[:, 2])
    >>> size += "0.02 + 0.1 * distance('wing')"

    Keys are those of the table [size] of a job file; lengths are numbers in model units, or texts: "5%", "2 mm".
    ``on={"wing": 0.01}`` asks for a size on the patches, curves and corners of a name.

    A function gets places (n, 3) and gives n sizes, or one for all; infinite where it has no opinion. It is called from
    several threads, one at a time, with any number of places, and must give the same size for the same place; detail
    that is smaller than a sixteenth of the domain and lies far from the geometry may be missed.
    """

    def __init__(self, **keys: Any) -> None:
        """Raises UsageError for an unknown key or a wrong value."""
        self._keys: dict[str, Any] = {}
        self._functions: list[SizeFunction] = []
        for key, value in keys.items():
            self._set(key, value)
        self._check()

    def _set(self, key: str, value: Any) -> None:
        if key in ("source", "box"):
            entries = list(value) if isinstance(value, (list, tuple)) else [value]
            for entry in entries:
                self._add_entry(entry if isinstance(entry, Source) else Source(key, dict(entry)))
        elif key == "expression" and callable(value):
            self._functions.append(value)
        elif key == "on" and isinstance(value, dict):
            sizes = {name: h if isinstance(h, dict) else {"h": h} for name, h in value.items()}
            self._keys["on"] = {**self._keys.get("on", {}), **sizes}
        else:
            self._keys[key] = value

    def _add_entry(self, source: Source) -> None:
        self._keys.setdefault(source.table, []).append(source.entry)

    def _add_expression(self, formula: str) -> None:
        before = self._keys.get("expression")
        if before is None:
            self._keys["expression"] = formula
        elif isinstance(before, dict):
            before["delta"] = f"min({before['delta']}, {formula})" if "delta" in before else formula
        else:
            self._keys["expression"] = f"min({before}, {formula})"

    def _check(self) -> None:
        _core.config("", {"size": self._keys})

    def __iadd__(self, other: "Union[Source, SizeFunction, str, Size]") -> "Size":
        """Ask for more: a source, a function, a formula, or all that another Size asks for."""
        before = copy.deepcopy(self._keys)
        if isinstance(other, Source):
            self._add_entry(other)
        elif isinstance(other, str):
            self._add_expression(other)
        elif isinstance(other, Size):
            self._merge(other)
        elif callable(other):
            self._functions.append(other)
        else:
            raise TypeError(f"expected a source, a function, a formula or a Size; got {type(other).__name__}")
        try:
            self._check()
        except Exception:
            self._keys = before
            raise
        return self

    def _merge(self, other: "Size") -> None:
        for key, value in copy.deepcopy(other._keys).items():
            if key == "expression" and isinstance(value, str):
                self._add_expression(value)
            else:
                self._set(key, value)
        self._functions += other._functions

    def __add__(self, other: "Union[Source, SizeFunction, str, Size]") -> "Size":
        result = Size()
        result._keys, result._functions = copy.deepcopy(self._keys), list(self._functions)
        result += other
        return result

    @property
    def job(self) -> dict[str, Any]:
        """What the job file would have in [size]: a copy, without the functions."""
        return copy.deepcopy(self._keys)

    def __repr__(self) -> str:
        parts = [f"{key}={value!r}" for key, value in self._keys.items()]
        parts += [f"<function {getattr(f, '__name__', '?')}>" for f in self._functions]
        return f"Size({', '.join(parts)})"


def vectorised(function: SizeFunction) -> SizeFunction:
    """What the extension calls: one float64 a place, in C order."""

    def sizes(at: np.ndarray) -> np.ndarray:
        given = function(at)
        if given is None:
            raise TypeError(f"the function {getattr(function, '__name__', 'of sizes')} gave None, not sizes")
        values = np.asarray(given, dtype=np.float64)
        if values.shape == (len(at),) and values.flags.c_contiguous:
            return values
        if values.shape not in ((), (len(at),), (len(at), 1)):
            name = getattr(function, "__name__", "of sizes")
            raise ValueError(
                f"the function {name} gave the shape {values.shape} for {len(at)} places; expected ({len(at)},)"
            )
        return np.array(np.broadcast_to(values.reshape(-1), (len(at),)), dtype=np.float64)

    return sizes
