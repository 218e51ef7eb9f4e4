"""What comes out. All of it can be pickled, so that it may come from another process."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Certificate:
    """What is proved of UVs as they are stored, by exact signs. It is true if `valid` is."""

    #: No triangle is turned over or collapsed, and no interior vertex wound around twice.
    valid: bool
    #: Valid, and no point of the plane is covered twice.
    injective: bool
    #: How many charts there are.
    charts: int
    #: Triangles that are turned over, against most of their chart.
    flips: int
    #: Triangles whose three UVs lie on one line.
    collapsed: int
    #: Valid triangles that are within the rounding of their coordinates of not being so.
    near_collapsed: int
    #: Interior vertices around which the triangles wind more than once.
    wound: int
    #: Places where the map lies over itself.
    overlaps: int
    #: Places where the boundary meets itself, and nothing is covered twice.
    touches: int
    #: The least and the greatest angle of all UV triangles, rad.
    uv_angle_min: float
    uv_angle_max: float
    #: The largest violation of the angle constraints, rad; None where no angles were solved for.
    constraint_residual: float | None
    #: The first of each kind, at most ten.
    flipped_faces: list[int] = field(repr=False)
    collapsed_faces: list[int] = field(repr=False)
    wound_vertices: list[int] = field(repr=False)
    overlapping_faces: list[tuple[int, int]] = field(repr=False)

    def __bool__(self) -> bool:
        return self.valid


@dataclass(frozen=True)
class Metrics:
    """How distorted UVs are. Only `uv_area` changes when UVs are moved, turned or scaled."""

    #: How many triangles there are.
    triangles: int
    #: Triangles without an area in space; they are in no figure of distortion.
    degenerate_3d: int
    #: The mean squared angle error, rad².
    f: float
    #: The mean squared relative angle error.
    f_weighted: float
    #: The largest angle error, rad.
    max_angle_error: float
    #: L² and L∞ stretch; 1 for an isometry.
    stretch_l2: float
    stretch_linf: float
    #: Quasi-conformal distortion; 1 for a conformal map.
    qc_mean: float
    qc_max: float
    #: Area distortion; 0 where areas keep their proportions.
    area_l2: float
    #: The area of the UVs, and that of the surface.
    uv_area: float
    surface_area: float
    #: What is proved of the UVs.
    certificate: Certificate = field(repr=False)


@dataclass(frozen=True)
class Progress:
    """How far a call is. `done` of `total` faces are finished: `unwrap` counts, `flatten` says it at the end only."""

    #: What is being done: "topology", "solve", "layout", "relax", "certificate"; "done" at the end.
    stage: str
    #: Which solver of `auto` it is, once one has begun.
    solver: str | None
    #: The last iteration, and its constraint residual, rad.
    iteration: int
    residual: float
    #: Faces in finished charts, of how many.
    done: int
    total: int


@dataclass(frozen=True)
class RelaxReport:
    """What relaxing a map did."""

    #: Which energy, for a surface of area 1: its name, or the weight of areas.
    energy: str
    #: What it was before, and at the end, each at the scale at which it is least.
    before: float
    after: float
    #: How many steps it took, and how many of these went for shapes within reach.
    steps: int
    progressive_steps: int
    #: Whether it started from Tutte's embedding, because the map was not valid.
    from_tutte: bool


@dataclass(frozen=True)
class InjectiveReport:
    """What was done about a map that lay over itself."""

    #: By which rule: "split" or "deform".
    rule: str
    #: How many overlaps there were.
    overlaps: int
    #: Which energy was least at the end, what it was before, with the overlaps, and what it is; None of a map that was parted.
    energy: str | None
    before: float | None
    after: float | None
    #: How many steps it took, and how many of these went for lengths first.
    steps: int
    first_steps: int
    #: The smallest distance of a boundary vertex and a boundary edge, in units of the UVs; None where it is not known.
    gap: float | None
    #: In how many parts the map is.
    parts: int
    #: Why the map is as it was.
    error: str | None


@dataclass(frozen=True)
class PinReport:
    """What became of pins. It is true if all that must be met are."""

    #: Which energy moved the other vertices, and what it is at the end.
    energy: str
    after: float
    #: How many steps it took; none for a similarity.
    steps: int
    #: The vertices that must be in their places and are not.
    missed: list[int]
    #: How far each vertex is from its place, in units of the UVs.
    distances: dict[int, float] = field(repr=False)

    def __bool__(self) -> bool:
        return not self.missed


@dataclass(frozen=True, eq=False)
class Judged:
    """A result with a map."""

    #: How distorted the map is, and what is proved of it as it is stored.
    metrics: Metrics

    @property
    def certificate(self) -> Certificate:
        """What is proved of the map."""
        return self.metrics.certificate


@dataclass(frozen=True, eq=False)
class Flattening(Judged):
    """A flat disk."""

    #: (n, 2) float64, one row per vertex. It has the area of the surface, unless it was normalized. A vertex of no
    #: face is at the origin.
    uv: NDArray[np.float64] = field(repr=False)
    #: Whose result it is, and how that solver ended.
    solver: str
    termination: str
    #: Valid UVs of a solver that ended as asked.
    certified: bool
    #: The solvers that `auto` tried, in order.
    tried: list[str] = field(repr=False)
    #: What `energy` did, and what became of `pins`; None where they were not asked for, or there was no map or no time.
    relaxed: RelaxReport | None = field(repr=False, default=None)
    pinned: PinReport | None = field(repr=False, default=None)
    #: What `injective` did; None where nothing was to be done.
    injective: InjectiveReport | None = field(repr=False, default=None)
    #: (m, 3) uint32: the row of `uv` of every corner of a map in parts, which has more rows than vertices; else None.
    uv_faces: NDArray[np.uint32] | None = field(repr=False, default=None)


@dataclass(frozen=True, eq=False)
class Unwrapped(Judged):
    """An atlas. It iterates as `vmapping, indices, uvs`, in the order and the types of xatlas.

    `metrics` and `certificate` are those of 32-bit numbers.
    """

    #: (k,) uint32: for every new vertex the vertex it is a copy of. The first ones are those of the input, in order.
    vmapping: NDArray[np.uint32] = field(repr=False)
    #: (m, 3) uint32: the new vertices of every face, in the order of the input.
    indices: NDArray[np.uint32] = field(repr=False)
    #: (k, 2) float32 in the unit square, v upwards. A vertex of no face is at the origin.
    uvs: NDArray[np.float32] = field(repr=False)
    #: (m,) int32: the chart of every face, and its page; -1 for faces without any area at all.
    chart_of_face: NDArray[np.int32] = field(repr=False)
    page_of_face: NDArray[np.int32] = field(repr=False)
    #: How many charts and pages there are.
    charts: int
    pages: int
    #: How many texels a unit of the mesh gets.
    texels_per_unit: float
    #: The part of the pages that charts cover.
    coverage: float
    #: The length of all seams, in units of the mesh.
    seam_length: float
    #: What had to be repaired, in sentences.
    repairs: list[str]
    #: How many cuts were made for `coverage`, and for `inner_margin="keep"`.
    parted_for_coverage: int
    parted_for_margin: int
    #: Every chart is finished and valid, of a solver that ended as asked; and nothing lies over anything else, unless
    #: `overlap="allow"`.
    certified: bool
    #: How many charts there was no time to finish; they are valid, and may miss the aim.
    unfinished: int
    #: How many steps `energy` took, all charts together.
    relax_steps: int

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return iter((self.vmapping, self.indices, self.uvs))


@dataclass(frozen=True, eq=False)
class Relaxed(Judged):
    """A map that was there, relaxed."""

    #: (n, 2) float64, one row per vertex; or (k, 2) with `uv_faces`, where that was given.
    uv: NDArray[np.float64] = field(repr=False)
    #: (m, 3) uint32: the row of `uv` of every corner. None: that of its vertex.
    uv_faces: NDArray[np.uint32] | None = field(repr=False)
    #: How it ended: of several charts the first end that was not as asked.
    termination: str
    #: Valid UVs, every chart relaxed.
    certified: bool
    #: (m,) int32: the chart of every face.
    chart_of_face: NDArray[np.int32] = field(repr=False)
    #: What was done to each chart; None for one that stays as it was.
    charts: list[RelaxReport | None] = field(repr=False)
    #: Why charts could not be relaxed and stay as they were, each with its first face.
    refused: list[str]
    #: What became of `pins`.
    pinned: PinReport | None = field(repr=False)


@dataclass(frozen=True, eq=False)
class Packed(Judged):
    """Islands laid out anew."""

    #: The rows of the UVs given, moved: (k, 2) float64 in the unit square. Rows of no corner are at the origin.
    uv: NDArray[np.float64] = field(repr=False)
    #: (m,) int32: the island of every face, and its page.
    island_of_face: NDArray[np.int32] = field(repr=False)
    page_of_face: NDArray[np.int32] = field(repr=False)
    #: How many islands and pages there are.
    islands: int
    pages: int
    #: How many texels a unit of the UVs given gets.
    texels_per_unit: float
    #: The part of the pages that islands cover.
    coverage: float


@dataclass(frozen=True, eq=False)
class MeshFile:
    """What a mesh file holds."""

    #: (n, 3) float64.
    vertices: NDArray[np.float64] = field(repr=False)
    #: (m, 3) uint32; polygons are cut into triangles.
    faces: NDArray[np.uint32] = field(repr=False)
    #: (k, 2) float64, if every corner has a UV.
    uv: NDArray[np.float64] | None = field(repr=False)
    #: (m, 3) uint32: the row of `uv` of every corner.
    uv_faces: NDArray[np.uint32] | None = field(repr=False)
    #: What was done to get there, and what was left alone, in sentences.
    notes: list[str]


def metrics_of(known: dict[str, Any]) -> Metrics:
    """The dict of the native part as what it stands for."""
    return Metrics(**{**known, "certificate": Certificate(**known["certificate"])})


def with_reports(known: dict[str, Any]) -> dict[str, Any]:
    """The dict with what relaxing and pins came to as what it stands for."""
    known = with_metrics(known)
    if known.get("relaxed") is not None:
        known["relaxed"] = RelaxReport(**known["relaxed"])
    if known.get("charts") is not None:
        known["charts"] = [report and RelaxReport(**report) for report in known["charts"]]
    if known.get("injective") is not None:
        known["injective"] = InjectiveReport(**known["injective"])
    if known["pinned"] is not None:
        known["pinned"] = PinReport(**known["pinned"])
    return known


def with_metrics(known: dict[str, Any]) -> dict[str, Any]:
    """The same for a dict that has one."""
    return {**known, "metrics": metrics_of(known["metrics"])}
