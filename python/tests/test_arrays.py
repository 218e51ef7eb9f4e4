"""What arrays may be, and what every wrong one raises."""

from __future__ import annotations

import math
import threading
from typing import Any

import abf_flatten as abf
import numpy as np
import pytest
from conftest import Mesh, bumpy

V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
F = np.array([[0, 1, 2], [0, 2, 3]])
UV = V[:, :2]


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", ">f4", "f2", "g", "i4", ">i2", "u1"])
def test_vertices_are_of_any_real_type(dtype: str) -> None:
    assert np.array_equal(abf.flatten(V.astype(dtype), F).uv, abf.flatten(V, F).uv)


@pytest.mark.parametrize("dtype", ["i1", "u1", "<i4", ">i4", "<u4", ">i8", "<u8", ">u8"])
def test_faces_are_of_any_whole_type(dtype: str) -> None:
    assert np.array_equal(abf.flatten(V, F.astype(dtype)).uv, abf.flatten(V, F).uv)


def test_arrays_may_be_read_only_strided_or_lists(disk: Mesh) -> None:
    vertices, faces = disk
    plain = abf.flatten(vertices, faces).uv
    vertices.flags.writeable = faces.flags.writeable = False
    wide = np.zeros((len(vertices), 7))
    wide[:, 1:7:2] = vertices
    meshes: list[tuple[Any, Any]] = [
        (vertices, faces),
        (np.asfortranarray(vertices), np.asfortranarray(faces)),
        (wide[:, 1:7:2], np.repeat(faces, 2, 0)[::2]),
        (vertices[::-1][::-1], faces[:, ::-1][:, ::-1]),
        (vertices.tolist(), faces.tolist()),
        (vertices.data, faces.data),
    ]
    for v, f in meshes:
        assert np.array_equal(abf.flatten(v, f).uv, plain)


def _with(vertex: int, value: float) -> Any:
    spoilt = V.copy()
    spoilt[vertex, 1] = value
    return spoilt


WRONG: list[tuple[str, type[Exception], str, Any, Any]] = [
    ("flat vertices", abf.ShapeError, r"vertices must have shape \(n, 3\)", V.reshape(-1), F),
    ("points of a plane", abf.ShapeError, r"vertices must have shape \(n, 3\), got \(4, 2\)", UV, F),
    ("flat faces", abf.ShapeError, r"faces must have shape \(n, 3\), got \(6,\)", V, F.reshape(-1)),
    ("quads", abf.ShapeError, r"faces must have shape \(n, 3\), got \(1, 4\)", V, [[0, 1, 2, 3]]),
    ("nothing", abf.ShapeError, "vertices must have shape", [], F),
    ("no faces", abf.ShapeError, "faces must have shape", V, []),
    ("no rows of faces", abf.GeometryError, "no faces", V, np.zeros((0, 3), int)),
    ("no vertices", abf.GeometryError, "there are 0 vertices", np.zeros((0, 3)), F),
    ("a scalar", abf.ShapeError, "vertices must have shape", 7.0, F),
    ("text", TypeError, "vertices must be real numbers", [["a", "b", "c"]], F),
    ("None", TypeError, "vertices must be real numbers", None, F),
    ("complex numbers", TypeError, "vertices must be real numbers", V.astype(complex), F),
    ("faces of floats", TypeError, "faces must be whole numbers, got an array of float64", V, F.astype(float)),
    ("faces of truth values", TypeError, "faces must be whole numbers", V, F.astype(bool)),
    ("NaN", abf.GeometryError, "vertex 2 has a coordinate that is not finite", _with(2, math.nan), F),
    ("infinity", abf.GeometryError, "vertex 1 has a coordinate that is not finite", _with(1, -math.inf), F),
    ("a negative index", abf.GeometryError, "face 1 has the index -1, and there are 4 vertices", V, [[0, 1, 2], [0, 2, -1]]),
    ("an index too large", abf.GeometryError, "face 0 has the index 4, and there are 4 vertices", V, [[0, 1, 4]]),
    ("an enormous index", abf.GeometryError, "18446744073709551615", V, np.array([[0, 1, 2**64 - 1]], np.uint64)),
    ("two triangles that touch in a point", abf.TopologyError, "2 separate fans", [*V.tolist(), [2, 2, 0]], [[0, 1, 2], [0, 3, 4]]),
    ("a closed surface", abf.NotADiskError, "closed", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
    ("an edge of three faces", abf.TopologyError, "3 faces", [*V.tolist(), [0, 0, 1]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]]),
    ("no area", abf.GeometryError, "area", V * [1, 0, 0], F),
]


