"""What the functions give back."""

from __future__ import annotations

import doctest
import importlib
import pickle
from pathlib import Path
from typing import Any

import abf_flatten as abf
import numpy as np
import pytest
from conftest import Mesh, bumpy
from numpy.typing import NDArray


@pytest.mark.parametrize("name", ["__init__", "_flatten", "_unwrap", "_relax", "_judge", "_pack", "_files"])
def test_the_examples_in_the_docstrings_run(name: str) -> None:
    module = importlib.import_module("abf_flatten" if name == "__init__" else f"abf_flatten.{name}")
    ran = doctest.testmod(module)
    assert ran.attempted > 0
    assert ran.failed == 0


def test_a_disk_is_flattened_and_proved(disk: Mesh) -> None:
    vertices, faces = disk
    flat = abf.flatten(vertices, faces)
    assert flat.uv.shape == (len(vertices), 2)
    assert flat.uv.dtype == np.float64
    assert flat.certified and flat.certificate and flat.certificate.injective
    assert flat.metrics.triangles == len(faces)
    assert flat.metrics.uv_area == pytest.approx(flat.metrics.surface_area)
    assert flat.tried == [flat.solver] == ["linabf"]
    assert abf.flatten(vertices, faces, normalize=True).uv.max() == pytest.approx(1)


def test_the_uvs_say_the_same_when_they_are_judged_anew(disk: Mesh) -> None:
    flat = abf.flatten(*disk)
    known = abf.metrics(*disk, flat.uv)
    assert (known.f, known.stretch_l2) == (flat.metrics.f, flat.metrics.stretch_l2)
    assert abf.metrics(*disk, flat.uv, as_stored=True).f == known.f
    assert abf.certify(*disk, flat.uv) == known.certificate
    turned = flat.uv.copy()
    turned[21] += 10
    spoilt = abf.certify(*disk, turned)
    assert not spoilt and spoilt.flips > 0 and spoilt.flipped_faces


@pytest.mark.parametrize("solver", abf.solvers)
def test_every_solver_takes_its_name(disk: Mesh, solver: str) -> None:
    flat = abf.flatten(*disk, solver=solver)  # type: ignore[arg-type]
    assert flat.certificate.valid
    assert solver in ("auto", flat.solver)


def test_settings_reach_their_solver(disk: Mesh) -> None:
    once = abf.flatten(*disk, solver="linabf", passes=1)
    assert once.termination != abf.flatten(*disk, solver="linabf").termination
    loose = abf.flatten(*disk, solver="uzawa", inner_tolerance=1e-2, max_inner_iterations=5, reduction="none")
    assert loose.metrics.f != abf.flatten(*disk, solver="uzawa").metrics.f
    assert abf.flatten(*disk, layout="poisson").certificate
    assert abf.flatten(*disk, time_limit=0.0).termination == "time-limit"


def test_the_boundary_is_what_is_asked_for(disk: Mesh) -> None:
    corners = [0, 19, 399, 380]
    flat = abf.flatten(*disk, boundary="rectangle=" + ",".join(map(str, corners)))
    assert flat.certificate.injective
    around = flat.uv[corners]
    sides = np.roll(around, -1, 0) - around
    across = np.roll(sides, -1, 0)
    assert np.allclose((sides * across).sum(1), 0, atol=1e-4)
    assert abf.flatten(*disk, boundary="rectangle").certificate.injective
    given = abf.flatten(*disk, boundary={vertex: np.pi / 2 for vertex in corners})
    for vertex, ends in ((0, (1, 20)), (399, (398, 379))):
        one, other = (given.uv[end] - given.uv[vertex] for end in ends)
        turn = np.arccos(one @ other / np.linalg.norm(one) / np.linalg.norm(other))
        assert turn == pytest.approx(np.pi / 2, abs=1e-4)
    assert np.array_equal(abf.flatten(*disk, solver="lscm", boundary="free").uv, abf.flatten(*disk, solver="lscm").uv)


def test_an_energy_is_less_after_relaxing(disk: Mesh) -> None:
    vertices, faces = disk[0] * [1, 1, 6], disk[1]
    free = abf.flatten(vertices, faces)
    assert free.relaxed is None and free.pinned is None
    stretches = []
    for energy in ("abf", "usable", 0.5, "isometric"):
        flat = abf.flatten(vertices, faces, energy=energy)
        assert flat.certified and flat.relaxed is not None and flat.relaxed.energy == str(energy)
        assert flat.relaxed.after <= flat.relaxed.before * (1 + 1e-12)
        stretches.append(flat.metrics.stretch_l2)
    assert min(stretches[0], free.metrics.stretch_l2) > stretches[1] > stretches[2] > stretches[3]
    stages = []
    abf.flatten(*bumpy(120), energy="isometric", progress=lambda news: stages.append(news.stage))
    assert "relax" in stages


