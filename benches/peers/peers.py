#!/usr/bin/env python3
"""Equal-error CPU time of translucid and Blender Cycles on the head and the dragon.

    python3 benches/peers/peers.py [--scenes head,dragon] [--spp 1,4,16,64,256] [--size 512]
                                   [--reference-samples 1024,2048] [--ours "--subsurface-method point-based"]
                                   [--model random-walk-rough]

README.md says what is measured and how. The first run installs bpy from PyPI into target/peers; where that can't be had, or
the meshes are not in the folder TRANSLUCID_ASSETS, it says so and ends well.
"""

import argparse
import hashlib
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ASSETS = Path(os.environ.get("TRANSLUCID_ASSETS", ""))
CACHE = ROOT / "target" / "peers"
PACKAGES = ["bpy==5.0.1", "OpenEXR==3.5.3"]
MESHES = {"head": "head/head_70k.ply", "dragon": "dragon/dragon_198k.ply"}


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def require_scans():
    """Ends where the meshes are not there."""
    for mesh in MESHES.values():
        if not (ASSETS / mesh).is_file():
            skip(f"{mesh} is not in the folder TRANSLUCID_ASSETS")


def enter_environment():
    """Goes on in the virtual environment that has bpy and numpy."""
    python = CACHE / "venv" / "bin" / "python"
    if Path(sys.prefix).resolve() == (CACHE / "venv").resolve():
        return
    try:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", CACHE / "venv"], check=True)
        if subprocess.run([python, "-c", "import bpy, numpy, OpenEXR"], capture_output=True).returncode != 0:
            print(f"installing {', '.join(PACKAGES)} into {CACHE / 'venv'}", flush=True)
            subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
            subprocess.run([python, "-c", "import bpy, numpy, OpenEXR"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        skip(f"{PACKAGES[0]} can't be had here ({error})")
    os.execv(python, [str(python), *sys.argv])


class Cycles:
    """The worker process, see blender_worker.py."""

    name = "Cycles"

    def __init__(self, model):
        self.method = "RANDOM_WALK" if is_walk(model) else "BURLEY"
        worker = Path(__file__).with_name("blender_worker.py")
        CACHE.mkdir(parents=True, exist_ok=True)
        self.log = open(CACHE / "blender.log", "w")
        self.process = subprocess.Popen(
            [sys.executable, worker], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, text=True
        )
        self.version = json.loads(self.process.stdout.readline())["version"]

    def ask(self, **command):
        self.process.stdin.write(json.dumps(command) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit(f"Blender has ended; see {self.log.name}")
        return json.loads(answer)

    def image(self, scene, size, spp, seed):
        out = str(CACHE / "cycles.npy")
        file, mesh = str(ROOT / "scenes" / f"{scene}.toml"), str(ASSETS / MESHES[scene])
        command = dict(scene=file, mesh=mesh, method=self.method, size=size, spp=spp, seed=seed)
        seconds = self.ask(do="render", out=out, **command)["cpu"]
        return np.load(out), seconds


class Translucid:
    """The command, built for release."""

    name = "translucid"

    def __init__(self, options, program=None):
        self.program, self.options = program or built(), options
        self.binary_hash = hashlib.sha256(Path(self.program).read_bytes()).hexdigest()

    def image(self, scene, size, spp, seed, options=None, lines=""):
        options = self.options if options is None else options
        with tempfile.TemporaryDirectory() as folder:
            out, file = Path(folder) / "image.exr", Path(folder) / "scene.toml"
            # As many bounces as Cycles has
            bounces = "[integrator]\nmax_depth = 12\nmax_diffuse_depth = 4\n" if scene in MESHES else ""
            base = ROOT / "scenes" / f"{scene}.toml" if scene in MESHES else Path(scene).resolve()
            file.write_text(f"extends = {json.dumps(str(base))}\n{bounces}{lines}\n")
            command = [self.program, "render", file, "--size", f"{size}x{size}", "--spp", str(spp)]
            command += ["--mesh", ASSETS / MESHES[scene]] if scene in MESHES else []
            command += ["--seed", str(seed), "--threads", "2", "--quiet", "-o", out, *options]
            process = subprocess.Popen(list(map(str, command)))
            _, status, usage = os.wait4(process.pid, 0)
            if status != 0:
                raise SystemExit(f"failed: {shlex.join(map(str, command))}")
            return OpenEXR.File(str(out)).channels()["RGBA"].pixels.astype(np.float32), usage.ru_utime + usage.ru_stime


def built():
    """The command of this repository."""
    subprocess.run(["cargo", "build", "--release", "--locked", "-p", "translucid-cli"], cwd=ROOT, check=True)
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "translucid"


def is_walk(model):
    return model.startswith("random-walk")


def cached(key, make):
    """An image by its key, made once."""
    path = CACHE / (re.sub(r"[^\w.-]+", "_", "-".join(map(str, key))) + ".npy")
    if not path.exists():
        image = make()
        np.save(path.with_suffix(".part.npy"), image)
        path.with_suffix(".part.npy").replace(path)
    return np.load(path)


def relative_mse(image, reference):
    """Mean of (x − ref)² / (ref² + 0.01) over the pixels that are not background."""
    seen = reference[..., 3] > 0
    x, truth = image[seen][:, :3].astype(float), reference[seen][:, :3].astype(float)
    return float(np.mean((x - truth) ** 2 / (truth**2 + 0.01)))


def relative_variance(first, second, reference):
    """The same of pictures by the difference of two, whatever their mean: that of each has half its square."""
    seen = reference[..., 3] > 0
    x, y, truth = (image[seen][:, :3].astype(float) for image in (first, second, reference))
    return float(np.mean((x - y) ** 2 / 2 / (truth**2 + 0.01)))


def compare_walks(scene, arguments, systems):
    """Prints the tables of a scene that is walked through: converged pictures would take hours."""
    size, spps = arguments.size, arguments.spp
    profile = ["--subsurface", "normalized-diffusion-refined"]
    key = ["profile", scene, size, systems[0].binary_hash[:16]]
    reference = cached(key, lambda: systems[0].image(scene, size, 64, 77, profile)[0])
    start = {s.name: float(np.median([s.image(scene, 2, 1, seed)[1] for seed in range(3)])) for s in systems}
    print(f"\n## {scene}, {size}×{size}, {arguments.model}\n")
    rows, light = {system.name: [] for system in systems}, {system.name: [] for system in systems}
    for spp in spps:
        results = {system.name: [] for system in systems}
        for seed in range(max(2, min(8, 16 // spp))):
            for system in systems:
                results[system.name].append(system.image(scene, size, spp, seed))
        for name, values in results.items():
            images, seconds = zip(*values)
            pairs = list(zip(images[::2], images[1::2]))
            errors = [relative_variance(first, second, reference) for first, second in pairs]
            rows[name].append([float(np.mean(seconds)) - start[name], float(np.mean(errors))])
            light[name] += [image[..., :3].sum(axis=(0, 1)) for image in images]
    ours, theirs = (np.mean(light[system.name], axis=0) for system in systems)
    print(f"Light of all pictures, Cycles over translucid, R, G, B: {(theirs / ours).astype(float).round(4).tolist()}\n")
    print_rows(rows, systems, spps, start)


def compare(scene, arguments, systems):
    """Prints the tables of a scene."""
    if is_walk(arguments.model):
        return compare_walks(scene, arguments, systems)
    size, spps = arguments.size, arguments.spp
    references, start = {}, {}
    for system, samples in zip(systems, arguments.reference_samples):
        key = [system.name, scene, size, samples]
        if system.name == "Cycles":
            key.append(system.version)
        else:
            key += [system.binary_hash[:16]]
        # The judge of translucid is its own ray-traced picture, whatever method is on trial.
        options = {} if system.name == "Cycles" else {"options": []}
        references[system.name] = cached(
            key, lambda: system.image(scene, size, samples, 77, **options)[0]
        )
        # What a picture of four pixels takes: the scene's preparation.
        start[system.name] = float(np.median([system.image(scene, 2, 1, seed)[1] for seed in range(3)]))
    print(f"\n## {scene}, {size}×{size}\n")
    ours, theirs = (references[system.name] for system in systems)
    seen = (ours[..., 3] > 0) & (theirs[..., 3] > 0)
    ratio = theirs[seen][:, :3].sum(axis=0) / ours[seen][:, :3].sum(axis=0)
    print(f"Light of the converged images, Cycles over translucid, R, G, B: {ratio.astype(float).round(4).tolist()}\n")
    rows = {system.name: [] for system in systems}
    for spp in spps:
        seeds = max(1, min(8, 16 // spp))
        results = {system.name: [] for system in systems}
        for seed in range(seeds):
            for system in systems:
                image, seconds = system.image(scene, size, spp, seed)
                error = relative_mse(image, references[system.name])
                results[system.name].append((max(seconds - start[system.name], 1e-3), error))
        for name, values in results.items():
            rows[name].append([float(np.mean(column)) for column in zip(*values)])
    print_rows(rows, systems, spps, start)


def print_rows(rows, systems, spps, start):
    """Prints the time and error of each number of samples, and the times of equal errors."""
    for system in systems:
        print(f"{system.name} takes {start[system.name]:.2f} s of CPU to prepare the scene, left out below.")
    print("\n| samples per pixel | " + " | ".join(f"{s.name} CPU s | relMSE" for s in systems) + " |")
    print("|---" * (1 + 2 * len(systems)) + "|")
    for index, spp in enumerate(spps):
        cells = (f"{rows[s.name][index][0]:.2f} | {rows[s.name][index][1]:.3e}" for s in systems)
        print(f"| {spp} | " + " | ".join(cells) + " |")
    last = spps[-1]
    print()
    for system in systems:
        print(f"{system.name}: {rows[system.name][-1][0] / last:.3f} s of CPU per sample per pixel of the frame")
    equal_error(rows, systems)


def equal_error(rows, systems):
    """CPU times at three levels of error that both reach, by lines through logarithms."""
    curves = {}
    for system in systems:
        seconds, errors = np.array(rows[system.name]).T
        order = np.argsort(errors)
        curves[system.name] = (np.log(errors[order]), np.log(seconds[order]))
    low = max(curve[0][0] for curve in curves.values())
    high = min(curve[0][-1] for curve in curves.values())
    if low >= high:
        print("\nThe errors of the two do not overlap: ask for other samples per pixel.")
        return
    print(f"\n| relMSE | {systems[0].name} CPU s | {systems[1].name} CPU s | ratio |\n|---|---|---|---|")
    for share in (1 / 6, 1 / 2, 5 / 6):
        level = high + (low - high) * share
        ours, theirs = (math.exp(np.interp(level, *curves[system.name])) for system in systems)
        print(f"| {math.exp(level):.2e} | {ours:.2f} | {theirs:.2f} | {ours / theirs:.2f} |")


def check_widths(cycles):
    """Fits the width of Cycles' profile to its picture of an edge of light on a plane."""
    skin = tomllib.loads((ROOT / "scenes" / "head.toml").read_text())["material"][0]
    albedos, lengths = skin["subsurface_color"], skin["subsurface_radius_scale"]
    out, columns, width = str(CACHE / "edge.npy"), 256, 24.0
    command = dict(albedo=albedos, mfp=lengths, columns=columns, width=width, spp=1024)
    cycles.ask(do="edge", out=out, **command)
    picture = np.load(out)[..., :3].mean(axis=0)
    x = (np.arange(columns) + 0.5) / columns * width - width / 2
    print("\n## Widths\n\nWidth d of the profile in mm, fitted to the light across an edge.\n")
    print("| channel | meant, ℓ/s(A) | Cycles | difference |\n|---|---|---|---|")
    for channel, name in enumerate("RGB"):
        albedo, mfp = albedos[channel], lengths[channel]
        meant = mfp / (1.9 - albedo + 3.5 * (albedo - 0.8) ** 2)
        found = fit_width(x, picture[:, channel])
        print(f"| {name} | {meant:.4f} | {found:.4f} | {100 * (found / meant - 1):+.2f} % |")


def fit_width(x, light):
    """Width d for which the edge response of normalized diffusion fits best, any scale."""
    # Cumulative line projection (K₀(x/d) + K₀(x/3d)) / 4πd, with K₀(z) = ∫₀^∞ exp(−z cosh t) dt, of d = 1:
    # ∫_x^∞ K₀(u/a) du = a ∫₀^∞ exp(−(x/a) cosh t) / cosh t dt.
    t = (np.arange(4000) + 0.5) * (12.0 / 4000)
    beyond = lambda z: np.exp(-np.outer(z, np.cosh(t))) @ (1.0 / np.cosh(t)) * (12.0 / 4000)
    grid = np.linspace(0.0, 60.0, 1500)
    tail = (beyond(grid) + 3.0 * beyond(grid / 3.0)) / (4.0 * math.pi)
    response = lambda z: np.where(z > 0, 1.0 - np.interp(np.abs(z), grid, tail), np.interp(np.abs(z), grid, tail))

    def error(d):
        shape = response(x / d)
        scale = (shape @ light) / (shape @ shape)
        return ((light - scale * shape) ** 2).sum()

    low, high = 0.01, 20.0
    for _ in range(200):
        third = (high / low) ** (1 / 3)
        if error(low * third) < error(low * third**2):
            high = low * third**2
        else:
            low = low * third
    return math.sqrt(low * high)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="head,dragon")
    parser.add_argument("--spp", default="1,4,16,64,256", type=lambda text: [int(n) for n in text.split(",")])
    parser.add_argument("--size", default=512, type=int)
    pair = lambda text: [int(n) for n in text.split(",")]
    parser.add_argument("--reference-samples", default="1024,2048", type=pair, help="ours, Cycles'")
    parser.add_argument("--ours", default="", help="further options of translucid render")
    parser.add_argument("--model", default="normalized-diffusion", help="of ours; a random walk is compared with a walk")
    arguments = parser.parse_args()
    cycles = Cycles(arguments.model)
    systems = [Translucid(["--subsurface", arguments.model, *shlex.split(arguments.ours)]), cycles]
    method = "random walk" if is_walk(arguments.model) else "Christensen–Burley"
    print(f"Blender Cycles {cycles.version}, {method}; 2 threads; one after the other in one run.")
    if not is_walk(arguments.model):
        check_widths(cycles)
    for scene in arguments.scenes.split(","):
        compare(scene, arguments, systems)


if __name__ == "__main__":
    require_scans()
    enter_environment()
    import numpy as np
    import OpenEXR

    main()
