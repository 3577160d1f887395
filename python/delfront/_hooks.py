# SPDX-License-Identifier: Apache-2.0
"""What hears of a run: progress on a terminal or in a notebook, messages through the module logging."""

from __future__ import annotations

import logging
import sys
import time
from typing import Callable, NamedTuple, Union

from . import _core

_LOG = logging.getLogger("delfront")
_LEVELS = {"debug": logging.DEBUG, "info": logging.INFO, "warning": logging.WARNING}


class Progress(NamedTuple):
    """What a run is at; ``total`` is 0 where it is not known beforehand."""

    stage: str
    done: int
    total: int
    unit: str


ProgressHook = Union[bool, None, Callable[[Progress], object]]


def _short(count: float) -> str:
    if count < 1e4:
        return f"{count:.0f}"
    return f"{count / 1e3:.1f}k" if count < 1e6 else f"{count / 1e6:.2f}M"


class _Bar:
    """One line that is written over, on stderr; plain lines where that is no terminal."""

    def __init__(self) -> None:
        self.start = self.shown = time.monotonic()
        self.stage = ""
        self.width = 0
        self.is_terminal = hasattr(sys.stderr, "isatty") and sys.stderr.isatty()

    def __call__(self, p: Progress) -> None:
        now = time.monotonic()
        is_new = p.stage != self.stage
        self.stage = p.stage
        if now - self.shown < (0.1 if self.is_terminal else 2.0) and not (is_new and self.is_terminal):
            return
        self.shown = now
        text = f"{p.stage:<14} "
        if p.total:
            share = min(p.done / p.total, 1.0)
            text += f"[{'#' * round(24 * share):.<24}] {100 * share:3.0f}%  {_short(p.done)} of {_short(p.total)} {p.unit}"
        else:
            text += f"{_short(p.done)} {p.unit}"
        if self.is_terminal:
            sys.stderr.write("\r" + text.ljust(self.width))
            self.width = len(text)
        else:
            sys.stderr.write(f"delfront: {text}\n")
        sys.stderr.flush()

    def close(self) -> None:
        if self.is_terminal and self.width:
            sys.stderr.write("\r" + " " * self.width + "\r")
            sys.stderr.flush()


class Hooks:
    """``with Hooks(...) as hooks:`` gives what the functions of the extension take, and clears the bar afterwards."""

    def __init__(self, threads: int = 0, progress: ProgressHook = None) -> None:
        self._bar = _Bar() if progress is True else None
        hear = self._bar if self._bar else progress
        if not hear:
            call = None
        elif callable(hear):
            call = lambda *event: hear(Progress(*event))  # noqa: E731
        else:
            raise TypeError(f"progress: expected True, False or a function; got {progress!r}")
        if not isinstance(threads, int):
            raise TypeError(f"threads: expected a whole number; got {threads!r}")
        self._core = _core.Hooks(threads, call, _log)

    def __enter__(self) -> _core.Hooks:
        return self._core

    def __exit__(self, *_: object) -> None:
        if self._bar:
            self._bar.close()


def _log(level: str, message: str) -> None:
    _LOG.log(_LEVELS[level], "%s", message)
