#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders every shader node, socket by socket, with Cycles and with translucid, and lists where they differ.

    PYTHON-OF-BPY blender/sweep.py [--write] [--only NODE,…] [--json FILE]

Shaders are on a ball above a matte ground, other nodes are the color of a plane that shows an image. Each socket and
each property is as it is made and has other values, and each number and color of a shader is an image once.
A row is *equal* where all regions of both pictures differ by less than 1 % or two standard errors, *said* where the panel
*Not Rendered as It Is* has a message, and *silent* otherwise, which is a bug. `--write` puts the table into
docs/guide/blender-nodes.md. It takes 15 minutes of CPU, and needs translucid's module in that Python, as the tests do.
"""

import argparse
import json
import re
import sys
from collections import defaultdict
from pathlib import Path

# In place of this folder, whose `translucid` is the extension and not the module.
sys.path[0] = str(Path(__file__).parent / "tests")

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from harness import Nodes, add_camera, add_light, add_plane, combined, matte, messages, new_scene, radians, render_cycles, set_world  # noqa: E402

PAGE = Path(__file__).parents[1] / "docs/guide/blender-nodes.md"
SIZE, SAMPLES = 24, 64
# Least differences that count, relative and absolute, and in standard errors.
RELATIVE, ABSOLUTE, ERRORS = 0.01, 0.0015, 2.0
# A difference below this, and one that is as small as this many times the least, is measured again with more samples.
DOUBTFUL, NOISY, MORE = 0.08, 1.2, 8

# What is not of Cycles, or has nothing to show: nodes of Eevee and Freestyle, frames of trees, scripts.
LEFT_OUT = {"EeveeSpecular", "ShaderToRGB", "UVAlongStroke", "Squeeze", "Group", "Script", "Background", "TexIES", "HairInfo"}
VOLUMES = ("PrincipledVolume", "VolumeAbsorption", "VolumeScatter", "VolumePrincipled", "VolumeCoefficients")
DISPLACEMENTS = ("Displacement", "VectorDisplacement")
NORMALS = ("Bump", "NormalMap", "Bevel")

# What makes the settings whose names begin so matter: sockets and properties of the node.
CONTEXTS = {
    "BsdfPrincipled": {
        "Subsurface IOR": {"Subsurface Weight": 1.0, "Subsurface Scale": 0.2, "subsurface_method": "RANDOM_WALK_SKIN"},
        "Subsurface": {"Subsurface Weight": 1.0, "Subsurface Scale": 0.2},
        "subsurface": {"Subsurface Weight": 1.0, "Subsurface Scale": 0.2},
        "Coat": {"Coat Weight": 1.0},
        "Sheen": {"Sheen Weight": 0.5},
        "Transmission": {"Transmission Weight": 1.0},
        "Emission": {"Emission Strength": 0.3},
        "Thin Film": {"Thin Film Thickness": 400.0},
        "Anisotropic": {"Metallic": 1.0, "Anisotropic": 0.6},
        "Tangent": {"Metallic": 1.0, "Anisotropic": 0.6},
        "distribution": {"Metallic": 1.0},
    },
    "BsdfAnisotropic": {"Rotation": {"Anisotropy": 0.6}, "Tangent": {"Anisotropy": 0.6}},
    "BsdfMetallic": {
        "Rotation": {"Anisotropy": 0.6},
        "Tangent": {"Anisotropy": 0.6},
        "IOR": {"fresnel_type": "PHYSICAL_CONDUCTOR"},
        "Extinction": {"fresnel_type": "PHYSICAL_CONDUCTOR"},
        "Thin Film": {"Thin Film Thickness": 400.0},
    },
    "BsdfGlass": {"Thin Film": {"Thin Film Thickness": 400.0}, "distribution": {"Roughness": 0.5}},
    "BsdfRefraction": {"distribution": {"Roughness": 0.5}},
    "SubsurfaceScattering": {"": {"Scale": 0.2}, "IOR": {"falloff": "RANDOM_WALK_SKIN"}, "Roughness": {"falloff": "RANDOM_WALK_SKIN"}},
}
# What other nodes begin with in place of an image in the first input.
BASES = {
    "Mix": {"data_type": "RGBA", "Factor_Float": 0.6, "A_Color": "image", "A_Float": "image", "A_Vector": "image", "B_Color": (0.3, 0.6, 0.4)},
    "MixRGB": {"Fac": 0.6, "Color1": "image", "Color2": (0.3, 0.6, 0.4)},
    "Math": {"Value": "image", "Value_001": 0.35, "Value_002": 0.15},
    "VectorMath": {"Vector": "image", "Vector_001": (0.3, 0.6, 0.4), "Vector_002": (0.5, 0.2, 0.7), "Scale": 0.7},
    "MapRange": {"Value": "image", "Vector": "image", "From Min": 0.2, "To Max": 0.8},
    "VectorRotate": {"Vector": "image", "Axis": (0.3, 0.2, 0.9), "Angle": 0.3, "Rotation": (0.2, 0.1, 0.3)},
    "Normal": {"Normal": "image"},
}
# Shaders that are mixed and added.
DIFFUSE, GLOSSY = ("BsdfDiffuse", {"Color": (0.6, 0.3, 0.15)}), ("BsdfAnisotropic", {"Color": (0.3, 0.25, 0.2), "Roughness": 0.3})
PAIRS = {
    "Diffuse and Diffuse": (("BsdfDiffuse", {"Color": (0.2, 0.4, 0.5)}), DIFFUSE),
    "Diffuse and Glossy": (DIFFUSE, GLOSSY),
    "Glossy and Glossy": (("BsdfAnisotropic", {"Color": (0.2, 0.3, 0.4), "Roughness": 0.6}), GLOSSY),
    "Diffuse and Glass": (DIFFUSE, ("BsdfGlass", {})),
    "Diffuse and Transparent": (DIFFUSE, ("BsdfTransparent", {})),
    "Diffuse and Emission": (DIFFUSE, ("Emission", {"Color": (0.2, 0.3, 0.4)})),
    "Transparent and Emission": (("BsdfTransparent", {}), ("Emission", {"Color": (0.2, 0.3, 0.4)})),
    "Principled and Glossy": (("BsdfPrincipled", {"Base Color": (0.6, 0.3, 0.15)}), GLOSSY),
    "Principled and Transparent": (("BsdfPrincipled", {"Base Color": (0.6, 0.3, 0.15)}), ("BsdfTransparent", {})),
    "Subsurface and Diffuse": (("SubsurfaceScattering", {"Scale": 0.2}), DIFFUSE),
    "Subsurface and Glossy": (("SubsurfaceScattering", {"Scale": 0.2}), GLOSSY),
}
# Values of sockets, by the beginning of the name, or the node and that; of others by kind.
VALUES = {
    "BsdfMetallic IOR": ((2.76, 2.51, 2.23), (0.2, 0.9, 1.1)),
    "BsdfMetallic Extinction": ((3.87, 3.4, 3.01), (3.9, 2.4, 2.3)),
    "IOR": (1.2, 2.0),
    "Subsurface IOR": (1.2, 1.8),
    "Coat IOR": (1.2, 2.0),
    "Thin Film IOR": (1.1, 2.0),
    "Thin Film Thickness": (200.0, 600.0),
    "Subsurface Scale": (0.05, 0.5),
    "Scale": (0.05, 0.5),
    "Subsurface Anisotropy": (-0.5, 0.7),
    "Anisotropy": (-0.5, 0.7),
    "Subsurface Radius": ((1.0, 1.0, 1.0), (0.1, 0.3, 0.6)),
    "Radius": ((0.5, 0.5, 0.5), (0.1, 0.3, 0.6)),
    "Temperature": (1500.0, 9000.0),
    "Wavelength": (450.0, 600.0),
}
BY_KIND = {"VALUE": (0.0, 0.3, 1.0), "RGBA": ((0.9, 0.5, 0.2), (0.2, 0.4, 0.8)), "VECTOR": ((0.2, 0.5, 0.3), (0.6, 0.1, 0.8)), "INT": (0, 3)}


def an_image():
    """Colors between 0.1 and 0.9 that differ in all quarters; one image for all rows."""
    image = bpy.data.images.get("sweep") or bpy.data.images.new("sweep", 128, 128, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    x, y = np.meshgrid(np.linspace(0.1, 0.9, 128), np.linspace(0.1, 0.9, 128))
    pixels = np.stack([x, y, 0.2 + 0.6 * x * y, np.ones_like(x)], axis=-1)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    return image


class Row:
    """A node with some settings: changes are values of sockets (by identifier) and properties; `image` is a linked image."""

    def __init__(self, kind, what, value, changes, output=0):
        self.kind, self.what, self.value, self.changes, self.output = kind, what, value, changes, output

    @property
    def is_shader(self):
        return self.kind in SHADERS or self.kind in VOLUMES + DISPLACEMENTS + NORMALS

    def material(self):
        nodes = Nodes("sweep")
        node = nodes.add(self.kind)
        names = sorted(self.changes, key=lambda name: name in {socket.identifier for socket in node.inputs})
        for name in names:
            self._set(nodes, node, name, self.changes[name])
        if self.kind in ("MixShader", "AddShader"):
            pair = PAIRS[self.value if self.value in PAIRS else "Diffuse and Diffuse"]
            for socket, (kind, inputs) in zip([s for s in node.inputs if s.type == "SHADER"], pair, strict=True):
                nodes.tree.links.new(nodes.add(kind, **{name.replace(" ", "_"): value for name, value in inputs.items()}).outputs[0], socket)
        if self.kind in ("TexImage", "TexEnvironment"):
            node.image = an_image()
        if self.kind in VOLUMES:
            nodes.tree.links.new(node.outputs[0], nodes.output.inputs["Volume"])
            return nodes.material
        if self.kind in DISPLACEMENTS:
            nodes.tree.links.new(node.outputs[0], nodes.output.inputs["Displacement"])
            return nodes.surface(nodes.add("BsdfDiffuse"))
        if self.kind in NORMALS:
            return nodes.surface(nodes.add("BsdfDiffuse", Normal=node.outputs[0]))
        output = next(output for output in (node.outputs[self.output], *node.outputs) if output.enabled)
        return nodes.surface(node if self.is_shader else nodes.add("BsdfDiffuse", Color=output))

    def _set(self, nodes, node, name, value):
        socket = next((socket for socket in node.inputs if socket.identifier == name), None)
        if socket is None:
            setattr(node, name, value)
        elif value == "image":
            texture = nodes.add("TexImage")
            texture.image = an_image()
            nodes.tree.links.new(texture.outputs[0], socket)
        elif value == "normal map":
            nodes.tree.links.new(nodes.add("NormalMap", Color=(0.6, 0.5, 0.9)).outputs[0], socket)
        elif value == "tangent":
            nodes.tree.links.new(nodes.add("Tangent").outputs[0], socket)
        else:
            socket.default_value = (*value, 1) if socket.type == "RGBA" else value


# --- which rows there are


def kinds():
    """The shaders and the other nodes that can be made and have something to show."""
    tree, shaders, others = Nodes().tree, [], []
    for name in dir(bpy.types):
        kind = name.removeprefix("ShaderNode")
        if kind == name or kind in LEFT_OUT or kind.startswith("Output"):
            continue
        try:
            node = tree.nodes.new(name)
        except RuntimeError:
            continue
        if len(node.outputs):
            (shaders if node.outputs[0].type == "SHADER" and kind not in VOLUMES else others).append(kind)
    return shaders, others


SHADERS, OTHERS = kinds()


def rows_of(kind):
    """A node as it is made, then with each other value of each property, socket and output."""
    node = Nodes().add(kind)
    is_shader = kind in SHADERS
    base = {} if is_shader or kind in NORMALS + DISPLACEMENTS + VOLUMES else BASES.get(kind) or pictured(node)
    yield Row(kind, "", "as made", {})
    if base:
        yield Row(kind, ", ".join(base), "", base)
    for pair in PAIRS if kind in ("MixShader", "AddShader") else ():
        yield Row(kind, "of", pair, {})
    own = set(node.bl_rna.properties.keys()) - set(bpy.types.ShaderNode.bl_rna.properties.keys())
    for name in sorted(own):
        for value in property_values(node, name):
            yield Row(kind, name, value, context(kind, name) | base | {name: value})
    for socket in node.inputs:
        name = socket.identifier
        if base.get(name) == "image" or name == "Weight" or socket.type in {"SHADER", "CUSTOM"}:
            continue
        for value in socket_values(kind, socket):
            yield Row(kind, name, value, base | context(kind, name) | {name: value})
    for index, output in enumerate(node.outputs):
        if index and output.enabled and not is_shader:
            yield Row(kind, f"output {output.identifier}", "", base, index)


def context(kind, name):
    found = CONTEXTS.get(kind, {})
    merged = {}
    for start in sorted((start for start in found if name.startswith(start)), key=len):
        merged = merged | found[start] if not start else found[start] | ({} if start else merged)
    return {key: value for key, value in merged.items() if key != name}


def pictured(node):
    """An image in the first input that is a color, vector or number."""
    for kinds in ({"RGBA"}, {"VECTOR"}, {"VALUE"}):
        for socket in node.inputs:
            if socket.type in kinds and socket.enabled and not (socket.hide_value and socket.name == "Vector" and node.type.startswith("TEX")):
                return {socket.identifier: "image"}
    return {}


def property_values(node, name):
    prop, value = node.bl_rna.properties[name], getattr(node, name)
    if prop.is_readonly or prop.type not in {"ENUM", "BOOLEAN"} or getattr(prop, "is_array", False):
        return []
    if prop.type == "BOOLEAN":
        return [not value]
    found = []
    for item in prop.enum_items:
        try:
            # Some items are of other editors.
            setattr(node, name, item.identifier)
            found.append(item.identifier)
        except TypeError:
            pass
    setattr(node, name, value)
    return [item for item in found if item != value]


def socket_values(kind, socket):
    """Two values that are not the default, and an image in a shader's numbers and colors."""
    if socket.hide_value:
        return ["normal map"] if "Normal" in socket.name else ["tangent"] if socket.name == "Tangent" else []
    if socket.type == "BOOLEAN":
        return [not socket.default_value]
    if socket.type == "MENU":
        return [item.identifier for item in socket.bl_rna.properties["default_value"].enum_items][:3]
    name = max((start for start in VALUES if f"{kind} {socket.identifier}".startswith((start, f"{kind} {start}"))), key=len, default=None)
    given = VALUES.get(name, BY_KIND.get(socket.type, ()))
    is_default = lambda value: np.allclose(np.atleast_1d(socket.default_value)[: np.size(value)], value)
    if not hasattr(socket, "default_value") or socket.type not in BY_KIND:
        return []
    if np.size(given[:1]) not in (0, np.size(socket.default_value), np.size(socket.default_value) - 1):
        given = BY_KIND[socket.type]
    values = [value for value in given if not is_default(value)][:2]
    return values + (["image"] if kind in SHADERS and socket.type in {"VALUE", "RGBA"} else [])


