"""The drop-in for xatlas, beside the real one where that is installed."""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

import abf_flatten
import abf_flatten.xatlas as drop_in
import numpy as np
import pytest
from conftest import Mesh, bumpy, torus

BOTH = ["abf_flatten.xatlas", "xatlas"]


@pytest.fixture(params=BOTH)
def xatlas(request: pytest.FixtureRequest) -> Any:
    if importlib.util.find_spec(request.param.split(".")[0]) is None:
        pytest.skip(f"{request.param} is not installed")
    return importlib.import_module(request.param)


def test_one_mesh(xatlas: Any, ring: Mesh) -> None:
    vertices, faces = ring[0].astype(np.float32), ring[1].astype(np.uint32)
    vmapping, indices, uvs = xatlas.parametrize(vertices, faces)
    assert (vmapping.dtype, indices.dtype, uvs.dtype) == (np.uint32, np.uint32, np.float32)
    assert vmapping.shape == uvs.shape[:1] and indices.shape == faces.shape
    assert np.array_equal(np.sort(vmapping[indices], 1), np.sort(faces, 1))
    assert 0 <= uvs.min() and uvs.max() <= 1


def test_several_meshes(xatlas: Any) -> None:
    atlas = xatlas.Atlas()
    assert len(atlas) == 0
    meshes = [torus(12, 8), bumpy(8), torus(12, 8)]
    for vertices, faces in meshes:
        atlas.add_mesh(vertices.astype(np.float32), faces.astype(np.uint32))
    atlas.generate(xatlas.ChartOptions(), xatlas.PackOptions())
    assert len(atlas) == atlas.mesh_count == 3
    assert atlas.chart_count >= 3 and atlas.atlas_count == 1
    assert atlas.width > 0 and atlas.height > 0 and atlas.texels_per_unit > 0
    assert 0 < atlas.get_utilization(0) <= 1 and 0 < atlas.utilization <= 1
    for number, (vertices, faces) in enumerate(meshes):
        vmapping, indices, uvs = atlas[number]
        assert vmapping.max() < len(vertices) and indices.max() < len(uvs) == len(vmapping)
        assert np.array_equal(np.sort(vmapping[indices], 1), np.sort(faces, 1))
    for outside in (3, -1):
        with pytest.raises((IndexError, TypeError)):
            atlas.get_mesh(outside)


def test_wrong_input(xatlas: Any, ring: Mesh) -> None:
    vertices, faces = ring[0].astype(np.float32), ring[1].astype(np.uint32)
    with pytest.raises(RuntimeError, match="Index out of range"):
        xatlas.parametrize(vertices, faces + 1)
    with pytest.raises(ValueError):
        xatlas.parametrize(vertices, faces.reshape(-1))


def test_the_same_options_have_the_same_defaults() -> None:
    if importlib.util.find_spec("xatlas") is None:
        pytest.skip("xatlas is not installed")
    real = importlib.import_module("xatlas")
    for name in ("ChartOptions", "PackOptions"):
        theirs, ours = getattr(real, name)(), getattr(drop_in, name)()
        known = {key for key in dir(theirs) if not key.startswith("_")}
        assert known == set(vars(ours))
        assert all(getattr(theirs, key) == pytest.approx(getattr(ours, key)) for key in known)


def test_pack_options_reach_the_packer(ring: Mesh) -> None:
    def made(**options: Any) -> drop_in.Atlas:
        atlas = drop_in.Atlas()
        atlas.add_mesh(*ring)
        atlas.generate(pack_options=drop_in.PackOptions(**options))
        return atlas

    assert made(resolution=256).width == 256
    assert made(resolution=256, texels_per_unit=40.0).texels_per_unit == 40
    assert made(padding=30).utilization < made().utilization
    with pytest.raises(abf_flatten.SettingError, match="create_image"):
        made(create_image=True)
    with pytest.raises(abf_flatten.SettingError, match="resolution"):
        made(texels_per_unit=10.0)


def test_seams_of_the_uvs_are_kept_if_asked(disk: Mesh) -> None:
    vertices, faces = disk
    two = abf_flatten.unwrap(vertices, faces, seams="keep", materials=vertices[faces].mean(1)[:, 0] < 0.5)
    atlas = drop_in.Atlas()
    atlas.add_mesh(vertices[two.vmapping], two.indices, uvs=two.uvs)
    atlas.generate(drop_in.ChartOptions(use_input_mesh_uvs=True))
    assert atlas.chart_count == 2 and atlas.result.certificate.injective
    atlas.generate()
    assert atlas.chart_count == 1
