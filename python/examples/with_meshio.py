"""From any format that meshio reads to one that it writes, with UVs.

Needs: meshio

    python with_meshio.py [FOLDER]
"""

import pathlib
import sys

import abf_flatten
import meshio
import numpy as np

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(parents=True, exist_ok=True)

# A box as a finite element program would have it: quads.
corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
meshio.write(folder / "box.vtk", meshio.Mesh(corners, [("quad", quads)]))

mesh = meshio.read(folder / "box.vtk")
quads = mesh.cells_dict["quad"]
triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
# No seam runs along the diagonal of a quad.
flat = abf_flatten.unwrap(mesh.points, triangles, polygons=np.tile(np.arange(len(quads)), 2))
vmapping, indices, uvs = flat
assert flat.metrics.stretch_l2 < 1.001, "a box unfolds without distortion"

out = meshio.Mesh(mesh.points[vmapping], [("triangle", indices)], point_data={"uv": uvs.astype(float)})
meshio.write(folder / "box.vtu", out)
back = meshio.read(folder / "box.vtu")
assert np.array_equal(back.point_data["uv"], uvs)
print(f"box.vtu: {len(indices)} triangles, {flat.charts} chart(s)")
