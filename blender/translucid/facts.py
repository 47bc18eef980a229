# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material's subsurface nodes say, in the words of physics: for the panel and the presets."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import translucid

from .export.material import interface_index

# Radii in mean free paths at which a profile is compared with the exact one.
_RADII = np.geomspace(1e-2, 30.0, 60)


@dataclass
class Facts:
    """Surface albedo and mean free path of the channels, None where they are textured."""

    node: object
    model: str
    surface_albedo: object
    mean_free_path_mm: object


def facts_of(material, unit_scale):
    """What the first node says that lets light travel below the surface, or None."""
    tree = material.node_tree if material is not None else None
    for node in tree.nodes if tree is not None else ():
        names = _NAMES.get(node.type)
        if names is None or node.type == "BSDF_PRINCIPLED" and not _scatters(node):
            continue
        method = node.falloff if node.type == "SUBSURFACE_SCATTERING" else node.subsurface_method
        sockets = [node.inputs[name] for name in names]
        color, radius, scale = (np.array(socket.default_value) for socket in sockets)
        keys = translucid.cycles_material(
            method, base_color=color[:3], radius=np.maximum(radius * scale, 0), ior=_index(node, method)
        )
        path = keys["subsurface_radius"] * np.array(keys["subsurface_radius_scale"]) * unit_scale * 1000
        is_textured = sockets[0].is_linked, any(socket.is_linked for socket in sockets)
        albedo = None if is_textured[0] else np.clip(color[:3], 0, 1)
        return Facts(node, keys["subsurface_model"], albedo, None if is_textured[1] else path)
    return None


_NAMES = {
    "BSDF_PRINCIPLED": ("Base Color", "Subsurface Radius", "Subsurface Scale"),
    "SUBSURFACE_SCATTERING": ("Color", "Radius", "Scale"),
}


def _scatters(node):
    weight, wall = (node.inputs.get(name) for name in ("Subsurface Weight", "Thin Wall"))
    if wall is not None and wall.default_value:
        return False
    return weight is not None and (weight.is_linked or weight.default_value > 0)


def _index(node, method):
    # Blender hides sockets that a method does not ask for.
    number = lambda name, default: node.inputs[name].default_value if name in node.inputs else default
    if node.type == "SUBSURFACE_SCATTERING":
        return number("IOR", 1.4)
    if method == "RANDOM_WALK_SKIN":
        return number("Subsurface IOR", 1.4)
    return interface_index(number("IOR", 1.5), number("Specular IOR Level", 0.5))


@lru_cache(maxsize=1024)
def profile_error(model, hundredths):
    """The distance of a model's profile from the exact one of an albedo in hundredths, as a share of its light.

    ∫ |R − R_exact| 2πr dr / A for diffuse light, index-matched and isotropic; None of what is not a profile.
    """
    if model not in translucid.models:
        return None
    albedo = min(max(hundredths / 100, 0.01), 0.99)
    exact, _ = translucid.reference.exact(_RADII, surface_albedo=albedo, mfp=1.0, configuration="diffuse")
    ours = translucid.Profile(model, surface_albedo=albedo, mfp=1.0).eval(_RADII)
    rings = np.abs(ours - exact) * 2 * np.pi * _RADII**2
    return float(np.sum((rings[1:] + rings[:-1]) / 2 * np.diff(np.log(_RADII))) / albedo)
