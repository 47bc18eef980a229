"""The script for Dask on a scheduler and a worker of this machine, which is killed."""

import os
import re
import signal
import subprocess
import sys
import pathlib

import pytest
from conftest import CONTRIB, LONG, SAMPLES, PROGRAM, assert_same_picture, make_plan, wait_for

DASK = pathlib.Path(sys.executable).with_name("dask")


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Address of the scheduler, and what the worker prints."""
    directory = tmp_path_factory.mktemp("dask")
    log = directory / "log"
    scheduler = directory / "scheduler"
    daemons = []
    with open(log, "wb") as out:
        for words in (["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"],
                      ["worker", "--nworkers", "1", "--nthreads", "1", "--no-dashboard"]):
            words = [DASK, *words, "--scheduler-file", scheduler]
            daemons.append(subprocess.Popen(words, cwd=directory, stdout=out, stderr=out))
        try:
            address = wait_for(lambda: re.search(r"Scheduler at: +(tcp://\S+)", log.read_text()))[1]
            yield address, log
        finally:
            for daemon in reversed(daemons):
                daemon.terminate()
                daemon.wait()


def submit(directory, address, program):
    environment = os.environ | {"TRANSLUCID": str(program)}
    words = [sys.executable, CONTRIB / "dask/submit", "plan.json", address]
    return subprocess.Popen(words, env=environment, cwd=directory)


def test_picture_is_that_of_one_run(tmp_path, cluster, scene, whole):
    make_plan(scene, tmp_path, 4, SAMPLES)
    assert submit(tmp_path, cluster[0], PROGRAM).wait() == 0
    assert_same_picture(tmp_path / "out.exr", whole)


def test_shard_of_a_dead_worker_goes_on(tmp_path, cluster, scene, long_whole, recorder):
    make_plan(scene, tmp_path, 1, LONG, "--checkpoint", "0.05")
    address, log = cluster
    running = submit(tmp_path, address, recorder)
    wait_for(lambda: list(tmp_path.glob("*.shard")))
    command = int((tmp_path / "pid").read_text())
    worker = int(pathlib.Path(f"/proc/{command}/stat").read_text().rsplit(")")[1].split()[1])
    os.kill(worker, signal.SIGKILL)
    assert running.wait() == 0
    assert int(re.search(r"continuing from (\d+) samples", log.read_text())[1]) > 0
    assert_same_picture(tmp_path / "out.exr", long_whole)