# --- pictures


def new_studio(is_shader):
    """A ball above a ground, or a plane in quarters; returns what has the material, and the regions."""
    scene = new_scene(SIZE, SIZE, SAMPLES)
    scene.render.threads, scene.translucid.use_caustics = 1, True
    # The renderer has one limit for all but diffuse bounces.
    scene.cycles.glossy_bounces = scene.cycles.transmission_bounces = 12
    x, y = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
    set_world((0.3, 0.35, 0.4))
    # A sun, because other lamps of the renderer hide the world behind them.
    add_light("SUN", rotation=radians(38, 0, 30), energy=1.0, angle=0.2)
    if not is_shader:
        owner = add_plane(1.0)
        add_camera((0, 0, 5), type="ORTHO", ortho_scale=1.8)
        right, down = x > SIZE / 2, y > SIZE / 2
        return owner, [right & down, right & ~down, ~right & down, ~right & ~down]
    bpy.ops.mesh.primitive_uv_sphere_add(segments=160, ring_count=80, radius=1)
    bpy.ops.object.shade_smooth()
    owner = bpy.context.object
    # Cycles moves the ends of shadow rays at smooth meshes; the renderer does not.
    owner.cycles.shadow_terminator_geometry_offset = 0.0
    add_plane(6, z=-1.0, material=matte((0.6, 0.6, 0.6), "ground"))
    add_camera((0, -6, 0.0), radians(90, 0, 0), type="ORTHO", ortho_scale=3.0)
    distance = np.hypot(x - SIZE / 2, y - SIZE / 2) * 3.0 / SIZE
    ball = distance < 0.88
    return owner, [ball & (y < SIZE / 2), ball & (y > SIZE / 2), (distance > 1.12) & (y > SIZE * 0.75)]


