"""Energies of a map from what is written in an OBJ file. It shares no code with the library, and needs no package."""
import dataclasses
import math


@dataclasses.dataclass
class Map:
    """A mesh with UVs: `faces` of the points, `corners` of the UVs, triangles both."""

    points: list
    uv: list
    faces: list
    corners: list


def read(path):
    """The map in an OBJ file; without `vt` lines the UVs are empty."""
    result = Map([], [], [], [])
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            kind, *rest = line.split() or [""]
            if kind == "v":
                result.points.append(tuple(float(x) for x in rest[:3]))
            elif kind == "vt":
                result.uv.append(tuple(float(x) for x in rest[:2]))
            elif kind == "f":
                corners = [corner.split("/") for corner in rest]
                for k in range(1, len(corners) - 1):
                    triangle = [corners[0], corners[k], corners[k + 1]]
                    result.faces.append([int(corner[0]) - 1 for corner in triangle])
                    if result.uv:
                        result.corners.append([int(corner[1]) - 1 for corner in triangle])
    return result


def errors(of):
    """`energy`, the symmetric Dirichlet energy `∫ s₁² + s₂² + s₁⁻² + s₂⁻² − 4` over the surface, its area as 1, at the scale of the
    map at which it is least; `l2`, the L² stretch; `areas`, `Σ |a₂ − a₃|` with equal total areas, 1; `qc`, the mean of `s₁/s₂`
    over the surface. All are infinite where a triangle is flipped or collapsed. Triangles without area in space count for nothing.
    """
    triangles = [
        singular([of.points[v] for v in face], [of.uv[v] for v in corners])
        for face, corners in zip(of.faces, of.corners)
    ]
    triangles = [triangle for triangle in triangles if triangle]
    if any(triangle[2] <= 0.0 for triangle in triangles):
        return dict.fromkeys(["energy", "l2", "areas", "qc"], math.inf)
    surface = math.fsum(area for area, *_ in triangles)
    plane = math.fsum(area * large * small for area, large, small in triangles)
    growing = math.fsum(a * (large * large + small * small) for a, large, small in triangles) / surface
    shrinking = math.fsum(a * (large**-2 + small**-2) for a, large, small in triangles) / surface
    scaled = [(a / surface, a * large * small / plane) for a, large, small in triangles]
    return {
        "energy": 2.0 * math.sqrt(growing * shrinking) - 4.0,
        "l2": math.sqrt(0.5 * shrinking * plane / surface),
        "areas": math.fsum(abs(in_plane - in_space) for in_space, in_plane in scaled),
        "qc": math.fsum(a * large / small for a, large, small in triangles) / surface,
    }


def best_scale(of):
    """The factor of the UVs at which the symmetric Dirichlet energy is least."""
    triangles = [
        singular([of.points[v] for v in face], [of.uv[v] for v in corners])
        for face, corners in zip(of.faces, of.corners)
    ]
    triangles = [triangle for triangle in triangles if triangle]
    growing = math.fsum(a * (large * large + small * small) for a, large, small in triangles)
    shrinking = math.fsum(a * (large**-2 + small**-2) for a, large, small in triangles)
    return (shrinking / growing) ** 0.25


def singular(points, uv):
    """The area in space, and the singular values of the map, the second negative where the triangle is flipped; None without
    an area in space."""
    e, f = ([points[k][i] - points[0][i] for i in range(3)] for k in (1, 2))
    length = math.hypot(*e)
    cross = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
    double_area = math.hypot(*cross)
    if not double_area > 0.0:
        return None
    # In the plane of the triangle, the first edge along x.
    along, height = sum(a * b for a, b in zip(e, f)) / length, double_area / length
    (ax, ay), (bx, by) = ((uv[k][0] - uv[0][0], uv[k][1] - uv[0][1]) for k in (1, 2))
    of_x = (ax / length, ay / length)
    of_y = ((bx - of_x[0] * along) / height, (by - of_x[1] * along) / height)
    determinant = (ax * by - ay * bx) / double_area
    # (s₁ + s₂)² and (s₁ − s₂)².
    total = math.hypot(of_x[0] + of_y[1], of_x[1] - of_y[0])
    apart = math.hypot(of_x[0] - of_y[1], of_x[1] + of_y[0])
    large = 0.5 * (total + apart)
    return 0.5 * double_area, large, determinant / large if large > 0.0 else 0.0
