# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the properties editor."""

import bpy

from . import engine
from .facts import facts_of, profile_error

# Panels of Blender's own engines that say nothing to this one.
_NOT_OURS = {
    "DATA_PT_area",
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_shadow",
    "DATA_PT_spot",
    "DATA_PT_sunsky",
    "RENDER_PT_freestyle",
    "RENDER_PT_simplify",
    "SCENE_PT_audio",
    "VIEWLAYER_PT_filter",
    "VIEWLAYER_PT_layer_passes",
}

# Panels of EEVEE on what all engines have: nodes, lamps, depth of field.
_SHARED = {
    "DATA_PT_EEVEE_light",
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
}


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {"TRANSLUCID"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def column(self, context):
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column(), context.scene.translucid


class TRANSLUCID_PT_sampling(_Panel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context):
        column, settings = self.column(context)
        for name in ("device", "samples", "preview_samples", "time_limit", "use_denoising"):
            column.prop(settings, name)
        row = column.row(align=True)
        row.prop(settings, "seed")
        row.prop(settings, "use_animated_seed", text="", icon="TIME")


class TRANSLUCID_PT_subsurface(_Panel, bpy.types.Panel):
    bl_label = "Subsurface"

    def draw(self, context):
        column, settings = self.column(context)
        for name in ("model", "method", "use_sharing"):
            column.prop(settings, name)


class TRANSLUCID_PT_paths(_Panel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, settings = self.column(context)
        column.prop(settings, "max_bounces")
        column.prop(settings, "use_caustics")


class TRANSLUCID_PT_compare(_Panel, bpy.types.Panel):
    bl_label = "Compare"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, settings = self.column(context)
        column.prop(settings, "compare_model")
        column.prop(settings, "compare_samples")
        column.operator("translucid.compare")


class TRANSLUCID_PT_film(_Panel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, _ = self.column(context)
        column.prop(context.scene.render, "filter_size")
        column.prop(context.scene.render, "film_transparent", text="Transparent")


class TRANSLUCID_PT_threads(_Panel, bpy.types.Panel):
    bl_label = "Threads"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, _ = self.column(context)
        render = context.scene.render
        column.prop(render, "threads_mode")
        inner = column.column()
        inner.enabled = render.threads_mode == "FIXED"
        inner.prop(render, "threads")


class TRANSLUCID_PT_report(_Panel, bpy.types.Panel):
    bl_label = "Not Rendered as It Is"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        messages = engine.last_messages
        for message in messages[:40]:
            self.layout.label(text=message)
        if not messages:
            self.layout.label(text="Nothing of the last rendering")


class TRANSLUCID_PT_passes(_Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        column, _ = self.column(context)
        layer = context.view_layer
        column.prop(layer, "use_pass_z")
        column.prop(layer, "use_pass_normal")
        for name in ("use_diffuse", "use_glossy", "use_subsurface", "use_emission", "use_albedo"):
            column.prop(layer.translucid, name)
        column = self.layout.column(heading="Cryptomatte")
        for what in ("object", "material", "asset"):
            column.prop(layer, f"use_pass_cryptomatte_{what}", text=what.title())
        column.prop(layer, "pass_cryptomatte_depth", text="Levels")


class TRANSLUCID_PT_material(_Panel, bpy.types.Panel):
    bl_label = "Subsurface Scattering"
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.material is not None

    def draw(self, context):
        layout = self.layout
        layout.operator_menu_enum("translucid.preset", "name", text="Preset")
        facts = facts_of(context.material, context.scene.unit_settings.scale_length)
        if facts is None:
            layout.label(text="No light travels below this surface")
            return
        chosen = context.scene.translucid.model
        model = facts.model if chosen == "NODE" else chosen
        layout.label(text=f"{facts.node.name}: {model}")
        grid = layout.grid_flow(row_major=True, columns=4, even_columns=True)
        for text in ("", "Red", "Green", "Blue"):
            grid.label(text=text)
        _row(grid, "A", facts.surface_albedo, "{:.3f}")
        _row(grid, "ℓ, mm", facts.mean_free_path_mm, "{:.3g}")
        if facts.surface_albedo is not None:
            errors = [profile_error(model, round(100 * float(a))) for a in facts.surface_albedo]
            if errors[0] is not None:
                _row(grid, "Error, %", [100 * error for error in errors], "{:.1f}")
            elif model == "random-walk":
                layout.label(text="The walk is the truth of A and the mean free path")


def _row(grid, title, numbers, form):
    grid.label(text=title)
    for i in range(3):
        grid.label(text="textured" if numbers is None else form.format(float(numbers[i])))


_CLASSES = (
    TRANSLUCID_PT_sampling,
    TRANSLUCID_PT_subsurface,
    TRANSLUCID_PT_paths,
    TRANSLUCID_PT_film,
    TRANSLUCID_PT_threads,
    TRANSLUCID_PT_compare,
    TRANSLUCID_PT_report,
    TRANSLUCID_PT_passes,
    TRANSLUCID_PT_material,
)


def _panels_of_blender():
    for name in dir(bpy.types):
        panel = getattr(bpy.types, name)
        # A set that is inherited is that of other panels, too.
        engines = getattr(panel, "__dict__", {}).get("COMPAT_ENGINES")
        if engines is None or panel in _CLASSES:
            continue
        if name in _SHARED or ("BLENDER_RENDER" in engines and name not in _NOT_OURS):
            yield panel


def register():
    for panel in _CLASSES:
        bpy.utils.register_class(panel)
    for panel in _panels_of_blender():
        panel.COMPAT_ENGINES.add("TRANSLUCID")


def unregister():
    for panel in _panels_of_blender():
        panel.COMPAT_ENGINES.discard("TRANSLUCID")
    for panel in reversed(_CLASSES):
        bpy.utils.unregister_class(panel)
