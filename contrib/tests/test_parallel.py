"""The recipe for GNU parallel: shards that are killed or stopped still give the picture of one run."""

import os
import re
import signal
import subprocess

import pytest
from conftest import CONTRIB, LONG, PROGRAM, assert_same_picture, make_plan, wait_for

PARALLEL = ["parallel", "--will-cite", "--ungroup", "--jobs", "1", "--termseq", "TERM,60000,KILL"]


@pytest.fixture
def commands(tmp_path, scene):
    """Starts the shards with these options of parallel."""
    make_plan(scene, tmp_path, 2, LONG, "--checkpoint", "0.05")

    def start(program, *options):
        environment = os.environ | {"TRANSLUCID": str(program)}
        words = [CONTRIB / "commands", "plan.json", "--resume", "--wait", "600"]
        lines = subprocess.run(words, env=environment, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
        (tmp_path / "shards").write_text("".join(lines.splitlines(keepends=True)[:-1]))
        (tmp_path / "merge").write_text(lines.splitlines()[-1])
        log = open(tmp_path / "log", "a")
        words = [*PARALLEL, *options, "-a", "shards"]
        return subprocess.Popen(words, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    return start


def assert_goes_on(directory, whole):
    subprocess.run(["sh", "merge"], cwd=directory, check=True)
    assert int(re.search(r"continuing from (\d+) samples", (directory / "log").read_text())[1]) > 0
    assert_same_picture(directory / "out.exr", whole)


def test_killed_shard_is_tried_again(tmp_path, commands, long_whole, recorder):
    running = commands(recorder, "--retries", "3")
    wait_for(lambda: list(tmp_path.glob("*.shard")))
    os.kill(int((tmp_path / "pid").read_text()), signal.SIGKILL)
    assert running.wait() == 0, (tmp_path / "log").read_text()
    assert_goes_on(tmp_path, long_whole)


def test_stopped_queue_saves_and_goes_on(tmp_path, commands, long_whole):
    running = commands(PROGRAM, "--joblog", "jobs")
    wait_for(lambda: list(tmp_path.glob("*.shard")))
    running.send_signal(signal.SIGTERM)
    assert running.wait() != 0
    assert "repeat the command with --resume" in (tmp_path / "log").read_text()
    assert commands(PROGRAM, "--joblog", "jobs", "--resume-failed").wait() == 0, (tmp_path / "log").read_text()
    assert_goes_on(tmp_path, long_whole)
