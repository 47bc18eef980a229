"""Render on two Ray nodes, each in a network namespace of its own, and cut the link between them in the middle.

    python ray_in_namespaces.py SCENE OUTPUT

Needs root and Linux. The link comes back only when all is done.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time

NAMES = ["translucid-a", "translucid-b"]
ADDRESSES = ["10.213.0.1", "10.213.0.2"]
PORT = 6399


def command(words, check=True):
    return subprocess.run(words.split(), check=check, capture_output=True, text=True)


def inside(number, words, **options):
    return subprocess.Popen(["ip", "netns", "exec", NAMES[number], *words], start_new_session=True, **options)


def set_up():
    tear_down()
    for name in NAMES:
        command(f"ip netns add {name}")
        command(f"ip netns exec {name} ip link set lo up")
    command(f"ip link add translucid-0 netns {NAMES[0]} type veth peer name translucid-1 netns {NAMES[1]}")
    for number, (name, address) in enumerate(zip(NAMES, ADDRESSES, strict=True)):
        command(f"ip netns exec {name} ip address add {address}/24 dev translucid-{number}")
        command(f"ip netns exec {name} ip link set translucid-{number} up")


def tear_down():
    for name in NAMES:
        for process in command(f"ip netns pids {name}", check=False).stdout.split():
            os.kill(int(process), signal.SIGKILL)
        command(f"ip netns delete {name}", check=False)


def start_node(number, folder):
    ray = os.path.join(os.path.dirname(sys.executable), "ray")
    words = [ray, "start", "--block", "--num-cpus=1", f"--node-ip-address={ADDRESSES[number]}"]
    if number == 0:
        # A node that is silent for three seconds is dead
        names = ["initial_delay_ms", "period_ms", "timeout_ms"]
        soon = {f"health_check_{name}": 1000 for name in names} | {"health_check_failure_threshold": 3}
        words += ["--head", f"--port={PORT}", "--include-dashboard=false", f"--temp-dir={folder}"]
        words += [f"--system-config={json.dumps(soon)}"]
    else:
        words += [f"--address={ADDRESSES[0]}:{PORT}"]
    return inside(number, words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def drive(scene, output):
    """Runs in the first namespace: renders, and cuts the link once some samples are there."""
    import ray

    import translucid.ray

    ray.init(address=f"{ADDRESSES[0]}:{PORT}", log_to_driver=False, _node_ip_address=ADDRESSES[0])
    start = time.monotonic()
    while len(ray.nodes()) < 2:
        assert time.monotonic() - start < 60, "the second node does not come"
        time.sleep(0.2)
    nodes = set()

    def where():
        return ray.get_runtime_context().get_node_id()

    # Both work before the link is cut
    while len(nodes) < 2:
        nodes.update(ray.get([ray.remote(num_cpus=1)(where).remote() for _ in range(4)]))
    cut = []

    def cut_the_link(done, _):
        if done >= 8 and not cut:
            cut.append(done)
            subprocess.run(["ip", "link", "set", "translucid-0", "down"], check=True)

    translucid.ray.render(scene, output, size=(96, 64), spp=96, task_samples=2, progress=cut_the_link)
    assert cut
    print("cut after", cut[0], "of 96 samples; done", flush=True)


def main():
    if sys.argv[1] == "--drive":
        drive(*sys.argv[2:])
        return
    set_up()
    try:
        with tempfile.TemporaryDirectory(prefix="ray-", dir="/tmp") as folder:
            for number in range(2):
                start_node(number, folder)
                time.sleep(4)
            driver = inside(0, [sys.executable, os.path.abspath(__file__), "--drive", *sys.argv[1:]])
            sys.exit(driver.wait(timeout=400))
    finally:
        tear_down()


main()
