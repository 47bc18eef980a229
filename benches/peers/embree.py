#!/usr/bin/env python3
"""Rays per CPU second of translucid and of Embree 4.4 on the dragon, single-threaded, the very same rays.

    python3 benches/peers/embree.py [--meshes dragon_198k,dragon_870k] [--rounds 7] [--rays 400000]

README.md says what is measured and how. The first run installs embreex from PyPI, whose wheel brings Embree along, into
target/peers and compiles embree_rays.c against it; where these can't be had, or the meshes are not in the folder
TRANSLUCID_ASSETS, it says so and ends well.
"""

import argparse
import ctypes
import os
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DRAGONS = Path(os.environ.get("TRANSLUCID_ASSETS", ""), "dragon")
CACHE = ROOT / "target" / "peers"
PACKAGES = ["embreex==4.4.0.post1", "numpy"]
NEAREST, ANY, EVERY = 0, 1, 2
KINDS = {
    "camera": NEAREST,
    "bounce": NEAREST,
    "scattered": NEAREST,
    "shadow": ANY,
    "probe": NEAREST,
    "probe-all": EVERY,
    "walk": NEAREST,
}


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def enter_environment():
    """Goes on in the virtual environment that has embreex and numpy."""
    python = CACHE / "venv" / "bin" / "python"
    if Path(sys.prefix).resolve() == (CACHE / "venv").resolve():
        return
    try:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", CACHE / "venv"], check=True)
        if subprocess.run([python, "-c", "import embreex, numpy"], capture_output=True).returncode != 0:
            print(f"installing {', '.join(PACKAGES)} into {CACHE / 'venv'}", flush=True)
            subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        skip(f"{PACKAGES[0]} can't be had here ({error})")
    os.execv(python, [str(python), __file__, *sys.argv[1:]])


def compiled():
    """The shim around Embree's interface."""
    # The wheel's own modules only: its functions for arrays know no filter, and so not every hit of a ray.
    import embreex

    folder = Path(embreex.__file__).parent.with_name("embreex.libs")
    library = next(folder.glob("libembree4*.so*"), None)
    if library is None:
        skip(f"there is no libembree4 in {folder}")
    shim = CACHE / "embree_rays.so"
    source = Path(__file__).with_name("embree_rays.c")
    command = ["gcc", "-O2", "-shared", "-fPIC", source, "-o", shim, library, f"-Wl,-rpath,{folder}"]
    try:
        subprocess.run(command, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        skip(f"embree_rays.c can't be compiled here ({error})")
    shim = ctypes.CDLL(str(shim))
    handle, size, integer = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    shim.new_device.restype = handle
    shim.new_scene.restype = handle
    shim.new_scene.argtypes = [handle, handle, size, handle, size, integer, integer]
    shim.trace.restype = ctypes.c_double
    shim.trace.argtypes = [handle, handle, size, integer, ctypes.POINTER(ctypes.c_uint64)]
    return shim


class Embree:
    """A mesh in Embree; `robust` is its mode without leaks at edges."""

    def __init__(self, shim, folder, robust):
        self.shim = shim
        self.vertices = np.fromfile(folder / "vertices.f32", np.float32)
        # Embree reads 16 bytes a vertex
        self.vertices = np.concatenate([self.vertices, np.zeros(4, np.float32)])
        self.triangles = np.fromfile(folder / "triangles.u32", np.uint32)
        self.rays = {kind: np.fromfile(folder / f"{kind}.rays", np.float32) for kind in KINDS}
        self.device = shim.new_device()
        counts = len(self.vertices) // 3 - 1, len(self.triangles) // 3
        make = lambda filtered: shim.new_scene(
            self.device, self.vertices.ctypes.data, counts[0], self.triangles.ctypes.data, counts[1], robust, filtered
        )
        self.scenes = {filtered: make(filtered) for filtered in (0, 1)}

    def trace(self, kind):
        """CPU seconds and hits."""
        hits, rays, question = ctypes.c_uint64(), self.rays[kind], KINDS[kind]
        scene = self.scenes[int(question == EVERY)]
        seconds = self.shim.trace(scene, rays.ctypes.data, len(rays) // 7, question, ctypes.byref(hits))
        return seconds, hits.value


class Translucid:
    """The bench `rays` as a server."""

    def __init__(self, mesh, folder, rays):
        command = ["cargo", "bench", "--quiet", "-p", "translucid-workbench", "--bench", "rays", "--"]
        command += [mesh, "--write", folder, "--rays", str(rays), "--serve"]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(list(map(str, command)), cwd=ROOT, stdin=pipe, stdout=pipe, text=True)
        answer = self.process.stdout.readline()
        if answer != "ready\n":
            raise SystemExit(f"the bench has ended: {answer}")

    def trace(self, kind):
        self.process.stdin.write(f"{kind}\n")
        self.process.stdin.flush()
        seconds, hits = self.process.stdout.readline().split()
        return float(seconds), int(hits)

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def compare(shim, mesh, rounds, rays):
    folder = CACHE / "rays"
    ours = Translucid(mesh, folder, rays)
    plain, robust = (Embree(shim, folder / mesh, flag) for flag in (0, 1))
    systems = {"ours": ours, "plain": plain, "robust": robust}
    count = len(plain.rays["camera"]) // 7
    seconds = {(name, kind): [] for name in systems for kind in KINDS}
    hits = {}
    # One round more than is counted, to warm up
    for turn in range(rounds + 1):
        for kind in KINDS:
            for name, system in systems.items():
                time, hits[name, kind] = system.trace(kind)
                if turn > 0:
                    seconds[name, kind].append(time)
    ours.end()
    print(f"\n{mesh}: {count} rays of each kind, medians of {rounds} rounds in turns, M rays per CPU second\n")
    print("| kind | translucid | Embree | Embree robust | translucid / Embree | / robust | hits per ray: ours, Embree, robust |")
    print("|---|---|---|---|---|---|---|")
    for kind in KINDS:
        rate = lambda name: count / statistics.median(seconds[name, kind]) * 1e-6

        def ratio(name):
            """Median of the rounds' ratios, and where the middle half of them lies."""
            each = sorted(b / a for a, b in zip(seconds["ours", kind], seconds[name, kind]))
            low, middle, high = (each[round(q * (len(each) - 1))] for q in (0.25, 0.5, 0.75))
            return f"{middle:.2f} ({low:.2f}–{high:.2f})"

        found = ", ".join(f"{hits[name, kind] / count:.5f}" for name in systems)
        rates = " | ".join(f"{rate(name):.2f}" for name in systems)
        print(f"| {kind} | {rates} | {ratio('plain')} | {ratio('robust')} | {found} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--meshes", default="dragon_198k,dragon_870k")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--rays", type=int, default=400_000)
    options = parser.parse_args()
    meshes = [mesh for mesh in options.meshes.split(",") if (DRAGONS / f"{mesh}.ply").is_file()]
    if not meshes:
        skip(f"{options.meshes} is not in the folder dragon of TRANSLUCID_ASSETS")
    enter_environment()
    global np
    import numpy as np

    shim = compiled()
    for mesh in meshes:
        compare(shim, mesh, options.rounds, options.rays)


if __name__ == "__main__":
    main()
