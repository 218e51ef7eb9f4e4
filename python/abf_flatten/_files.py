"""`read`, `parse` and `write`."""

from __future__ import annotations

import os

from numpy.typing import ArrayLike

from . import _abf
from ._arrays import indices, mesh, reals
from ._results import MeshFile


def read(path: str | os.PathLike[str]) -> MeshFile:
    """Read a mesh file: OBJ, OFF, PLY, STL or glTF, by its extension; one that ends in .gz is decompressed.

    Vertices and faces keep their order. Polygons are cut into triangles; what else was done is in `notes`.

    Raises:
        OSError: The file cannot be opened: `FileNotFoundError` and its like.
        FormatError: It cannot be understood. The message says where.
    """
    return MeshFile(**_abf.read(path))


def parse(name: str | os.PathLike[str], data: bytes) -> MeshFile:
    """Read a mesh from the bytes of a file with that name.

    Raises:
        FormatError: They cannot be understood. The message says where.

    >>> import abf_flatten
    >>> mesh = abf_flatten.parse("square.obj", b"v 0 0 0\\nv 1 0 0\\nv 1 1 0\\nv 0 1 0\\nf 1 2 3 4")
    >>> mesh.faces.tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    return MeshFile(**_abf.parse(name, data))


def write(
    path: str | os.PathLike[str],
    vertices: ArrayLike,
    faces: ArrayLike,
    uv: ArrayLike | None = None,
    uv_faces: ArrayLike | None = None,
) -> None:
    """Write a mesh file: OBJ, PLY or glTF, by its extension. It appears under its name only when it is complete.

    Args:
        path: Where.
        vertices: (n, 3) real numbers.
        faces: (m, 3) whole numbers.
        uv: (n, 2) real numbers, one row per vertex; or (k, 2) with `uv_faces`.
        uv_faces: (m, 3) whole numbers: the row of `uv` of every corner.

    Raises:
        OSError: The file cannot be written.
        FormatError: The extension names no format that is written.
        TypeError, ShapeError, GeometryError: As for `flatten`; for UVs, too.
    """
    if uv is None and uv_faces is not None:
        raise _abf.SettingError("uv_faces are rows of uv, which is not given")
    map_rows = None if uv is None else reals(uv, "uv", 2)
    rows = None if uv_faces is None else indices(uv_faces, "uv_faces")
    _abf.write(path, *mesh(vertices, faces), map_rows, rows)
