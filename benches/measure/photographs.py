#!/usr/bin/env python3
"""Measures materials in synthetic photographs of Mitsuba 3, and prints how far from the truth the numbers are.

    python3 benches/measure/photographs.py [--collisions 6e6] [--write]

README.md says what is measured and how. The first run installs mitsuba from PyPI into target/peers/mitsuba; where it can't
be had, it says so and ends well. --write puts the first table into docs/accuracy/measure.md.
"""

import argparse
import functools
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / "target" / "peers"
VENV = CACHE / "mitsuba"
PACKAGES = ["mitsuba==3.9.1", "numpy"]
PAGE = ROOT / "docs" / "accuracy" / "measure.md"


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def enter_environment():
    """Goes on in the virtual environment that has mitsuba and numpy."""
    python = VENV / "bin" / "python"
    if Path(sys.prefix).resolve() == VENV.resolve():
        return
    try:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", VENV], check=True)
        if subprocess.run([python, "-c", "import mitsuba, numpy"], capture_output=True).returncode != 0:
            print(f"installing {', '.join(PACKAGES)} into {VENV}", flush=True)
            subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        skip(f"{PACKAGES[0]} can't be had here ({error})")
    os.execv(python, [str(python), *sys.argv])


enter_environment()

import numpy as np  # noqa: E402

# Media by albedo A of a pencil of light without a boundary, mean cosine g and relative index; three channels of a photograph each
MEDIA = {
    "isotropic, index-matched": {
        "edge": [(0.1, 0.0, 1.0), (0.3, 0.0, 1.0), (0.5, 0.0, 1.0), (0.7, 0.0, 1.0), (0.85, 0.0, 1.0), (0.95, 0.0, 1.0)],
        "spot": [(0.1, 0.0, 1.0), (0.3, 0.0, 1.0), (0.5, 0.0, 1.0), (0.7, 0.0, 1.0), (0.85, 0.0, 1.0), (0.98, 0.0, 1.0)],
    },
    "dielectric, η = 1.4": {setup: [(0.3, 0.0, 1.4), (0.6, 0.0, 1.4), (0.8, 0.0, 1.4)] for setup in ("edge", "spot")},
    "forward scattering": {
        "edge": [(0.3, 0.8, 1.0), (0.5, 0.8, 1.0), (0.7, 0.8, 1.0)],
        "spot": [(0.3, 0.9, 1.0), (0.5, 0.9, 1.0), (0.7, 0.9, 1.0)],
    },
}
# Photographs of a medium: mean free path [mm], blur in pixels, dark corners
SETUPS = [(0.1, 0.8, 0.0), (0.6, 1.5, 0.05), (5.0, 1.0, 0.10)]
COLUMNS, ROWS = 192, 96
# Spots: the picture's side, the light's radius, and how far it is off the middle, in pixels
SPOT, RADIUS, OFFSET = 96, 7.0, (3.3, -2.6)
# Paths of a photograph's channel, at most
MOST_PATHS = 2e5


def h_function(alpha, mu):
    """Chandrasekhar's H function of isotropic scatterers."""
    t = (np.arange(20000) + 0.5) / 20000 * (math.pi / 2)
    k = np.tan(t) / mu
    return math.exp(-np.mean(np.log(1 - alpha * np.arctan(k) / k)) / 2)


def searchlight_albedo(alpha):
    """1 - H(1) sqrt(1 - alpha), the albedo of a matched isotropic half space for a pencil of light."""
    return 1 - h_function(alpha, 1) * math.sqrt(1 - alpha)


def dielectric_albedo(alpha, eta):
    """The same below a smooth surface, of the light that enters [M. M. R. Williams 2006]:

    y(mu) = H(1) mu / (1 + mu) + alpha/2 int F(m)/m H(m)^2 y(m) / (1/mu + 1/m) dm, A = alpha/2 int (1 - F) H y dmu
    """
    critical = math.sqrt(1 - 1 / eta ** 2)
    x, weights = np.polynomial.legendre.leggauss(40)
    # Below the critical angle all is reflected, and the reflectance has a root there
    low, high = (x + 1) / 2 * critical, critical + (1 - critical) * ((x + 1) / 2) ** 2
    mu = np.concatenate([low, high])
    weight = np.concatenate([weights / 2 * critical, weights / 2 * (1 - critical) * (x + 1)])
    outside = np.sqrt(np.maximum(1 - eta ** 2 * (1 - mu ** 2), 0))
    parallel = ((outside - mu / eta) / (outside + mu / eta)) ** 2
    across = ((outside - mu * eta) / (outside + mu * eta)) ** 2
    reflected = np.where(mu <= critical, 1, (parallel + across) / 2)
    h = np.array([h_function(alpha, m) for m in mu])
    kernel = alpha / 2 * weight * reflected / mu * h ** 2 / (1 / mu[:, None] + 1 / mu)
    y = np.linalg.solve(np.eye(len(mu)) - kernel, h_function(alpha, 1) * mu / (1 + mu))
    return alpha / 2 * np.sum(weight * (1 - reflected) * h * y)


