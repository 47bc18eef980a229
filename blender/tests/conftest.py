# SPDX-License-Identifier: GPL-3.0-or-later
"""These tests need Blender as a module (`bpy`), or are skipped; `.ci/blender` brings it."""

collect_ignore = []
try:
    import bpy  # noqa: F401
except ImportError:
    collect_ignore = ["test_engine.py", "test_geometry.py", "test_lamps.py", "test_materials.py", "test_scenes.py", "test_package.py", "test_speed.py"]
