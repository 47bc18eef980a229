#!/usr/bin/env python3
"""Has Mitsuba 3 render a body of scatterers, and prints how bright each sixteenth of the picture is.

    python3 benches/measure/truth.py [--pictures 16] [--samples 256] [--write]

README.md says what is rendered and how. --write puts the numbers beside the scene, where the test `volume_truth` reads them.
"""

import argparse
import math
import time
import tomllib

from photographs import ROOT, alpha_of
from shapes import diffuse_albedo

import mitsuba as mi
import numpy as np

DATA = ROOT / "crates" / "translucid-workbench" / "tests" / "data"
# Sixteenths of a picture
ACROSS = 4


def read_ply(path):
    """Corners and triangles of a binary PLY file whose vertices have a position only."""
    header, data = path.read_bytes().split(b"end_header\n", 1)
    vertices, faces = (int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element"))
    corners = np.frombuffer(data, "<f4", 3 * vertices).reshape(-1, 3)
    faces = np.frombuffer(data[corners.nbytes :], [("count", "u1"), ("corners", "<u4", 3)], faces)
    return corners, faces["corners"]


def volume(path):
    """How many cubic units a mesh encloses, and how much is left of its area vectors, which is nothing if it is closed."""
    corners, triangles = read_ply(path)
    a, b, c = (corners[triangles[:, i]].astype(float) for i in range(3))
    return np.sum(a * np.cross(b, c)) / 6, np.abs(np.cross(b - a, c - a).sum(axis=0)).max()


def loaded(scene, channel):
    """One channel of a scene file in Mitsuba."""
    material, thing = scene["material"][0], scene["object"][0]
    camera, lamp, film = scene["camera"], scene["light"][0], scene["film"]
    alpha = alpha_of(material["subsurface_color"][channel], diffuse_albedo)
    mfp = material["subsurface_radius"] * material["subsurface_radius_scale"][channel]
    transform, up = mi.ScalarTransform4f, [0, 1, 0]
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 1000000},
        "sensor": {
            "type": "perspective", "fov": camera["fov"], "fov_axis": "x", "near_clip": 0.1, "far_clip": 1e4,
            "to_world": transform().look_at(origin=camera["position"], target=camera["target"], up=up),
            "film": {"type": "hdrfilm", "width": film["size"][0], "height": film["size"][1],
                     "rfilter": {"type": "box"}, "pixel_format": "luminance"},
            "sampler": {"type": "independent"},
        },
        "body": {"type": "ply", "filename": str(DATA / thing["file"]), "bsdf": {"type": "null"},
                 "to_world": transform().translate(thing["translate"]),
                 "interior": {"type": "homogeneous", "albedo": alpha, "sigma_t": 1 / mfp}},
        "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": lamp["radiance"][channel]},
                 "to_world": transform().look_at(origin=lamp["center"], target=lamp["target"], up=up)
                 @ transform().scale([lamp["size"][0] / 2, lamp["size"][1] / 2, 1])},
        "sky": {"type": "constant", "radiance": scene["environment"]["radiance"][channel]},
    })


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--pictures", type=int, default=16, help="of a seed each, whose spread gives the standard errors [16]")
    parser.add_argument("--samples", type=int, default=256, help="per pixel of a picture [256]")
    parser.add_argument("--write", action="store_true", help="beside the scene")
    arguments = parser.parse_args()
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    scene = tomllib.loads((DATA / "bust.toml").read_text())
    inside, open_area = volume(DATA / scene["object"][0]["file"])
    print(f"the mesh encloses {inside:.4g} cubic units; its area vectors add up to {open_area:.1e}")
    width, height = scene["film"]["size"]
    begin = time.process_time()
    means = np.empty((arguments.pictures, 3, ACROSS * ACROSS))
    for channel in range(3):
        prepared = loaded(scene, channel)
        for seed in range(arguments.pictures):
            picture = np.array(mi.render(prepared, spp=arguments.samples, seed=3 * seed + channel)).reshape(height, width)
            blocks = picture.reshape(ACROSS, height // ACROSS, ACROSS, width // ACROSS)
            means[seed, channel] = blocks.mean(axis=(1, 3)).ravel()
    mean, error = means.mean(axis=0), means.std(axis=0, ddof=1) / math.sqrt(arguments.pictures)
    lines = [
        f"# python3 benches/measure/truth.py --pictures {arguments.pictures} --samples {arguments.samples} --write",
        f"# Mitsuba {mi.__version__}, volpath, scalar_rgb; radiance of each sixteenth of bust.toml and its standard error",
        "column,row,red,green,blue,red_error,green_error,blue_error",
    ]
    for region in range(ACROSS * ACROSS):
        numbers = ",".join(f"{value:.6g}" for value in (*mean[:, region], *error[:, region]))
        lines.append(f"{region % ACROSS},{region // ACROSS},{numbers}")
    print("\n".join(lines))
    print(f"{time.process_time() - begin:.0f} CPU s")
    if arguments.write:
        (DATA / "bust-truth.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
