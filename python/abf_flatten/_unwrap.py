"""`unwrap`."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from . import _abf
from ._arrays import indices, labels, mesh, reals, settings_of, teller
from ._results import Unwrapped, with_metrics
from ._types import (
    DoubleSided,
    Effort,
    Energy,
    Hessian,
    Holes,
    Injective,
    InnerMargin,
    Layout,
    LineSearch,
    OnProgress,
    Overlap,
    Pages,
    Preconditioner,
    Reduction,
    Solver,
    Weld,
    Wheel,
    ZeroArea,
)


def unwrap(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    solver: Solver = "auto",
    layout: Layout = "auto",
    zero_area: ZeroArea = "carry",
    energy: Energy | None = None,
    injective: Injective = "off",
    seams: Literal["auto", "keep"] | ArrayLike | None = None,
    uv: ArrayLike | None = None,
    uv_faces: ArrayLike | None = None,
    materials: ArrayLike | None = None,
    objects: ArrayLike | None = None,
    polygons: ArrayLike | None = None,
    holes: Holes = "auto",
    max_stretch: float = 1.15,
    max_seam: float | None = None,
    crease_angle: float = 30.0,
    max_chart_length: float = 4.0,
    cut_disks: bool = True,
    weld: Weld = "auto",
    double_sided: DoubleSided = "own",
    overlap: Overlap = "refuse",
    strict: bool = False,
    atlas: Pages = "one",
    resolution: int | None = None,
    page: tuple[int, int] | None = None,
    margin: int | Literal["auto"] | None = None,
    mip_levels: int | None = None,
    pack: Effort = "good",
    max_pages: int = 1,
    texels_per_unit: float | None = None,
    coverage: float | None = None,
    seam_budget: float | None = None,
    inner_margin: InnerMargin = "count",
    time_limit: float | None = None,
    max_memory: int | None = None,
    threads: int | None = None,
    progress: OnProgress | None = None,
    ring_switch: float | Literal["off"] | None = None,
    angle_bound: float | None = None,
    tolerance: float | None = None,
    max_iterations: int | None = None,
    passes: int | Literal["auto"] | None = None,
    error_bound: float | None = None,
    barrier_floor: float | None = None,
    wheel: Wheel | None = None,
    hessian: Hessian | None = None,
    line_search: LineSearch | None = None,
    reduction: Reduction | None = None,
    preconditioner: Preconditioner | None = None,
    max_inner_iterations: int | None = None,
    inner_tolerance: float | Literal["auto"] | None = None,
) -> Unwrapped:
    """Unwrap any mesh into an atlas: repaired, cut, flattened chart by chart, and packed.

    Args:
        vertices: (n, 3) real numbers, in any unit.
        faces: (m, 3) whole numbers from 0 to n - 1.
        solver, layout, zero_area: As for `flatten`.
        energy: As for `flatten`: each chart is relaxed, and its stretch after that counts.
        injective: As for `flatten`, of each chart. Charts that lie over themselves are parted in any case: "deform"
            makes them anew first.
        seams: Where charts end. "auto": where the map stretches. "keep": at the seams of `uv`, and where `materials`
            changes. An (s, 2) array: there, and at these edges, each given by its two vertices. What seams leave is
            cut further only where it is no disk, or misses the aim. None is "auto", and "keep" for pages per material.
        uv, uv_faces: UVs that the mesh has: (n, 2), one per vertex, or (k, 2) with (m, 3) rows per corner.
        materials: (m,) whole numbers or names: the material of every face.
        objects: (m,) whole numbers or names: vertices in one place are joined within one object only.
        polygons: (m,) whole numbers or names: no seam runs between two faces of one polygon, as the halves of a quad.
        holes: What becomes of holes.
        max_stretch: Seams grow until the L² stretch of every chart is at most this.
        max_seam: Or until they are so long, as a multiple of the diagonal of the component.
        crease_angle: Edges that turn by no more than so many degrees are smooth.
        max_chart_length: Charts are parted that are longer than so many page widths; math.inf for no limit.
        cut_disks: Whether a mesh that is one disk is cut, too, where it misses the aim.
        weld: Which vertices in one place are joined: those within rounding, "off" none, or those at most so far apart.
        double_sided: Whether faces with the same vertices have texels of their own, or share them.
        overlap: Whether a map that lies over itself is `certified`: "allow", or not.
        strict: Whether a mesh that needs repair is refused.
        atlas: Which charts share a page.
        resolution: Texels along the sides of a page [1024].
        page: Texels along x and y, where it is no square.
        margin: Texels between charts, and to the border [2].
        mip_levels: Sets the margin to what so many mip levels need, 2 · 2^levels.
        pack: How hard to try to fill the atlas: milliseconds, about a second, or several.
        max_pages: How many pages the charts may take that share pages.
        texels_per_unit: Texels per unit of the mesh; as many as fit if None.
        coverage: Part the largest chart where that lets charts cover more, until they cover so much of the atlas; in (0, 1].
        seam_budget: By which part of their length seams may grow for `coverage` [0.25].
        inner_margin: Whether charts that come nearer to themselves than the margin are parted there: "keep", or not.
        time_limit: Seconds; then charts come back that may miss the aim.
        max_memory: Bytes, for each chart.
        threads, progress, and every other setting: As for `flatten`.

    Returns:
        An `Unwrapped`. It iterates as `vmapping, indices, uvs`, in the order and the types of xatlas.

    Raises:
        TypeError, ShapeError, GeometryError, SettingError, NoResultError, MemoryError: As for `flatten`.
        TopologyError: A mesh that needs repair, with `strict`.

    >>> import abf_flatten
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> vmapping, indices, uvs = abf_flatten.unwrap(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> indices.shape, (vmapping[indices] == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).all().item()
    ((4, 3), True)
    """
    arguments = locals()
    edges = None
    if seams is not None and not isinstance(seams, str):
        edges, seams = indices(seams, "seams", 2), "keep"
    elif seams not in (None, "auto", "keep"):
        raise _abf.SettingError(f"seams must be 'auto', 'keep' or an array of edges, got {seams!r}")
    elif seams is None:
        # Pages per material make sense only where charts end at their borders.
        seams = "keep" if atlas == "per-material" and materials is not None else "auto"
    if seams == "keep" and edges is None and uv is None and materials is None:
        raise _abf.SettingError("seams='keep' keeps those of uv and materials, and neither is given")
    if uv is None and uv_faces is not None:
        raise _abf.SettingError("uv_faces are rows of uv, which is not given")
    hints = {
        "uv": None if uv is None or seams == "auto" else reals(uv, "uv", 2),
        "uv_faces": None if uv_faces is None or seams == "auto" else indices(uv_faces, "uv_faces"),
        "edges": edges,
        "materials": labels(materials, "materials"),
        "objects": labels(objects, "objects"),
        "polygons": labels(polygons, "polygons"),
    }
    settings = settings_of(arguments, "vertices", "faces", "progress", "seams", *hints)
    settings["keeps"] = seams != "auto"
    return Unwrapped(**with_metrics(_abf.unwrap(*mesh(vertices, faces), hints, settings, teller(progress))))
