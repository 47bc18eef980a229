# SPDX-License-Identifier: GPL-3.0-or-later
"""translucid in Blender: subsurface scattering you can trust."""

import sys

from . import compare, engine, panels, presets, process, properties

_PARTS = (properties, engine, compare, presets, panels)


def register():
    process.find_denoiser()
    for part in _PARTS:
        part.register()


def unregister():
    # There is a viewport only where there is a display.
    viewport = sys.modules.get(f"{__name__}.viewport")
    if viewport is not None:
        viewport.unregister()
    for part in reversed(_PARTS):
        part.unregister()