class Studio:
    """The two scenes, of which one is built; results by row."""

    def __init__(self):
        self.is_shader = None

    def measure(self, row, samples=SAMPLES):
        """Ratios and differences of the regions, in standard errors, and the messages."""
        if row.is_shader != self.is_shader:
            self.owner, self.regions = new_studio(row.is_shader)
            self.is_shader = row.is_shader
        self.owner.data.materials.clear()
        self.owner.data.materials.append(row.material())
        scene = bpy.context.scene
        scene.translucid.samples, ours = samples, []
        for scene.translucid.seed in (1, 2):
            ours.append(combined()[..., :3])
        said = [message.split(": ", 1)[1] for message in messages()]
        theirs = [render_cycles(samples, seed)[..., :3] for seed in (1, 2)]
        for material in [m for m in bpy.data.materials if m.name.startswith("sweep") and m.users == 0]:
            bpy.data.materials.remove(material)
        a, b = (np.array([np.mean([p[region].mean(axis=0) for p in both], axis=0) for region in self.regions]) for both in (ours, theirs))
        noise = np.sqrt(sum(np.array([(p[0] - p[1])[region].var(axis=0) / 4 / region.sum() for region in self.regions]) for p in (ours, theirs)))
        return a, b, noise, said

    def judge(self, row):
        a, b, noise, said = self.measure(row)
        is_doubtful = 0 < np.max(excess(a, b, noise)) and np.max(np.abs(a / np.maximum(b, 0.02) - 1)) < DOUBTFUL
        if is_doubtful or np.max(ERRORS * noise / least(b)) > NOISY:
            a, b, noise, said = self.measure(row, SAMPLES * MORE)
        over = excess(a, b, noise)
        worst = int(np.argmax(over.max(axis=1)))
        state = "equal" if over.max() <= 0 else "said" if said else "silent"
        ratio = [round(float(x), 3) for x in a[worst] / np.maximum(b[worst], 1e-6)]
        return {"kind": row.kind, "what": row.what, "value": row.value, "state": state, "ratio": ratio, "said": said, "region": worst}


