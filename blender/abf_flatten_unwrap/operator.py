"""The operator, its panel and its entry in the UV menu."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from .unwrap import Refused, Settings, unwrap_mesh

_METHODS = [
    ("auto", "Auto", "One method after the other, up to the first result that is proved valid"),
    ("linabf", "Linear ABF", "Linear angle-based flattening: fast"),
    ("abf++", "ABF++", "Angle-based flattening as published in 2005"),
    ("barrier", "Interior Point", "Never leaves the angles that triangles have"),
    ("descent", "Descent", "Moves the vertices, and never turns a triangle over"),
    ("lscm", "LSCM", "Least squares conformal maps"),
]
_EFFORTS = [
    ("fast", "Fast", "Milliseconds"),
    ("good", "Good", "About a second"),
    ("best", "Best", "Several seconds"),
]
_ENERGIES = [
    ("none", "As Solved", "Nothing is moved after the method"),
    ("usable", "Usable", "Angles first, and areas within bounds"),
    ("isometric", "Lengths", "Lengths are kept: for fabric, and for textures whose size counts"),
    ("abf", "Angles", "The errors of angles alone"),
]
_OVERLAPS = [
    ("split", "Cut", "A chart that lies over itself is cut in two"),
    ("deform", "Deform", "A chart that lies over itself is deformed until it does not: fewer charts, and it takes longer"),
]


class UV_OT_abf_unwrap(bpy.types.Operator):
    """Unwrap the selected faces by angle-based flattening; in object mode all faces of the selected meshes"""

    bl_idname = "uv.abf_unwrap"
    bl_label = "Unwrap (ABF)"
    bl_options = {"REGISTER", "UNDO"}

    method: EnumProperty(name="Method", items=_METHODS, default="auto")
    energy: EnumProperty(
        name="Relax", description="What is to be little in each chart, after the method", items=_ENERGIES, default="none"
    )
    injective: EnumProperty(
        name="Overlaps", description="What becomes of a chart that lies over itself", items=_OVERLAPS, default="split"
    )
    use_seams: BoolProperty(
        name="Keep Marked Seams",
        description="Charts end at the marked seams; what these leave is cut further only where it has to be",
        default=True,
    )
    mark_seams: BoolProperty(name="Mark New Seams", description="Mark the edges where charts end", default=False)
    max_stretch: FloatProperty(
        name="Max Stretch", description="Charts are cut until they stretch at most so much", default=1.15, min=1.0, soft_max=3.0
    )
    resolution: IntProperty(
        name="Texture Size", description="Texels along a side of the texture, for the margin", default=1024, min=16, max=65536
    )
    margin: IntProperty(name="Margin", description="Texels between charts", default=2, min=0, soft_max=64)
    pack: EnumProperty(name="Packing", items=_EFFORTS, default="good")

    @classmethod
    def poll(cls, context):
        return any(known.type == "MESH" for known in _objects(context))

    def execute(self, context):
        settings = Settings(
            solver=self.method,
            energy=None if self.energy == "none" else self.energy,
            injective=self.injective,
            use_seams=self.use_seams,
            mark_seams=self.mark_seams,
            max_stretch=self.max_stretch,
            resolution=self.resolution,
            margin=min(self.margin, self.resolution // 4),
            pack=self.pack,
        )
        is_editing = context.mode == "EDIT_MESH"
        meshes = [known for known in _objects(context) if known.type == "MESH"]
        if is_editing:
            # The mesh of edit mode is elsewhere: it is written back, and read again.
            bpy.ops.object.mode_set(mode="OBJECT")
        try:
            done = [self._unwrap(known, settings, is_editing) for known in meshes]
        finally:
            if is_editing:
                bpy.ops.object.mode_set(mode="EDIT")
        return {"FINISHED"} if any(done) else {"CANCELLED"}

    def _unwrap(self, known, settings, is_editing):
        """Whether the mesh of an object was changed. What became of it is reported."""
        try:
            report = unwrap_mesh(known.data, settings, selected_only=is_editing, scale=known.matrix_world.to_scale())
        except Refused as error:
            # An ERROR would be an exception in scripts, and would undo what was done to other objects.
            self.report({"WARNING"}, f"{known.name}: {error}")
            return False
        if report is not None:
            self.report({"INFO"} if report.injective else {"WARNING"}, f"{known.name}: {report.text}")
        return report is not None

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        names = ("method", "energy", "injective", "use_seams", "mark_seams", "max_stretch", "resolution", "margin", "pack")
        for name in names:
            layout.prop(self, name)


class VIEW3D_PT_abf_unwrap(bpy.types.Panel):
    """A button in the sidebar"""

    bl_label = "Unwrap (ABF)"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "UV"

    @classmethod
    def poll(cls, context):
        return UV_OT_abf_unwrap.poll(context)

    def draw(self, context):
        self.layout.operator(UV_OT_abf_unwrap.bl_idname)
        what = "the selected faces" if context.mode == "EDIT_MESH" else "all faces"
        self.layout.label(text=f"Takes {what}")


def draw_menu(self, _context):
    self.layout.separator()
    self.layout.operator(UV_OT_abf_unwrap.bl_idname)


def _objects(context):
    if context.mode == "EDIT_MESH":
        return list(context.objects_in_mode_unique_data)
    if context.mode != "OBJECT":
        return []
    # Two objects with one mesh would unwrap it twice.
    return list({known.data: known for known in context.selected_editable_objects}.values())
