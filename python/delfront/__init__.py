# SPDX-License-Identifier: Apache-2.0
"""delfront: from CAD or facets to a solver-ready grid.

>>> import delfront as df
>>> geo = df.load("wing.step")
>>> geo = df.enclose(geo, sphere=20 * geo.chord)
>>> mesh = df.mesh(geo, df.Size(hmax=0.5, growth=1.2, curvature=18), progress=True)
>>> print(mesh, mesh.quality.table())
>>> mesh.write("wing.su2")

Functions release Python's lock, can be interrupted, and share nothing: several may run at once in threads. Messages go
to the logger "delfront" of the module logging.
"""

from . import source
from ._core import __version__, has_cad
from ._errors import (
    Error,
    Finding,
    GateError,
    GriddingError,
    InputError,
    InternalError,
    Interrupted,
    LimitError,
    UsageError,
    WriteError,
)
from ._files import Format, convert, formats, read, refine
from ._geometry import Geometry, enclose, load
from ._hooks import Progress
from ._jobs import Estimate, config, estimate, mesh, run, sizes
from ._look import Check, Info, check, info
from ._mesh import NO_GROUP, Entities, Group, Measure, Mesh, Quality, Ragged
from ._size import Size

__all__ = [
    "Check",
    "Entities",
    "Error",
    "Estimate",
    "Finding",
    "Format",
    "GateError",
    "Geometry",
    "GriddingError",
    "Group",
    "Info",
    "InputError",
    "InternalError",
    "Interrupted",
    "LimitError",
    "Measure",
    "Mesh",
    "NO_GROUP",
    "Progress",
    "Quality",
    "Ragged",
    "Size",
    "UsageError",
    "WriteError",
    "__version__",
    "check",
    "config",
    "convert",
    "enclose",
    "estimate",
    "formats",
    "has_cad",
    "info",
    "load",
    "mesh",
    "read",
    "refine",
    "run",
    "sizes",
    "source",
]
