"""The templates for Open Job Description, run by its command: every picture is bit for bit that of one run."""

import os
import pathlib
import re
import signal
import subprocess
import sys

import pytest
from conftest import CONTRIB, LONG, PROGRAM, SAMPLES, SCENE, SIZE, assert_same_picture, one_run, wait_for

OPENJD = pathlib.Path(sys.executable).with_name("openjd")


def job(template, **parameters):
    words = [OPENJD, "run", CONTRIB / f"openjd/{template}.yaml", "--step", "Merge", "--run-dependencies"]
    for name, value in ({"Program": PROGRAM} | parameters).items():
        words += ["-p", f"{name}={value}"]
    return words


def run(template, **parameters):
    return subprocess.run(job(template, **parameters), capture_output=True, text=True)


@pytest.mark.parametrize("template", ["picture", "animation"])
def test_template_is_valid(template):
    subprocess.run([OPENJD, "check", CONTRIB / f"openjd/{template}.yaml"], check=True)


@pytest.mark.parametrize(("samples_per_shard", "shards"), [(4, 3), (1, 10)])
def test_picture_is_that_of_one_run(tmp_path, scene, whole, samples_per_shard, shards):
    done = run(
        "picture", Scene=scene, Output=tmp_path / "out.exr", Shards=tmp_path / "shards", Samples=SAMPLES,
        SamplesPerShard=samples_per_shard, Options=" ".join(SIZE),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(list((tmp_path / "shards").glob("*.shard"))) == shards
    assert_same_picture(tmp_path / "out.exr", whole)


def test_jobs_of_other_samples_share_a_directory(tmp_path, scene):
    """10 samples by 4 are shards of 4, 3 and 3 samples, 12 by 4 three of 4: the second job takes the first shard as it is."""
    for samples in (SAMPLES, SAMPLES + 2):
        done = run(
            "picture", Scene=scene, Output=tmp_path / f"{samples}.exr", Shards=tmp_path / "shards", Samples=samples,
            SamplesPerShard=4, Options=" ".join(SIZE),
        )
        assert done.returncode == 0, done.stdout + done.stderr
        assert_same_picture(tmp_path / f"{samples}.exr", one_run(scene, tmp_path / f"one-{samples}.exr", samples))
    shards = {"000000-000004", "000004-000007", "000007-000010", "000004-000008", "000008-000012"}
    assert {path.stem for path in (tmp_path / "shards").glob("*.shard")} == shards


def test_animation_is_that_of_one_run_each(tmp_path):
    """Frames differ by a scene file each, and by a view."""
    for frame in (8, 9):
        changed = SCENE.replace("fov = 30", f"fov = {10 + 2 * frame}")
        (tmp_path / f"frame-{frame:04}.toml").write_text(changed)
    done = run(
        "animation", Scene=tmp_path / "frame-%04d.toml", Output=tmp_path / "out-%d.exr", Shards=tmp_path / "shards",
        Samples=SAMPLES, SamplesPerShard=6, Frames="8-9", Options=" ".join(SIZE) + " --view %d0,10",
    )
    assert done.returncode == 0, done.stdout + done.stderr
    for frame in (8, 9):
        scene = tmp_path / f"frame-{frame:04}.toml"
        expected = one_run(scene, tmp_path / f"one-{frame}.exr", SAMPLES, "--view", f"{frame}0,10")
        assert_same_picture(tmp_path / f"out-{frame}.exr", expected)
    a, b = (path.read_bytes() for path in (tmp_path / "out-8.png", tmp_path / "out-9.png"))
    assert a != b


def test_killed_task_goes_on_from_its_shard(tmp_path, scene, long_whole, recorder):
    parameters = dict(
        Scene=scene, Output=tmp_path / "out.exr", Shards=tmp_path / "shards", Samples=LONG, SamplesPerShard=LONG,
        Options=" ".join([*SIZE, "--checkpoint", "0.05"]), Program=recorder,
    )
    with subprocess.Popen(job("picture", **parameters), stdout=subprocess.PIPE, text=True) as first:
        wait_for(lambda: list((tmp_path / "shards").glob("*.shard")))
        os.kill(int((tmp_path / "pid").read_text()), signal.SIGKILL)
        text, _ = first.communicate()
    assert first.returncode != 0 and not (tmp_path / "out.exr").exists(), text
    second = run("picture", **parameters)
    assert second.returncode == 0, second.stdout + second.stderr
    assert int(re.search(r"continuing from (\d+) samples", second.stdout)[1]) > 0
    assert_same_picture(tmp_path / "out.exr", long_whole)


def test_wrong_scene_fails_the_job_with_its_message(tmp_path):
    (tmp_path / "wrong.toml").write_text("unit = 7\n")
    done = run(
        "picture", Scene=tmp_path / "wrong.toml", Output=tmp_path / "out.exr", Shards=tmp_path / "shards", Samples=4,
    )
    assert done.returncode != 0 and not (tmp_path / "out.exr").exists()
    assert "wrong.toml" in done.stdout and "code: 2" in done.stdout, done.stdout