def test_charts_are_relaxed(ring: Mesh) -> None:
    plain, relaxed = abf.unwrap(*ring), abf.unwrap(*ring, energy="isometric")
    assert plain.relax_steps == 0 < relaxed.relax_steps
    assert relaxed.certified and relaxed.metrics.stretch_l2 < plain.metrics.stretch_l2


def test_vertices_are_pinned(disk: Mesh) -> None:
    two = abf.flatten(*disk, pins={0: (1, 1), 19: np.array([3.0, 1.0])})
    assert two.certified and two.pinned and two.pinned.steps == 0
    assert two.pinned.missed == [] and two.pinned.distances == {0: 0.0, 19: 0.0}
    assert np.array_equal(two.uv[[0, 19]], [[1, 1], [3, 1]])
    free = abf.flatten(*disk).uv
    places = {int(v): tuple(free[v] * [1.2, 1.0]) for v in (0, 19, 380, 399)}
    more = abf.flatten(*disk, energy="usable", pins={**places, 210: (*free[210], 3.0)})
    assert more.certified and more.pinned and more.pinned.energy == "usable"
    assert all(np.array_equal(more.uv[v], place) for v, place in places.items())
    assert more.pinned.distances[210] > 0
    # No map has a pyramid's corners the other way around, and that is said.
    corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 0.5]])
    sides = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    missed = abf.flatten(corners, sides, pins={0: (1, 0), 1: (0, -1), 2: (-1, 0), 3: (0, 1)})
    assert missed.certificate and not missed.certified
    assert missed.pinned is not None and not missed.pinned and missed.pinned.missed


def test_a_map_that_lies_over_itself_is_parted_or_deformed() -> None:
    # A flat ramp that winds around its axis more than once.
    turns = strip(2.4 * np.pi)
    turns[0][:, 2] = np.repeat(np.linspace(0, 1, 97), 5)
    free = abf.flatten(*turns)
    assert free.certificate.valid and not free.certificate.injective and free.injective is None
    deformed = abf.flatten(*turns, injective="deform")
    assert deformed.certificate.injective and deformed.injective is not None and deformed.injective.parts == 1
    assert deformed.uv_faces is None and deformed.injective.steps > 0
    parted = abf.flatten(*turns, injective="split")
    assert parted.certificate.injective and parted.injective is not None and parted.injective.parts > 1
    assert parted.uv_faces is not None and len(parted.uv) > len(turns[0])
    assert abf.certify(*turns, parted.uv, parted.uv_faces).injective
    assert abf.flatten(*bumpy(20), injective="deform").injective is None


def test_a_map_that_is_there_is_relaxed(disk: Mesh, ring: Mesh) -> None:
    vertices, faces = disk
    flat = abf.flatten(vertices, faces, solver="lscm", normalize=True)
    better = abf.relax(vertices, faces, flat.uv)
    assert better.certified and better.uv.shape == flat.uv.shape and better.uv_faces is None
    assert better.metrics.stretch_l2 < flat.metrics.stretch_l2
    assert better.metrics.uv_area == pytest.approx(flat.metrics.uv_area)
    assert better.uv.mean(0) == pytest.approx(flat.uv.mean(0))
    spoilt = flat.uv.copy()
    spoilt[210] += 1
    (report,) = abf.relax(vertices, faces, spoilt, energy=0.1).charts
    assert report is not None and report.from_tutte and report.energy == "0.1"
    pinned = abf.relax(vertices, faces, flat.uv, pins={0: (0, 0), 399: (1, 1)})
    assert pinned.pinned and np.array_equal(pinned.uv[[0, 399]], [[0, 0], [1, 1]])
    parts = abf.unwrap(*ring, seams="keep", materials=ring[0][ring[1]].mean(1)[:, 0] > 0, max_stretch=1.5)
    all_better = abf.relax(*ring, parts.uvs, parts.indices)
    assert all_better.certificate.valid and len(all_better.charts) == parts.charts == len(set(all_better.chart_of_face))
    assert all_better.uv_faces is not None and all_better.uv_faces.shape == ring[1].shape
    assert all_better.metrics.stretch_l2 < parts.metrics.stretch_l2
    assert abf.certify(*ring, all_better.uv, all_better.uv_faces).valid
    assert all_better.refused == []


def test_a_chart_that_cannot_be_relaxed_stays_and_says_why(disk: Mesh) -> None:
    vertices, faces = disk
    uv = abf.flatten(vertices, faces, solver="lscm").uv
    # Two triangles that meet at a vertex only.
    bow = np.array([[0, 0], [1, 0], [1, 1], [2, 2], [1, 2]]) + 50.0
    all_vertices = np.vstack([vertices, np.column_stack([bow, np.zeros(5)])])
    all_faces = np.vstack([faces, np.array([[0, 1, 2], [2, 3, 4]]) + len(vertices)])
    map_of_both = abf.relax(all_vertices, all_faces, np.vstack([uv, bow]))
    assert not map_of_both.certified and len(map_of_both.refused) == 1
    assert f"face {len(faces)}" in map_of_both.refused[0]
    assert [report is not None for report in map_of_both.charts] == [True, False]
    assert np.array_equal(map_of_both.uv[len(vertices) :], bow)


