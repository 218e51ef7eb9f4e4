"""Unwrap (ABF): UVs of the selected faces by angle-based flattening, with a certificate."""

import bpy

from .operator import UV_OT_abf_unwrap, VIEW3D_PT_abf_unwrap, draw_menu

_CLASSES = (UV_OT_abf_unwrap, VIEW3D_PT_abf_unwrap)


def register():
    for known in _CLASSES:
        bpy.utils.register_class(known)
    bpy.types.VIEW3D_MT_uv_map.append(draw_menu)


def unregister():
    bpy.types.VIEW3D_MT_uv_map.remove(draw_menu)
    for known in reversed(_CLASSES):
        bpy.utils.unregister_class(known)
