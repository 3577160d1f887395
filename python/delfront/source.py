# SPDX-License-Identifier: Apache-2.0
"""Sources of sizes: what ``size += df.source.line(...)`` adds.

Places with a size that rises with the distance from them: point, line, polyline, triangle, surface. Regions with one
size in them: box, sphere, cylinder, cone, inside. Lengths are numbers in model units, or texts: "5%", "2 mm", "0.1c".
"""

from __future__ import annotations

from typing import Any, Union

from ._mesh import PathLike, path_text

Length = Union[float, str]


class Source:
    """One entry of [[size.source]] or [[size.box]], as the job file has it."""

    def __init__(self, table: str, entry: dict[str, Any]) -> None:
        self.table = table  #: "source" or "box"
        self.entry = {key: value for key, value in entry.items() if value is not None}

    def __repr__(self) -> str:
        keys = ", ".join(f"{key}={value!r}" for key, value in self.entry.items())
        return f"<Source {self.table}: {keys}>"


def _place(kind: str, at: Any, delta0: Length, law: Any, gamma: float | None, keys: dict[str, Any]) -> Source:
    if isinstance(law, str) and (gamma is not None or "coefficients" in keys):
        law = {"type": law, "gamma": gamma, "coefficients": keys.pop("coefficients", None)}
    elif law is None and gamma is not None:
        law = {"type": "power", "gamma": gamma}
    return Source("source", {"type": kind, "at": at, "delta0": delta0, "law": law, **keys})


def point(*at: Any, delta0: Length, law: Any = None, gamma: float | None = None, **keys: Any) -> Source:
    """One point, or several: ``point((0, 0, 0), (1, 0, 0), delta0=0.01)``.

    delta0 is the size on it, up to the distance r0. With r1 it rises by the law "power": delta0 (1 + rho^gamma),
    "exponential": delta0 e^(gamma rho), or "polynomial" with coefficients, where rho = (r - r0) / r1; without r1 as
    fast as growth lets it. Other keys: stretch, motion, group, as in the job file.
    """
    return _place("point", list(at), delta0, law, gamma, keys)


def line(start: Any, end: Any, *, delta0: Length, law: Any = None, gamma: float | None = None, **keys: Any) -> Source:
    """The line from start to end; keys as of :func:`point`."""
    return _place("line", [start, end], delta0, law, gamma, keys)


def polyline(at: Any, *, delta0: Length, law: Any = None, gamma: float | None = None, **keys: Any) -> Source:
    """Lines through points, (n, 3); keys as of :func:`point`."""
    return _place("polyline", at, delta0, law, gamma, keys)


def triangle(
    a: Any, b: Any, c: Any, *, delta0: Length, law: Any = None, gamma: float | None = None, **keys: Any
) -> Source:
    """A triangle; keys as of :func:`point`."""
    return _place("triangle", [a, b, c], delta0, law, gamma, keys)


def surface(file: PathLike, *, delta0: Length, law: Any = None, gamma: float | None = None, **keys: Any) -> Source:
    """The facets of a file; keys as of :func:`point`."""
    return _place("surface", None, delta0, law, gamma, {"file": path_text(file), **keys})


def box(min: Any, max: Any, h: Length) -> Source:
    """The size h in a box along the axes, growing outside of it."""
    return Source("box", {"shape": "box", "min": min, "max": max, "h": h})


def sphere(centre: Any, radius: Length, h: Length) -> Source:
    """The size h in a sphere."""
    return Source("box", {"shape": "sphere", "centre": centre, "radius": radius, "h": h})


def cylinder(start: Any, end: Any, radius: Length, h: Length) -> Source:
    """The size h in a cylinder with this axis."""
    return Source("box", {"shape": "cylinder", "from": start, "to": end, "radius": radius, "h": h})


def cone(start: Any, end: Any, radius: Length, radius_to: Length, h: Length) -> Source:
    """The size h in a cone, or a part of one, whose radius goes from radius to radius_to."""
    return Source("box", {"shape": "cone", "from": start, "to": end, "radius": radius, "radius_to": radius_to, "h": h})


def inside(file: PathLike, h: Length) -> Source:
    """The size h inside of the closed surface of a file."""
    return Source("box", {"shape": "surface", "file": path_text(file), "h": h})
