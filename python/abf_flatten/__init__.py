"""Flatten triangle meshes to the plane by solving for the angles of the flat mesh.

>>> import numpy as np, abf_flatten
>>> vertices = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 0.5]])
>>> flat = abf_flatten.flatten(vertices, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
>>> flat.uv.shape, flat.certificate.injective
((5, 2), True)

`flatten` takes a disk. `unwrap` takes any mesh and makes an atlas. `metrics` and `certify` judge UVs that anybody
made; `relax` makes them better. `pack` lays out the islands of UVs anew. `read` and `write` are for mesh files. `abf_flatten.xatlas` has the
names of the package `xatlas`.

Every function releases the interpreter's lock while it works, may be called from several threads at once, hears Ctrl-C,
and works in a process that was forked. Bad input raises an `AbfError`, which is a `ValueError`; a mesh that would
take more than `max_memory` a `MemoryError`; an argument of a wrong type a `TypeError`.
"""

import atexit as _atexit

from ._abf import (
    AbfError,
    FormatError,
    GeometryError,
    NoResultError,
    NotADiskError,
    SettingError,
    ShapeError,
    TopologyError,
    __version__,
    solvers,
)
from ._abf import end_calls as _end_calls
from ._files import parse, read, write
from ._flatten import flatten
from ._judge import certify, metrics
from ._pack import pack
from ._relax import relax
from ._results import (
    Certificate,
    Flattening,
    InjectiveReport,
    MeshFile,
    Metrics,
    Packed,
    PinReport,
    Progress,
    Relaxed,
    RelaxReport,
    Unwrapped,
)
from ._unwrap import unwrap

# Calls of daemon threads end before the interpreter does.
_atexit.register(_end_calls)

__all__ = [
    "AbfError",
    "Certificate",
    "Flattening",
    "FormatError",
    "GeometryError",
    "InjectiveReport",
    "MeshFile",
    "Metrics",
    "NoResultError",
    "NotADiskError",
    "Packed",
    "PinReport",
    "Progress",
    "RelaxReport",
    "Relaxed",
    "SettingError",
    "ShapeError",
    "TopologyError",
    "Unwrapped",
    "__version__",
    "certify",
    "flatten",
    "metrics",
    "pack",
    "parse",
    "read",
    "relax",
    "solvers",
    "unwrap",
    "write",
]
