# SPDX-License-Identifier: GPL-3.0-or-later
"""translucid in Blender: subsurface scattering you can trust."""

from . import engine, process, properties

_PARTS = (properties, engine)


def register():
    process.find_denoiser()
    for part in _PARTS:
        part.register()


def unregister():
    for part in reversed(_PARTS):
        part.unregister()
