# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' subsurface settings as the transport that looks the same."""

from functools import lru_cache

import numpy as np
import translucid

from .value import Value, combine

# Our transport for each of Cycles' methods, and the system of `translucid.convert` that knows the method's lengths.
TRANSPORTS = {
    "BURLEY": ("normalized-diffusion", "cycles-burley"),
    "RANDOM_WALK": ("random-walk-rough", "cycles-random-walk"),
    "RANDOM_WALK_SKIN": ("random-walk-rough", "cycles-skin"),
}

# Albedos at which lengths of textured materials are converted; between them the mean free path is interpolated.
_ALBEDOS = np.linspace(0.0, 1.0, 257)


@lru_cache(maxsize=64)
def mean_free_path_table(method, ior):
    """The mean free path of radius × scale = 1 at the albedos of the table, in the same unit."""
    system = TRANSPORTS[method][1]
    words = {"subsurface_ior": ior} if method == "RANDOM_WALK_SKIN" else {}
    inner = np.clip(_ALBEDOS, 1e-3, 0.9999)
    lengths = []
    for start in range(0, inner.size, 3):
        three = np.resize(inner[start : start + 3], 3)
        converted = translucid.convert(
            system, surface_albedo=three, subsurface_radius=1.0, subsurface_scale=1.0, unit="mm", to="translucid", **words
        )
        lengths.append(np.broadcast_to(converted["translucid"]["mfp"], 3))
    return np.concatenate(lengths)[: inner.size]


def mean_free_path(method, color, length, ior):
    """The mean free path per channel, of values of three channels."""
    table = mean_free_path_table(method, round(ior, 4))
    return combine(lambda a, l: l * np.interp(a, _ALBEDOS, table), color, length)


def transport_keys(method, color, radius, scale, ior, anisotropy):
    """The material keys of a node's subsurface scattering.

    `ior` is the index through which the view is refracted on its way in: 1 is straight on.
    """
    length = combine(lambda r, s: np.maximum(r * s, 0), radius, scale)
    path = mean_free_path(method, color, length, ior)
    keys = {"subsurface_model": TRANSPORTS[method][0], "subsurface_color": color, "subsurface_radius": Value.of(1.0)}
    keys["subsurface_radius_scale"] = path
    keys["subsurface_scatter_anisotropy"] = Value.of(0.0 if method == "BURLEY" else min(max(anisotropy, 0.0), 0.9))
    keys["subsurface_eta"] = Value.of(1.0 if method == "BURLEY" else min(max(ior, 1.0), 3.0))
    return keys