@functools.cache
def alpha_of(albedo, of_alpha=searchlight_albedo):
    """The single-scattering albedo of a matched isotropic half space with an albedo, for a pencil of light or as `of_alpha` says."""
    low, high = 0.0, 1 - 1e-9
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if of_alpha(middle) < albedo else (low, middle)
    return (low + high) / 2


def decay(alpha):
    """k0 with alpha artanh(k0) / k0 = 1: light falls as exp(-k0 r)."""
    low, high = 1e-9, 1 - 1e-15
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if alpha * math.atanh(middle) / middle < 1 else (low, middle)
    return low


def pixel_of(setup, medium):
    """Width of a pixel in transport mean free paths: the picture shows what light creeps over."""
    columns, widest = (COLUMNS, 60) if setup == "edge" else (SPOT, 40)
    return 2 * min(max(5 / decay(alpha_of(medium[0])), 8), widest) / columns


def paths_of(setup, medium, part, collisions):
    """Paths of a camera that looks straight down on a point of a half space: how far from it each gets out, in transport mean
    free paths along two axes, and its weight. The mean weight is the piece's albedo times what it sends up through its surface.

    Each path ends on a plane of light, whose color is the place: red and green rise along its axes, blue is 1.
    The camera lies below the surface and sees neither the light nor what a smooth surface reflects.
    """
    albedo, g, eta = medium
    alpha_prime = alpha_of(albedo)
    # sigma'_t = 1: sigma_s = alpha' / (1 - g), sigma_a = 1 - alpha'
    sigma_s, sigma_a = alpha_prime / (1 - g), 1 - alpha_prime
    alpha = sigma_s / (sigma_s + sigma_a)
    side = math.ceil(math.sqrt(min(MOST_PATHS, collisions * (1 - alpha) / (1 - albedo))))
    path = CACHE / "measure" / f"{setup}-{albedo}-{g}-{eta}-{part}-{side}.npy"
    # Through a smooth surface a part gets out, which spreads over more directions
    seen = (1 - ((eta - 1) / (eta + 1)) ** 2) / eta ** 2
    if path.exists():
        return np.load(path) * [1, 1, seen]
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    transform = mi.ScalarTransform4f
    # The renderer starts rays so far from surfaces that a nearer light would be missed from the farthest exits that count
    half, reach = 400.0, pixel_of(setup, medium) * (COLUMNS if setup == "edge" else SPOT)
    gap = 1e-4 * (1 + max(reach, 6 / decay(alpha_prime) if setup == "edge" else 0))
    ramp = np.zeros((2, 2, 3), np.float32)
    ramp[:, 1, 0], ramp[1, :, 1], ramp[:, :, 2] = 1, 1, 1
    # Where the renderer's roulette makes weights of no finite variance, paths end when nothing is left of them
    plays = alpha < 0.97
    ends = {"max_depth": -1, "rr_depth": 1} if plays else \
        {"max_depth": int(math.log(1e-5) / math.log(alpha)) + 2, "rr_depth": 1000000}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", **ends},
        "inside": {"type": "homogeneous", "albedo": alpha, "sigma_t": sigma_s + sigma_a, "phase": {"type": "hg", "g": g}},
        "sensor": {
            "type": "orthographic", "near_clip": 1e-6, "far_clip": 1e6, "medium": {"type": "ref", "id": "inside"},
            "to_world": transform().look_at(origin=[0, 0, -1e-3], target=[0, 0, -1], up=[0, 1, 0])
            @ transform().scale([1e-6, 1e-6, 1]),
            "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                     "component_format": "float32"},
            "sampler": {"type": "independent", "sample_count": 1},
        },
        # No path samples the light through a smooth boundary, of index 1, too: each meets it once or never
        "piece": {"type": "cube", "to_world": transform().translate([0, 0, -half]) @ transform().scale(half),
                  "bsdf": {"type": "dielectric", "int_ior": eta, "ext_ior": 1.0},
                  "interior": {"type": "ref", "id": "inside"}},
        "light": {"type": "rectangle", "bsdf": {"type": "diffuse", "reflectance": 0.0},
                  "emitter": {"type": "area", "radiance": {"type": "bitmap", "bitmap": mi.Bitmap(ramp), "raw": True,
                                                           "wrap_mode": "clamp"}},
                  "to_world": transform().translate([0, 0, gap]) @ transform().scale(2 * half)
                  @ transform().rotate([1, 0, 0], 180)},
    })
    seed = int(1e4 * albedo) + int(1e6 * g) + int(1e7 * eta) + 7919 * part + (0 if setup == "edge" else 104729)
    begin = time.process_time()
    found = np.array(mi.render(scene, spp=1, seed=seed)).reshape(-1, 3).astype(float)
    weight = found[:, 2]
    places = (found[:, :2] / np.maximum(weight, 1e-30)[:, None] - 0.5) * 2 * half
    found = np.column_stack([places, weight])
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, found.astype(np.float32))
    print(f"{path.stem}: {time.process_time() - begin:.0f} CPU s, total {weight.mean() * seen:.4f} "
          f"± {weight.std() * seen / side:.4f}", flush=True)
    return found * [1, 1, seen]