def least(b):
    """The differences that count."""
    return np.maximum(RELATIVE * b, ABSOLUTE)


def excess(a, b, noise):
    """By how much regions differ beyond what is allowed."""
    return np.abs(a - b) - np.maximum(least(b), ERRORS * noise)


# --- the page


def label(kind):
    return Nodes().add(kind).bl_label


def table(found):
    """Markdown: a line for each node, then one for each thing that is not equal."""
    counts = {state: sum(row["state"] == state for row in found) for state in ("equal", "said", "silent")}
    words = f"of {len(found)} rows {counts['equal']} are equal, {counts['said']} said, {counts['silent']} silent"
    lines = [f"Blender {bpy.app.version_string}: {words}.", ""]
    by_kind = defaultdict(list)
    for row in found:
        by_kind[row["kind"]].append(row)
    equal = [f"{label(kind)} ({len(rows)})" for kind, rows in by_kind.items() if all(row["state"] == "equal" for row in rows)]
    lines += [f"Equal in all rows: {', '.join(equal)}.", "", "| node | setting | ratio | message |", "|---|---|---|---|"]
    for kind, rows in by_kind.items():
        groups = defaultdict(list)
        for row in rows:
            if row["state"] != "equal":
                groups[(row["state"], "; ".join(re.sub(r"^[^:;]*: ", "", text) for text in row["said"]))].append(row)
        same = sum(row["state"] == "equal" for row in rows)
        for (state, text), group in groups.items():
            ratios = np.array([row["ratio"] for row in group])
            span = f"{ratios.min():.2f} to {ratios.max():.2f}" if ratios.max() < 100 else "black in Cycles"
            settings = worded(group) if len(group) < len(rows) else "all"
            lines.append(f"| {label(kind)} | {settings} | {span} | {text if state == 'said' else '**silent**'} |")
        if groups and same:
            lines.append(f"| {label(kind)} | {same} others | equal | |")
    return "\n".join(lines)


