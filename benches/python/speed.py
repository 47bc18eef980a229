"""Speed of the Python module against the Rust slice functions, NumPy and a plain Python loop, in one run.

Run with the module installed from a release build (`maturin develop --release`), on an idle machine:

    python benches/python/speed.py

Times are the best of some, in nanoseconds for each of 10^7 numbers. Ratios are to the Rust function that does the same:
with `out=` to the one that writes into memory that is there, else to the one that asks for it.
"""

import math
import pathlib
import subprocess
import timeit

import numpy as np

import translucid

ROOT = pathlib.Path(__file__).resolve().parents[2]
COUNT = 10_000_000
REPETITIONS = 9
LOOP = 100_000


def rust():
    """Nanoseconds of the slice functions: into memory that is there, and into fresh memory."""
    words = ["cargo", "run", "--release", "-q", "-p", "translucid-profile", "--example", "slice_speed"]
    text = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    rows = (line.split() for line in text.splitlines())
    return {(model, name): (float(there), float(fresh)) for model, name, there, fresh in rows}


def best(work, count=COUNT, repetitions=REPETITIONS):
    return 1e9 / count * min(timeit.repeat(work, number=1, repeat=repetitions))


def numpy_eval(d):
    """Normalized diffusion as one would write it with NumPy."""
    return lambda r: 0.5 * (np.exp(-r / d) + np.exp(-r / (3 * d))) / (8 * np.pi * d * r)


def numpy_sample(d):
    """Its two exponentials, chosen by the same number."""
    return lambda u: np.where(u < 0.25, -d * np.log1p(-4 * np.minimum(u, 0.25 - 1e-9)), -3 * d * np.log((1 - u) / 0.75))


def loop(f):
    return lambda numbers: [f(x) for x in numbers]


def main():
    fractions = (np.arange(COUNT) * 0.6180339887498949) % 1.0
    radii = 10.0 * fractions
    out = np.empty(COUNT)
    slices = rust()
    print(f"{'':<30} {'eval':>8} {'ratio':>6} {'sample':>8} {'ratio':>6}")

    def line(name, times, model, fresh=True):
        cells = (f"{t:8.2f} {t / slices[model, n][fresh]:6.2f}" for n, t in zip(("eval", "sample"), times))
        print(f"{name:<30} {' '.join(cells)}")

    for model in ("normalized-diffusion-refined", "normalized-diffusion"):
        profile = translucid.Profile(model, surface_albedo=0.5, mfp=1.0)
        print(model)
        line("  Rust, memory there", [slices[model, name][0] for name in ("eval", "sample")], model, fresh=False)
        line("  Rust, fresh memory", [slices[model, name][1] for name in ("eval", "sample")], model)
        works = ((profile.eval, radii), (profile.sample, fractions))
        line("  translucid, out=", [best(lambda: f(x, out=out)) for f, x in works], model, fresh=False)
        line("  translucid", [best(lambda: f(x)) for f, x in works], model)
        line("  translucid, every second", [best(lambda: f(x[::2]), COUNT // 2) for f, x in works], model)
        single = [(f, x.astype(np.float32)) for f, x in works]
        line("  translucid, float32", [best(lambda: f(x)) for f, x in single], model)
        line("  translucid, Python loop", [best(lambda: loop(f)(x[:LOOP].tolist()), LOOP) for f, x in works], model)
    d = 1.0 / (1.9 - 0.5 + 3.5 * 0.3**2)
    e, s = numpy_eval(d), numpy_sample(d)
    line("  NumPy", [best(lambda: e(radii + 1e-9)), best(lambda: s(fractions))], model)

    def python_eval(r):
        return 0.5 * (math.exp(-r / d) + math.exp(-r / (3 * d))) / (8 * math.pi * d * r)

    def python_sample(u):
        return -d * math.log(1 - 4 * u) if u < 0.25 else -3 * d * math.log((1 - u) / 0.75)

    plain = ((python_eval, radii[1 : LOOP + 1].tolist()), (python_sample, fractions[:LOOP].tolist()))
    line("  plain Python loop", [best(lambda: loop(f)(x), LOOP) for f, x in plain], model)

    timer = timeit.Timer("f(1.0)", globals={"f": profile.eval})
    empty = timeit.Timer("f(1.0)", globals={"f": float})
    one = 1e9 * min(timer.repeat(9, 200_000)) / 200_000
    nothing = 1e9 * min(empty.repeat(9, 200_000)) / 200_000
    print(f"one number: {one:.0f} ns a call (float(1.0): {nothing:.0f} ns)")


if __name__ == "__main__":
    main()
