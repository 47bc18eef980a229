#!/usr/bin/env python3
"""Photons per CPU second of translucid and of MCML 1.2.2 on the same .mci files, one thread each, in turns.

    python3 benches/peers/mcml.py [--program target/release/translucid] [--source URL] [--rounds 5] [--photons 1000000]

README.md says what is measured and how. The first run fetches MCML's source at a pinned commit into target/peers and compiles
it; where it can't be had, the script says so and ends well.
"""

import argparse
import os
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / "target" / "peers" / "mcml"
COMMIT = "92f1a64646b05da94cd2c490fc82ae91d8f64e5a"
CODE = "V1/mcR5unix/mcmlcode"
FLAGS = ["-O3", "-march=native", "-ansi", "-w", "-fno-common"]

# Layers as lines n, mua, mus, g, d; grids as dz, dr and numbers
CASES = {
    "MCML's example, 3 layers": ("0.01 0.01\n40 50 30", ["1.37 1 100 0.9 0.1", "1.37 1 10 0 0.1", "1.37 2 10 0.7 0.2"]),
    "half space, n = 1.4": ("0.01 0.01\n40 50 30", ["1.4 1 90 0.8 1e8"]),
    "pane on two layers": ("0.02 0.05\n20 12 10", ["1.5 0 0 0 0.1", "1.4 2 30 0.8 0.05", "1.33 0.5 20 0.6 0.3"]),
}


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def mcml(source):
    """The program, fetched and compiled once."""
    program = CACHE / "mcml"
    if program.exists():
        return program
    code = CACHE / "source"
    try:
        if not code.exists():
            subprocess.run(["git", "clone", "--quiet", "--no-checkout", source, code], check=True)
        subprocess.run(["git", "-C", code, "checkout", "--quiet", COMMIT], check=True)
        files = sorted((code / CODE).glob("*.c"))
        subprocess.run(["cc", *FLAGS, *files, "-o", program, "-lm"], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        skip(f"MCML can't be had here ({error})")
    return program


def timed(command, folder):
    """CPU seconds of a command."""
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{command[0]} failed")
    return usage.ru_utime + usage.ru_stime


def totals(path):
    """Diffuse reflectance, absorption and transmittance of an .mco file, as printed."""
    words = " ".join(line.split("#")[0] for line in path.read_text().splitlines()).split()
    place = words.index("RAT")
    return [float(word) for word in words[place + 2 : place + 5]]


def errors(path):
    """Their standard errors, from the comments of ours."""
    return [float(line.rsplit(" ", 1)[1]) for line in path.read_text().splitlines() if "standard error" in line]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "target" / "release" / "translucid", type=Path)
    parser.add_argument("--source", default="https://github.com/scottprahl/MCML")
    parser.add_argument("--rounds", default=5, type=int)
    parser.add_argument("--photons", default=1_000_000, type=int)
    arguments = parser.parse_args()
    if not arguments.program.exists():
        skip(f"there is no {arguments.program}: cargo build --release")
    CACHE.mkdir(parents=True, exist_ok=True)
    peer = mcml(arguments.source)
    print("| layers | MCML, photons per CPU second | translucid | ratio | quartiles | worst difference of totals, in errors |")
    print("|---|---|---|---|---|---|")
    for name, (grid, layers) in CASES.items():
        text = "\n".join(["1.0", "1", "{} A", "{}", grid, str(len(layers)), "1", *layers, "1", ""])
        rates, ratios = [], []
        for _ in range(arguments.rounds):
            pair = []
            for system, command in (("mcml", [peer, "mcml.mci"]), ("ours", None)):
                (CACHE / f"{system}.mci").write_text(text.format(f"{system}.mco", arguments.photons))
                ours = [arguments.program.resolve(), "reference", "--layers", "ours.mci", "--threads", "1", "--quiet"]
                pair.append(arguments.photons / timed(command or ours, CACHE))
            rates.append(pair)
            ratios.append(pair[1] / pair[0])
        both = zip(totals(CACHE / "mcml.mco"), totals(CACHE / "ours.mco"), errors(CACHE / "ours.mco"))
        worst = max(abs(a - b) / (2**0.5 * error) for a, b, error in both)
        best = [max(rate) for rate in zip(*rates)]
        low, _, high = statistics.quantiles(ratios, n=4) if len(ratios) > 1 else ratios * 3
        middle = statistics.median(ratios)
        print(f"| {name} | {best[0]:.3g} | {best[1]:.3g} | {middle:.1f} | {low:.1f}–{high:.1f} | {worst:.1f} |", flush=True)


if __name__ == "__main__":
    main()
