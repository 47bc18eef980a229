# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene as a description of arrays and numbers, which `translucid.Scene` takes.

Lengths are Blender's units and directions those of Blender's world, z upward: nothing is scaled or turned.
"""
