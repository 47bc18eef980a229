#!/usr/bin/env python3
"""Error and CPU time of several builds of translucid on the head, the dragon or scene files, in turns.

    python3 benches/peers/programs.py [--scene head,FILE.toml…] [--model random-walk-rough] [--spp 4] [--pairs 4] [--size 512]
                                      [--lines TEXT] "PROGRAM OPTION…" "PROGRAM OPTION…" …

Each program may have further options of `translucid render`, and the scene further lines of a scene file. What a change of
sampling is worth: its relMSE times its CPU time over those of the first program, and that its light is the same. relMSE is
that of peers.py, from pairs of seeds; times are without what a picture of four pixels takes. A file's materials keep their
models.
"""

import argparse
import shlex
import sys

import peers


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--scene", default="head", type=lambda text: text.split(","))
    parser.add_argument("--model", default="random-walk-rough")
    parser.add_argument("--lines", default="")
    for name, value in (("--spp", 4), ("--pairs", 4), ("--size", 512)):
        parser.add_argument(name, default=value, type=int)
    arguments = parser.parse_args()

    for scene in arguments.scene:
        compare(scene, arguments)


def compare(scene, arguments):
    """Prints the table of a scene."""
    systems = []
    for words in map(shlex.split, arguments.programs):
        model = ["--subsurface", arguments.model] if scene in peers.MESHES else []
        systems.append(peers.Translucid([*model, *words[1:]], program=words[0]))
    picture = lambda system, *rest, **options: system.image(scene, *rest, lines=arguments.lines, **options)
    size, pairs = arguments.size, arguments.pairs
    reference = picture(systems[0], size, 64, 77, options=["--subsurface", "normalized-diffusion-refined"])[0]
    start = [min(picture(system, 2, 1, seed)[1] for seed in range(3)) for system in systems]
    errors, seconds, light = (np.zeros((pairs, len(systems), *shape)) for shape in ((), (2,), (3,)))
    for pair in range(pairs):
        for place, system in enumerate(systems):
            images, taken = zip(*(picture(system, size, arguments.spp, 2 * pair + seed) for seed in (0, 1)))
            seconds[pair, place] = np.maximum(np.array(taken) - start[place], 1e-3)
            errors[pair, place] = peers.relative_variance(*images, reference)
            light[pair, place] = sum(image[..., :3].sum(axis=(0, 1)) for image in images)

    print(f"\n{scene}\n")
    print("| program | relMSE | CPU s | relMSE over the first's | least CPU s over the first's | both | light, R, G, B |")
    print("|---|---|---|---|---|---|---|")
    for place, words in enumerate(arguments.programs):
        error = errors[:, place].mean() / errors[:, 0].mean()
        # The least is what other work on the machine disturbs least
        time = seconds[:, place].min() / seconds[:, 0].min()
        same = light[:, place].mean(axis=0) / light[:, 0].mean(axis=0)
        cells = [errors[:, place].mean(), seconds[:, place].mean(), error, time, error * time]
        print(f"| {words} | " + " | ".join(f"{cell:.3g}" for cell in cells) + f" | {same.round(4).tolist()} |")


if __name__ == "__main__":
    if not any(word.endswith(".toml") for word in sys.argv):
        peers.require_scans()
    peers.enter_environment()
    import numpy as np
    import OpenEXR

    peers.np, peers.OpenEXR = np, OpenEXR
    main()
