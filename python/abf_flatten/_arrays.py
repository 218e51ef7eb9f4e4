"""Arrays of anybody as arrays of one type. What is of that type already is not copied here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._abf import GeometryError, ShapeError
from ._results import Progress
from ._types import Indices, Mapped, OnProgress, Pins, Reals


def reals(given: ArrayLike, name: str, columns: int) -> NDArray[np.float64]:
    """An (n, columns) array of floats; whole numbers become floats."""
    array = np.asarray(given)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be real numbers, got an array of {array.dtype}")
    return np.ascontiguousarray(_shaped(array, name, columns), dtype=np.float64)


def indices(given: ArrayLike, name: str, columns: int = 3) -> NDArray[np.int64]:
    """An (n, columns) array of whole numbers."""
    array = np.asarray(given)
    if array.size == 0 and not isinstance(given, np.ndarray):
        # An empty list has no type of its own.
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be whole numbers, got an array of {array.dtype}")
    array = _shaped(array, name, columns)
    if array.dtype == np.uint64 and array.size and array.max() > np.iinfo(np.int64).max:
        raise GeometryError(f"{name} has the index {array.max()}, which names nothing")
    return np.ascontiguousarray(array, dtype=np.int64)


def mesh(vertices: ArrayLike, faces: ArrayLike) -> tuple[Reals, Indices]:
    """The arrays of a mesh."""
    return reals(vertices, "vertices", 3), indices(faces, "faces")


def mapped(vertices: ArrayLike, faces: ArrayLike, uv: ArrayLike, uv_faces: ArrayLike | None) -> Mapped:
    """The arrays of a mesh with UVs."""
    rows = None if uv_faces is None else indices(uv_faces, "uv_faces")
    return (*mesh(vertices, faces), reals(uv, "uv", 2), rows)


def settings_of(arguments: Mapping[str, Any], *others: str) -> dict[str, Any]:
    """Those arguments of a call that are settings: all but `others`."""
    return {name: value for name, value in arguments.items() if name not in others}


def labels(given: ArrayLike | None, name: str) -> NDArray[np.uint32] | None:
    """A label for every face: equal ones have one number."""
    if given is None:
        return None
    array = np.asarray(given)
    if array.ndim != 1:
        raise ShapeError(f"{name} must have shape (m,), got {array.shape}")
    if array.size and array.dtype.kind not in "biuUSO":
        raise TypeError(f"{name} must be whole numbers or names, got an array of {array.dtype}")
    numbers: NDArray[np.uint32] = np.unique(array, return_inverse=True)[1].reshape(-1).astype(np.uint32)
    return numbers


def pins_of(given: Pins | None) -> list[tuple[int, tuple[float, float], float | None]] | None:
    """Pins for the native part: the vertex, its place, and its weight where it is soft."""
    if given is None:
        return None
    if not isinstance(given, Mapping):
        raise TypeError(f"pins must be a dict of vertices with their places, got {type(given).__name__}")
    pins = []
    for vertex, place in given.items():
        try:
            numbers = [float(x) for x in place]
        except (TypeError, ValueError):
            raise TypeError(f"pins[{vertex!r}] must be (u, v) or (u, v, weight), got {place!r}") from None
        if len(numbers) not in (2, 3):
            raise ShapeError(f"pins[{vertex!r}] must be (u, v) or (u, v, weight), got {len(numbers)} numbers")
        pins.append((vertex, (numbers[0], numbers[1]), numbers[2] if len(numbers) == 3 else None))
    return pins


def teller(progress: OnProgress | None) -> Any:
    """A callable for the native part."""
    if progress is None:
        return None
    if not callable(progress):
        raise TypeError(f"progress must be callable, got {type(progress).__name__}")
    return lambda *news: progress(Progress(*news))


def _shaped(array: NDArray[Any], name: str, columns: int) -> NDArray[Any]:
    if array.ndim != 2 or array.shape[1] != columns:
        raise ShapeError(f"{name} must have shape (n, {columns}), got {array.shape}")
    return array
