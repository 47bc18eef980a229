# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte passes. The names that they pick by are Blender's own, as in Cycles."""

from dataclasses import dataclass

import translucid

from .export.scene import placed_meshes

# What Blender calls the passes, and the property of a view layer that asks for them.
_KINDS = {
    "CryptoObject": "use_pass_cryptomatte_object",
    "CryptoMaterial": "use_pass_cryptomatte_material",
    "CryptoAsset": "use_pass_cryptomatte_asset",
}

# Lower case, by which OpenEXR's lossy compressions know that they must leave the numbers alone.
CHANNELS = "rgba"


@dataclass
class Matte:
    """A kind of Cryptomatte that a view layer asks for. Knows nothing of Blender."""

    # The view layer's name and the kind's.
    name: str
    # Names of the passes, each of two ids and their shares.
    passes: list
    what: str
    # Blender's names of what has other names in the renderer.
    names: dict

    def values(self, session):
        """The passes' names and values."""
        pairs = session.cryptomatte(self.what, levels=2 * len(self.passes), names=self.names)
        for number, name in enumerate(self.passes):
            two = pairs[:, :, 2 * number : 2 * number + 2]
            yield name, two.reshape(*two.shape[:2], 4)

    def notes(self):
        """What the picture's file says of the names."""
        return translucid.cryptomatte_metadata(self.name, dict.fromkeys(self.names.values()))


def passes_of(layer):
    """Names of all passes that a view layer asks for."""
    return [name for kind in _kinds(layer) for name in _passes(kind, layer)]


def mattes_of(layer, description):
    """What a view layer asks for, of what a description shows."""
    for kind in _kinds(layer):
        what = "material" if kind == "CryptoMaterial" else "object"
        yield Matte(f"{layer.name}.{kind}", _passes(kind, layer), what, _names(kind, description))


def _kinds(layer):
    return [kind for kind, asked in _KINDS.items() if getattr(layer, asked)]


def _passes(kind, layer):
    # As many as Cycles makes of an odd number.
    return [f"{kind}{number:02d}" for number in range((min(16, layer.pass_cryptomatte_depth) + 1) // 2)]


def _names(kind, description):
    """Blender's names: the renderer has an object for each material of each place."""
    if kind == "CryptoMaterial":
        return description.material_names
    names = {}
    for name, body in description.bodies.items():
        for places, keys in placed_meshes(name, body, description.materials):
            for place in places:
                own = f"{keys['name']}[{place}]" if "transforms" in keys else keys["name"]
                names[own] = body.shown[place][kind == "CryptoAsset"]
    return names
