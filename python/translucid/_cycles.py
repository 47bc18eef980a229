"""Materials of Blender Cycles."""

from __future__ import annotations

import math
import sys

import numpy as np

from . import _translucid

def cycles_material(
    method: str,
    *,
    base_color,
    radius,
    scale: float = 1.0,
    ior: float = 1.4,
    anisotropy: float = 0.0,
    alpha: float = 1.0,
    version: tuple[int, ...] | None = None,
) -> dict:
    """Return the keys of a material whose subsurface looks like that of Blender Cycles.

    Parameters
    ----------
    method : {"BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN", "RANDOM_WALK_LEGACY"}
        The method of a Subsurface Scattering node or a Principled BSDF, as this `version` of Blender names it.
    base_color : float or array_like of shape (..., 3)
        Linear color, clamped to [0, 1]; an image of shape (H, W, 3) gives images.
    radius : float or array_like of shape (..., 3)
        Radius socket, at least 0; an image of shape (H, W, 3) gives images. A channel of 0 is Lambertian.
    scale : float, default 1
        Scale socket; times factors between the units of the two scenes.
    ior : float, default 1.4
        Index that the view is refracted by. Subsurface Scattering node: its IOR. Principled BSDF: its Subsurface IOR for
        RANDOM_WALK_SKIN; for the other walks its IOR, adjusted by the Specular IOR Level as Cycles does, 1.01 at level 0.
    anisotropy : float, default 0
        Anisotropy socket, clamped to [-0.9, 0.9], and to [0, 0.9] before Blender 5.2.
    alpha : float, default 1
        Width of the facets that refract the view in walks other than RANDOM_WALK_SKIN: the square of the Principled BSDF's Roughness, the
        Roughness of a Subsurface Scattering node as it is.
    version : tuple of int, optional
        Version of Blender that the node is of, from (3, 0) on: RANDOM_WALK is another method before (5, 2), and yet another
        before (4, 0). By default that of the Blender that runs this, and (5, 2) outside.

    Returns
    -------
    dict
        For `Scene.add_material` and `Session.edit_material`: ``subsurface_model``, ``subsurface_color``,
        ``subsurface_radius``, ``subsurface_radius_scale`` and what else the model takes; numbers and lists, or arrays where
        an image was given.

    Raises
    ------
    ValueError
        The version does not know the method, or a number is not finite or negative.

    Notes
    -----
    BURLEY is ``normalized-diffusion`` of the width radius * scale / 4 pi; cut where Cycles cuts it by
    ``scene.set_integrator(subsurface_tail=0.00362)`` and counted as Cycles counts it by ``subsurface_method="cycles-disk"``,
    for all materials.
    RANDOM_WALK has the mean free path radius * scale; RANDOM_WALK_LEGACY, which is RANDOM_WALK before Blender 5.2, has
    radius * scale (1 - g) / 4 pi, without 1 - g where g is below 0. Both are ``random-walk-rough``, RANDOM_WALK_SKIN is ``random-walk-skin``, in the medium
    that Cycles chooses. Walks end after 256 flights as they do there: whatever the color, a half space comes out no brighter
    than 0.919. With an anisotropy Cycles goes on in the similar isotropic medium after 10 flights; the walk here does not,
    and ends as late as that would.

    Examples
    --------
    >>> keys = translucid.cycles_material(
    ...     "RANDOM_WALK", base_color=[0.8, 0.5, 0.2], radius=[1, 0.2, 0.1], scale=0.05, version=(5, 1)
    ... )
    >>> keys["subsurface_model"], np.round(keys["subsurface_color"], 3).tolist()
    ('random-walk-rough', [0.812, 0.505, 0.202])
    """
    if version is None:
        bpy = sys.modules.get("bpy")
        version = (5, 2) if bpy is None else bpy.app.version
    if not (math.isfinite(scale) and scale >= 0.0):
        raise ValueError(f"scale is {scale}, but must be finite and at least 0")
    color, length = (np.asarray(values, dtype=np.float64) for values in (base_color, radius))
    for name, values in (("base_color", color), ("radius", length)):
        if values.ndim > 0 and values.shape[-1] != 3:
            raise ValueError(f"{name} has the shape {values.shape}, but must end in 3")
        if not (np.isfinite(values).all() and (values >= 0.0).all()):
            raise ValueError(f"{name} has numbers that are not finite or below 0")
    keys, color, mfp = _translucid._cycles_material(method, tuple(version), color + np.zeros(3), ior, anisotropy, alpha)
    mfp = (length * scale + np.zeros(3)) * mfp
    greatest = float(mfp.max())
    shares = mfp / greatest if greatest > 0.0 else np.ones_like(mfp)
    return keys | {
        "subsurface_color": _value(color),
        "subsurface_radius": greatest,
        "subsurface_radius_scale": _value(shares),
    }


def _value(values):
    return values.tolist() if values.ndim == 1 else values.astype(np.float32)