def test_an_error_bound_makes_passes_shorter(disk: Mesh) -> None:
    plain = abf.flatten(*disk, solver="linabf", passes=1)
    bounded = abf.flatten(*disk, solver="linabf", passes=1, error_bound=0.01)
    assert bounded.certificate and bounded.metrics.f != plain.metrics.f


def test_the_bits_are_the_same_for_any_number_of_threads(disk: Mesh, ring: Mesh) -> None:
    flat = [abf.flatten(*disk, threads=threads).uv for threads in (None, 1, 3)]
    assert np.array_equal(flat[0], flat[1]) and np.array_equal(flat[0], flat[2])
    uvs = [abf.unwrap(*ring, threads=threads).uvs for threads in (None, 1, 3)]
    assert np.array_equal(uvs[0], uvs[1]) and np.array_equal(uvs[0], uvs[2])


def test_a_closed_surface_becomes_an_atlas(ring: Mesh) -> None:
    vertices, faces = ring
    flat = abf.unwrap(vertices, faces)
    vmapping, indices, uvs = flat
    assert [array.dtype.name for array in flat] == ["uint32", "uint32", "float32"]
    assert np.array_equal(vmapping[indices], faces)
    assert np.array_equal(vmapping[: len(vertices)], np.arange(len(vertices)))
    assert 0 <= uvs.min() and uvs.max() <= 1
    assert flat.certified and flat.certificate.injective
    assert flat.metrics.stretch_l2 <= 1.15
    assert set(flat.chart_of_face) == set(range(flat.charts))
    assert set(flat.page_of_face) == {0}
    assert flat.repairs == [] and flat.unfinished == 0
    # 32-bit numbers, judged by someone else.
    assert abf.certify(vertices[vmapping], indices, uvs, precision="single").injective


def test_marked_edges_are_seams(disk: Mesh) -> None:
    vertices, faces = disk
    across = np.arange(20) + 20 * 10
    marked = np.stack([across[:-1], across[1:]], -1)
    assert abf.unwrap(vertices, faces).charts == 1
    parted = abf.unwrap(vertices, faces, seams=marked)
    assert parted.charts == 2
    assert parted.seam_length == pytest.approx(np.linalg.norm(np.diff(vertices[across], axis=0), axis=1).sum())


def test_seams_of_uvs_and_borders_of_materials_are_kept(disk: Mesh) -> None:
    vertices, faces = disk
    left = vertices[faces].mean(1)[:, 0] < 0.5
    two = np.where(left, "brick", "glass")
    assert abf.unwrap(vertices, faces, seams="keep", materials=two).charts == 2
    assert abf.unwrap(vertices, faces, materials=two).charts == 1
    assert abf.unwrap(vertices, faces, atlas="per-material", materials=two).pages == 2
    known = abf.unwrap(vertices, faces, seams="keep", materials=two)
    again = abf.unwrap(vertices, faces, seams="keep", uv=known.uvs, uv_faces=known.indices)
    assert again.charts == 2


def test_objects_are_not_joined(disk: Mesh) -> None:
    vertices, faces = disk
    both = np.concatenate([vertices, vertices + [1, 0, 0]])
    twice = np.concatenate([faces, faces + len(vertices)])
    of_object = np.repeat([0, 1], len(faces))
    assert abf.unwrap(both, twice, objects=of_object).charts == 2


def test_no_seam_runs_inside_a_polygon() -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    flat = abf.unwrap(corners, triangles, polygons=np.tile(range(6), 2), max_stretch=1.0)
    halves = flat.indices.reshape(2, 6, 3)
    assert np.array_equal(halves[0][:, 0], halves[1][:, 0]) and np.array_equal(halves[0][:, 2], halves[1][:, 1])


def test_pages_margins_and_texels(ring: Mesh) -> None:
    small, large = abf.unwrap(*ring, resolution=256), abf.unwrap(*ring, resolution=1024)
    assert large.texels_per_unit > 3 * small.texels_per_unit
    given = abf.unwrap(*ring, texels_per_unit=100.0, max_pages=9, pack="fast")
    assert given.texels_per_unit == 100
    assert abf.unwrap(*ring, page=(2048, 1024), mip_levels=3).certificate.injective
    assert abf.unwrap(*ring, margin=40).coverage < abf.unwrap(*ring, margin="auto").coverage