@pytest.mark.parametrize(("error", "text", "vertices", "faces"), [w[1:] for w in WRONG], ids=[w[0] for w in WRONG])
def test_every_wrong_mesh_has_its_exception(error: type[Exception], text: str, vertices: Any, faces: Any) -> None:
    with pytest.raises(error, match=text) as raised:
        abf.flatten(vertices, faces)
    assert type(raised.value) is error
    assert issubclass(error, (ValueError, TypeError))


SETTINGS: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"threads": 0}, abf.SettingError, "threads must be in 1..=1024, got 0"),
    ({"threads": -1}, abf.SettingError, "threads"),
    ({"threads": 10**30}, abf.SettingError, "threads"),
    ({"threads": 1.5}, TypeError, "threads"),
    ({"time_limit": math.nan}, abf.SettingError, "time_limit must be a number of seconds, at least 0, got NaN"),
    ({"time_limit": -1.0}, abf.SettingError, "time_limit"),
    ({"time_limit": math.inf}, abf.SettingError, "time_limit"),
    ({"time_limit": "soon"}, TypeError, "time_limit"),
    ({"max_memory": -1}, abf.SettingError, "max_memory"),
    ({"max_memory": 1000}, MemoryError, "the limit is 1.0 kB"),
    ({"solver": "abff"}, abf.SettingError, "solver"),
    ({"solver": 3}, TypeError, "solver must be a str"),
    ({"layout": "nice"}, abf.SettingError, "layout"),
    ({"zero_area": "maybe"}, abf.SettingError, "zero_area"),
    ({"tolerance": 0.0}, abf.SettingError, "tolerance must be positive"),
    ({"max_iterations": 0}, abf.SettingError, "max_iterations"),
    ({"passes": 0}, abf.SettingError, "passes"),
    ({"passes": "all"}, abf.SettingError, "passes must be a number or 'auto', got 'all'"),
    ({"ring_switch": math.nan}, abf.SettingError, "ring_switch"),
    ({"angle_bound": 4.0}, abf.SettingError, "angle_bound"),
    ({"barrier_floor": -1.0}, abf.SettingError, "barrier_floor"),
    ({"solver": "lscm", "time_limit": 1.0}, abf.SettingError, "time_limit means nothing to the solver 'lscm'"),
    ({"solver": "linabf", "wheel": "log"}, abf.SettingError, "wheel means nothing to the solver 'linabf'"),
    ({"solver": "descent", "layout": "tree"}, abf.SettingError, "descent"),
    ({"solver": "uzawa", "wheel": "product"}, abf.SettingError, "product wheel"),
    ({"boundary": "oval"}, abf.SettingError, "boundary must be free, convex"),
    ({"boundary": "below-2pi=7"}, abf.SettingError, "boundary must be below-2pi=EPS"),
    ({"boundary": "rectangle=0,1,2"}, abf.SettingError, "rectangle"),
    ({"boundary": "rectangle=0,1,2,2"}, abf.SettingError, "the corner 2 of the rectangle is named twice"),
    ({"boundary": {9: 1.0}}, abf.SettingError, "9"),
    ({"boundary": {-1: 1.0}}, abf.SettingError, "boundary"),
    ({"boundary": {0: "wide"}}, TypeError, "boundary"),
    ({"boundary": [1.0]}, TypeError, "boundary"),
    ({"boundary": "convex", "solver": "uzawa"}, abf.SettingError, "boundary means nothing to the solver 'uzawa'"),
    ({"boundary": "convex", "solver": "linabf", "error_bound": 0.5}, abf.SettingError, "does not go with"),
    ({"error_bound": 2.0, "solver": "linabf"}, abf.SettingError, "error_bound must be in"),
    ({"error_bound": 0.5}, abf.SettingError, "error_bound means nothing to the solver 'auto'"),
    ({"energy": "little"}, abf.SettingError, "energy must be abf, isometric, usable or a positive number, got 'little'"),
    ({"energy": -1.0}, abf.SettingError, "energy must be abf"),
    ({"energy": math.nan}, abf.SettingError, "energy must be abf"),
    ({"energy": [1.0]}, TypeError, "energy"),
    ({"energy": "usable", "boundary": "convex"}, abf.SettingError, "moves the boundary"),
    ({"injective": "yes"}, abf.SettingError, "injective"),
    ({"injective": "deform", "boundary": "convex"}, abf.SettingError, "does not go with a boundary rule"),
    ({"injective": "split", "pins": {0: (0, 0)}}, abf.SettingError, "does not go with pins"),
    ({"boundary_gap": 0.1}, abf.SettingError, "boundary gap needs the rule 'deform'"),
    ({"boundary_gap": -1.0, "injective": "deform"}, abf.SettingError, "gap"),
    ({"pins": [1.0]}, TypeError, "pins must be a dict of vertices"),
    ({"pins": {0: 1.0}}, TypeError, r"pins\[0\] must be \(u, v\) or \(u, v, weight\), got 1.0"),
    ({"pins": {0: "here"}}, TypeError, r"pins\[0\]"),
    ({"pins": {0: (1.0,)}}, abf.ShapeError, r"pins\[0\] must be \(u, v\) or \(u, v, weight\), got 1 numbers"),
    ({"pins": {"a": (1.0, 2.0)}}, TypeError, "pins"),
    ({"pins": {1.5: (1.0, 2.0)}}, TypeError, "pins"),
    ({"pins": {-1: (1.0, 2.0)}}, abf.SettingError, "pins"),
    ({"pins": {4: (1.0, 2.0)}}, abf.SettingError, "there is no vertex 4: the mesh has 4"),
    ({"pins": {0: (math.nan, 2.0)}}, abf.SettingError, "the pin of vertex 0 has a number that is not finite"),
    ({"pins": {0: (1.0, 2.0, 0.0)}}, abf.SettingError, "the pin of vertex 0"),
    ({"pins": {0: (0, 0), 1: (0, 0)}}, abf.SettingError, "all 2 hard pins are in one place"),
    ({"pins": {0: (0, 0), 2: (1, 0), 1: (0, 1)}}, abf.SettingError, "turn face 0 over"),
    ({"pins": {0: (0, 0)}, "normalize": True}, abf.SettingError, "pins do not go with normalize"),
    ({"pins": {0: (0, 0)}, "boundary": "circle"}, abf.SettingError, "pins do not go with a boundary rule"),
    ({"progress": 3}, TypeError, "progress must be callable"),
    ({"speed": 3}, TypeError, "speed"),
]


