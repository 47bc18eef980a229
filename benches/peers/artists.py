#!/usr/bin/env python3
"""Error times CPU time of translucid and Blender Cycles in ten scenes of the kind that artists make.

    python3 benches/peers/artists.py [--blender PYTHON[,PYTHON…]] [--ours WHEELDIR [WHEELDIR …]] [--without-cycles]
                                     [--scenes head,milk] [--spp 8,16] [--pairs 2] [--size 384] [--save DIR] [--json FILE]
                                     [--export DIR]

README.md says what is measured and how. Each PYTHON has a version of bpy, each WHEELDIR an installed wheel of translucid.
Without them the first run installs bpy from PyPI into target/peers, and builds a wheel.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import peers

ROOT, CACHE = peers.ROOT, peers.CACHE / "artists"
SCENES = "head,figure,milk,jade,candle,marble,fruit,soap,hand,food"
PAGE = ROOT / "docs" / "speed" / "how-fast.md"
BEGIN, END = "<!-- measured: python3 benches/peers/artists.py --write -->\n", "<!-- end of what was measured -->"
PLAIN = {"use_sharing": True, "use_denoising": False}


class Blender:
    """A worker process, see artists_worker.py: a version of Blender with a wheel of translucid."""

    def __init__(self, python, wheel):
        self.name = Path(wheel).name
        CACHE.mkdir(parents=True, exist_ok=True)
        self.log = CACHE / f"{os.getpid()}-{id(self)}.log"
        environment = {**os.environ, "PYTHONPATH": str(Path(wheel).resolve())}
        worker = [python, Path(__file__).with_name("artists_worker.py")]
        pipe, log = subprocess.PIPE, open(self.log, "w")
        self.process = subprocess.Popen(worker, stdin=pipe, stdout=pipe, stderr=log, text=True, env=environment)

    def ask(self, **command):
        self.process.stdin.write(json.dumps(command) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit(f"Blender has ended; see {self.log}")
        return json.loads(answer)

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.log.unlink()


class System:
    """An engine of a worker, in turns with others."""

    def __init__(self, name, blender, engine):
        self.name, self.blender, self.engine = name, blender, engine
        self.said = []

    def image(self, file, size, spp, seed, **settings):
        out = CACHE / f"{os.getpid()}.npy"
        settings = PLAIN | settings
        command = dict(file=str(file), engine=self.engine, size=size, spp=spp, seed=seed, out=str(out), settings=settings)
        answer = self.blender.ask(do="render", **command)
        self.said = answer["said"]
        image = np.load(out)
        out.unlink()
        return image, answer["cpu"]


def compare(file, systems, arguments):
    """The measures of a scene: for each system by number of samples relMSE and seconds, its light, its messages, its picture."""
    size = arguments.size
    # What a picture of four pixels takes: the scene's preparation
    start = {s.name: float(np.median([s.image(file, 2, 1, seed)[1] for seed in range(3)])) for s in systems}
    # Smooth, so that its noise does not count; it only weighs the errors
    reference = systems[0].image(file, size, arguments.reference_samples, 77, use_denoising=True)[0]
    results = {s.name: {"preparation": start[s.name], "samples": {}} for s in systems}
    pictures = {s.name: [] for s in systems}
    for spp in arguments.spp:
        found = {s.name: [] for s in systems}
        for pair in range(arguments.pairs):
            images = {s.name: [] for s in systems}
            for seed in (2 * pair, 2 * pair + 1):
                for system in systems:
                    images[system.name].append(system.image(file, size, spp, 1000 * spp + seed))
            for name, ((first, seconds), (second, more)) in images.items():
                error = peers.relative_variance(first, second, reference)
                found[name].append((error, max((seconds + more) / 2 - start[name], 1e-3)))
                pictures[name] += [(first + second) / 2]
        for name, values in found.items():
            errors, seconds = np.array(values).T
            results[name]["samples"][spp] = {"relMSE": errors.mean(), "cpu": seconds.mean(), "pairs": values}
    for system in systems:
        light = np.array([picture[..., :3].sum(axis=(0, 1), dtype=float) for picture in pictures[system.name]])
        results[system.name]["light"] = light.mean(axis=0).tolist()
        results[system.name]["light_error"] = (light.std(axis=0, ddof=1) / len(light) ** 0.5).tolist() if len(light) > 1 else [0.0] * 3
        results[system.name]["said"] = system.said
    means = {s.name: np.mean(pictures[s.name], axis=0) for s in systems}
    return results, means


def cost(result, spp):
    return result["samples"][spp]["relMSE"] * result["samples"][spp]["cpu"]


def geometric_mean(values):
    return float(np.exp(np.mean(np.log(values))))


def row(name, results, systems, spps):
    """A line of the table: each system over the last one, which is Cycles, or the first build."""
    base = results[systems[-1].name if systems[-1].engine == "CYCLES" else systems[0].name]
    lines = []
    for system in [s for s in systems if results[s.name] is not base]:
        ours = results[system.name]
        ratios = [cost(ours, spp) / cost(base, spp) for spp in spps]
        light = np.array(ours["light"]) / np.array(base["light"])
        doubt = np.hypot(*(np.array(r["light_error"]) / np.array(r["light"]) for r in (ours, base)))
        cells = [f"{ratio:.2f}" for ratio in ratios] + [f"**{geometric_mean(ratios):.2f}**"]
        last = spps[-1]
        cells += [f"{r['samples'][last]['relMSE']:.2e} · {r['samples'][last]['cpu']:.1f} s" for r in (ours, base)]
        cells.append(" ".join(f"{x:.3f}" for x in light) + f" (±{doubt.max():.3f})")
        lines.append((geometric_mean(ratios), f"| {name} | {system.name} | " + " | ".join(cells) + " |"))
    return lines


def save(folder, version, scene, means):
    """Pictures as PNG, side by side: ours, the other, and their difference, amplified around gray."""
    first, last = (list(means.values())[k][..., :3] for k in (0, -1))
    difference = 0.5 + 4 * (first - last) / (first + last + 0.1)
    encode = lambda x: np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    sheet = np.concatenate([encode(np.clip(first, 0, 1)), encode(np.clip(last, 0, 1)), np.clip(difference, 0, 1)], axis=1)
    Path(folder).mkdir(parents=True, exist_ok=True)
    png.write(Path(folder) / f"{scene}-{version}.png", (sheet * 255 + 0.5).astype(np.uint8))


def measure(python, wheels, arguments):
    """All scenes in one version of Blender; lines of the table."""
    blenders = [Blender(python, wheel) for wheel in wheels]
    systems = [System(b.name if len(blenders) > 1 else "translucid", b, "TRANSLUCID") for b in blenders]
    if not arguments.without_cycles:
        systems.append(System("Cycles", blenders[0], "CYCLES"))
    lines, ratios, kept = [], {}, {}
    for scene in arguments.scenes.split(","):
        folder = CACHE / "files"
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"{scene}-{os.getpid()}.blend"
        answer = blenders[0].ask(do="build", scene=scene, file=str(file))
        version = answer["version"].split()[0]
        for name in answer["missing"]:
            print(f"{scene}: {name} is not in the folder TRANSLUCID_ASSETS", flush=True)
        if not answer["made"]:
            print(f"{scene}: left out", flush=True)
            continue
        if arguments.export:
            folder = Path(arguments.export).resolve() / f"{scene}-{version}"
            blenders[0].ask(do="export", file=str(file), size=arguments.size, folder=str(folder))
            print(f"{folder / 'scene.toml'}", flush=True)
            continue
        results, means = compare(file, systems, arguments)
        file.unlink()
        kept[scene] = results
        for message in sorted({text for s in systems for text in s.said}):
            print(f"{scene}: {message}", flush=True)
        for system, (ratio, line) in zip(systems if arguments.without_cycles is False else systems[1:], row(scene, results, systems, arguments.spp)):
            ratios.setdefault(system.name, []).append(ratio)
            lines.append(line)
            print(line, flush=True)
        if arguments.save:
            save(arguments.save, version, scene, means)
    for blender in blenders:
        blender.close()
    for name, values in ratios.items():
        lines.append(f"| geometric mean | {name} | " + " | " * len(arguments.spp) + f"**{geometric_mean(values):.2f}** | | | |")
        print(lines[-1], flush=True)
    return version, lines, kept


def installed_wheel():
    """The folder of this repository's wheel, built for release."""
    wheel = subprocess.run([ROOT / ".ci" / "wheel", "release"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()[-1]
    folder = peers.CACHE / "wheel"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--upgrade", "--target", folder, wheel]
    subprocess.run(pip, check=True)
    return str(folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blender", default=sys.executable, help="Pythons with bpy, with commas between")
    parser.add_argument("--ours", nargs="+", help="folders of installed wheels; several are compared in turns")
    parser.add_argument("--without-cycles", action="store_true", help="compare the wheels alone")
    parser.add_argument("--scenes", default=SCENES)
    parser.add_argument("--spp", default="8,16", type=lambda text: [int(n) for n in text.split(",")])
    parser.add_argument("--pairs", default=2, type=int)
    parser.add_argument("--size", default=384, type=int)
    parser.add_argument("--reference-samples", default=64, type=int)
    parser.add_argument("--save", help="folder for pictures of both, and their difference")
    parser.add_argument("--export", help="folder for the scenes as files of the command translucid; nothing is measured")
    parser.add_argument("--json", type=Path, help="file for all figures")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/speed/how-fast.md")
    arguments = parser.parse_args()
    wheels = arguments.ours or [installed_wheel()]
    text, kept = [], {}
    for python in arguments.blender.split(","):
        head = ["scene", "renderer", *(f"{spp} samples" for spp in arguments.spp), "mean", f"relMSE · CPU at {arguments.spp[-1]}", "of the other", "light over the other's"]
        lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
        print(f"\n{lines[0]}\n{lines[1]}", flush=True)
        version, more, kept_here = measure(python, wheels, arguments)
        kept[version] = kept_here
        text += [f"Blender {version}:", "", *lines, *more, ""]
        if arguments.json:
            arguments.json.write_text(json.dumps(kept, indent=1))
    if arguments.write:
        before, rest = PAGE.read_text().split(BEGIN)
        PAGE.write_text(f"{before}{BEGIN}\n" + "\n".join(text) + f"\n{END}{rest.split(END, 1)[1]}")


if __name__ == "__main__":
    if not any(word.startswith("--blender") for word in sys.argv):
        peers.enter_environment()
    try:
        import numpy as np
    except ImportError:
        # The first Blender's Python has it
        python = sys.argv[sys.argv.index("--blender") + 1].split(",")[0]
        os.execv(python, [python, *sys.argv])
    import png

    peers.np = np
    main()
