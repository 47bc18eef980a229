"""The scripts for Slurm on a cluster of this machine alone: slurmctld, slurmd and munged in a temporary directory."""

import getpass
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile

import pytest
from conftest import CONTRIB, LONG, PROGRAM, SAMPLES, assert_same_picture, make_plan, one_run, wait_for

CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
# A job that queues itself again waits for as long, 5 s at the least
AuthInfo=socket={directory}/munge.socket,cred_expire=5
CredType=cred/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={directory}/state
SlurmdSpoolDir={directory}/spool
SlurmctldPidFile={directory}/slurmctld.pid
SlurmdPidFile={directory}/slurmd.pid
SlurmctldLogFile={directory}/slurmctld.log
SlurmdLogFile={directory}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SchedulerParameters=sched_interval=1,bf_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
KillWait=5
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@pytest.fixture(scope="module")
def cluster():
    """The environment of Slurm's commands."""
    # Not pytest's own directory: a socket's path must be short, and munged refuses folders that others may write
    with tempfile.TemporaryDirectory() as name:
        directory = pathlib.Path(name)
        directory.chmod(0o755)
        for folder in ("state", "spool"):
            (directory / folder).mkdir()
        key = directory / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        controller_port, node_port = free_ports(2)
        values = dict(
            host=socket.gethostname().split(".")[0], controller_port=controller_port, node_port=node_port,
            directory=directory, user=getpass.getuser(), processors=len(os.sched_getaffinity(0)),
        )
        (directory / "slurm.conf").write_text(CONFIGURATION.format(**values))
        environment = os.environ | {
            "SLURM_CONF": str(directory / "slurm.conf"),
            "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin",
        }
        # --force: munged would not use a directory below one that everybody may write, as /tmp is
        munged = ["munged", "--foreground", "--force", "--num-threads=2"]
        for option, file in [("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"),
                             ("seed-file", "seed")]:
            munged.append(f"--{option}={directory}/munge.{file}")
        daemons = []
        try:
            for words in (munged, ["slurmctld", "-D"], ["slurmd", "-D"]):
                log = open(directory / f"{words[0]}.output", "wb")
                daemons.append(subprocess.Popen(words, env=environment, stdout=log, stderr=log))
                if words is munged:
                    wait_for((directory / "munge.socket").exists)
            states = lambda: slurm(environment, "sinfo", "--noheader", "--format=%T", check=False)
            try:
                wait_for(lambda: states().strip() == "idle", 30)
            except TimeoutError:
                logs = [path.read_text(errors="replace")[-2000:] for path in directory.glob("*.log")]
                pytest.fail("\n".join(["Slurm did not start", states(), *logs]))
            yield environment
        finally:
            for daemon in reversed(daemons):
                daemon.terminate()
                try:
                    daemon.wait(20)
                except subprocess.TimeoutExpired:
                    daemon.kill()
                    daemon.wait()


def slurm(environment, *words, check=True):
    return subprocess.run(words, env=environment, check=check, capture_output=True, text=True).stdout


def submit(environment, directory, program=PROGRAM):
    """Numbers of the array job and of the merge."""
    words = [CONTRIB / "slurm/submit", "plan.json", "--time=10"]
    done = subprocess.run(
        words, env=environment | {"TRANSLUCID": str(program)}, cwd=directory, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return re.fullmatch(r"shards: job (\d+), tasks 0-\d+; merge: job (\d+)\n", done.stdout).groups()


def state(environment, job):
    text = slurm(environment, "scontrol", "show", "job", job)
    return re.search(r"JobState=(\w+)", text)[1]


def wait_for_end(environment, job):
    ends = {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT"}
    return wait_for(lambda: (found := state(environment, job)) in ends and found, 600)


def logs(directory):
    return "\n".join(path.read_text() for path in sorted(directory.glob("*.log")))


def test_picture_is_that_of_one_run(tmp_path, cluster, scene, whole):
    plan = make_plan(scene, tmp_path, 4, SAMPLES)
    _, merge = submit(cluster, tmp_path)
    assert wait_for_end(cluster, merge) == "COMPLETED", logs(tmp_path)
    assert all((tmp_path / shard["output"]).exists() for shard in plan["shards"])
    assert_same_picture(tmp_path / "out.exr", whole)
    # A plan of other samples, whose shards begin elsewhere
    make_plan(scene, tmp_path, 4, SAMPLES + 3)
    _, merge = submit(cluster, tmp_path)
    assert wait_for_end(cluster, merge) == "COMPLETED", logs(tmp_path)
    assert_same_picture(tmp_path / "out.exr", one_run(scene, tmp_path / "one.exr", SAMPLES + 3))


def test_shard_out_of_time_goes_on_in_the_queue(tmp_path, cluster, scene, long_whole):
    make_plan(scene, tmp_path, 1, LONG, "--checkpoint", "0.05")
    array, merge = submit(cluster, tmp_path)
    wait_for((tmp_path / f"out-000000-{LONG:06}.shard").exists)
    # What Slurm does two minutes before the limit
    slurm(cluster, "scancel", "--batch", "--signal=USR1", f"{array}_0")
    assert wait_for_end(cluster, merge) == "COMPLETED", logs(tmp_path)
    assert int(re.search(r"continuing from (\d+) samples", logs(tmp_path))[1]) > 0
    assert_same_picture(tmp_path / "out.exr", long_whole)


def test_killed_shard_leaves_no_picture_and_goes_on_when_submitted_again(tmp_path, cluster, scene, long_whole, recorder):
    make_plan(scene, tmp_path, 1, LONG, "--checkpoint", "0.05")
    _, merge = submit(cluster, tmp_path, recorder)
    wait_for((tmp_path / f"out-000000-{LONG:06}.shard").exists)
    os.kill(int((tmp_path / "pid").read_text()), signal.SIGKILL)
    assert wait_for_end(cluster, merge) == "CANCELLED", logs(tmp_path)
    assert not (tmp_path / "out.exr").exists()
    _, merge = submit(cluster, tmp_path)
    assert wait_for_end(cluster, merge) == "COMPLETED", logs(tmp_path)
    assert int(re.search(r"continuing from (\d+) samples", logs(tmp_path))[1]) > 0
    assert_same_picture(tmp_path / "out.exr", long_whole)


def test_missing_plan_is_said(tmp_path):
    done = subprocess.run([CONTRIB / "slurm/submit", tmp_path / "none.json"], capture_output=True, text=True)
    assert done.returncode == 2 and "usage:" in done.stderr