def strip(turn: float) -> Mesh:
    """A flat strip that goes around a circle so far: it covers little of a page."""
    angle, radius = np.meshgrid(np.linspace(0, turn, 97), np.linspace(4, 5, 5), indexing="ij")
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * radius], -1).reshape(-1, 3)
    i = np.arange(97 * 5).reshape(97, 5)
    a, b, c, d = (k.reshape(-1) for k in (i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]))
    return vertices, np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def test_charts_are_parted_to_cover_more() -> None:
    half = strip(np.pi)
    whole = abf.unwrap(*half, resolution=256)
    parted = abf.unwrap(*half, resolution=256, coverage=0.6, seam_budget=0.5)
    assert (whole.charts, whole.parted_for_coverage) == (1, 0)
    assert parted.charts == 1 + parted.parted_for_coverage > 1
    assert parted.coverage > 1.2 * whole.coverage and parted.certified
    assert abf.unwrap(*half, resolution=256, coverage=0.6, seam_budget=0.0).charts == 1


def test_charts_are_parted_where_they_come_too_near_to_themselves() -> None:
    nearly_around = strip(2 * np.pi - 0.05)
    near = abf.unwrap(*nearly_around, resolution=256, margin=8)
    kept = abf.unwrap(*nearly_around, resolution=256, margin=8, inner_margin="keep")
    assert near.charts == 1 and near.parted_for_margin == 0
    assert kept.charts == 1 + kept.parted_for_margin > 1


def test_a_disk_stays_whole_where_that_is_asked_for() -> None:
    vertices, faces = bumpy(20)
    steep = vertices * [1, 1, 8]
    assert abf.unwrap(steep, faces).charts > 1
    assert abf.unwrap(steep, faces, cut_disks=False).charts == 1


def test_settings_of_a_solver_reach_the_charts(ring: Mesh) -> None:
    plain = abf.unwrap(*ring, solver="linabf")
    bounded = abf.unwrap(*ring, solver="linabf", error_bound=0.05, passes=1)
    assert bounded.metrics.f != plain.metrics.f
    assert plain.certified and abf.unwrap(*ring, overlap="allow").certified


def test_islands_are_packed_anew(ring: Mesh) -> None:
    flat = abf.unwrap(*ring, seams="keep", materials=np.arange(len(ring[1])) // 100)
    assert flat.charts > 4
    scattered = flat.uvs + 3.0 * flat.chart_of_face[_face_of(flat.indices, len(flat.uvs))][:, None]
    packed = abf.pack(ring[0][flat.vmapping], flat.indices, scattered)
    assert packed.uv.shape == flat.uvs.shape
    assert packed.islands == flat.charts
    assert packed.certificate.injective and packed.uv.min() >= 0 and packed.uv.max() <= 1


def _face_of(indices: NDArray[Any], count: int) -> NDArray[np.int64]:
    face: NDArray[np.int64] = np.zeros(count, np.int64)
    face[indices.reshape(-1)] = np.arange(indices.size) // 3
    return face


def test_files_are_written_and_read(ring: Mesh, tmp_path: Path) -> None:
    flat = abf.unwrap(*ring)
    for name in ("torus.obj", "torus.ply"):
        path = tmp_path / name
        abf.write(path, ring[0], ring[1], flat.uvs, flat.indices)
        back = abf.read(path)
        assert np.array_equal(back.vertices, ring[0]) and np.array_equal(back.faces, ring[1])
        assert back.uv is not None and back.uv_faces is not None
        assert np.array_equal(back.uv[back.uv_faces], flat.uvs[flat.indices])
        parsed = abf.parse(name, path.read_bytes())
        assert np.array_equal(parsed.vertices, back.vertices)
    abf.write(str(tmp_path / "torus.glb"), *ring)
    assert abf.read(str(tmp_path / "torus.glb")).uv is None


def test_results_can_be_pickled(disk: Mesh, ring: Mesh) -> None:
    flat = pickle.loads(pickle.dumps(abf.flatten(*disk, energy="usable", pins={0: (0, 0)})))
    assert flat.pinned and flat.relaxed.steps > 0
    assert flat.certificate and flat.uv.shape == (400, 2)
    assert len(list(pickle.loads(pickle.dumps(abf.unwrap(*ring))))) == 3
    error = pickle.loads(pickle.dumps(abf.NotADiskError("no disk")))
    assert isinstance(error, abf.NotADiskError) and str(error) == "no disk"


def test_a_result_is_handed_over_without_a_copy(disk: Mesh) -> None:
    flat = abf.flatten(*disk)
    owner = flat.uv.base if flat.uv.base is not None else flat.uv
    while isinstance(owner, np.ndarray) and owner.base is not None:
        owner = owner.base
    # The memory is Rust's: NumPy did not allocate it.
    assert type(owner).__name__ == "PySliceContainer"
    assert flat.uv.flags.writeable and flat.uv.flags.c_contiguous
