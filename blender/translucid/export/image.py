# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of Blender's images."""

import numpy as np

# What integer and float images with these color spaces hold.
_SRGB = {"sRGB", "sRGB OETF"}
_LINEAR = {"Non-Color", "Linear", "Linear Rec.709", "Linear BT.709", "Raw", "Generic Data"}


def pixels_of(image, say):
    """The pixels of an image, the upper row first: uint8 codes of sRGB, or linear float32; None if there are none.

    RGBA. `say` is told what is not as the image has it.
    """
    if image.source == "TILED":
        say("of its UDIM tiles only the first is used")
    elif image.source in {"SEQUENCE", "MOVIE"}:
        say("only the frame that Blender has loaded is used")
    if image.size[0] == 0 or image.size[1] == 0:
        # Blender loads a file when its pixels are asked for.
        len(image.pixels)
    width, height = image.size
    if width == 0 or height == 0:
        return None
    values = np.empty(width * height * 4, dtype=np.float32)
    if len(image.pixels) != values.size:
        return None
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, 4)[::-1]
    space = image.colorspace_settings.name
    if image.is_float:
        if space not in _LINEAR and space not in _SRGB:
            say(f"its color space {space!r} is taken for linear Rec. 709")
        if not np.isfinite(values).all():
            say("pixels that are no numbers are black")
            values = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
        return np.ascontiguousarray(values)
    if space in _LINEAR:
        return np.ascontiguousarray(values)
    if space not in _SRGB:
        say(f"its color space {space!r} is taken for sRGB")
    return np.rint(values * 255).astype(np.uint8)
