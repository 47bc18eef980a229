# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' subsurface settings as the transport that looks the same."""

import numpy as np
import translucid

from .value import Value, combine


def transport_keys(method, color, radius, scale, ior, anisotropy, alpha):
    """The material keys of a node's subsurface scattering, as values; as `translucid.cycles_material` has them.

    `specular_roughness` among them, where the model has it, is that of the facets through which the view enters.
    """
    both = combine(_color_and_length, color, radius, scale)
    pixels = both.linear if both.placement is not None else both.linear[0, 0]
    keys = translucid.cycles_material(
        method, base_color=pixels[..., :3], radius=pixels[..., 3:], ior=ior, anisotropy=anisotropy, alpha=alpha
    )
    values = {key: _value(value, both.placement) for key, value in keys.items()}
    if color.attribute is not None:
        values["subsurface_color"] = color
    return values


def _color_and_length(color, radius, scale):
    length = np.maximum(radius * scale, 0)
    return np.concatenate(np.broadcast_arrays(np.clip(color, 0, 1), length), axis=-1)


def _value(value, placement):
    if isinstance(value, str):
        return value
    if isinstance(value, np.ndarray) and value.ndim == 3:
        return Value(value, placement)
    return Value.of(value)
