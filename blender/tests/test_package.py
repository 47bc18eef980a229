# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension as users get it: built and validated by Blender's tool, installed without a network."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

FOLDER = Path(__file__).parents[1]

INSTALLED = """
import bpy, sys
print(bpy.ops.extensions.package_install_files(filepath=sys.argv[-1], repo="user_default", enable_on_install=True))
scene = bpy.context.scene
scene.render.engine = "TRANSLUCID"
scene.render.resolution_x, scene.render.resolution_y, scene.translucid.samples = 32, 24, 1
bpy.ops.render.render()
import translucid
print("module", translucid.__file__)
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.translucid")
print("done")
"""


def blender_tool():
    return Path(bpy.utils.resource_path("LOCAL")) / "scripts/addons_core/bl_pkg/cli/blender_ext.py"


def test_extension_is_built_validated_and_installed_offline(tmp_path):
    wheel = os.environ.get("TRANSLUCID_WHEEL")
    if wheel is None:
        pytest.skip("TRANSLUCID_WHEEL does not name the wheel to bundle")
    build = [sys.executable, FOLDER / "package.py", "--wheel", wheel, "--tool", blender_tool(), "-o", tmp_path]
    done = subprocess.run(build, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    package = Path(done.stdout.strip())
    assert package.name == "translucid-0.1.0.zip"
    # The module is to be the wheel's: where the tests take theirs from must not be seen.
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path / "user")}
    environment.pop("PYTHONPATH", None)
    command = [sys.executable, "-c", INSTALLED, str(package)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0 and "done" in done.stdout, done.stdout + done.stderr
    module = next(line for line in done.stdout.splitlines() if line.startswith("module"))
    if "PYTHONPATH" in os.environ:
        assert str(tmp_path) in module, module


def test_a_wheel_of_another_version_is_refused(tmp_path):
    wheel = tmp_path / "translucid-9.9.9-cp310-abi3-manylinux_2_17_x86_64.whl"
    wheel.touch()
    build = [sys.executable, FOLDER / "package.py", "--wheel", wheel, "--tool", blender_tool(), "-o", tmp_path]
    done = subprocess.run(build, capture_output=True, text=True)
    assert done.returncode != 0 and "is not of translucid 0.1.0" in done.stderr
