#!/usr/bin/env python3
"""Compares thin walls and the slabs that they stand for with Mitsuba 3, and prints both.

    python3 benches/measure/thin_walls.py [--samples 40000]

README.md says what is compared and how. Ends with 1 if a mean differs by more than 1 %.
"""

import argparse
import csv
import io
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from photographs import ROOT, alpha_of, table
from shapes import diffuse_albedo

import mitsuba as mi
import numpy as np

PROGRAM = os.environ.get("TRANSLUCID", str(ROOT / "target" / "release" / "translucid"))
# Surface albedo and mean free path in thicknesses of the slab
SLABS = [(0.8, 1.0), (0.8, 0.2), (0.5, 0.5), (0.95, 0.1)]
# Angles of view, whose Gaussian weights make a mean over diffuse light
COSINES, WEIGHTS = (np.array(v) for v in np.polynomial.legendre.leggauss(6))
COSINES, WEIGHTS = 0.5 * (COSINES + 1.0), 0.5 * WEIGHTS
SEEDS = 8
COLOR = [0.8, 0.5, 0.3]
# Light from the normal's side and from behind, and the angle of view on the normal's side
SUNS, VIEW = [20, 160], 40


def radiance(scene, origin, direction, samples):
    """The mean of a ray, and its standard error by renderings with seeds of their own."""
    to_world = mi.ScalarTransform4f().look_at(origin=origin, target=[o + d for o, d in zip(origin, direction)], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    sensor = mi.load_dict({"type": "radiancemeter", "to_world": to_world, "film": film})
    found = [np.array(mi.render(scene, sensor=sensor, spp=samples // SEEDS, seed=seed)).reshape(3) for seed in range(SEEDS)]
    return np.mean(found, axis=0), np.std(found, axis=0, ddof=1) / math.sqrt(SEEDS)


def of_slab(albedo, mfp, samples):
    """Reflectance and transmittance of diffuse light, by reciprocity those seen under a wide lamp."""
    transform = mi.ScalarTransform4f
    medium = {"type": "homogeneous", "albedo": alpha_of(albedo, diffuse_albedo), "sigma_t": 1.0 / mfp}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 1000000},
        "slab": {"type": "cube", "to_world": transform().scale([1e3, 1e3, 0.5]), "bsdf": {"type": "null"}, "interior": medium},
        "lamp": {"type": "rectangle", "to_world": transform().translate([0, 0, 10]) @ transform().rotate([1, 0, 0], 180)
                 @ transform().scale(1e5), "emitter": {"type": "area", "radiance": 1.0}},
    })
    means, errors = np.zeros(2), np.zeros(2)
    for cosine, weight in zip(COSINES, WEIGHTS):
        sine = math.sqrt(1.0 - cosine * cosine)
        for side, sign in enumerate((1, -1)):
            mean, error = radiance(scene, [-5 * sine / cosine, 0, 5 * sign], [sine, 0, -sign * cosine], samples)
            means[side] += 2 * weight * cosine * mean[0]
            errors[side] += (2 * weight * cosine * error[0]) ** 2
    return means, np.sqrt(errors)


def convert(albedo, mfp, thickness):
    """Rows of `translucid convert --thin`, by system and parameter."""
    words = ["convert", "--from", f"translucid:mfp={mfp}", "--surface-albedo", str(albedo), "--thin", str(thickness)]
    printed = subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True).stdout
    return {(row["system"], row["parameter"]): float(row["value"]) for row in csv.DictReader(io.StringIO(printed))}


def of_wall(anisotropy, sun):
    """A sheet of Mitsuba's principledthin without a highlight under a sun, seen from above."""
    direction = [-math.sin(math.radians(sun)), 0, -math.cos(math.radians(sun))]
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path"},
        "sheet": {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale(1e3),
                  "bsdf": {"type": "principledthin", "base_color": {"type": "rgb", "value": COLOR}, "roughness": 0.5,
                           "spec_trans": 0.0, "diff_trans": 1.0 + anisotropy}},
        "sun": {"type": "directional", "direction": direction, "irradiance": {"type": "rgb", "value": [1.0, 1.0, 1.0]}},
    })
    view = math.radians(VIEW)
    return radiance(scene, [-5 * math.sin(view), 0, 5 * math.cos(view)], [math.sin(view), 0, -math.cos(view)], 64)[0]


def rendered(anisotropy, sun):
    """The same by `translucid render`."""
    view, light = math.radians(VIEW), math.radians(sun)
    scene = f"""
unit = "mm"
[camera]
position = [{-5 * math.sin(view)}, 0, {5 * math.cos(view)}]
target = [0, 0, 0]
fov = 1
[film]
size = [4, 4]
[environment]
radiance = [0, 0, 0]
[[light]]
type = "distant"
direction = [{math.sin(light)}, 0, {math.cos(light)}]
irradiance = [1, 1, 1]
[[material]]
name = "sheet"
geometry_thin_walled = true
specular_weight = 0
subsurface_weight = 1
subsurface_color = {COLOR}
subsurface_scatter_anisotropy = {anisotropy}
[[object]]
shape = "rectangle"
width = 1000
height = 1000
material = "sheet"
"""
    with tempfile.TemporaryDirectory() as folder:
        path, picture = Path(folder) / "sheet.toml", Path(folder) / "sheet.exr"
        path.write_text(scene)
        subprocess.run([PROGRAM, "render", path, "--spp", "16", "-o", picture], check=True, capture_output=True)
        # The first layer is the picture
        return np.array(mi.Bitmap(str(picture)).split()[0][1])[..., :3].mean(axis=(0, 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--samples", type=int, default=40000, help="per angle of view [40000]")
    arguments = parser.parse_args()
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    worst, rows = 0.0, []
    for albedo, mfp in SLABS:
        ours, (theirs, errors) = convert(albedo, mfp, 1.0), of_slab(albedo, mfp, arguments.samples)
        for side, name in enumerate(("reflectance", "transmittance")):
            found = ours["slab", name]
            off = abs(found / theirs[side] - 1.0)
            worst = max(worst, off - 3 * errors[side] / theirs[side])
            rows.append([f"{albedo}", f"{mfp}", name, f"{found:.4f}", f"{theirs[side]:.4f} ± {errors[side]:.4f}", f"{100 * off:.1f} %"])
    print(table(["A", "ℓ", "slab", "convert --thin", "Mitsuba, volume", "off"], rows))
    rows = []
    for anisotropy in (-0.5, 0.0, 0.6):
        for sun in SUNS:
            ours, theirs = rendered(anisotropy, sun), of_wall(anisotropy, sun)
            off = np.abs(ours / theirs - 1.0).max()
            worst = max(worst, off)
            side = "in front" if sun < 90 else "behind"
            rows.append([f"{anisotropy}", side, f"{ours.round(4)}", f"{theirs.round(4)}", f"{100 * off:.1f} %"])
    print(table(["g", "sun", "geometry_thin_walled", "Mitsuba, principledthin", "off"], rows))
    sys.exit(int(worst > 0.01))


if __name__ == "__main__":
    main()
