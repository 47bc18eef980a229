#!/usr/bin/env python3
"""Makes the sample materials of docs/samples, their pictures, and the numbers of docs/guide/samples.md.

    python3 contrib/samples.py              # everything
    python3 contrib/samples.py jade leaf    # the pictures of some samples; numbers of all others stay
    python3 contrib/samples.py --files      # the glTF files, MaterialX documents and scenes only

`translucid` must be on the path, or named by TRANSLUCID. Needs NumPy, OpenEXR and Pillow.
Pictures and numbers are means over RUNS renderings of other seeds; an error is the standard error of that mean.
"""

import base64
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs/samples"
PAGE = ROOT / "docs/guide/samples.md"
TRANSLUCID = os.environ.get("TRANSLUCID", "translucid")

SIZE = (256, 192)
SPP = 128
RUNS = 8
EXPOSURE = -0.6
# Rectangles of pixels, x, y, x', y': in the light, in the shade, and light that has passed through the thin part
PLACES = {"ball, lit": (28, 72, 44, 88), "ball, shaded": (76, 100, 92, 116), "thin part": (185, 88, 201, 104)}

# The irradiance of a surface that faces a light, in lux: of π W/m² a white Lambertian surface has the radiance 1 W/(m² sr).
LUX = 683 * math.pi

# Samples: file, what it is, whether it is a sheet, and its material in the words of its format. Lengths are meters.
BODIES = {
    "jade": {"color": [0.5, 0.7, 0.45], "mfp": [0.0008, 0.001, 0.0007], "g": 0.0},
    "marble": {"color": [0.931, 0.913, 0.894], "mfp": [0.000456, 0.000381, 0.000333], "g": 0.0},
    "skin": {"color": [0.625, 0.385, 0.241], "mfp": [0.001295, 0.000952, 0.000671], "g": 0.0},
    "soap": {"color": [0.85, 0.7, 0.6], "mfp": [0.0008, 0.0006, 0.0005], "g": 0.5},
    "wax": {"color": [0.9, 0.75, 0.4], "mfp": [0.002, 0.0014, 0.0007], "g": 0.0},
}
SHEETS = {
    "leaf": {"color": [0.25, 0.45, 0.08], "g": 0.2},
    "paper": {"reflected": [0.8, 0.78, 0.7], "passed": [0.8, 0.72, 0.55], "share": 0.4},
}
# Name, format
SAMPLES = [
    ("marble", "mtlx"),
    ("skin", "mtlx"),
    ("jade", "mtlx"),
    ("leaf", "mtlx"),
    ("jade", "gltf"),
    ("wax", "gltf"),
    ("soap", "gltf"),
    ("paper", "gltf"),
]


def ball(center, radius, rows=32):
    """A sphere with the normals of a true one."""
    points, normals, triangles = [], [], []
    for j in range(rows + 1):
        for i in range(2 * rows + 1):
            polar, azimuth = math.pi * j / rows, math.pi * i / rows
            normal = [math.sin(polar) * math.sin(azimuth), math.cos(polar), math.sin(polar) * math.cos(azimuth)]
            points.append([c + radius * n for c, n in zip(center, normal)])
            normals.append(normal)
            if j < rows and i < 2 * rows:
                a, b = j * (2 * rows + 1) + i, (j + 1) * (2 * rows + 1) + i
                triangles += [[a, b, b + 1]] * (j < rows - 1) + [[a, b + 1, a + 1]] * (j > 0)
    return points, normals, triangles