def blurred(values, blur):
    """Means over a Gaussian of such a standard deviation, along every axis; the ends go on."""
    reach = np.arange(-12, 13)
    kernel = np.exp(-0.5 * (reach / blur) ** 2)
    for axis in range(values.ndim):
        wide = np.pad(values, [(12, 12) if i == axis else (0, 0) for i in range(values.ndim)], mode="edge")
        values = np.apply_along_axis(np.convolve, axis, wide, kernel / kernel.sum(), "valid")
    return values


def light_of(setup, medium, part, blur, collisions, generator):
    """What the camera sees of the piece and of white paper in its place, and the pixel's width [ℓ'].

    A path may begin anywhere on the piece. Around a spot each ends anywhere in the light, and is seen where it began and the
    lens blurs it to. Of an edge each row has paths of its own, which begin in all of its pixels.
    """
    pixel = pixel_of(setup, medium)
    paths = paths_of(setup, medium, part, collisions)
    away, weight, count = paths[:, :2] / pixel, paths[:, 2], len(paths)
    lens = blur * generator.normal(size=(count, 2))
    if setup == "edge":
        row = np.arange(count) * ROWS // count
        # The first pixel from which a path ends in the light
        first = np.floor(COLUMNS / 2 - away[:, 0] + lens[:, 0] + generator.uniform(size=count))
        first = np.clip(first, 0, COLUMNS).astype(int)
        seen = np.bincount(row * (COLUMNS + 1) + first, weights=weight, minlength=ROWS * (COLUMNS + 1))
        seen = seen.reshape(ROWS, COLUMNS + 1).cumsum(1)[:, :COLUMNS] / np.bincount(row)[:, None]
        return seen, np.ones(seen.shape), pixel
    radius, angle = RADIUS * np.sqrt(generator.uniform(size=count)), 2 * math.pi * generator.uniform(size=count)
    end = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]) + OFFSET
    x, y = (end - away + lens + SPOT / 2).T
    seen, _, _ = np.histogram2d(y, x, SPOT, ((0, SPOT), (0, SPOT)), weights=weight)
    fine = (np.arange(8 * SPOT) + 0.5) / 8 - SPOT / 2
    disk = np.hypot(fine - OFFSET[0], fine[:, None] - OFFSET[1]) < RADIUS
    return seen * math.pi * RADIUS ** 2 / count, blurred(disk.reshape(SPOT, 8, SPOT, 8).mean((1, 3)), blur), pixel


