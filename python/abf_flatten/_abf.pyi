"""The native part: arrays of one type each in, dicts out."""

import os
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._types import Indices, Mapped, Reals

_Settings: TypeAlias = dict[str, Any]
_Progress: TypeAlias = Callable[[str, str | None, int, float, int, int], object]

__all__ = [
    "AbfError",
    "FormatError",
    "GeometryError",
    "NoResultError",
    "NotADiskError",
    "SettingError",
    "ShapeError",
    "TopologyError",
    "__version__",
    "certify",
    "end_calls",
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

__version__: str
solvers: list[str]

class AbfError(ValueError): ...
class ShapeError(AbfError): ...
class GeometryError(AbfError): ...
class TopologyError(AbfError): ...
class NotADiskError(AbfError): ...
class SettingError(AbfError): ...
class NoResultError(AbfError): ...
class FormatError(AbfError): ...

def flatten(
    vertices: Reals, faces: Indices, settings: _Settings, progress: _Progress | None
) -> dict[str, Any]: ...
def unwrap(
    vertices: Reals,
    faces: Indices,
    hints: Mapping[str, Any],
    settings: _Settings,
    progress: _Progress | None,
) -> dict[str, Any]: ...
def relax(mapped: Mapped, settings: _Settings, progress: _Progress | None) -> dict[str, Any]: ...
def metrics(mapped: Mapped, settings: _Settings) -> dict[str, Any]: ...
def certify(mapped: Mapped, settings: _Settings) -> dict[str, Any]: ...
def pack(mapped: Mapped, materials: NDArray[np.uint32] | None, settings: _Settings) -> dict[str, Any]: ...
def read(path: str | os.PathLike[str]) -> dict[str, Any]: ...
def parse(name: str | os.PathLike[str], data: bytes) -> dict[str, Any]: ...
def write(
    path: str | os.PathLike[str],
    vertices: Reals,
    faces: Indices,
    uv: Reals | None,
    uv_faces: Indices | None,
) -> None: ...

def end_calls() -> None: ...
