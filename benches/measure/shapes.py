#!/usr/bin/env python3
"""Measures the material of known shapes in pictures of Mitsuba 3, and prints how far from the truth the numbers are.

    TRANSLUCID_ASSETS=… python3 benches/measure/shapes.py [--write]

README.md says what is measured and how. --write puts the table into docs/accuracy/measure.md.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import time
from pathlib import Path

from photographs import CACHE, ROOT, alpha_of, percent, table, write

import numpy as np

# Lengths in mm; what the scene of a shape and that of Mitsuba have in common
SHAPES = {
    "sphere": {
        "mesh": None, "radius": 10.0, "size": [96, 96], "samples": 256,
        "camera": {"position": [0, 0, 80], "target": [0, 0, 0], "fov": 16.5},
        "lamp": {"center": [-40, 40, 20], "target": [0, 0, 0], "size": [10, 10], "radiance": 30.0},
        "surface_albedo": [0.8, 0.5, 0.3], "mfp": [3.0, 2.0, 1.0],
        "start": {"surface_albedo": [0.6] * 3, "mfp": [1.5] * 3},
    },
    "head": {
        "mesh": "head/head_70k.ply", "size": [96, 96], "samples": 256,
        "camera": {"position": [230, 95, 690], "target": [6, 72, 0], "fov": 14.0},
        "lamp": {"center": [-380, 300, 180], "target": [0, 70, 30], "size": [100, 100], "radiance": 20.0},
        "surface_albedo": [0.8, 0.6, 0.4], "mfp": [6.0, 4.0, 3.0],
        "start": {"surface_albedo": [0.5] * 3, "mfp": [2.5] * 3},
    },
}
SKY = 0.05
PARAMETERS = {"surface_albedo": "A", "mfp": "ℓ"}


def diffuse_albedo(alpha):
    """1 - 2 sqrt(1 - alpha) ∫ H(mu) mu dmu, the albedo of a matched isotropic half space in light from all directions."""
    k = np.tan((np.arange(4000) + 0.5) / 4000 * (math.pi / 2))
    logarithm = np.log(1 - alpha * np.arctan(k) / k)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    mu = (nodes + 1) / 2
    # ∫ dk / (1 + mu² k²) = mean of (1 + k²) / (1 + mu² k²) over the angles of k
    log_h = [-m / 2 * np.mean(logarithm * (1 + k * k) / (1 + (m * k) ** 2)) for m in mu]
    return 1 - 2 * math.sqrt(1 - alpha) * np.sum(weights / 2 * np.exp(log_h) * mu)


def rendering(name, mesh, channel):
    """One channel of a shape's picture by a volumetric path tracer."""
    shape = SHAPES[name]
    camera, lamp, (width, height) = shape["camera"], shape["lamp"], shape["size"]
    albedo, mfp = shape["surface_albedo"][channel], shape["mfp"][channel]
    path = CACHE / "measure" / f"{name}-{albedo}-{mfp}-{width}x{height}-{shape['samples']}.npy"
    if path.exists():
        return np.load(path)
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    transform = mi.ScalarTransform4f
    body = {"type": "ply", "filename": str(mesh)} if mesh else {"type": "sphere", "radius": shape["radius"]}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 1000000},
        "sensor": {
            "type": "perspective", "fov": camera["fov"], "fov_axis": "x", "near_clip": 1.0, "far_clip": 1e5,
            "to_world": transform().look_at(origin=camera["position"], target=camera["target"], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"},
                     "pixel_format": "luminance"},
            "sampler": {"type": "independent", "sample_count": shape["samples"]},
        },
        "body": {**body, "bsdf": {"type": "null"},
                 "interior": {"type": "homogeneous", "albedo": alpha_of(albedo, diffuse_albedo), "sigma_t": 1 / mfp}},
        "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": lamp["radiance"]},
                 "to_world": transform().look_at(origin=lamp["center"], target=lamp["target"], up=[0, 1, 0])
                 @ transform().scale([lamp["size"][0] / 2, lamp["size"][1] / 2, 1])},
        "sky": {"type": "constant", "radiance": SKY},
    })
    begin = time.process_time()
    picture = np.array(mi.render(scene, spp=shape["samples"], seed=channel + 1)).reshape(height, width)
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, picture)
    print(f"rendered {path.stem}: {time.process_time() - begin:.0f} CPU s", flush=True)
    return picture


