"""Work on a Ray cluster of two nodes on this machine, one of which is killed or slowed: the bits of one run."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import translucid

ray = pytest.importorskip("ray", reason="Ray is not installed; .ci/python has it")
psutil = pytest.importorskip("psutil")

import translucid.ray  # noqa: E402
from ray.cluster_utils import Cluster  # noqa: E402

SIZE = (48, 32)
SPP = 24

SCENE = """
unit = "mm"
[[material]]
name = "wax"
subsurface_weight = 1.0
subsurface_color = { file = "textures/spots.png" }
subsurface_radius = 0.3
[[object]]
name = "cube"
file = "cube.obj"
material = "wax"
[[object]]
name = "ball"
shape = "sphere"
material = "wax"
translate = [1.5, 0.0, 0.0]
"""

CUBE = "".join(
    f"v {x} {y} {z}\nvt {(x + 1) / 2} {(y + 1) / 2}\n" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)
) + "".join(
    "f " + " ".join(f"{i}/{i}" for i in face) + "\n"
    for face in [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
)


@pytest.fixture(scope="module")
def cluster():
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


@pytest.fixture
def second_node(cluster):
    """A node beside the first, for one test."""
    node = cluster.add_node(num_cpus=1)
    cluster.wait_for_nodes()
    yield node
    if node in cluster.list_all_nodes():
        cluster.remove_node(node)


@pytest.fixture
def scene(tmp_path):
    folder = tmp_path / "scene"
    (folder / "textures").mkdir(parents=True)
    spots = np.array([[0.9, 0.4], [0.2, 0.7]], np.float32)[..., None].repeat(3, axis=2)
    translucid.Picture({"radiance": spots}).save(folder / "textures" / "spots.png")
    (folder / "cube.obj").write_text(CUBE)
    path = folder / "scene.toml"
    path.write_text(SCENE)
    return path


def run_command(*words):
    subprocess.run([sys.executable, "-m", "translucid", *words, "-q"], check=True)


@pytest.fixture
def whole(scene, tmp_path):
    """The picture of one run by the command."""
    path = tmp_path / "whole.exr"
    size = "x".join(map(str, SIZE))
    run_command("render", scene, "--size", size, "--spp", str(SPP), "-o", path)
    return path


def assert_same_picture(a, b):
    one, other = translucid.read_exr(a), translucid.read_exr(b)
    assert one.keys() == other.keys()
    for layer in one:
        assert np.array_equal(one[layer], other[layer]), layer
    assert a.with_suffix(".png").read_bytes() == b.with_suffix(".png").read_bytes()


def processes_of(node):
    """The raylet of a node and its workers."""
    raylet = psutil.Process(node.all_processes["raylet"][0].process.pid)
    return [raylet, *raylet.children(recursive=True)]


def test_picture_has_the_bits_of_one_run_though_a_node_is_killed(cluster, second_node, scene, whole, tmp_path):
    killed = []

    def kill(done, _):
        if done >= 4 and not killed:
            killed.extend(processes_of(second_node))
            for process in killed:
                os.kill(process.pid, signal.SIGKILL)

    output = tmp_path / "out.exr"
    translucid.ray.render(scene, output, size=SIZE, spp=SPP, task_samples=2, progress=kill)
    assert len(killed) >= 2, "the raylet and a worker"
    assert_same_picture(whole, output)


def test_picture_has_the_bits_of_one_run_though_a_node_is_slow(cluster, second_node, scene, whole, tmp_path):
    ends = threading.Event()

    def slow_down():
        while not ends.is_set():
            workers = processes_of(second_node)[1:]
            for number, pause in [(signal.SIGSTOP, 0.4), (signal.SIGCONT, 0.1)]:
                for worker in workers:
                    try:
                        worker.send_signal(number)
                    except psutil.NoSuchProcess:
                        pass
                time.sleep(pause)

    thread = threading.Thread(target=slow_down)
    thread.start()
    output = tmp_path / "out.exr"
    try:
        translucid.ray.render(scene, output, size=SIZE, spp=SPP, task_samples=1)
    finally:
        ends.set()
        thread.join()
    assert_same_picture(whole, output)


def test_interrupted_picture_goes_on_from_its_parts(cluster, scene, whole, tmp_path):
    parts, output = tmp_path / "parts", tmp_path / "out.exr"

    def interrupt(done, _):
        if done >= 6:
            raise KeyboardInterrupt

    options = {"size": SIZE, "spp": SPP, "task_samples": 3, "parts": parts}
    with pytest.raises(KeyboardInterrupt):
        translucid.ray.render(scene, output, progress=interrupt, **options)
    kept = {path.name for path in parts.iterdir()}
    assert len(kept) >= 2 and not output.exists()
    seen = []
    translucid.ray.render(scene, output, progress=lambda done, total: seen.append(total), **options)
    assert seen[0] == SPP - 3 * len(kept)
    assert_same_picture(whole, output)
    # Parts of another picture are not taken for those of this one
    with pytest.raises(ValueError, match="cannot be merged"):
        next(parts.iterdir()).unlink()
        translucid.ray.render(scene, output, **options | {"seed": 5})


def test_table_has_the_bits_of_one_walk(cluster, second_node, tmp_path):
    arguments = {"radii": [0.5, 1.0], "single_scattering_albedo": 0.9, "seed": 3}
    table = translucid.ray.reference(60_000, task_photons=7_000, **arguments)
    one = translucid.reference.walk(60_000, **arguments)
    table.save(tmp_path / "a.npz")
    one.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def can_make_namespaces():
    name = "translucid-try"
    try:
        made = subprocess.run(["ip", "netns", "add", name], capture_output=True).returncode == 0
        subprocess.run(["ip", "netns", "delete", name], capture_output=True)
    except OSError:
        return False
    return made


@pytest.mark.skipif(not can_make_namespaces(), reason="this machine makes no network namespaces")
def test_picture_has_the_bits_of_one_run_though_a_link_is_cut(scene, tmp_path):
    output, whole = tmp_path / "out.exr", tmp_path / "whole.exr"
    run_command("render", scene, "--size", "96x64", "--spp", "96", "-o", whole)
    program = Path(__file__).with_name("ray_in_namespaces.py")
    run = subprocess.run(
        [sys.executable, program, scene, output], capture_output=True, text=True, timeout=450, cwd=tmp_path
    )
    assert run.returncode == 0, run.stderr
    assert "cut after" in run.stdout
    assert_same_picture(whole, output)


def test_wrong_arguments_are_said_before_anything_is_sent(scene, tmp_path):
    output = tmp_path / "out.exr"
    for wrong, error, words in [
        ({"output": tmp_path / "out.jpg"}, ValueError, ".exr, .png or .shard"),
        ({"spp": 0}, ValueError, "spp is 0"),
        ({"threads": 1.5}, TypeError, "threads is 1.5"),
        ({"task_samples": 0}, ValueError, "task_samples is 0"),
        ({"size": (0, 1)}, ValueError, "size"),
        ({"scene": tmp_path / "no.toml"}, translucid.SceneError, "no.toml"),
    ]:
        arguments = {"scene": scene, "output": output} | wrong
        with pytest.raises(error, match=words):
            translucid.ray.render(arguments.pop("scene"), arguments.pop("output"), **arguments)
    with pytest.raises(ValueError, match="photons"):
        translucid.ray.reference(0)
    with pytest.raises(TypeError, match="surface_albedos"):
        translucid.ray.reference(100, surface_albedos=0.5)
    assert not output.exists()