@pytest.mark.parametrize(("settings", "error", "text"), SETTINGS, ids=[str(s[0]) for s in SETTINGS])
def test_every_wrong_setting_has_its_exception(settings: dict[str, Any], error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        abf.flatten(V, F, **settings)


RELAXING: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"energy": 0.0}, abf.SettingError, "energy"),
    ({"time_limit": -1.0}, abf.SettingError, "time_limit"),
    ({"max_memory": 1000}, MemoryError, "the limit is 1.0 kB"),
    ({"threads": 0}, abf.SettingError, "threads"),
    ({"pins": {9: (0, 0)}}, abf.SettingError, "there is no vertex 9"),
    ({"solver": "auto"}, TypeError, "solver"),
    ({"progress": 3}, TypeError, "progress must be callable"),
    ({"uv": UV[:3]}, abf.ShapeError, "uv must have a row for each of the 4 vertices"),
    ({"uv": V}, abf.ShapeError, r"uv must have shape \(n, 2\)"),
    ({"uv": UV + math.inf}, abf.GeometryError, "row 0 of uv is not finite"),
    ({"uv_faces": F + 2}, abf.GeometryError, "4 UVs"),
    ({"faces": [[0, 1, 2], [0, 1, 3]]}, abf.TopologyError, "edge"),
    ({"uv": np.arange(12.0).reshape(6, 2), "uv_faces": [[0, 1, 2], [3, 4, 5]], "pins": {0: (0, 0)}}, abf.SettingError, "seams"),
]