def scene_file(name, mesh):
    """The scene whose picture it is, with a material from which the fit starts."""
    shape = SHAPES[name]
    camera, lamp, start = shape["camera"], shape["lamp"], shape["start"]
    body = f"file = {json.dumps(str(mesh))}" if mesh else f'shape = "sphere"\nradius = {shape["radius"]}'
    return f"""unit = "mm"
[camera]
position = {camera["position"]}
target = {camera["target"]}
fov = {camera["fov"]}
[film]
size = {shape["size"]}
filter = "box"
[[material]]
name = "piece"
specular_weight = 0
subsurface_weight = 1
subsurface_model = "random-walk"
subsurface_color = {start["surface_albedo"]}
subsurface_radius = 1
subsurface_radius_scale = {start["mfp"]}
[[object]]
{body}
material = "piece"
[[light]]
type = "rectangle"
center = {lamp["center"]}
target = {lamp["target"]}
size = {lamp["size"]}
radiance = {lamp["radiance"]}
[environment]
radiance = {SKY}
"""


def measured(name, mesh, program, directory, samples):
    """Rows of `translucid measure` by quantity and channel, and its CPU seconds."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    picture = np.stack([rendering(name, mesh, channel) for channel in range(3)], -1)
    mi.Bitmap(picture.astype(np.float32)).write(str(directory / "photo.exr"))
    (directory / "scene.toml").write_text(scene_file(name, mesh))
    words = [program, "measure", "photo.exr", "--scene", "scene.toml", "--fit", "material.surface_albedo,material.mfp",
             "--spp", samples, "--format", "json", "-q"]
    before = cpu_of_children()
    ran = subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=directory, check=False)
    if ran.returncode != 0:
        raise SystemExit(f"{name}: {ran.stderr.strip()}")
    print(ran.stderr, end="")
    return {(row["quantity"], row["channel"]): row for row in json.loads(ran.stdout)}, cpu_of_children() - before


def cpu_of_children():
    import resource

    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=Path, default=ROOT / "target" / "release" / "translucid")
    parser.add_argument("--samples", type=int, default=32, help="per pixel of the fit's pictures [32]")
    parser.add_argument("--shape", choices=SHAPES, help="this one alone")
    parser.add_argument("--write", action="store_true", help="into docs/accuracy/measure.md")
    arguments = parser.parse_args()
    lines, worst = [], 0.0
    for name in [arguments.shape] if arguments.shape else SHAPES:
        shape = SHAPES[name]
        mesh = shape["mesh"] and Path(os.environ.get("TRANSLUCID_ASSETS", ""), shape["mesh"]).resolve()
        if mesh and not mesh.exists():
            print(f"skipped: {name}, as {shape['mesh']} is not in TRANSLUCID_ASSETS")
            continue
        with tempfile.TemporaryDirectory() as directory:
            rows, cpu = measured(name, mesh, arguments.program.resolve(), Path(directory), arguments.samples)
        print(f"measured the {name}: {cpu:.0f} CPU s", flush=True)
        for quantity, letter in PARAMETERS.items():
            for channel, truth in zip(("red", "green", "blue"), shape[quantity]):
                row = rows[quantity, channel]
                error = row["value"] / truth - 1
                worst = max(worst, abs(error))
                lines.append([name, channel, letter, f"{truth:g}", f"{row['value']:.3g}",
                              f"{row['from_95']:.3g} to {row['to_95']:.3g}", percent(error)])
    text = table(["shape", "channel", "parameter", "truth", "measured", "95 % interval", "error"], lines)
    print(f"{text}\n\nLargest error {percent(worst)}.")
    if arguments.write:
        write("shapes.py", text)


if __name__ == "__main__":
    main()
