#!/usr/bin/env python3
"""Error times CPU time of translucid and Blender Cycles in ten scenes of the kind that artists make.

    python3 benches/peers/artists.py [--blender PYTHON[,PYTHON…]] [--ours WHEELDIR [WHEELDIR …]] [--without-cycles]
                                     [--scenes head,milk] [--spp 8,16] [--pairs 2] [--size 384] [--save DIR] [--json FILE]
                                     [--export DIR] [--denoised]

README.md says what is measured and how. Each PYTHON has a version of bpy, each WHEELDIR an installed wheel of translucid.
Without them the first run installs bpy from PyPI into target/peers, and builds a wheel.
"""

import argparse
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import peers

ROOT, CACHE = peers.ROOT, peers.CACHE / "artists"
SCENES = "head,figure,milk,jade,candle,marble,fruit,soap,hand,food"
PAGE = ROOT / "docs" / "speed" / "how-fast.md"
BEGIN, END = "<!-- measured: python3 benches/peers/artists.py --blender PYTHON,PYTHON{} --write -->\n", "<!-- end of what was measured -->"
PLAIN = {"use_sharing": True, "use_denoising": False}


class Blender:
    """A worker process, see artists_worker.py: a version of Blender with a wheel of translucid."""

    def __init__(self, python, wheel):
        self.name = Path(wheel).resolve().name
        CACHE.mkdir(parents=True, exist_ok=True)
        self.log = CACHE / f"{os.getpid()}-{self.name}.log"
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
    """For each system its preparation, relMSE and seconds by number of samples, light and messages; and its mean picture."""
    size = arguments.size
    # What a picture of four pixels takes: the scene's preparation
    start = {s.name: float(np.median([s.image(file, 2, 1, seed)[1] for seed in range(3)])) for s in systems}
    # Smooth, as it only weighs the errors
    reference = systems[0].image(file, size, arguments.reference_samples, 77, use_denoising=True)[0]
    found = {s.name: {spp: [] for spp in arguments.spp} for s in systems}
    means = {s.name: [] for s in systems}
    for spp in arguments.spp:
        for pair in range(arguments.pairs):
            turns = [(s.name, *s.image(file, size, spp, 1000 * spp + 2 * pair + k)) for k in (0, 1) for s in systems]
            for system in systems:
                (first, seconds), (second, more) = (turn[1:] for turn in turns if turn[0] == system.name)
                error = peers.relative_variance(first, second, reference)
                found[system.name][spp].append((error, max((seconds + more) / 2 - start[system.name], 1e-3)))
                means[system.name].append((first + second) / 2)
    results = {}
    for system in systems:
        light = np.array([image[..., :3].sum(axis=(0, 1), dtype=float) for image in means[system.name]])
        figures = {spp: np.mean(values, axis=0).tolist() for spp, values in found[system.name].items()}
        results[system.name] = {
            "preparation": start[system.name],
            "relMSE, CPU s": figures,
            "pairs": found[system.name],
            "light": light.mean(axis=0).tolist(),
            "said": system.said,
        }
    return results, {name: np.mean(images, axis=0) for name, images in means.items()}


def compare_denoised(scene, file, systems, arguments):
    """Rows of CPU seconds and mean FLIP of denoised pictures, against each engine's own of many samples, and of the time to the
    FLIP of Cycles over its time."""
    from flip_evaluator import evaluate

    shown = lambda image: np.ascontiguousarray(np.clip(encoded(image[..., :3]), 0, 1), dtype=np.float32)
    found = {}
    for system in systems:
        start = system.image(file, 2, 1, 0)[1]
        truth = shown(system.image(file, arguments.size, arguments.reference_samples, 77, use_denoising=True)[0])
        for spp in arguments.spp:
            images = [system.image(file, arguments.size, spp, seed, use_denoising=True) for seed in range(arguments.pairs)]
            error = np.mean([evaluate(truth, shown(image), "LDR")[1] for image, _ in images])
            seconds = np.mean([seconds for _, seconds in images]) - start
            found.setdefault(system.name, []).append((seconds, error))
    # Of two straight lines through the logarithms, where the second has its mean
    other = np.log(list(found.values())[-1])
    to_same = lambda points: np.polyval(np.polyfit(np.log(points)[:, 1], np.log(points)[:, 0], 1), other[:, 1].mean())
    rows = []
    for name, points in found.items():
        ratio = math.exp(to_same(points) - to_same(np.exp(other)))
        cells = [f"{seconds:.1f} s · {error:.4f}" for seconds, error in points]
        rows.append(f"| {' | '.join([scene, name, *cells, f'{ratio:.2f}'])} |")
    print("\n".join(rows), flush=True)
    return rows


def geometric_mean(values):
    return float(np.exp(np.mean(np.log(values))))


def line(scene, name, ours, other, spps):
    """A row of the table, and the ratios of relMSE times CPU time in it."""
    cost = lambda result, spp: math.prod(result["relMSE, CPU s"][spp])
    ratios = [cost(ours, spp) / cost(other, spp) for spp in spps]
    words = [f"{error:.2e} · {seconds:.1f} s" for error, seconds in (result["relMSE, CPU s"][spps[-1]] for result in (ours, other))]
    light = " ".join(f"{a / b:.3f}" for a, b in zip(ours["light"], other["light"]))
    return row(scene, name, ratios, *words, light), ratios


