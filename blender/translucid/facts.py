# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material's subsurface nodes say, in the words of physics: for the panel and the presets."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import translucid

from .export.material import interface_index
from .export.subsurface import TRANSPORTS, mean_free_path
from .export.value import Value

# Radii in mean free paths at which a profile is compared with the exact one.
_RADII = np.geomspace(1e-2, 30.0, 60)


@dataclass
class Facts:
    """Surface albedo and mean free path of the channels, None where they are textured."""

    node: object
    method: str
    surface_albedo: object
    mean_free_path_mm: object

    @property
    def model(self):
        return TRANSPORTS[self.method][0]


def facts_of(material, unit_scale):
    """What the first node says that lets light travel below the surface, or None."""
    tree = material.node_tree if material is not None else None
    for node in tree.nodes if tree is not None else ():
        names = _NAMES.get(node.type)
        if names is None or node.type == "BSDF_PRINCIPLED" and not _scatters(node):
            continue
        method = node.falloff if node.type == "SUBSURFACE_SCATTERING" else node.subsurface_method
        color, radius, scale = (node.inputs[name] for name in names)
        albedo = None if color.is_linked else np.array(color.default_value[:3])
        path = None
        if albedo is not None and not radius.is_linked and not scale.is_linked:
            length = np.array(radius.default_value[:]) * scale.default_value
            values = Value.of(np.clip(albedo, 0, 1)), Value.of(length)
            path = mean_free_path(method, *values, _index(node, method)).constant * unit_scale * 1000
        return Facts(node, method, albedo, path)
    return None


_NAMES = {
    "BSDF_PRINCIPLED": ("Base Color", "Subsurface Radius", "Subsurface Scale"),
    "SUBSURFACE_SCATTERING": ("Color", "Radius", "Scale"),
}


def _scatters(node):
    weight = node.inputs.get("Subsurface Weight")
    return weight is not None and (weight.is_linked or weight.default_value > 0)


def _index(node, method):
    if node.type == "SUBSURFACE_SCATTERING":
        return node.inputs["IOR"].default_value
    if method == "RANDOM_WALK_SKIN":
        return node.inputs["Subsurface IOR"].default_value
    return interface_index(node.inputs["IOR"].default_value, node.inputs["Specular IOR Level"].default_value)


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