def photographs(setup, media, part, collisions, generator):
    """A photograph of red, green and blue, that of white paper of reflectance 0.9 in place of the piece, the millimeters per
    pixel, and the true mean free paths [mm]."""
    mfp, blur, dark = SETUPS[part]
    channels, papers, lengths, mm = [], [], [], None
    for medium in media:
        light, white, pixel = light_of(setup, medium, part, blur, collisions, generator)
        mm = mm or mfp * pixel
        lengths.append(mm / pixel)
        channels.append(light)
        papers.append(0.9 * white)
    pair = [np.stack(channels, -1), np.stack(papers, -1)]
    y, x = np.mgrid[-1:1:pair[0].shape[0] * 1j, -1:1:pair[0].shape[1] * 1j]
    corners = (1 - dark * (x * x + y * y) / 2)[..., None]
    exposure = 0.95 / max(light.max() for light in pair)
    taken = []
    for light in pair:
        light = light * corners * exposure
        light = light + 0.01 * np.sqrt(np.maximum(light, 0)) * generator.normal(size=light.shape)
        taken.append(light)
    return taken, mm, lengths


def save(photo, path):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    if path.suffix == ".exr":
        # 16 bits above a black level that is subtracted, as cameras have one
        mi.Bitmap((np.round(photo * 65535) / 65535).astype(np.float32)).write(str(path))
    else:
        photo = np.clip(photo, 0, 1)
        coded = np.where(photo <= 0.0031308, 12.92 * photo, 1.055 * np.maximum(photo, 1e-9) ** (1 / 2.4) - 0.055)
        mi.Bitmap(np.round(255 * coded).astype(np.uint8)).write(str(path), quality=92)


def words_of(setup, pair, coding, mm, program, directory, *more, rim=False):
    """The command that measures a photograph, which is written into a directory; white is the paper's photograph, or a card at
    the rim."""
    photo, paper = pair
    paths = [directory / f"{name}.{'jpg' if coding == 'JPEG' else 'exr'}" for name in ("photo", "paper")]
    height, width = photo.shape[:2]
    if rim:
        photo = np.concatenate([paper[:24], photo])
    for path, picture in zip(paths, (photo, paper)):
        save(picture, path)
    words = [program, "measure", paths[0], "--setup", setup, "--mm-per-pixel", f"{mm:.6g}", "--format", "json", *more]
    words += ["--white", f"4,3,{width - 4},21"] if rim else ["--white-photo", paths[1]]
    if setup == "edge":
        top = 24 if rim else 0
        words += ["--region", f"0,{top},{width},{height + top}", "--edge",
                  f"{width // 2},{top},{width // 2},{height + top}", "--card", "hidden"]
    return [str(word) for word in words]


def measured(words):
    """Rows of `translucid measure`, by channel and quantity."""
    ran = subprocess.run(words, capture_output=True, text=True)
    if ran.returncode != 0:
        print(f"refused: {ran.stderr.strip().splitlines()[-1]}")
        return {}
    return {(row["channel"], row["quantity"]): row for row in json.loads(ran.stdout)}


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def write(script, content):
    """Puts what a script printed between its marks on the page."""
    begin, end = f"<!-- measured: python3 benches/measure/{script} --write -->", "<!-- end of what was measured -->"
    head, rest = PAGE.read_text().split(begin)
    PAGE.write_text(f"{head}{begin}\n\n{content}\n\n{end}{rest.split(end, 1)[1]}")


def percent(value):
    return f"{100 * value:.1f} %" if math.isfinite(value) else "–"


