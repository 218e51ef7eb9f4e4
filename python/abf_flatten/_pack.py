"""`pack`."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from . import _abf
from ._arrays import labels, mapped, settings_of
from ._results import Packed, with_metrics
from ._types import Effort, Pages


def pack(
    vertices: ArrayLike,
    faces: ArrayLike,
    uv: ArrayLike,
    uv_faces: ArrayLike | None = None,
    *,
    stack: bool = False,
    materials: ArrayLike | None = None,
    atlas: Pages = "one",
    resolution: int | None = None,
    page: tuple[int, int] | None = None,
    margin: int | Literal["auto"] | None = None,
    mip_levels: int | None = None,
    pack: Effort = "good",
    max_pages: int = 1,
    texels_per_unit: float | None = None,
    threads: int | None = None,
) -> Packed:
    """Lay out the islands of UVs anew: turned and moved, all scaled alike, none of them changed otherwise.

    Args:
        vertices, faces, uv, uv_faces: As for `metrics`.
        stack: Lay islands of one shape upon each other.
        texels_per_unit: Texels per unit of the UVs given; as many as fit if None.
        materials, atlas, resolution, page, margin, mip_levels, pack, max_pages: As for `unwrap`.
        threads: As for `flatten`.

    Returns:
        A `Packed`; its `uv` has the rows of the one given.

    Raises:
        TypeError, ShapeError, GeometryError, SettingError: As for `metrics`.
        NoResultError: The islands do not fit into their pages.

    >>> import abf_flatten
    >>> corners, faces = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]
    >>> far_apart = [[0, 0], [1, 0], [1, 1], [50, 0], [51, 1], [50, 1]]
    >>> packed = abf_flatten.pack(corners, faces, far_apart, [[0, 1, 2], [3, 4, 5]])
    >>> packed.islands, packed.coverage > 0.4, packed.uv.max().item() <= 1
    (2, True, True)
    """
    arguments = locals()
    settings = settings_of(arguments, "vertices", "faces", "uv", "uv_faces", "materials")
    known = _abf.pack(mapped(vertices, faces, uv, uv_faces), labels(materials, "materials"), settings)
    return Packed(**with_metrics(known))
