"""The add-on in a Blender without a window: `pip install bpy`, and the wheel of abf_flatten.

    python test_addon.py EXTENSION.zip

With a zip it is installed as Blender installs extensions, wheel and all; without one it is imported from its folder.
"""

import pathlib
import sys

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


def install():
    if len(sys.argv) > 1:
        package = pathlib.Path(sys.argv[1]).resolve()
        bpy.ops.extensions.package_install_files(filepath=str(package), repo="user_default", enable_on_install=True)
        assert "bl_ext.user_default.abf_flatten_unwrap" in bpy.context.preferences.addons, "the extension is not enabled"
    else:
        sys.path.insert(0, str(HERE.parent))
        import abf_flatten_unwrap

        abf_flatten_unwrap.register()


def fresh(primitive, **options):
    """A new mesh alone in the scene, selected, in object mode."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    getattr(bpy.ops.mesh, f"primitive_{primitive}_add")(**options)
    return bpy.context.object.data


def uvs(mesh):
    values = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", values)
    return values.reshape(-1, 2)


def corners(mesh):
    """The vertices and the UVs of all triangles."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    vertices, loops, positions = np.empty(3 * count, np.int32), np.empty(3 * count, np.int32), np.empty(3 * len(mesh.vertices))
    mesh.loop_triangles.foreach_get("vertices", vertices)
    mesh.loop_triangles.foreach_get("loops", loops)
    mesh.vertices.foreach_get("co", positions)
    return positions.reshape(-1, 3), vertices.reshape(-1, 3), loops.reshape(-1, 3)


def certificate(mesh):
    """What is proved of the UVs as Blender has them now, corner by corner."""
    return certificate_of(mesh, np.ones(len(mesh.polygons), bool))


def certificate_of(mesh, chosen):
    """The same for some polygons."""
    import abf_flatten

    positions, vertices, loops = corners(mesh)
    of_polygon = np.array([triangle.polygon_index for triangle in mesh.loop_triangles])
    rows = chosen[of_polygon]
    return abf_flatten.certify(positions, vertices[rows], uvs(mesh), loops[rows], precision="single")


def edit(mesh, chosen):
    """Edit mode with these polygons selected."""
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="FACE")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh.polygons.foreach_set("select", np.asarray(chosen, bool))
    bpy.ops.object.mode_set(mode="EDIT")


def charts(mesh):
    """How many pieces the UVs are, where corners of one vertex in one place are joined."""
    _, vertices, loops = corners(mesh)
    uv = uvs(mesh)
    parent = list(range(len(vertices)))

    def root(k):
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    known = {}
    for face, (of_face, at) in enumerate(zip(vertices, loops)):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            ends = sorted((int(of_face[k]), *map(float, uv[at[k]])) for k in (a, b))
            parent[root(face)] = root(known.setdefault(tuple(ends), face))
    return len({root(face) for face in range(len(vertices))})


def test_primitives_are_unwrapped_and_proved():
    for primitive in ("cube", "torus", "monkey", "uv_sphere", "cylinder", "grid"):
        mesh = fresh(primitive)
        assert bpy.ops.uv.abf_unwrap() == {"FINISHED"}, primitive
        known, uv = certificate(mesh), uvs(mesh)
        assert known.injective, (primitive, known)
        assert uv.min() >= 0 and uv.max() <= 1
        print(f"  {primitive}: {len(mesh.polygons)} polygons, {charts(mesh)} charts")


def test_a_cube_and_a_torus_without_seams_are_one_chart_each():
    for primitive in ("cube", "torus"):
        mesh = fresh(primitive)
        bpy.ops.uv.abf_unwrap()
        assert charts(mesh) == 1, primitive


def test_charts_are_relaxed_on_request():
    import abf_flatten

    mesh = fresh("torus")
    stretches = []
    for energy in ("none", "isometric"):
        assert bpy.ops.uv.abf_unwrap(energy=energy) == {"FINISHED"}
        positions, vertices, loops = corners(mesh)
        stretches.append(abf_flatten.metrics(positions, vertices, uvs(mesh), loops).stretch_l2)
        assert certificate(mesh).injective, energy
    assert stretches[1] < stretches[0], stretches


def test_a_road_that_climbs_around_an_axis_is_cut_or_deformed():
    # It lies over itself when it is flattened.
    turns, steps = 1.3, 60
    angles = 2 * np.pi * turns * np.arange(steps + 1) / steps
    vertices = [(r * np.cos(a), r * np.sin(a), 0.3 * a) for a in angles for r in (4, 4.5, 5)]
    quads = [(k, k + 1, k + 4, k + 3) for i in range(steps) for k in (3 * i, 3 * i + 1)]
    mesh = fresh("cube")
    mesh.clear_geometry()
    mesh.from_pydata(vertices, [], quads)
    mesh.update()
    counts = []
    for injective in ("split", "deform"):
        assert bpy.ops.uv.abf_unwrap(injective=injective) == {"FINISHED"}
        assert certificate(mesh).injective, injective
        counts.append(charts(mesh))
    assert counts[1] == 1 < counts[0], counts


