# SPDX-License-Identifier: GPL-3.0-or-later
"""These tests need Blender as a module (`bpy`), or are skipped; `.ci/blender` brings it."""

collect_ignore = []
try:
    import bpy  # noqa: F401
except ImportError:
    needs = ("compare", "cryptomatte", "edits", "engine", "geometry", "lamps", "materials", "odd_scenes", "package", "panels", "pictures", "scenes", "speed", "subsurface")
    collect_ignore = [f"test_{name}.py" for name in needs]
