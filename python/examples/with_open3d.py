"""UVs for a triangle mesh of Open3D, as one per corner.

Needs: open3d

    python with_open3d.py [FOLDER]
"""

import pathlib
import sys

import abf_flatten
import numpy as np
import open3d

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(parents=True, exist_ok=True)

mesh = open3d.geometry.TriangleMesh.create_torus(radial_resolution=40, tubular_resolution=20)
flat = abf_flatten.unwrap(np.asarray(mesh.vertices), np.asarray(mesh.triangles))
mesh.triangle_uvs = open3d.utility.Vector2dVector(flat.uvs[flat.indices].reshape(-1, 2).astype(float))

tensors = open3d.t.geometry.TriangleMesh.from_legacy(mesh)
assert tensors.triangle.texture_uvs.shape == (len(flat.indices), 3, 2)
assert np.allclose(tensors.triangle.texture_uvs.numpy(), flat.uvs[flat.indices])
assert open3d.io.write_triangle_mesh(str(folder / "torus_open3d.obj"), mesh)
print(f"torus_open3d.obj: {len(flat.indices)} triangles, valid: {flat.certificate.valid}")
