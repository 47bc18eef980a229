"""Ground truth: the exact half space, plane layers, and Monte Carlo walks for everything else.

All but layers is per unit of flux that has entered the medium: what the boundary reflects from outside is not part of it.
Layers count light that arrives.

>>> import translucid
>>> value, error = translucid.reference.exact(1.0, surface_albedo=0.5, configuration="searchlight")
>>> walk = translucid.reference.walk(100_000, radii=[1.0], surface_albedo=0.5, configuration="searchlight")
>>> mean, standard_error = walk.eval(1.0, surface_albedo=0.5)
>>> abs(mean - value) < 4 * standard_error
True
"""

from typing import NamedTuple

from ._translucid import (
    WhiteTable,
    exact,
    exact_beyond,
    exact_enclosed,
    exact_total,
    layers,
    layers_profile,
    layers_walk,
    walk,
)

__all__ = [
    "LayersProfile",
    "LayersTotals",
    "LayersWalk",
    "WhiteTable",
    "exact",
    "exact_beyond",
    "exact_enclosed",
    "exact_total",
    "layers",
    "layers_profile",
    "layers_walk",
    "walk",
]


class LayersTotals(NamedTuple):
    """Parts of the light that arrives on layers, as `layers` solves them: numbers or arrays.

    They sum to 1, but for `error`, an estimate of the greatest numerical error among them.
    `absorbed` has one more axis, along the layers.
    """

    specular_reflectance: float
    diffuse_reflectance: float
    collimated_transmittance: float
    diffuse_transmittance: float
    absorbed: float
    absorbed_by_ground: float
    error: float


class LayersProfile(NamedTuple):
    """R(r) and T(r) of layers per area, as `layers_profile` solves them, with estimates of their greatest numerical errors."""

    reflectance: float
    reflectance_error: float
    transmittance: float
    transmittance_error: float


class LayersWalk(NamedTuple):
    """Figures of a walk through layers, as `layers_walk` counts them: pairs of values and standard errors.

    `specular_reflectance` is exact: what the first face reflects, or both faces of a clear first layer under a beam along
    the normal.
    `reflected`, `transmitted`, `absorbed_by_layer`, `absorbed_by_ground` and `lost` are parts of the light that arrives.
    `lost` is what was given up after 2**24 collisions.
    `r` and `z` are the centers of rings and depths, `reflectance` and `transmittance` light per area in each ring, and
    `absorption` light per volume, of shape (nr, nz).
    The last ring and depth also count what is beyond them.
    """

    specular_reflectance: float
    reflected: tuple
    transmitted: tuple
    absorbed_by_layer: tuple
    absorbed_by_ground: tuple
    lost: tuple
    r: object
    z: object
    reflectance: tuple
    transmittance: tuple
    absorption: tuple
