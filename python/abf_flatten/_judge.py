"""`metrics` and `certify`."""

from __future__ import annotations

from numpy.typing import ArrayLike

from . import _abf
from ._arrays import mapped
from ._results import Certificate, Metrics, metrics_of
from ._types import Precision, Weld


def metrics(
    vertices: ArrayLike,
    faces: ArrayLike,
    uv: ArrayLike,
    uv_faces: ArrayLike | None = None,
    *,
    as_stored: bool = False,
    weld: Weld = "auto",
    threads: int | None = None,
) -> Metrics:
    """Measure the distortion of UVs that anybody made, and certify them.

    Args:
        vertices: (n, 3) real numbers.
        faces: (m, 3) whole numbers.
        uv: (n, 2) real numbers, one row per vertex; or (k, 2) with `uv_faces`.
        uv_faces: (m, 3) whole numbers: the row of `uv` of every corner.
        as_stored: Judge the faces as they are, without the repair that `unwrap` makes first.
        weld: As for `unwrap`.
        threads: As for `flatten`.

    Returns:
        `Metrics`, with the certificate in them.

    Raises:
        TypeError, ShapeError, GeometryError, SettingError: As for `flatten`; for UVs, too.

    >>> import abf_flatten
    >>> square, faces = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]
    >>> known = abf_flatten.metrics(square, faces, [[0, 0], [2, 0], [2, 1], [0, 1]])
    >>> round(known.qc_max, 9), known.certificate.injective
    (2.0, True)
    """
    settings = {"as_stored": as_stored, "weld": weld, "threads": threads}
    return metrics_of(_abf.metrics(mapped(vertices, faces, uv, uv_faces), settings))


def certify(
    vertices: ArrayLike,
    faces: ArrayLike,
    uv: ArrayLike,
    uv_faces: ArrayLike | None = None,
    *,
    precision: Precision = "double",
    threads: int | None = None,
) -> Certificate:
    """Prove what is true of UVs as they are: whether a triangle is flipped or collapsed, and whether the map overlaps.

    Args:
        vertices, faces, uv, uv_faces, threads: As for `metrics`.
        precision: What the UVs will be stored in: they are rounded to it first.

    Returns:
        A `Certificate`, which is true if the map is valid.

    Raises:
        TypeError, ShapeError, GeometryError, SettingError: As for `metrics`.

    >>> import abf_flatten
    >>> square, faces = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]
    >>> bool(abf_flatten.certify(square, faces, [[0, 0], [1, 0], [1, 1], [2, -1]]))
    False
    """
    settings = {"precision": precision, "threads": threads}
    return Certificate(**_abf.certify(mapped(vertices, faces, uv, uv_faces), settings))
