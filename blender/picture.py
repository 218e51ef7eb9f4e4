"""Draws the monkey beside its layout, as the add-on makes it: `pip install bpy`, and the wheel of abf_flatten.

    python picture.py docs/images/monkey.jpg
"""

import pathlib
import sys

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
#: Of the picture, in pixels; and how much of the scene its width shows.
WIDTH, HEIGHT, SHOWN = 1000, 500, 5.4
SAMPLES = 24
PALE, BLUE, INK = (0.9, 0.88, 0.84, 1), (0.1, 0.28, 0.5, 1), (0.02, 0.02, 0.03, 1)


def monkey():
    """The monkey, unwrapped."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sys.path.insert(0, str(HERE))
    import abf_flatten_unwrap

    abf_flatten_unwrap.register()
    bpy.ops.mesh.primitive_monkey_add(size=2.2, location=(-1.4, 0, 0), rotation=(0, 0, -0.35))
    assert bpy.ops.uv.abf_unwrap(margin=8) == {"FINISHED"}
    bpy.ops.object.shade_smooth()
    return bpy.context.object


def layout(mesh):
    """The UVs of a mesh as a flat mesh of its own, with the same UVs."""
    uv = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uv)
    uv = uv.reshape(-1, 2)
    # A little nearer to the eye than what stands behind.
    places = np.stack([0.15 + 2.4 * uv[:, 0], np.full(len(uv), -0.01), -1.2 + 2.4 * uv[:, 1]], -1)
    flat = bpy.data.meshes.new("layout")
    flat.from_pydata(places.tolist(), [], [list(polygon.loop_indices) for polygon in mesh.polygons])
    layer = flat.uv_layers.new(name="UVMap")
    of_loop = np.empty(len(flat.loops), np.int32)
    flat.loops.foreach_get("vertex_index", of_loop)
    layer.uv.foreach_set("vector", uv[of_loop].ravel())
    return flat


def checkered():
    """A material with a checkerboard on the UVs."""
    material = bpy.data.materials.new("checkered")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    board, place = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeUVMap")
    board.inputs["Color1"].default_value, board.inputs["Color2"].default_value = PALE, BLUE
    board.inputs["Scale"].default_value = 48
    links.new(place.outputs["UV"], board.inputs["Vector"])
    links.new(board.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.8
    return material


def plain(name, colour):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = colour
    return material


def shown(name, mesh, material):
    known = bpy.data.objects.new(name, mesh)
    known.data.materials.append(material)
    bpy.context.collection.objects.link(known)
    return known


def lit():
    """A sun, and a sky of one colour."""
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 1.6, (0.9, 0.25, 0.5)
    bpy.context.collection.objects.link(sun)
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.45
    bpy.context.scene.world = world


def seen(path):
    """Renders the scene from the front."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", SHOWN
    camera.location, camera.rotation_euler = (0, -10, 0), (np.pi / 2, 0, 0)
    bpy.context.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.seed = "CYCLES", SAMPLES, 0
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "JPEG"
    scene.render.image_settings.quality = 85
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main():
    path = pathlib.Path(sys.argv[1]).resolve()
    head, board = monkey(), checkered()
    head.data.materials.append(board)
    flat = layout(head.data)
    shown("layout", flat, board)
    lines = shown("lines", flat.copy(), plain("ink", INK))
    lines.data.materials.clear()
    lines.data.materials.append(plain("ink", INK))
    lines.modifiers.new("lines", "WIREFRAME").thickness = 0.006
    lit()
    seen(path)
    print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
