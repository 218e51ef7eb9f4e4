"""`relax`."""

from __future__ import annotations

from numpy.typing import ArrayLike

from . import _abf
from ._arrays import mapped, pins_of, settings_of, teller
from ._results import Relaxed, with_reports
from ._types import Energy, OnProgress, Pins


def relax(
    vertices: ArrayLike,
    faces: ArrayLike,
    uv: ArrayLike,
    uv_faces: ArrayLike | None = None,
    *,
    energy: Energy = "isometric",
    pins: Pins | None = None,
    time_limit: float | None = None,
    max_memory: int | None = None,
    threads: int | None = None,
    progress: OnProgress | None = None,
) -> Relaxed:
    """Relax UVs that anybody made until an energy is least, each chart by itself, through valid maps only.

    A chart that is not valid starts from Tutte's embedding, if it is a disk; else it stays. The area of the whole map
    stays. Each chart keeps its centre, and is turned as little as can be. Charts may come to lie over each other: `pack`
    lays them out.

    Args:
        vertices, faces, uv, uv_faces: As for `metrics`.
        energy: What is to be little: "abf" (angles), "isometric" (lengths), "usable" (angles, and areas within bounds),
            or the weight of areas beside angles; "usable" is 0.01.
        pins: As for `flatten`: for one chart without seams. They say where the map is then.
        time_limit: Seconds; then the best there is comes back.
        max_memory: Bytes. A mesh for which more is predicted is refused.
        threads, progress: As for `flatten`.

    Returns:
        A `Relaxed`: `uv` with its `certificate` and `metrics`, and what was done to each chart.

    Raises:
        TypeError, ShapeError, GeometryError, MemoryError: As for `flatten`; for UVs, too.
        TopologyError: A chart that is no oriented manifold.
        SettingError: A setting outside its range, or pins that no map of the mesh can have.

    >>> import abf_flatten
    >>> square, faces = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]
    >>> flat = abf_flatten.relax(square, faces, [[0, 0], [4, 0], [4, 1], [0, 1]])
    >>> flat.uv.round(3).tolist(), flat.charts[0].before > 2
    ([[1.0, -0.5], [3.0, -0.5], [3.0, 1.5], [1.0, 1.5]], True)
    """
    arguments = locals()
    settings = settings_of(arguments, "vertices", "faces", "uv", "uv_faces", "progress")
    settings["pins"] = pins_of(pins)
    return Relaxed(**with_reports(_abf.relax(mapped(vertices, faces, uv, uv_faces), settings, teller(progress))))