def test_marked_seams_are_kept_or_not_as_asked():
    mesh = fresh("cylinder", vertices=16)
    # The rims of both caps.
    caps = {p.index for p in mesh.polygons if len(p.vertices) > 4}
    rims = {tuple(sorted(key)) for p in mesh.polygons if p.index in caps for key in p.edge_keys}
    for known in mesh.edges:
        known.use_seam = tuple(sorted(known.vertices)) in rims
    bpy.ops.uv.abf_unwrap(use_seams=True)
    assert charts(mesh) == 3 and certificate(mesh).injective
    before = uvs(mesh)
    bpy.ops.uv.abf_unwrap(use_seams=False)
    assert not np.array_equal(uvs(mesh), before)


def test_new_seams_are_marked_on_request():
    mesh = fresh("cube")
    bpy.ops.uv.abf_unwrap(mark_seams=False)
    assert not any(known.use_seam for known in mesh.edges)
    bpy.ops.uv.abf_unwrap(mark_seams=True)
    marked = sum(known.use_seam for known in mesh.edges)
    # A net of a cube hangs together by 5 of its 12 edges.
    assert marked == 7, marked
    before = uvs(mesh)
    bpy.ops.uv.abf_unwrap(use_seams=True)
    assert charts(mesh) == 1 and np.allclose(np.sort(uvs(mesh), 0), np.sort(before, 0), atol=1e-3)


def test_no_seam_crosses_a_face_of_half_a_monkey():
    unwrap = next(module for name, module in sys.modules.items() if name.endswith("abf_flatten_unwrap.unwrap"))
    mesh = fresh("monkey")
    half = np.array([p.center.x > 0 for p in mesh.polygons])
    for polygon, chosen in zip(mesh.polygons, half):
        polygon.select = bool(chosen)
    report = unwrap.unwrap_mesh(mesh, unwrap.Settings(), selected_only=True)
    assert report.injective and certificate_of(mesh, half).injective, report
    assert "seams cross" not in report.text, report


def test_only_selected_faces_are_touched_in_edit_mode():
    mesh = fresh("torus")
    before = uvs(mesh)
    chosen = np.array([p.center.x > 0 for p in mesh.polygons])
    edit(mesh, chosen)
    assert bpy.ops.uv.abf_unwrap() == {"FINISHED"}
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    of_loop = np.repeat(chosen, [p.loop_total for p in mesh.polygons])
    assert np.array_equal(uvs(mesh)[~of_loop], before[~of_loop])
    assert not np.array_equal(uvs(mesh)[of_loop], before[of_loop])
    assert np.array_equal([p.select for p in mesh.polygons], chosen), "the selection has changed"
    assert certificate_of(mesh, chosen).injective
    edit(mesh, chosen & False)
    assert bpy.ops.uv.abf_unwrap() == {"CANCELLED"}


def test_pinned_uvs_stay_where_they_are():
    mesh = fresh("torus")
    before = uvs(mesh)
    layer, pinned = mesh.uv_layers.active, [p for p in mesh.polygons if p.index % 7 == 0]
    for polygon in pinned:
        layer.data[polygon.loop_start].pin_uv = True
    bpy.ops.uv.abf_unwrap()
    stay = np.concatenate([np.arange(p.loop_start, p.loop_start + p.loop_total) for p in pinned])
    assert np.array_equal(uvs(mesh)[stay], before[stay])
    assert not np.array_equal(uvs(mesh), before)
    assert sum(value.value for value in layer.pin) == len(pinned)


def test_the_scale_of_the_object_counts():
    mesh = fresh("grid", x_subdivisions=4, y_subdivisions=4)
    bpy.context.object.scale = (3, 1, 1)
    bpy.context.view_layer.update()
    bpy.ops.uv.abf_unwrap()
    uv, polygon = uvs(mesh), mesh.polygons[0]
    sides = [np.linalg.norm(uv[polygon.loop_start] - uv[polygon.loop_start + k]) for k in (1, 3)]
    assert abs(max(sides) / min(sides) - 3) < 0.01, sides


def test_two_objects_with_one_mesh_and_one_without_uvs():
    mesh = fresh("torus")
    first = bpy.context.object
    twin = bpy.data.objects.new("twin", mesh)
    bpy.context.collection.objects.link(twin)
    twin.select_set(True)
    first.select_set(True)
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    assert bpy.ops.uv.abf_unwrap() == {"FINISHED"}
    assert len(mesh.uv_layers) == 1 and certificate(mesh).injective


def test_a_mesh_without_faces_is_left_alone():
    mesh = fresh("circle")
    assert len(mesh.polygons) == 0
    assert bpy.ops.uv.abf_unwrap() == {"CANCELLED"}


def test_it_can_be_undone():
    mesh = fresh("torus")
    name, before = bpy.context.object.name, uvs(mesh)
    windows = bpy.context.window_manager.windows
    if not windows:
        print("  there is no window here, and without one Blender undoes nothing")
        return
    with bpy.context.temp_override(window=windows[0]):
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.uv.abf_unwrap(mark_seams=True)
        bpy.ops.ed.undo_push(message="after")
        assert not np.array_equal(uvs(mesh), before) and any(known.use_seam for known in mesh.edges)
        bpy.ops.ed.undo()
        mesh = bpy.data.objects[name].data
        assert np.array_equal(uvs(mesh), before), "the UVs are not undone"
        assert not any(known.use_seam for known in mesh.edges), "the seams are not undone"


def main():
    install()
    tests = {name: test for name, test in globals().items() if name.startswith("test_")}
    for name, test in tests.items():
        print(name, flush=True)
        test()
    print(f"{len(tests)} tests passed in Blender {bpy.app.version_string}")


if __name__ == "__main__":
    main()
