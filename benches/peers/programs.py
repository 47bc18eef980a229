#!/usr/bin/env python3
"""Error and CPU time of several builds of translucid on the head or the dragon, in turns.

    python3 benches/peers/programs.py [--scene head] [--model random-walk-rough] [--spp 4] [--pairs 4] [--size 512]
                                      [--lines TEXT] "PROGRAM OPTION…" "PROGRAM OPTION…" …

Each program may have further options of `translucid render`, and the scene further lines of a scene file. What a change of
sampling is worth: its relMSE times its CPU time over those of the first program, and that its light is the same. relMSE is
that of peers.py, from pairs of seeds.
"""

import argparse
import shlex

import peers


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--scene", default="head", choices=peers.MESHES)
    parser.add_argument("--model", default="random-walk-rough")
    parser.add_argument("--lines", default="")
    for name, value in (("--spp", 4), ("--pairs", 4), ("--size", 512)):
        parser.add_argument(name, default=value, type=int)
    arguments = parser.parse_args()

    systems = []
    for words in map(shlex.split, arguments.programs):
        systems.append(peers.Translucid(["--subsurface", arguments.model, *words[1:]], program=words[0]))
    picture = lambda system, *rest, **options: system.image(
        arguments.scene, arguments.size, *rest, lines=arguments.lines, **options
    )
    reference = picture(systems[0], 64, 77, options=["--subsurface", "normalized-diffusion-refined"])[0]
    errors, seconds, light = (np.zeros((arguments.pairs, len(systems), *shape)) for shape in ((), (2,), (3,)))
    for pair in range(arguments.pairs):
        for place, system in enumerate(systems):
            images, seconds[pair, place] = zip(*(picture(system, arguments.spp, 2 * pair + seed) for seed in (0, 1)))
            errors[pair, place] = peers.relative_variance(*images, reference)
            light[pair, place] = sum(image[..., :3].sum(axis=(0, 1)) for image in images)

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
    peers.require_scans()
    peers.enter_environment()
    import numpy as np
    import OpenEXR

    peers.np, peers.OpenEXR = np, OpenEXR
    main()