def plate(center, size, turn):
    """A box, turned about y."""
    points, normals, triangles = [], [], []
    cos, sin = math.cos(turn), math.sin(turn)
    turned = lambda p: [cos * p[0] + sin * p[2], p[1], cos * p[2] - sin * p[0]]
    for axis in range(3):
        for side in (-1, 1):
            first = len(points)
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = [0, 0, 0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, side * u, v
                points.append([c + p for c, p in zip(center, turned([0.5 * s * x for s, x in zip(size, corner)]))])
                normals.append(turned([side * (i == axis) for i in range(3)]))
            triangles += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
    return points, normals, triangles


def sheet(center, size, turn, bend=0.6, columns=24):
    """A rectangle bent to a part of a cylinder about y."""
    points, normals, triangles = [], [], []
    radius = size[0] / (2 * bend)
    for i in range(columns + 1):
        angle = bend * (2 * i / columns - 1)
        for y in (-0.5, 0.5):
            bent = [radius * math.sin(angle), y * size[1], radius * (math.cos(angle) - 1)]
            cos, sin = math.cos(turn), math.sin(turn)
            points.append([center[0] + cos * bent[0] + sin * bent[2], center[1] + bent[1], center[2] + cos * bent[2] - sin * bent[0]])
            normals.append([math.sin(angle + turn), 0, math.cos(angle + turn)])
        if i < columns:
            a = 2 * i
            triangles += [[a, a + 2, a + 3], [a, a + 3, a + 1]]
    return points, normals, triangles


def gltf(material, is_sheet):
    """A glTF file of a ball and a thin part, two lights and a camera."""
    parts = {"ball": ball([-0.0125, 0, 0], 0.01)}
    if is_sheet:
        parts["sheet"] = sheet([0.0125, 0, 0], [0.018, 0.02], math.radians(-20))
    else:
        parts["plate"] = plate([0.0125, 0, 0], [0.018, 0.02, 0.002], math.radians(-20))
    data, views, accessors, meshes = b"", [], [], []

    def add(rows, form, kind, component, target):
        nonlocal data
        packed = b"".join(struct.pack(f"<{len(row)}{form}", *row) for row in rows)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed), "target": target})
        count = len(rows) * (len(rows[0]) if kind == "SCALAR" else 1)
        accessor = {"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind}
        data += packed + b"\0" * (-len(packed) % 4)
        accessors.append(accessor)
        return len(accessors) - 1

    for name, (points, normals, triangles) in parts.items():
        single = [list(struct.unpack("<3f", struct.pack("<3f", *point))) for point in points]
        at = add(single, "f", "VEC3", 5126, 34962)
        accessors[at] |= {"min": [min(c) for c in zip(*single)], "max": [max(c) for c in zip(*single)]}
        of = {"POSITION": at, "NORMAL": add(normals, "f", "VEC3", 5126, 34962)}
        indices = add(triangles, "H", "SCALAR", 5123, 34963)
        meshes.append({"name": name, "primitives": [{"attributes": of, "indices": indices, "material": 0}]})

    # The second of them is behind, at the right: a node shines along its -z
    about_x, about_y = lambda a: [math.sin(a / 2), 0, 0, math.cos(a / 2)], lambda a: [0, math.sin(a / 2), 0, math.cos(a / 2)]
    turn = lambda y, x: [
        about_y(y)[3] * about_x(x)[0],
        about_y(y)[1] * about_x(x)[3],
        -about_y(y)[1] * about_x(x)[0],
        about_y(y)[3] * about_x(x)[3],
    ]
    lights = [{"name": name, "type": "directional", "intensity": irradiance * LUX} for name, irradiance in (("key", 1), ("back", 2))]
    angles = [(math.radians(-60), math.radians(-60)), (math.radians(155), math.radians(-20))]
    nodes = [{"name": mesh["name"], "mesh": i} for i, mesh in enumerate(meshes)]
    nodes += [
        {"name": light["name"], "rotation": turn(*angles[i]), "extensions": {"KHR_lights_punctual": {"light": i}}}
        for i, light in enumerate(lights)
    ]
    nodes.append({"name": "camera", "translation": [0, 0, 0.12], "camera": 0})
    camera = {"type": "perspective", "perspective": {"yfov": 2 * math.atan(0.75 * math.tan(math.radians(11.5))), "aspectRatio": 4 / 3, "znear": 0.01}}
    used = sorted({"KHR_lights_punctual", *material["extensions"]})
    return {
        "asset": {"version": "2.0", "generator": "translucid, contrib/samples.py"},
        "extensionsUsed": used,
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "cameras": [camera],
        "extensions": {"KHR_lights_punctual": {"lights": lights}},
        "materials": [material],
        "meshes": meshes,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }


def gltf_material(name):
    """A material of the extensions of glTF, without a highlight."""
    extensions = {"KHR_materials_specular": {"specularFactor": 0}}
    base = [1, 1, 1]
    if name in BODIES:
        body = BODIES[name]
        # Extinction is -ln(color) / distance: of the longest mean free path the color is 1/e
        distance = max(body["mfp"])
        extensions |= {
            "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
            "KHR_materials_volume": {
                "thicknessFactor": 0.002,
                "attenuationDistance": distance,
                "attenuationColor": [math.exp(-distance / mfp) for mfp in body["mfp"]],
            },
            "KHR_materials_volume_scatter": {"multiscatterColorFactor": body["color"], "scatterAnisotropy": body["g"]},
        }
    else:
        of = SHEETS[name]
        base = of["reflected"]
        extensions["KHR_materials_diffuse_transmission"] = {
            "diffuseTransmissionFactor": of["share"],
            "diffuseTransmissionColorFactor": of["passed"],
        }
    pbr = {"baseColorFactor": [*base, 1], "metallicFactor": 0, "roughnessFactor": 1}
    return {"name": name, "doubleSided": name in SHEETS, "pbrMetallicRoughness": pbr, "extensions": extensions}


def mtlx(name):
    """A material of OpenPBR Surface, without a highlight."""
    listed = lambda numbers: ", ".join(f"{x:g}" for x in numbers)
    inputs = [("specular_weight", "float", "0"), ("subsurface_weight", "float", "1")]
    if name in BODIES:
        body = BODIES[name]
        longest = max(body["mfp"])
        inputs += [
            ("subsurface_color", "color3", listed(body["color"])),
            ("subsurface_radius", "float", f'{1000 * longest:g}" unittype="distance" unit="millimeter'),
            ("subsurface_radius_scale", "color3", listed(mfp / longest for mfp in body["mfp"])),
            ("subsurface_scatter_anisotropy", "float", f"{body['g']:g}"),
        ]
    else:
        inputs += [
            ("subsurface_color", "color3", listed(SHEETS[name]["color"])),
            ("subsurface_scatter_anisotropy", "float", f"{SHEETS[name]['g']:g}"),
            ("geometry_thin_walled", "boolean", "true"),
        ]
    lines = [f'    <input name="{name}" type="{kind}" value="{value}" />' for name, kind, value in inputs]
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<materialx version="1.39" colorspace="lin_rec709">',
            f'  <open_pbr_surface name="{name}_shader" type="surfaceshader">',
            *lines,
            "  </open_pbr_surface>",
            f'  <surfacematerial name="{name}" type="material">',
            f'    <input name="surfaceshader" type="surfaceshader" nodename="{name}_shader" />',
            "  </surfacematerial>",
            "</materialx>",
            "",
        ]
    )


