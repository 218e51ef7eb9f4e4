"""A drop-in for the package `xatlas`: `import abf_flatten.xatlas as xatlas`.

`parametrize` and `Atlas` take and give what xatlas's do. What comes out is an atlas of `abf_flatten.unwrap`: fewer
charts, as a rule, each proved valid. Programs that import xatlas themselves, as trimesh does, take this module after
`sys.modules["xatlas"] = abf_flatten.xatlas`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._abf import SettingError
from ._arrays import indices as _indices
from ._arrays import reals as _reals
from ._results import Unwrapped
from ._unwrap import unwrap

__all__ = ["Atlas", "ChartOptions", "PackOptions", "parametrize"]

_Mesh = tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.float32]]
#: As many pages as it takes.
_ALL_PAGES = 65_536


@dataclass
class ChartOptions:
    """How xatlas makes charts. Only `use_input_mesh_uvs` means something here: it keeps the seams of those UVs."""

    fix_winding: bool = False
    max_boundary_length: float = 0.0
    max_chart_area: float = 0.0
    max_cost: float = 2.0
    max_iterations: int = 1
    normal_deviation_weight: float = 2.0
    normal_seam_weight: float = 4.0
    roundness_weight: float = 0.01
    straightness_weight: float = 6.0
    texture_seam_weight: float = 0.5
    use_input_mesh_uvs: bool = False


@dataclass
class PackOptions:
    """How charts are packed. `padding` texels are free between charts, and two more with `bilinear`.

    `bruteForce` tries harder. `blockAlign`, `max_chart_size`, `rotate_charts` and `rotate_charts_to_axis` mean nothing
    here; `create_image` is refused.
    """

    bilinear: bool = True
    blockAlign: bool = False  # noqa: N815, the name is xatlas's
    bruteForce: bool = False  # noqa: N815
    create_image: bool = False
    max_chart_size: int = 0
    padding: int = 0
    resolution: int = 0
    rotate_charts: bool = True
    rotate_charts_to_axis: bool = True
    texels_per_unit: float = 0.0


def parametrize(
    positions: ArrayLike,
    indices: ArrayLike,
    normals: ArrayLike | None = None,
    uvs: ArrayLike | None = None,
) -> _Mesh:
    """Unwrap one mesh: `vmapping, indices, uvs`.

    Args:
        positions: (n, 3) real numbers.
        indices: (m, 3) whole numbers.
        normals, uvs: Not used, as by xatlas with its default options.

    Returns:
        (k,) uint32: which vertex every new one is a copy of; (m, 3) uint32; (k, 2) float32 in the unit square.

    Raises:
        What `abf_flatten.unwrap` raises.
    """
    atlas = Atlas()
    atlas.add_mesh(positions, indices, normals, uvs)
    atlas.generate()
    return atlas[0]


class Atlas:
    """Several meshes in one atlas: `add_mesh`, `generate`, then `atlas[i]` is `vmapping, indices, uvs` of mesh i."""

    def __init__(self) -> None:
        self._meshes: list[tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64] | None]] = []
        self._result: Unwrapped | None = None
        self._side = 0

    def add_mesh(
        self,
        positions: ArrayLike,
        indices: ArrayLike,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
    ) -> None:
        """Add a mesh: (n, 3) positions and (m, 3) indices; `uvs` are for `ChartOptions.use_input_mesh_uvs` only."""
        points, faces = _reals(positions, "positions", 3), _indices(indices, "indices")
        if faces.size and not 0 <= faces.min() <= faces.max() < len(points):
            raise RuntimeError("Adding mesh failed: Index out of range")
        self._meshes.append((points, faces, None if uvs is None else _reals(uvs, "uvs", 2)))
        self._result = None

    def generate(
        self,
        chart_options: ChartOptions | None = None,
        pack_options: PackOptions | None = None,
        verbose: bool = False,
    ) -> None:
        """Make the atlas of all meshes. `verbose` prints nothing: a library does not."""
        charts, pack = chart_options or ChartOptions(), pack_options or PackOptions()
        if pack.create_image:
            raise SettingError("create_image is not supported: draw the UVs of the result")
        if pack.texels_per_unit and not pack.resolution:
            raise SettingError("texels_per_unit needs a resolution")
        if not self._meshes:
            raise SettingError("there is no mesh: call add_mesh() first")
        first = np.cumsum([0, *(len(points) for points, _, _ in self._meshes)])
        uvs = [uv for _, _, uv in self._meshes]
        keeps = charts.use_input_mesh_uvs and all(uv is not None for uv in uvs)
        self._side = int(pack.resolution) or 1024
        settings: dict[str, Any] = {
            "resolution": self._side,
            "margin": pack.padding + (2 if pack.bilinear else 0),
            "pack": "best" if pack.bruteForce else "good",
        }
        if keeps:
            settings |= {"seams": "keep", "uv": np.concatenate([uv for uv in uvs if uv is not None])}
        if pack.texels_per_unit:
            settings |= {"texels_per_unit": pack.texels_per_unit, "max_pages": _ALL_PAGES}
        self._result = unwrap(
            np.concatenate([points for points, _, _ in self._meshes]),
            np.concatenate([faces + start for (_, faces, _), start in zip(self._meshes, first)]),
            objects=np.repeat(np.arange(len(self._meshes)), [len(faces) for _, faces, _ in self._meshes]),
            **settings,
        )

    def get_mesh(self, mesh_index: int) -> _Mesh:
        """The mesh of this number: `vmapping, indices, uvs`.

        Raises:
            IndexError: There is none of this number, or nothing has been generated.
        """
        count = len(self._meshes) if self._result else 0
        if not 0 <= mesh_index < count:
            raise IndexError(f"Mesh index {mesh_index} out of bounds for atlas with {count} meshes.")
        known = self._known
        first_vertex = sum(len(points) for points, _, _ in self._meshes[:mesh_index])
        first_face = sum(len(faces) for _, faces, _ in self._meshes[:mesh_index])
        points, faces, _ = self._meshes[mesh_index]
        is_own = (known.vmapping >= first_vertex) & (known.vmapping < first_vertex + len(points))
        number = np.cumsum(is_own, dtype=np.uint32) - np.uint32(1)
        rows = known.indices[first_face : first_face + len(faces)]
        return known.vmapping[is_own] - np.uint32(first_vertex), number[rows], known.uvs[is_own]

    def __getitem__(self, mesh_index: int) -> _Mesh:
        return self.get_mesh(mesh_index)

    def __len__(self) -> int:
        return len(self._meshes) if self._result else 0

    @property
    def mesh_count(self) -> int:
        """How many meshes there are."""
        return len(self)

    @property
    def atlas_count(self) -> int:
        """How many pages there are."""
        return self._known.pages if self._result else 0

    @property
    def chart_count(self) -> int:
        """How many charts there are."""
        return self._known.charts if self._result else 0

    @property
    def width(self) -> int:
        """Texels along a side of a page."""
        return self._side if self._result else 0

    @property
    def height(self) -> int:
        """The same: pages are squares."""
        return self.width

    @property
    def texels_per_unit(self) -> float:
        """How many texels a unit of the meshes gets."""
        return self._known.texels_per_unit if self._result else 0.0

    @property
    def utilization(self) -> float:
        """The part of the pages that charts cover."""
        return self._known.coverage if self._result else 0.0

    def get_utilization(self, atlas_index: int) -> float:
        """The same for every page."""
        if not 0 <= atlas_index < self.atlas_count:
            raise IndexError(f"Atlas index {atlas_index} out of bounds for {self.atlas_count} atlases.")
        return self.utilization

    @property
    def result(self) -> Unwrapped:
        """All of it at once, with the certificate: xatlas has no such thing.

        Raises:
            IndexError: Nothing has been generated.
        """
        return self._known

    @property
    def _known(self) -> Unwrapped:
        if self._result is None:
            raise IndexError("there is no atlas: call generate() first")
        return self._result