@pytest.mark.parametrize(("given", "error", "text"), RELAXING, ids=[str(s[0])[:60] for s in RELAXING])
def test_every_wrong_map_to_relax_has_its_exception(given: dict[str, Any], error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        abf.relax(**{"vertices": V, "faces": F, "uv": UV, **given})


UNWRAPPING: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"max_stretch": 0.5}, abf.SettingError, "max_stretch must be at least 1, got 0.5"),
    ({"energy": "little"}, abf.SettingError, "energy"),
    ({"pins": {0: (0, 0)}}, TypeError, "pins"),
    ({"max_stretch": math.nan}, abf.SettingError, "max_stretch"),
    ({"max_seam": -1.0}, abf.SettingError, "max_seam"),
    ({"max_chart_length": 0.5}, abf.SettingError, "max_chart_length"),
    ({"crease_angle": 200.0}, abf.SettingError, "crease_angle must be in 0..=180 degrees"),
    ({"resolution": 0}, abf.SettingError, "page"),
    ({"resolution": -1}, abf.SettingError, "resolution"),
    ({"resolution": 10**7}, abf.SettingError, "page"),
    ({"resolution": 64, "page": (64, 64)}, abf.SettingError, "page and resolution"),
    ({"page": (64, 0)}, abf.SettingError, "page height"),
    ({"margin": 900}, abf.SettingError, "margin"),
    ({"margin": "wide"}, abf.SettingError, "margin"),
    ({"margin": 2, "mip_levels": 2}, abf.SettingError, "mip_levels"),
    ({"max_pages": 0}, abf.SettingError, "pages"),
    ({"texels_per_unit": 0.0}, abf.SettingError, "texels per unit must be positive"),
    ({"texels_per_unit": 1e6}, abf.NoResultError, "texels"),
    ({"pack": "hard"}, abf.SettingError, "pack"),
    ({"weld": -1.0}, abf.SettingError, "weld"),
    ({"weld": "on"}, abf.SettingError, "weld"),
    ({"holes": "open"}, abf.SettingError, "holes"),
    ({"atlas": "per-material"}, abf.SettingError, "material"),
    ({"seams": "nice"}, abf.SettingError, "seams must be"),
    ({"seams": "keep"}, abf.SettingError, "neither is given"),
    ({"seams": [[0, 1, 2]]}, abf.ShapeError, "seams"),
    ({"seams": [[0, 9]]}, abf.GeometryError, "seam 0 has the index 9"),
    ({"seams": [[0.5, 1.0]]}, TypeError, "seams"),
    ({"uv_faces": F}, abf.SettingError, "uv_faces"),
    ({"uv": UV[:3], "seams": "keep"}, abf.ShapeError, "uv must have a row for each of the 4 vertices, got 3"),
    ({"uv": UV, "uv_faces": F + 3, "seams": "keep"}, abf.GeometryError, "row of uv_faces 0 has the index"),
    ({"uv": UV, "uv_faces": F[:1], "seams": "keep"}, abf.ShapeError, "uv_faces must have a row for each of the 2 faces"),
    ({"uv": np.full((4, 2), np.nan), "seams": "keep"}, abf.GeometryError, "row 0 of uv is not finite"),
    ({"materials": [1]}, abf.ShapeError, "materials must have a label for each of the 2 faces, got 1"),
    ({"materials": [0.5, 1.0]}, TypeError, "materials"),
    ({"objects": [[1], [2]]}, abf.ShapeError, "objects"),
    ({"coverage": 0.0}, abf.SettingError, r"coverage must be in \(0, 1\], got 0"),
    ({"coverage": math.nan}, abf.SettingError, "coverage must be in"),
    ({"coverage": "much"}, TypeError, "coverage"),
    ({"coverage": 0.5, "seam_budget": -1.0}, abf.SettingError, "seam budget must be"),
    ({"seam_budget": 0.1}, abf.SettingError, "give coverage, too"),
    ({"inner_margin": "part"}, abf.SettingError, "inner_margin must be 'keep' or 'count', got 'part'"),
    ({"overlap": "yes"}, abf.SettingError, "overlap must be 'allow' or 'refuse', got 'yes'"),
    ({"overlap": 1}, TypeError, "overlap"),
    ({"cut_disks": "no"}, TypeError, "cut_disks"),
    ({"solver": "linabf", "error_bound": 1.0}, abf.SettingError, "error_bound must be in"),
    ({"wheel": "log"}, abf.SettingError, "wheel means nothing to the solver 'auto'"),
    ({"passes": 0}, abf.SettingError, "passes"),
    ({"boundary": "convex"}, TypeError, "boundary"),
]


