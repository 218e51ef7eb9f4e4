"""From a mesh of Blender to arrays, and back. Nothing here needs a window."""

from dataclasses import dataclass

import numpy as np

_NAME = "UVMap"


class Refused(Exception):
    """Why a mesh was left as it is, for its user."""


@dataclass(frozen=True)
class Settings:
    """What the operator was told."""

    solver: str = "auto"
    energy: "str | None" = None
    injective: str = "split"
    use_seams: bool = True
    mark_seams: bool = False
    max_stretch: float = 1.15
    resolution: int = 1024
    margin: int = 2
    pack: str = "good"


@dataclass(frozen=True)
class Report:
    """What became of a mesh."""

    injective: bool
    charts: int
    text: str


def unwrap_mesh(mesh, settings, selected_only, scale=(1.0, 1.0, 1.0)):
    """Gives UVs to the faces of a mesh in object mode, or to those that are selected; faces with a pinned UV stay.

    `scale` is that of its object, so that UVs are true to what is seen.
    Returns a `Report`, or None where there is no face to unwrap. Raises `Refused`.
    """
    import abf_flatten

    polygons = _chosen(mesh, selected_only)
    layer = mesh.uv_layers.active
    pinned = _polygons_with_pins(mesh, layer) & polygons if layer else np.zeros(len(mesh.polygons), bool)
    polygons &= ~pinned
    if not polygons.any():
        return None
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners = _get(mesh.loop_triangles, "vertices", 3 * count, np.int32).reshape(-1, 3)
    loops = _get(mesh.loop_triangles, "loops", 3 * count, np.int32).reshape(-1, 3)
    of_polygon = _get(mesh.loop_triangles, "polygon_index", count, np.int32)
    is_chosen = polygons[of_polygon]
    corners, loops, of_polygon = corners[is_chosen], loops[is_chosen], of_polygon[is_chosen]
    positions = _get(mesh.vertices, "co", 3 * len(mesh.vertices), np.float32).reshape(-1, 3)
    positions = positions * np.abs(np.asarray(scale, np.float32))
    # Only the vertices of these faces, by numbers of their own.
    used, rows = np.unique(corners, return_inverse=True)
    number = np.full(len(mesh.vertices), -1, np.int32)
    number[used] = np.arange(len(used))
    seams = number[_marked(mesh)] if settings.use_seams else np.zeros((0, 2), np.int32)
    seams = seams[(seams >= 0).all(1)]
    try:
        flat = abf_flatten.unwrap(
            positions[used],
            rows.reshape(-1, 3),
            solver=settings.solver,
            energy=settings.energy,
            injective=settings.injective,
            seams=seams if len(seams) else "auto",
            max_stretch=settings.max_stretch,
            resolution=settings.resolution,
            margin=settings.margin,
            pack=settings.pack,
            polygons=of_polygon,
            # Vertices of Blender are joined where they are meant to be.
            weld="off",
        )
    except (ValueError, MemoryError) as error:
        raise Refused(str(error)) from None
    layer = layer or mesh.uv_layers.new(name=_NAME)
    uv = _get(layer.uv, "vector", 2 * len(mesh.loops), np.float32).reshape(-1, 2)
    written = flat.uvs[flat.indices]
    uv[loops] = written
    # Where no other way was found a seam crosses a face. Blender has one UV for each of its corners: the map is another one then.
    is_crossed = (uv[loops] != written).any(axis=(1, 2))
    known, crossed = flat.certificate, len(np.unique(of_polygon[is_crossed]))
    if crossed:
        known = abf_flatten.certify(positions[used], rows.reshape(-1, 3), uv, loops, precision="single")
    # Not by layer.uv: what is written there reaches the copies that undo keeps.
    mesh.attributes[layer.name].data.foreach_set("vector", uv.ravel())
    if settings.mark_seams:
        _mark(mesh, corners, flat.indices, of_polygon)
    mesh.update()
    return _report(flat, known, crossed, int(pinned.sum()))


def _report(flat, known, crossed, pinned):
    proved = "injective" if known.injective else "valid, with overlaps" if known.valid else f"{known.flips} flipped faces"
    text = f"{flat.charts} chart{'s' * (flat.charts != 1)}, stretch {flat.metrics.stretch_l2:.3f}, {proved}"
    if flat.repairs:
        text += f"; repaired: {'; '.join(flat.repairs)}"
    if crossed:
        text += f"; seams cross {crossed} faces: triangulate them, or aim at another stretch"
    if pinned:
        text += f"; {pinned} faces with pinned UVs left as they are"
    return Report(known.injective, flat.charts, text)


def _chosen(mesh, selected_only):
    """For every polygon whether it is to be unwrapped. Hidden ones are not, in edit mode."""
    count = len(mesh.polygons)
    if not selected_only:
        return np.ones(count, bool)
    return _get(mesh.polygons, "select", count, bool) & ~_get(mesh.polygons, "hide", count, bool)


def _polygons_with_pins(mesh, layer):
    """For every polygon whether a corner of it has a pinned UV."""
    count = len(mesh.loops)
    pins = _get(layer.pin, "value", count, bool) if len(layer.pin) == count else np.zeros(count, bool)
    of_loop = np.repeat(np.arange(len(mesh.polygons)), _get(mesh.polygons, "loop_total", len(mesh.polygons), np.int32))
    has = np.zeros(len(mesh.polygons), bool)
    has[of_loop[pins]] = True
    return has


def _marked(mesh):
    """The edges that are marked as seams, by their vertices."""
    count = len(mesh.edges)
    marks = _get(mesh.edges, "use_seam", count, bool)
    return _get(mesh.edges, "vertices", 2 * count, np.int32).reshape(-1, 2)[marks]


def _mark(mesh, corners, indices, of_polygon):
    """Marks the edges where charts end: those with two faces here whose UVs differ along them."""
    sides = {}
    for a, b in ((0, 1), (1, 2), (2, 0)):
        ends = np.sort(corners[:, [a, b]], axis=1)
        swapped = corners[:, a] > corners[:, b]
        first = np.where(swapped, indices[:, b], indices[:, a])
        second = np.where(swapped, indices[:, a], indices[:, b])
        for edge, uv, polygon in zip(map(tuple, ends), zip(first, second), of_polygon):
            sides.setdefault(edge, []).append((uv, polygon))
    ending = {edge for edge, known in sides.items() if len({uv for uv, _ in known}) > 1}
    pairs = _get(mesh.edges, "vertices", 2 * len(mesh.edges), np.int32).reshape(-1, 2)
    marks = _get(mesh.edges, "use_seam", len(mesh.edges), bool)
    marks |= np.fromiter((tuple(sorted(pair)) in ending for pair in pairs.tolist()), bool, len(pairs))
    mesh.edges.foreach_set("use_seam", marks)


def _get(collection, name, count, dtype):
    values = np.empty(count, dtype)
    collection.foreach_get(name, values)
    return values
