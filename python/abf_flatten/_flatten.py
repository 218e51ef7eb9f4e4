"""`flatten`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from numpy.typing import ArrayLike

from . import _abf
from ._arrays import mesh, pins_of, settings_of, teller
from ._results import Flattening, with_reports
from ._types import (
    Energy,
    Hessian,
    Injective,
    Layout,
    LineSearch,
    OnProgress,
    Pins,
    Preconditioner,
    Reduction,
    Solver,
    Wheel,
    ZeroArea,
)


def flatten(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    solver: Solver = "auto",
    layout: Layout = "auto",
    normalize: bool = False,
    boundary: str | Mapping[int, float] = "free",
    energy: Energy | None = None,
    pins: Pins | None = None,
    injective: Injective = "off",
    boundary_gap: float | None = None,
    zero_area: ZeroArea = "carry",
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
) -> Flattening:
    """Flatten a disk: a connected manifold mesh with one boundary loop.

    Args:
        vertices: (n, 3) real numbers, in any unit.
        faces: (m, 3) whole numbers from 0 to n - 1, counter-clockwise.
        solver: The method; "auto" tries one after the other, up to the first whose result is proved valid.
        layout: How angles become coordinates.
        normalize: Whether UVs are scaled into the unit square. Otherwise they have the area of the surface.
        boundary: What the boundary is to be: "free", "convex", "below-2pi[=EPS]", "rectangle[=v0,v1,v2,v3]" with vertices
            as corners, "circle", or a dict with the angles of vertices, rad. "auto", "linabf" and "barrier" keep it.
        energy: Relax the map after the solver until an energy is least: "abf" (angles), "isometric" (lengths), "usable"
            (angles, and areas within bounds), or the weight of areas beside angles; "usable" is 0.01. Not with `boundary`.
        pins: Vertices in given places: a dict from vertices to (u, v), or (u, v, weight) where the place need not be met.
            One or two are met by moving, turning and scaling the map, more by moving the others with `energy`, or
            "isometric". Not with `boundary` or `normalize`.
        injective: What becomes of a map that lies over itself: "off" leaves it, "split" parts it along the overlap (`uv_faces`
            has the rows of the corners then), "deform" makes it anew without overlaps, which takes many times as long. Not
            with `pins` or `boundary`.
        boundary_gap: With "deform", how far parts of the boundary stay from each other, in units of the mesh [0].
        zero_area: What becomes of faces without area: a place like all others, or an error.
        time_limit: Seconds, for all solvers together; then the best there is comes back.
        max_memory: Bytes. A mesh for which more is predicted is refused, before any is taken.
        threads: How many work on this call alone. None: one per processor, shared with other such calls. The result is
            the same for any number.
        progress: Called with a `Progress` at most every 20 ms, on the thread that calls. What it raises ends the call.

    Every other setting is that of the command line, by the same name; None is the solver's own default. One that means
    nothing to the solver is an error.

    Returns:
        A `Flattening`: `uv`, (n, 2) float64, with its `certificate` and `metrics`.

    Raises:
        TypeError: An argument of a wrong type, as faces of floats.
        ShapeError: An array of another shape.
        GeometryError: No faces, a coordinate that is not finite, or an index of no vertex.
        TopologyError: Faces that form no oriented manifold.
        NotADiskError: A manifold that is no disk.
        SettingError: A setting outside its range, or pins that no map of the mesh can have.
        NoResultError: No solver found a map.
        MemoryError: More than `max_memory` is predicted.

    >>> import abf_flatten
    >>> square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> flat = abf_flatten.flatten(square, [[0, 1, 2], [0, 2, 3]])
    >>> flat.uv.round(9).tolist(), bool(flat.certificate)
    ([[0.0, 0.0], [0.707106781, -0.707106781], [1.414213562, 0.0], [0.707106781, 0.707106781]], True)
    >>> abf_flatten.flatten(square, [[0, 1, 2], [0, 2, 3]], pins={0: (0, 0), 1: (5, 0)}).uv.round(9).tolist()
    [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0]]
    """
    arguments = locals()
    settings = settings_of(arguments, "vertices", "faces", "progress")
    if boundary == "free":
        # Every solver keeps that.
        settings["boundary"] = None
    elif isinstance(boundary, Mapping):
        settings["boundary"] = dict(boundary)
    settings["pins"] = pins_of(pins)
    return Flattening(**with_reports(_abf.flatten(*mesh(vertices, faces), settings, teller(progress))))
