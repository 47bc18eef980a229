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

# Media by albedo A of a pencil of light, mean cosine g and relative index; three channels of a photograph each
MEDIA = {
    "isotropic, index-matched": [(0.1, 0.0, 1.0), (0.3, 0.0, 1.0), (0.5, 0.0, 1.0),
                                 (0.7, 0.0, 1.0), (0.85, 0.0, 1.0), (0.95, 0.0, 1.0)],
    "dielectric, η = 1.4": [(0.3, 0.0, 1.4), (0.6, 0.0, 1.4), (0.8, 0.0, 1.4)],
    "forward scattering, g = 0.8": [(0.3, 0.8, 1.0), (0.5, 0.8, 1.0), (0.7, 0.8, 1.0)],
}
# Parts of a rendering's rows make photographs of their own: mean free path [mm], blur in pixels, dark corners
SETUPS = [(0.1, 0.8, 0.0), (0.6, 1.5, 0.05), (5.0, 1.0, 0.10)]
COLUMNS, ROWS = 192, 288


def searchlight_albedo(alpha):
    """1 - H(1) sqrt(1 - alpha), the albedo of a matched isotropic half space for a pencil of light."""
    t = (np.arange(20000) + 0.5) / 20000 * (math.pi / 2)
    k = np.tan(t)
    log_h = -np.mean(np.log(1 - alpha * np.arctan(k) / k)) / 2
    return 1 - math.exp(log_h) * math.sqrt(1 - alpha)


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


def rendering(medium, collisions):
    """Rows of an edge of even light on a half space, seen straight from above, and the pixel's width; in transport mean free
    paths.

    The light is a rectangle that lies on the lit half. The camera lies below the surface and looks down: it sees neither the
    light nor what a smooth surface reflects.
    """
    albedo, g, eta = medium
    samples = samples_of(medium, collisions)
    alpha_prime = alpha_of(albedo)
    pixel = 2 * min(max(5 / decay(alpha_prime), 8), 60) / COLUMNS
    path = CACHE / "measure" / f"edge-{albedo}-{g}-{eta}-{samples}.npy"
    if path.exists():
        return np.load(path), pixel, alpha_prime
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    # sigma'_t = 1: sigma_s = alpha' / (1 - g), sigma_a = 1 - alpha'
    sigma_s, sigma_a = alpha_prime / (1 - g), 1 - alpha_prime
    transform = mi.ScalarTransform4f
    half, gap, width = 400.0, 0.02, COLUMNS * pixel
    boundary = {"type": "null"} if eta == 1 else {"type": "dielectric", "int_ior": eta, "ext_ior": 1.0}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 1000000},
        "inside": {"type": "homogeneous", "albedo": sigma_s / (sigma_s + sigma_a), "sigma_t": sigma_s + sigma_a,
                   "phase": {"type": "hg", "g": g}},
        "sensor": {
            "type": "orthographic", "near_clip": 1e-6, "far_clip": 1e6, "medium": {"type": "ref", "id": "inside"},
            "to_world": transform().look_at(origin=[0, 0, -gap / 2], target=[0, 0, -1], up=[0, 1, 0])
            @ transform().scale([-width / 2, width / 2, 1]),
            "film": {"type": "hdrfilm", "width": COLUMNS, "height": ROWS, "rfilter": {"type": "box"},
                     "pixel_format": "luminance"},
            "sampler": {"type": "independent", "sample_count": samples},
        },
        "piece": {"type": "cube", "to_world": transform().translate([0, 0, -half]) @ transform().scale(half),
                  "bsdf": boundary, "interior": {"type": "ref", "id": "inside"}},
        "light": {"type": "rectangle", "emitter": {"type": "area", "radiance": 1.0},
                  "bsdf": {"type": "diffuse", "reflectance": 0.0},
                  "to_world": transform().translate([2 * half, 0, gap]) @ transform().scale(2 * half)
                  @ transform().rotate([1, 0, 0], 180)},
    })
    seed = int(1e4 * albedo) + int(1e6 * g) + int(1e7 * eta)
    begin = time.process_time()
    picture = np.array(mi.render(scene, spp=samples, seed=seed)).reshape(ROWS, COLUMNS)
    # Light on the right, however the camera was turned
    if picture[:, :COLUMNS // 4].mean() > picture[:, -COLUMNS // 4:].mean():
        picture = picture[:, ::-1]
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, picture)
    print(f"rendered {path.stem}: {time.process_time() - begin:.0f} CPU s", flush=True)
    return picture, pixel, alpha_prime


