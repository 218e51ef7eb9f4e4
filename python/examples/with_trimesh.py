"""trimesh's own `mesh.unwrap()` by abf_flatten, a texture, and a GLB that keeps both.

Needs: trimesh, pillow

    python with_trimesh.py [FOLDER]
"""

import pathlib
import sys

import abf_flatten
import abf_flatten.xatlas
import numpy as np
import trimesh
from PIL import Image

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(parents=True, exist_ok=True)

# From here on trimesh finds abf_flatten where it asks for xatlas.
sys.modules["xatlas"] = abf_flatten.xatlas

mesh = trimesh.creation.torus(major_radius=2.0, minor_radius=0.7)
flat = mesh.unwrap()
assert len(flat.faces) == len(mesh.faces)
assert abf_flatten.certify(flat.vertices, flat.faces, flat.visual.uv, precision="single").injective

squares = np.indices((512, 512)).sum(0) // 32 % 2 * 200 + 40
picture = Image.fromarray(squares.astype(np.uint8)).convert("RGB")
flat.visual = trimesh.visual.TextureVisuals(uv=flat.visual.uv, image=picture)
flat.export(folder / "torus.glb")

back = trimesh.load(folder / "torus.glb", force="mesh")
assert back.visual.uv.shape == flat.visual.uv.shape
assert back.visual.material.baseColorTexture.size == (512, 512)
print(f"torus.glb: {len(back.faces)} faces, {len(back.visual.uv)} UVs")
