"""What the tests of the queues share: the command, a picture of one run, and pictures compared bit for bit."""

import json
import os
import pathlib
import subprocess
import time

import numpy
import OpenEXR
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONTRIB = ROOT / "contrib"
PROGRAM = pathlib.Path(os.environ.get("TRANSLUCID", ROOT / "target/debug/translucid")).resolve()
SIZE = ["--size", "48x27"]
SAMPLES = 10
LONG = 1500


SCENE = """
unit = "mm"
[camera]
position = [0, 2, 8]
target = [0, 0, 0]
fov = 30
[integrator]
samples_per_pixel = 8
[[material]]
name = "stuff"
subsurface_weight = 1
subsurface_color = [0.8, 0.5, 0.3]
subsurface_radius = 0.3
subsurface_model = "normalized-diffusion"
[[object]]
shape = "sphere"
material = "stuff"
[environment]
radiance = [1, 1, 1]
[[light]]
type = "sphere"
center = [5, 5, 0]
radius = 1
radiance = [20, 20, 20]
"""


def translucid(*words):
    subprocess.run([PROGRAM, *map(str, words)], check=True)


def one_run(scene, output, samples, *options):
    translucid("render", scene, *SIZE, "-q", "--spp", samples, *options, "-o", output)
    return output


def make_plan(scene, directory, shards, samples, *options):
    words = [PROGRAM, "plan", scene, "--shards", shards, "-o", "out.exr", "--", "--spp", samples, *SIZE, *options]
    text = subprocess.run([*map(str, words)], check=True, capture_output=True, text=True, cwd=directory).stdout
    (directory / "plan.json").write_text(text)
    return json.loads(text)


def channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}


def assert_same_picture(found, expected):
    """Bit for bit: every channel of the OpenEXR file, every byte of the PNG."""
    a, b = channels(found), channels(expected)
    assert a.keys() == b.keys() and len(a) > 4
    for name in a:
        assert numpy.array_equal(a[name].view(numpy.uint8), b[name].view(numpy.uint8)), name
    assert found.with_suffix(".png").read_bytes() == expected.with_suffix(".png").read_bytes()


@pytest.fixture(scope="session")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "ball.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="session")
def whole(scene):
    return one_run(scene, scene.with_name("whole.exr"), SAMPLES)



@pytest.fixture(scope="session")
def long_whole(scene):
    """Of LONG samples, which last long enough to be stopped in the middle."""
    return one_run(scene, scene.with_name("long.exr"), LONG)


@pytest.fixture
def recorder(tmp_path):
    """The command under another path: it leaves its process number in a file, so that a test can kill it."""
    path = tmp_path / "recorder"
    path.write_text(f'#!/bin/sh\necho $$ > "{tmp_path}/pid.new"; mv "{tmp_path}/pid.new" "{tmp_path}/pid"\n'
                    f'exec "{PROGRAM}" "$@"\n')
    path.chmod(0o755)
    return path


def wait_for(what, seconds=60):
    """Waits until `what()` is true; what it then is."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = what()
        if value:
            return value
        time.sleep(0.05)
    raise TimeoutError(f"nothing after {seconds} s")