def worded(group):
    """Settings with their values, in few words."""
    by_name = defaultdict(list)
    for row in group:
        by_name[row["what"]].append(str(row["value"]))
    return ", ".join(f"{name} {'/'.join(values)}".strip() for name, values in by_name.items())


def write(text):
    begin, end = "<!-- measured: blender/sweep.py -->\n", "<!-- end of what was measured -->"
    page = PAGE.read_text()
    head, rest = page.split(begin)
    PAGE.write_text(f"{head}{begin}\n{text}\n\n{end}{rest.split(end, 1)[1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="put the table into the page")
    parser.add_argument("--only", help="nodes, as Principled's BsdfPrincipled, with commas between")
    parser.add_argument("--json", type=Path, help="keep rows here, and take the nodes that are there from it")
    arguments = parser.parse_args()
    # Those on a ball first.
    others = sorted(OTHERS, key=lambda kind: kind not in VOLUMES + DISPLACEMENTS + NORMALS)
    wanted = arguments.only.split(",") if arguments.only else SHADERS + others
    studio, found = Studio(), []
    kept = json.loads(arguments.json.read_text()) if arguments.json and arguments.json.exists() else []
    for kind in wanted:
        known = [row for row in kept if row["kind"] == kind]
        if known:
            found += known
            continue
        for row in list(rows_of(kind)):
            found.append(studio.judge(row))
            if found[-1]["state"] == "said" and any("node cannot be translated" in text for text in found[-1]["said"]):
                # So are its other settings.
                break
        if arguments.json:
            arguments.json.write_text(json.dumps(found))
    print(table(found))
    if arguments.write:
        write(table(found))


if __name__ == "__main__":
    main()