@pytest.mark.parametrize(("settings", "error", "text"), UNWRAPPING, ids=[str(s[0])[:60] for s in UNWRAPPING])
def test_every_wrong_setting_of_an_atlas_has_its_exception(
    settings: dict[str, Any], error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        abf.unwrap(V, F, **settings)


def test_a_strict_run_refuses_what_needs_repair() -> None:
    with pytest.raises(abf.TopologyError):
        abf.unwrap([*V.tolist(), [0, 0, 1]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]], strict=True)
    with pytest.raises(abf.GeometryError, match="face 2 has no area"):
        abf.flatten([*V.tolist(), [0.5, 0, 0]], [[0, 1, 2], [0, 2, 3], [1, 0, 4]], zero_area="refuse")


def test_wrong_uvs_have_their_exception() -> None:
    for call in (abf.metrics, abf.certify, abf.pack):
        with pytest.raises(abf.ShapeError, match="uv must have a row"):
            call(V, F, UV[:3])
        with pytest.raises(abf.ShapeError, match=r"uv must have shape \(n, 2\)"):
            call(V, F, V)
        with pytest.raises(abf.GeometryError, match="row 0 of uv is not finite"):
            call(V, F, np.full((4, 2), np.nan))
        with pytest.raises(TypeError, match="uv must be real numbers"):
            call(V, F, UV.astype(str))
    with pytest.raises(abf.SettingError, match="precision must be 'single' or 'double', got 'half'"):
        abf.certify(V, F, UV, precision="half")  # type: ignore[arg-type]


def test_wrong_files_have_their_exception(tmp_path: Any) -> None:
    with pytest.raises(FileNotFoundError, match="missing.obj"):
        abf.read(tmp_path / "missing.obj")
    with pytest.raises(IsADirectoryError):
        abf.read(tmp_path)
    (tmp_path / "broken.obj").write_text("v 0 0 zero\n")
    with pytest.raises(abf.FormatError, match="broken.obj, line 1"):
        abf.read(tmp_path / "broken.obj")
    (tmp_path / "mesh.xyz").write_text("0 0 0")
    with pytest.raises(abf.FormatError, match="known are"):
        abf.read(tmp_path / "mesh.xyz")
    with pytest.raises(abf.FormatError, match="known are"):
        abf.parse("mesh.xyz", b"0 0 0")
    with pytest.raises(abf.FormatError):
        abf.parse("mesh.off", b"")
    with pytest.raises(abf.FormatError, match="can be written"):
        abf.write(tmp_path / "mesh.off", V, F)
    with pytest.raises(FileNotFoundError):
        abf.write(tmp_path / "missing" / "mesh.obj", V, F)
    with pytest.raises(abf.GeometryError, match="not finite"):
        abf.write(tmp_path / "mesh.obj", V * np.nan, F)
    with pytest.raises(TypeError):
        abf.read(3)  # type: ignore[arg-type]
    assert not (tmp_path / "mesh.obj").exists()


def test_an_array_that_another_thread_changes_does_no_harm() -> None:
    vertices, faces = bumpy(40)
    good, stop = faces.copy(), threading.Event()

    def spoil() -> None:
        while not stop.is_set():
            faces[:] = -(2**40)
            faces[:] = good

    other = threading.Thread(target=spoil)
    other.start()
    try:
        for _ in range(30):
            try:
                assert abf.flatten(vertices, faces, threads=1).certificate.valid
            except abf.GeometryError as error:
                assert "has the index" in str(error)
            except (abf.TopologyError, abf.NotADiskError):
                pass
    finally:
        stop.set()
        other.join()
