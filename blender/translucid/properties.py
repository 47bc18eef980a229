# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a scene: `scene.translucid`."""

import bpy
import translucid

_WALKS = ("random-walk", "random-walk-diffuse", "random-walk-rough")

# Blender forgets what a callback returns, unless Python keeps it.
_MODELS = [
    ("NODE", "As the nodes say", "The transport that looks like the node's method in Cycles"),
    *((name, name, "Random walk: the truth of a body" if name == "random-walk" else "Random walk") for name in _WALKS),
    *((name, name, "Reflectance profile") for name in translucid.models if name not in {*_WALKS, "none"}),
    ("none", "none", "No light below the surfaces"),
]


def _changed(settings, context):
    """Tells Blender what it sees of itself in its own panels only: the rendered view follows scripts, too."""
    settings.id_data.update_tag()


class TranslucidSceneSettings(bpy.types.PropertyGroup):
    samples: bpy.props.IntProperty(
        name="Samples", description="Samples per pixel of a rendering", default=128, min=1, max=1 << 24
    )
    preview_samples: bpy.props.IntProperty(
        name="Viewport Samples", description="Samples per pixel of the viewport", default=64, min=1, max=1 << 24, update=_changed
    )
    time_limit: bpy.props.FloatProperty(
        name="Time Limit", description="Maximum time to render a picture; 0 is no limit", default=0.0, min=0.0, unit="TIME_ABSOLUTE"
    )
    seed: bpy.props.IntProperty(name="Seed", description="Seed of the random numbers", default=0, min=0, update=_changed)
    use_animated_seed: bpy.props.BoolProperty(
        name="Animate Seed", description="Different noise in each frame", default=True, update=_changed
    )
    model: bpy.props.EnumProperty(
        name="Model", description="Transport of light below surfaces", items=_MODELS, default="NODE", update=_changed
    )
    method: bpy.props.EnumProperty(
        name="Method",
        description="Method to find entry points of light; walks are always traced",
        items=[
            ("ray-traced", "Ray-Traced", "Every path looks for the place where its light entered"),
            ("point-based", "Point-Based", "The light that enters is computed at points beforehand and summed; the rendered view is ray-traced all the same"),
        ],
        default="ray-traced",
        update=_changed,
    )
    use_sharing: bpy.props.BoolProperty(
        name="Share between Pixels", description="Pixels share light below the surface, which reduces noise; not in denoised pictures, which are better and faster without", default=True, update=_changed
    )
    max_bounces: bpy.props.IntProperty(name="Bounces", description="Maximum number of scattering events on a path after the first", default=12, min=0, max=1023, update=_changed)
    use_caustics: bpy.props.BoolProperty(
        name="Caustics", description="Light that glossy surfaces throw onto matte ones; noisy", default=False, update=_changed
    )
    device: bpy.props.EnumProperty(
        name="Device",
        description="Who traces the paths; both find the same light",
        items=[
            ("cpu", "Processor", "All cores, or as many as Threads says"),
            ("auto", "Graphics Processor", "The best one that is there; where it lacks what the scene needs, the processor traces, and a line says so"),
        ],
        default="cpu",
        update=_changed,
    )
    use_denoising: bpy.props.BoolProperty(
        name="Denoise", description="By Open Image Denoise, if Blender's library is found", default=False
    )
    compare_model: bpy.props.EnumProperty(
        name="Beside", description="Model that Compare renders beside the scene's", items=_MODELS, default="random-walk"
    )
    compare_samples: bpy.props.IntProperty(name="Samples", description="Samples of each picture of Compare", default=64, min=1, max=1 << 16)


def register():
    bpy.utils.register_class(TranslucidSceneSettings)
    bpy.types.Scene.translucid = bpy.props.PointerProperty(type=TranslucidSceneSettings)


def unregister():
    del bpy.types.Scene.translucid
    bpy.utils.unregister_class(TranslucidSceneSettings)