def photograph(media, setup, collisions, generator, smooth):
    """Red, green and blue of an edge below a white card, its millimeters per pixel, and the true mean free paths [mm].

    A smooth one has the mean of its rows in each, and the camera's noise alone.
    """
    part, (mfp, blur, dark) = setup
    rows = ROWS // len(SETUPS)
    channels, lengths, mm = [], [], None
    for medium in media:
        picture, pixel, _ = rendering(medium, collisions)
        mm = mm or mfp * pixel
        lengths.append(mm / pixel)
        own = picture[part * rows:(part + 1) * rows].reshape(rows // 4, 4, COLUMNS).mean(1)
        # The lens blurs the light, not the noise of its simulation, which stands for that of the camera
        mean = own.mean(0)
        reach = np.arange(-12, 13)
        kernel = np.exp(-0.5 * (reach / blur) ** 2)
        wide = np.pad(mean, 12, mode="edge")
        blurred = np.convolve(wide, kernel / kernel.sum(), "valid")
        channels.append((0 if smooth else own - mean) + np.broadcast_to(blurred, own.shape))
    edge = np.stack(channels, -1)
    card = np.full((24, COLUMNS, 3), 0.9)
    photo = np.concatenate([card, edge]) * 0.95 / max(1, edge.max())
    y, x = np.mgrid[-1:1:photo.shape[0] * 1j, -1:1:COLUMNS * 1j]
    photo = photo * (1 - dark * (x * x + y * y) / 2)[..., None]
    photo = photo + 0.01 * np.sqrt(np.maximum(photo, 0)) * generator.normal(size=photo.shape)
    return np.clip(photo, 0, 1), mm, lengths


def measure(photo, kind, mm, program, directory, *more):
    """Rows of `translucid measure`, by channel and quantity."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    if kind == "16 bits, linear":
        path = directory / "photo.exr"
        mi.Bitmap((np.round(photo * 65535) / 65535).astype(np.float32)).write(str(path))
    else:
        path = directory / "photo.jpg"
        coded = np.where(photo <= 0.0031308, 12.92 * photo, 1.055 * np.maximum(photo, 1e-9) ** (1 / 2.4) - 0.055)
        mi.Bitmap(np.round(255 * coded).astype(np.uint8)).write(str(path), quality=92)
    height = photo.shape[0]
    words = [program, "measure", path, "--mm-per-pixel", f"{mm:.6g}", "--white", f"4,3,{COLUMNS - 4},21", "--region",
             f"0,24,{COLUMNS},{height}", "--edge", f"{COLUMNS // 2},24,{COLUMNS // 2},{height}", "--card", "hidden",
             "--format", "json", *more]
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
    exact = "isotropic, index-matched"
    found = {}
    with tempfile.TemporaryDirectory() as directory:
        for kind, media in MEDIA.items():
            for group in range(0, len(media), 3):
                for setup in enumerate(SETUPS):
                    three = media[group:group + 3]
                    for coding in ("16 bits, linear", "JPEG")[:2 if media is MEDIA[exact] else 1]:
                        smooth = coding == "JPEG"
                        photo, mm, lengths = photograph(three, setup, arguments.collisions, generator, smooth)
                        for light in ("searchlight", "diffuse") if coding != "JPEG" else ("searchlight",):
                            rows = measure(photo, coding, mm, arguments.program, Path(directory), "--configuration", light)
                            for name, medium, length in zip(("red", "green", "blue"), three, lengths):
                                if (name, "mfp") in rows:
                                    case = (rows[name, "mfp"], length, rows[name, "surface_albedo"], medium[0])
                                    found.setdefault((kind, coding, light), []).append(case)
                                    found.setdefault((kind, medium, coding, light), []).append(case)
    first = table(
        ["photograph", "measurements", "ℓ within 95 %", "median error of ℓ", "A within 95 %", "median error of A"],
        [["16 bits, linear", *summary(found[exact, "16 bits, linear", "searchlight"])],
         # The simulation's noise is the same in all rows, so that intervals cannot know of it
         ["JPEG", *("–" if i in (1, 3) else text for i, text in enumerate(summary(found[exact, "JPEG", "searchlight"])))]])
    bias = []
    for kind, media in MEDIA.items():
        for medium in media:
            cases = found.get((kind, medium, "16 bits, linear", "searchlight"), [])
            others = found.get((kind, medium, "16 bits, linear", "diffuse"), [])
            if cases and others:
                ratio = [np.median([row["value"] / truth for row, truth, _, _ in some]) for some in (cases, others)]
                albedo = [np.median([row["value"] for _, _, row, _ in some]) for some in (cases, others)]
                bias.append([kind, f"{medium[0]:g}", *(f"{value:.3f}" for pair in zip(ratio, albedo) for value in pair)])
    second = table(["medium", "A of the matched, isotropic one", "ℓ / truth", "A", "ℓ / truth by the default",
                    "A by the default"], bias)
    for text in (first, second):
        print(text + "\n")
    if arguments.write:
        write("photographs", first)
        write("bias", second)


if __name__ == "__main__":
    main()
