"""Texture coordinates of PyVista, and a picture rendered off screen.

Needs: pyvista

    python with_pyvista.py [FOLDER]
"""

import pathlib
import sys

import abf_flatten
import numpy as np
import pyvista

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(parents=True, exist_ok=True)

surface = pyvista.ParametricTorus(u_res=60, v_res=30, w_res=30).triangulate()
faces = surface.faces.reshape(-1, 4)[:, 1:]
vmapping, indices, uvs = abf_flatten.unwrap(surface.points, faces)

flat = pyvista.PolyData.from_regular_faces(np.asarray(surface.points)[vmapping], indices)
flat.active_texture_coordinates = uvs
squares = np.indices((512, 512)).sum(0) // 32 % 2 * 200 + 40
texture = pyvista.numpy_to_texture(np.repeat(squares[..., None], 3, 2).astype(np.uint8))

plotter = pyvista.Plotter(off_screen=True, window_size=(640, 480))
plotter.add_mesh(flat, texture=texture)
plotter.screenshot(folder / "torus.png")
plotter.close()

seen = pyvista.read(folder / "torus.png").active_scalars
assert len(np.unique(seen.reshape(-1, seen.shape[-1]), axis=0)) > 100, "the picture is empty"
print(f"torus.png: {flat.n_cells} triangles in {flat.n_points} points")