def summary(found):
    """Coverage of the 95 % intervals and median errors of a list of (row of ℓ, true ℓ, row of A, true A)."""
    ells = [abs(row["value"] / truth - 1) for row, truth, _, _ in found]
    albedos = [abs(row["value"] / truth - 1) for _, _, row, truth in found]
    covered = [row["from_95"] <= truth <= row["to_95"] for row, truth, _, _ in found]
    covered_albedo = [row["from_95"] <= truth <= row["to_95"] for _, _, row, truth in found]
    return [str(len(found)), percent(np.mean(covered)), percent(np.median(ells)), percent(np.mean(covered_albedo)),
            percent(np.median(albedos))]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=Path, default=ROOT / "target" / "release" / "translucid")
    parser.add_argument("--collisions", type=float, default=6e6, help="of a photograph's channel, about [6e6]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="measurements at once")
    parser.add_argument("--write", action="store_true", help=f"into {PAGE.relative_to(ROOT)}")
    arguments = parser.parse_args()
    generator = np.random.default_rng(1)
    exact, dielectric = "isotropic, index-matched", "dielectric, η = 1.4"
    below = {}
    # How a photograph is kept, measured, and for which media: the first two are right
    ways = {
        "16 bits": ({}, ["--configuration", "searchlight"], MEDIA),
        "JPEG": ({}, ["--configuration", "searchlight"], [exact]),
        "η given": ({}, ["--configuration", "searchlight", "--eta", "1.4"], [dielectric]),
        "card at the rim": ({"rim": True}, ["--configuration", "searchlight"], [exact]),
        "by the default": ({}, ["--configuration", "diffuse"], [exact, dielectric]),
    }
    found = {}
    with tempfile.TemporaryDirectory() as directory, ThreadPoolExecutor(arguments.jobs) as pool:
        tasks = []
        for kind, by_setup in MEDIA.items():
            for setup, media in by_setup.items():
                for three in (media[i:i + 3] for i in range(0, len(media), 3)):
                    for part in range(len(SETUPS)):
                        for way, (keywords, words, kinds) in ways.items():
                            if kind not in kinds or (setup == "spot" and keywords):
                                continue
                            pair, mm, lengths = photographs(setup, three, part, arguments.collisions, generator)
                            own = Path(directory) / str(len(tasks))
                            own.mkdir()
                            words = words_of(setup, pair, way, mm, arguments.program, own, *words, **keywords)
                            tasks.append((way, kind, setup, three, lengths, words))
        for (way, kind, setup, three, lengths, _), rows in zip(tasks, pool.map(measured, [task[-1] for task in tasks])):
            print(f"{setup}, {kind}, {way}:", flush=True)
            for name, medium, length in zip(("red", "green", "blue"), three, lengths):
                if (name, "mfp") not in rows:
                    continue
                albedo = medium[0]
                if way == "η given":
                    albedo = below.setdefault(medium, dielectric_albedo(alpha_of(albedo), medium[2]))
                case = (rows[name, "mfp"], length, rows[name, "surface_albedo"], albedo)
                found.setdefault((way, kind, setup), []).append(case)
                found.setdefault((way, kind, setup, medium), []).append(case)
                parts = [f"{row['value'] / truth:.4f} ({row['from_95'] / truth:.4f} to {row['to_95'] / truth:.4f})"
                         for row, truth in (case[:2], case[2:])]
                print(f"  A = {medium[0]}, ℓ = {length:.3g} mm: ℓ {parts[0]}, A {parts[1]} of the truth", flush=True)
    lines = [
        ("edge, 16 bits", [("16 bits", exact, "edge"), ("η given", dielectric, "edge")]),
        ("spot, 16 bits", [("16 bits", exact, "spot"), ("η given", dielectric, "spot")]),
        ("both", [(way, kind, setup) for way, kind in (("16 bits", exact), ("η given", dielectric))
                  for setup in ("edge", "spot")]),
        ("edge, 16 bits, η = 1.4 alone", [("η given", dielectric, "edge")]),
        ("spot, 16 bits, η = 1.4 alone", [("η given", dielectric, "spot")]),
        ("edge, 16 bits, a white card at the rim", [("card at the rim", exact, "edge")]),
        ("edge, JPEG", [("JPEG", exact, "edge")]),
        ("spot, JPEG", [("JPEG", exact, "spot")]),
    ]
    rows = []
    for name, keys in lines:
        cases = [case for key in keys for case in found.get(key, [])]
        if cases:
            rows.append([name, *summary(cases)])
    first = table(["photograph", "measurements", "ℓ within 95 %", "median error of ℓ", "A within 95 %",
                   "median error of A"], rows)
    bias = []
    for kind, by_setup in MEDIA.items():
        for setup, media in by_setup.items():
            for medium in media:
                cells = [setup, kind + (f", g = {medium[1]:g}" if medium[1] else ""), f"{medium[0]:g}"]
                for way in ("16 bits", "by the default"):
                    cases = found.get((way, kind, setup, medium), [])
                    cells += [f"{np.median([row['value'] / truth for row, truth, _, _ in cases]):.3f}" if cases else "–",
                              f"{np.median([row['value'] for _, _, row, _ in cases]):.3f}" if cases else "–"]
                bias.append(cells)
    second = table(["light", "medium", "A of the matched, isotropic one", "ℓ / truth", "A", "ℓ / truth by the default",
                    "A by the default"], bias)
    for text in (first, second):
        print(text + "\n")
    if arguments.write:
        write("photographs.py", first)


if __name__ == "__main__":
    main()
