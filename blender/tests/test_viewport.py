# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view of Blender itself, on a display that nobody sees."""

import json
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import pytest

SESSION = Path(__file__).parent / "viewport_session.py"

# Many take minutes: they are for `.ci/thorough`.
EDITS = 500 if "TRANSLUCID_THOROUGH" in os.environ else 60


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What a session in the rendered view has seen. TRANSLUCID_BLENDER_MODULES has modules for that Blender's Python."""
    for program in ("blender", "Xvfb"):
        if shutil.which(program) is None:
            pytest.skip(f"there is no {program}")
    folder = tmp_path_factory.mktemp("viewport")
    modules = os.environ.get("TRANSLUCID_BLENDER_MODULES")
    if modules is None:
        pytest.skip("TRANSLUCID_BLENDER_MODULES does not name a folder with numpy and translucid for Blender's Python")
    for entry in Path(modules).iterdir():
        (folder / entry.name).symlink_to(entry)
    read, write = os.pipe()
    display = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24"], pass_fds=[write], stderr=subprocess.DEVNULL)
    try:
        os.close(write)
        with os.fdopen(read) as file:
            number = file.readline().strip()
        environment = os.environ | {"DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1"}
        # Blender's Python is not ours.
        environment.pop("PYTHONPATH", None)
        command = ["blender", "--factory-startup", "--python", str(SESSION), "--", str(folder), str(EDITS)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600 + 8 * EDITS)
    finally:
        display.terminate()
        display.wait()
    line = next((line for line in done.stdout.splitlines() if line.startswith("SEEN ")), None)
    assert line is not None, f"Blender ended with {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    found = json.loads(line[5:])
    print(json.dumps(found), file=sys.stderr)
    assert "error" not in found, found["error"]
    keep = os.environ.get("TRANSLUCID_SCREENSHOTS")
    for picture in folder.glob("*.png") if keep else ():
        shutil.copy(picture, keep)
    return found


def test_moved_views_have_new_pixels_soon(seen):
    median = statistics.median(seen["latency"])
    print(f"from a moved view to new pixels: median {median * 1000:.0f} ms of {len(seen['latency'])}, worst {max(seen['latency']) * 1000:.0f} ms")
    assert median < 0.15


def test_edits_change_the_picture(seen):
    red, green, blue = seen["blue"]
    assert red < 0 and blue > 0
    assert seen["moved"] > 1e-3


def test_no_picture_is_stale_after_random_edits(seen):
    assert seen["edits"] == EDITS
    # The same samples of the same scene: what differs is the rounding of moved vertices.
    assert max(seen["compared"]) < 0.02, seen["compared"]


def test_memory_is_steady(seen):
    assert seen["memory"][-1] - seen["memory"][0] < 200, seen["memory"]


def test_files_are_reloaded_while_the_view_is_rendered(seen):
    assert seen["reloaded"]