def scene(name, form):
    """The scene file of a sample."""
    of = "body" if name in BODIES else "sheet"
    file = f"{name}.gltf" if form == "gltf" else f"stage-{of}.gltf"
    unit = 'file_unit = "mm"\n' if name in SHEETS else ""  # Of a length that does not count
    material = f'[[material]]\nname = "sample"\nfile = "{name}.mtlx"\n{unit}\n' if form == "mtlx" else ""
    link = 'material = "sample"\n' if form == "mtlx" else ""
    return (
        f'unit = "mm"\n\n[camera]\nposition = [0, 0, 120]\ntarget = [0, 0, 0]\nfov = 23\n\n[film]\nsize = [{SIZE[0]}, {SIZE[1]}]\n'
        f'exposure = {EXPOSURE}\ntone_mapping = "srgb"\n\n{material}[[object]]\nfile = "{file}"\n{link}'
    )


def write_files():
    FOLDER.mkdir(exist_ok=True)
    write = lambda name, text: (FOLDER / name).write_text(text)
    dumped = lambda tree: json.dumps(tree, indent=1) + "\n"
    grey = {"name": "grey", "pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {}}
    for of in ("body", "sheet"):
        write(f"stage-{of}.gltf", dumped(gltf(grey, of == "sheet")))
    for name, form in SAMPLES:
        if form == "gltf":
            write(f"{name}.gltf", dumped(gltf(gltf_material(name), name in SHEETS)))
        else:
            write(f"{name}.mtlx", mtlx(name))
        write(f"{name}-{form}.toml", scene(name, form))


def render(stem):
    """The runs of a sample: linear pictures."""
    import numpy
    import OpenEXR

    runs = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(1, RUNS + 1):
            words = [TRANSLUCID, "render", str(FOLDER / f"{stem}.toml"), "--subsurface", "random-walk", "-q"]
            words += ["--spp", str(SPP // RUNS), "--seed", str(seed), "-o", f"{folder}/run.exr"]
            subprocess.run(words, check=True)
            channels = OpenEXR.File(f"{folder}/run.exr", separate_channels=True).channels()
            runs.append(numpy.stack([channels[c].pixels for c in "RGB"], axis=-1).astype(float))
    return numpy.array(runs)


def save(picture, path):
    """Writes a linear picture as sRGB at the exposure of the scenes."""
    import numpy
    from PIL import Image

    light = numpy.clip(2**EXPOSURE * picture, 0, 1)
    coded = numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    Image.fromarray((255 * coded + 0.5).astype(numpy.uint8)).save(path, optimize=True)


def rows(runs, name):
    for place, (x, y, x2, y2) in PLACES.items():
        means = runs[:, y:y2, x:x2].mean(axis=(1, 2))
        mean, error = means.mean(axis=0), means.std(axis=0, ddof=1) / math.sqrt(RUNS)
        cells = (f"{m:.4f} ± {e:.4f}" for m, e in zip(mean, error))
        yield f"| `{name}` | {place} | " + " | ".join(cells) + " |"


def write_page(made):
    """Puts rows between the marks of the page; those of samples that were not made stay."""
    text = PAGE.read_text()
    marks = re.compile(r"(<!-- measured: python3 contrib/samples\.py -->\n)(.*?)(<!-- end of what was measured -->)", re.DOTALL)
    old = marks.search(text)[2].splitlines()
    table = ["| sample | place | red | green | blue |", "|---|---|---|---|---|"]
    for name, form in SAMPLES:
        file = f"{name}.{form}"
        table += made.get(file) or [row for row in old if row.startswith(f"| `{file}` ")]
    PAGE.write_text(marks.sub(lambda match: match[1] + "\n".join(table) + "\n" + match[3], text))


def main():
    write_files()
    wanted = sys.argv[1:]
    if wanted == ["--files"]:
        return
    made = {}
    for name, form in SAMPLES:
        if wanted and name not in wanted:
            continue
        runs = render(f"{name}-{form}")
        path = FOLDER / f"{name}-{form}.png"
        save(runs.mean(axis=0), path)
        made[f"{name}.{form}"] = list(rows(runs, f"{name}.{form}"))
        print(f"{path.name}: {path.stat().st_size / 1000:.0f} kB")
        print("\n".join(made[f"{name}.{form}"]), flush=True)
    write_page(made)


if __name__ == "__main__":
    main()