def row(scene, name, ratios, *cells):
    return f"| {' | '.join([scene, name, *(f'{ratio:.2f}' for ratio in ratios), f'**{geometric_mean(ratios):.2f}**', *cells])} |"


def encoded(x):
    """sRGB codes of linear light."""
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def save(folder, version, scene, means):
    """Pictures as PNG, side by side: ours, the other, and their difference, amplified around gray."""
    first, last = (list(means.values())[k][..., :3] for k in (0, -1))
    difference = 0.5 + 4 * (first - last) / (first + last + 0.1)
    sheet = np.concatenate([encoded(np.clip(first, 0, 1)), encoded(np.clip(last, 0, 1)), np.clip(difference, 0, 1)], axis=1)
    Path(folder).mkdir(parents=True, exist_ok=True)
    png.write(Path(folder) / f"{scene}-{version}.png", (sheet * 255 + 0.5).astype(np.uint8))


def measure(python, wheels, arguments):
    """All scenes in one version of Blender; its name, the rows of the table and all figures."""
    blenders = [Blender(python, wheel) for wheel in wheels]
    systems = [System(blender.name, blender, "TRANSLUCID") for blender in blenders]
    if not arguments.without_cycles:
        systems.append(System("Cycles", blenders[0], "CYCLES"))
    # Each is compared with Cycles, or with the first build
    other = systems[0 if arguments.without_cycles else -1].name
    compared = [system.name for system in systems if system.name != other]
    rows, ratios, kept = [], {name: [] for name in compared}, {}
    for scene in arguments.scenes.split(","):
        file = CACHE / f"{scene}-{os.getpid()}.blend"
        answer = blenders[0].ask(do="build", scene=scene, file=str(file))
        version = answer["version"].split()[0]
        for name in answer["missing"]:
            print(f"{scene}: {name} is not in the folder TRANSLUCID_ASSETS", flush=True)
        if not answer["made"]:
            print(f"{scene}: left out", flush=True)
            continue
        if arguments.export:
            folder = Path(arguments.export).resolve() / f"{scene}-{version}"
            said = blenders[0].ask(do="export", file=str(file), size=arguments.size, folder=str(folder))["said"]
            print("\n".join([*said, str(folder / "scene.toml")]), flush=True)
            continue
        if arguments.denoised:
            rows += compare_denoised(scene, file, systems, arguments)
            file.unlink()
            continue
        kept[scene], means = compare(file, systems, arguments)
        file.unlink()
        for message in sorted({text for system in systems for text in system.said}):
            print(f"{scene}: {message}", flush=True)
        for name in compared:
            text, found = line(scene, name, kept[scene][name], kept[scene][other], arguments.spp)
            ratios[name].append(found)
            rows.append(text)
            print(text, flush=True)
        if arguments.save:
            save(arguments.save, version, scene, means)
    for blender in blenders:
        blender.close()
    for name in compared if kept else []:
        rows.append(row("geometric mean", name, [geometric_mean(column) for column in zip(*ratios[name])], "", "", ""))
        print(rows[-1], flush=True)
    return version, rows, kept


def installed_wheel():
    """The folder of this repository's wheel, built for release."""
    wheel = subprocess.run([ROOT / ".ci" / "wheel", "release"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()[-1]
    folder = peers.CACHE / "translucid"
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
    parser.add_argument("--denoised", action="store_true", help="CPU seconds and FLIP of denoised pictures; needs flip-evaluator")
    parser.add_argument("--json", type=Path, help="file for all figures")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/speed/how-fast.md")
    arguments = parser.parse_args()
    if arguments.write and arguments.denoised:
        parser.error("--write is for the tables of noise")
    if arguments.denoised and len(arguments.spp) < 2:
        parser.error("--denoised fits a line, and needs two numbers of samples in --spp")
    wheels = arguments.ours or [installed_wheel()]
    text, kept = [], {}
    last = arguments.spp[-1]
    head = ["scene", "renderer", *(f"{spp} samples" for spp in arguments.spp), "mean"]
    head += [f"relMSE and CPU time at {last}", "… of the other", "light over the other's, R, G, B"]
    if arguments.denoised:
        head = ["scene", "renderer", *(f"{spp} samples: CPU, FLIP" for spp in arguments.spp), "time to the same FLIP"]
    for python in arguments.blender.split(","):
        lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
        print("\n".join(["", *lines]), flush=True)
        version, rows, found = measure(python, wheels, arguments)
        kept[version] = found
        text += [f"Blender {version}, {arguments.size}² pixels, pairs of seeds: {arguments.pairs}", "", *lines, *rows, ""]
        if arguments.json:
            arguments.json.write_text(json.dumps(kept, indent=1))
    if arguments.write:
        begin = BEGIN.format(" --denoised" if arguments.denoised else "")
        before, rest = PAGE.read_text().split(begin)
        PAGE.write_text(f"{before}{begin}\n" + "\n".join(text) + f"\n{END}{rest.split(END, 1)[1]}")


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
