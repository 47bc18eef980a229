# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured materials for Principled BSDF."""

import bpy
import numpy as np
import translucid

# Blender forgets what a callback returns, unless Python keeps it.
_ITEMS = [(name, name, translucid.presets[name].source) for name in translucid.presets]


class TRANSLUCID_OT_preset(bpy.types.Operator):
    """Give the material's Principled BSDF the color and the lengths of a measured material"""

    bl_idname = "translucid.preset"
    bl_label = "Subsurface Preset"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "name"

    name: bpy.props.EnumProperty(name="Preset", items=_ITEMS)

    @classmethod
    def poll(cls, context):
        return _principled(getattr(context, "material", None) or _active_material(context)) is not None

    def invoke(self, context, event):
        context.window_manager.invoke_search_popup(self)
        return {"FINISHED"}

    def execute(self, context):
        node = _principled(getattr(context, "material", None) or _active_material(context))
        apply_preset(node, translucid.presets[self.name], context.scene.unit_settings.scale_length)
        return {"FINISHED"}


def apply_preset(node, preset, unit_scale):
    """Sets the sockets of a Principled BSDF; lengths are of the scene."""
    walk = "cycles-walk" if bpy.app.version >= (5, 2) else "cycles-walk-legacy"
    converted = translucid.convert("translucid", surface_albedo=preset.surface_albedo, mfp=preset.mfp, unit="mm", to=walk)[walk]
    radius = np.broadcast_to(converted["subsurface_radius"], 3)
    node.subsurface_method = "RANDOM_WALK"
    values = {
        "Base Color": (*preset.surface_albedo, 1.0),
        "Subsurface Weight": 1.0,
        "Subsurface Radius": tuple(float(x) for x in radius),
        # Blender's units are meters times the scene's scale.
        "Subsurface Scale": float(converted["subsurface_scale"]) / 1000 / unit_scale,
        "Subsurface Anisotropy": 0.0,
        "Roughness": preset.roughness,
        "IOR": preset.eta,
        "Coat Weight": preset.coat,
        "Coat Roughness": preset.coat_roughness,
    }
    for name, value in values.items():
        node.inputs[name].default_value = value


def _active_material(context):
    return context.object.active_material if getattr(context, "object", None) else None


def _principled(material):
    tree = material.node_tree if material is not None else None
    return next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None) if tree else None


def register():
    bpy.utils.register_class(TRANSLUCID_OT_preset)


def unregister():
    bpy.utils.unregister_class(TRANSLUCID_OT_preset)
