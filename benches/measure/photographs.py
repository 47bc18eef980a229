#!/usr/bin/env python3
"""Measures materials in synthetic photographs of Mitsuba 3, and prints how far from the truth the numbers are.

    python3 benches/measure/photographs.py [--samples 4] [--write]

README.md says what is measured and how. The first run installs mitsuba from PyPI into target/peers/mitsuba; where it can't
be had, it says so and ends well. --write puts the tables into docs/accuracy/measure.md.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
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
# Parts of a rendering's rows make photographs of their own: mean free path [mm], blur in pixels, dark corners
SETUPS = [(0.1, 0.8, 0.0), (0.6, 1.5, 0.05), (5.0, 1.0, 0.10)]
COLUMNS, ROWS = 192, 288
# Spots: the picture's side, the light's radius, and how far it is off the middle, in pixels
SPOT, RADIUS, OFFSET = 96, 7.0, (3.3, -2.6)


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


def alpha_of(albedo, albedo_of=searchlight_albedo):
    low, high = 0.0, 1 - 1e-9
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if albedo_of(middle) < albedo else (low, middle)
    return (low + high) / 2


def decay(alpha):
    """k0 with alpha artanh(k0) / k0 = 1: light falls as exp(-k0 r)."""
    low, high = 1e-9, 1 - 1e-15
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if alpha * math.atanh(middle) / middle < 1 else (low, middle)
    return low


def samples_of(medium, collisions):
    """Samples per pixel that take about so many collisions, 1 to 4."""
    albedo, g, _ = medium
    per_sample = (1 - albedo) / (1 - alpha_of(albedo)) / (1 - g)
    return max(1, min(4, round(collisions / (per_sample * COLUMNS * ROWS))))


def rendering(setup, medium, part, collisions):
    """Light that leaves a half space straight up, over that of white, and the pixel's width in transport mean free paths.

    The light is a rectangle that lies on the lit half, or a disk. The camera lies below the surface and looks down: it sees
    neither the light nor what a smooth surface reflects.
    """
    albedo, g, eta = medium
    samples = samples_of(medium, collisions)
    alpha_prime = alpha_of(albedo)
    if setup == "edge":
        columns, rows, widest, name = COLUMNS, ROWS, 60, f"edge-{albedo}-{g}-{eta}-{samples}"
    else:
        columns, rows, widest, samples = SPOT, SPOT, 40, 2 * samples
        name = f"spot-{albedo}-{g}-{eta}-{samples}-{part}"
    pixel = 2 * min(max(5 / decay(alpha_prime), 8), widest) / columns
    # Through a smooth surface a part gets out, which spreads over more directions
    seen = (1 - ((eta - 1) / (eta + 1)) ** 2) / eta ** 2
    path = CACHE / "measure" / f"{name}.npy"
    if path.exists():
        return seen * np.load(path), pixel
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    # sigma'_t = 1: sigma_s = alpha' / (1 - g), sigma_a = 1 - alpha'
    sigma_s, sigma_a = alpha_prime / (1 - g), 1 - alpha_prime
    transform = mi.ScalarTransform4f
    half, gap, width = 400.0, 0.02, columns * pixel
    if setup == "edge":
        light, place, size = "rectangle", [2 * half, 0, gap], 2 * half
    else:
        light, place, size = "disk", [pixel * OFFSET[0], pixel * OFFSET[1], gap], pixel * RADIUS
    # No path samples a small light through a boundary: so near that would be noise without a variance
    is_open = setup == "edge" and eta == 1
    boundary = {"type": "null"} if is_open else {"type": "dielectric", "int_ior": eta, "ext_ior": 1.0}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 1000000},
        "inside": {"type": "homogeneous", "albedo": sigma_s / (sigma_s + sigma_a), "sigma_t": sigma_s + sigma_a,
                   "phase": {"type": "hg", "g": g}},
        "sensor": {
            "type": "orthographic", "near_clip": 1e-6, "far_clip": 1e6, "medium": {"type": "ref", "id": "inside"},
            "to_world": transform().look_at(origin=[0, 0, -gap / 2], target=[0, 0, -1], up=[0, 1, 0])
            @ transform().scale([-width / 2, width / 2, 1]),
            "film": {"type": "hdrfilm", "width": columns, "height": rows, "rfilter": {"type": "box"},
                     "pixel_format": "luminance"},
            "sampler": {"type": "independent", "sample_count": samples},
        },
        "piece": {"type": "cube", "to_world": transform().translate([0, 0, -half]) @ transform().scale(half),
                  "bsdf": boundary, "interior": {"type": "ref", "id": "inside"}},
        "light": {"type": light, "emitter": {"type": "area", "radiance": 1.0},
                  "bsdf": {"type": "diffuse", "reflectance": 0.0},
                  "to_world": transform().translate(place) @ transform().scale(size)
                  @ transform().rotate([1, 0, 0], 180)},
    })
    seed = int(1e4 * albedo) + int(1e6 * g) + int(1e7 * eta) + (0 if setup == "edge" else 7919 * (part + 1))
    begin = time.process_time()
    picture = np.array(mi.render(scene, spp=samples, seed=seed)).reshape(rows, columns)
    # Light on the right, however the camera was turned
    if setup == "edge" and picture[:, :columns // 4].mean() > picture[:, -columns // 4:].mean():
        picture = picture[:, ::-1]
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, picture)
    print(f"rendered {path.stem}: {time.process_time() - begin:.0f} CPU s", flush=True)
    return seen * picture, pixel


def blurred(values, blur):
    """Means over a Gaussian of such a standard deviation, along every axis; the ends go on."""
    reach = np.arange(-12, 13)
    kernel = np.exp(-0.5 * (reach / blur) ** 2)
    for axis in range(values.ndim):
        wide = np.pad(values, [(12, 12) if i == axis else (0, 0) for i in range(values.ndim)], mode="edge")
        values = np.apply_along_axis(np.convolve, axis, wide, kernel / kernel.sum(), "valid")
    return values


def light_of(setup, medium, part, blur, collisions, smooth):
    """What the camera sees of the piece and of white paper in its place, and the pixel's width [ℓ'].

    The lens blurs the light, not the noise of its simulation, which stands for that of the camera; in a smooth picture there
    is none of it.
    """
    if setup == "edge":
        picture, pixel = rendering(setup, medium, 0, collisions)
        rows = ROWS // len(SETUPS)
        own = picture[part * rows:(part + 1) * rows].reshape(rows // 4, 4, COLUMNS).mean(1)
        mean = own.mean(0)
        return (0 if smooth else own - mean) + np.broadcast_to(blurred(mean, blur), own.shape), np.ones(own.shape), pixel
    picture, pixel = rendering(setup, medium, part, collisions)
    y, x = np.mgrid[0:SPOT, 0:SPOT] + 0.5 - SPOT / 2
    # The middle of the light, however the camera was turned
    away = min(((x - i * OFFSET[0]) ** 2 + (y - j * OFFSET[1]) ** 2 for i in (-1, 1) for j in (-1, 1)),
               key=lambda square: picture[square < RADIUS ** 2].mean() * -1)
    distance = np.sqrt(away)
    disk = np.clip(RADIUS + 0.5 - distance, 0, 1)
    # Its power is what was rendered
    disk *= math.pi * RADIUS ** 2 / disk.sum()
    # By rings, finely where light changes much
    rings = np.concatenate([np.arange(0, 2 * RADIUS, 0.5), np.arange(2 * RADIUS, SPOT, 2.0)])
    ring = np.digitize(distance.ravel(), rings)
    count = np.maximum(np.bincount(ring, minlength=len(rings) + 1), 1)
    sums = [np.bincount(ring, weights=of.ravel(), minlength=len(rings) + 1) for of in (picture, distance)]
    seen = np.bincount(ring, minlength=len(rings) + 1) > 0
    mean = np.interp(distance, (sums[1] / count)[seen], (sums[0] / count)[seen])
    if smooth:
        return blurred(mean, blur), blurred(disk, blur), pixel
    return picture - mean + blurred(mean, blur), blurred(disk, blur), pixel


def photographs(setup, media, part, collisions, generator, smooth):
    """A photograph of red, green and blue, that of white paper of reflectance 0.9 in place of the piece, the millimeters per
    pixel, and the true mean free paths [mm]."""
    mfp, blur, dark = SETUPS[part]
    channels, papers, lengths, mm = [], [], [], None
    for medium in media:
        light, white, pixel = light_of(setup, medium, part, blur, collisions, smooth)
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


def measure(setup, pair, coding, mm, program, directory, *more, rim=False):
    """Rows of `translucid measure`, by channel and quantity; white is the paper's photograph, or a card at the rim."""
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
    ran = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if ran.returncode != 0:
        print(f"refused: {ran.stderr.strip().splitlines()[-1]}")
        return {}
    return {(row["channel"], row["quantity"]): row for row in json.loads(ran.stdout)}


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def write(name, content):
    """Puts a table between its marks on the page."""
    text = PAGE.read_text()
    begin = f"<!-- photographs: {name} -->\n"
    start = text.index(begin) + len(begin)
    PAGE.write_text(text[:start] + "\n" + content + "\n\n" + text[text.index("<!-- end of photographs -->", start):])


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
    parser.add_argument("--collisions", type=float, default=2e6, help="of a rendering [2e6]")
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
    with tempfile.TemporaryDirectory() as directory:
        for kind, by_setup in MEDIA.items():
            for setup, media in by_setup.items():
                for three in (media[i:i + 3] for i in range(0, len(media), 3)):
                    for part in range(len(SETUPS)):
                        for way, (keywords, words, kinds) in ways.items():
                            if kind not in kinds or (setup == "spot" and keywords):
                                continue
                            pair, mm, lengths = photographs(setup, three, part, arguments.collisions, generator,
                                                            way == "JPEG")
                            rows = measure(setup, pair, way, mm, arguments.program, Path(directory), *words, **keywords)
                            for name, medium, length in zip(("red", "green", "blue"), three, lengths):
                                if (name, "mfp") not in rows:
                                    continue
                                albedo = medium[0]
                                if way == "η given":
                                    albedo = below.setdefault(medium, dielectric_albedo(alpha_of(albedo), medium[2]))
                                case = (rows[name, "mfp"], length, rows[name, "surface_albedo"], albedo)
                                found.setdefault((way, kind, setup), []).append(case)
                                found.setdefault((way, kind, setup, medium), []).append(case)
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
            numbers = summary(cases)
            # The simulation's noise is the same in all rows, so that intervals cannot know of it
            rows.append([name, *("–" if "JPEG" in name and i in (1, 3) else text for i, text in enumerate(numbers))])
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
        write("photographs", first)
        write("bias", second)


if __name__ == "__main__":
    main()
