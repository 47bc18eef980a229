#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a release of Blender has changed that the extension and its tests look at.

    PYTHON-OF-ONE-BPY     blender/changes.py dump -o 52.json
    PYTHON-OF-ANOTHER-BPY blender/changes.py dump -o 53.json
    python3               blender/changes.py compare 52.json 53.json

A dump takes a minute of CPU, and needs translucid's module in that Python, as the tests do.
It holds every shader node with its properties (items of menus with their numbers, values when new, ranges) and sockets
(kind, value, range), the settings of lamps, cameras, worlds, view layers, image files and Cycles, and numbers of six kinds
of pictures by Cycles, each the mean of eight seeds with its standard error.
`compare` prints one line for each difference; numbers of pictures differ where they are 1 % and five standard errors apart.
"""

import argparse
import itertools
import json
import math
import sys
import warnings
from pathlib import Path

if "compare" not in sys.argv:
    # In place of this folder, whose `translucid` is the extension and not the module.
    sys.path[0] = str(Path(__file__).parent / "tests")
    import bpy
    import harness
    import numpy as np

SEEDS = range(1, 9)
# Least relative and absolute difference of a picture's numbers, and the least in standard errors.
RELATIVE, ABSOLUTE, ERRORS = 0.01, 1e-4, 5.0


# --- what there is


def settings_of(owner, base=None):
    """The properties of something new, or those that it has and the class `base` has not."""
    known = {"rna_type"} | set(() if base is None else base.bl_rna.properties.keys())
    return {p.identifier: described(p, owner) for p in owner.bl_rna.properties if p.identifier not in known}


def described(prop, owner):
    """One property: its kind, items of a menu with their numbers, value and range.

    The value is that of `owner`: the default that a property states for itself is often not what a new thing has.
    """
    found = {"kind": prop.type}
    if prop.type == "ENUM":
        found["items"] = {item.identifier: item.value for item in prop.enum_items}
        found["default"] = plain(sorted(value) if isinstance(value := getattr(owner, prop.identifier), set) else value)
    elif prop.type in {"BOOLEAN", "FLOAT", "INT"} and not prop.is_readonly:
        found["default"] = plain(getattr(owner, prop.identifier))
    if prop.type in {"FLOAT", "INT"}:
        found["range"] = plain((prop.hard_min, prop.hard_max))
    return found


def plain(value):
    """A value as JSON takes it, numbers with six digits."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    return value if value is None or isinstance(value, (bool, int, str)) else [plain(x) for x in value]


def sockets_of(sockets, node, interface):
    """Sockets by identifier; a group's interface that is made of one knows its range."""
    found = {}
    for socket in sockets:
        entry = found[socket.identifier] = {"kind": socket.type, "name": socket.name, "is shown": socket.enabled}
        if hasattr(socket, "default_value"):
            entry["default"] = plain(socket.default_value)
        if socket.type in {"VALUE", "INT"} and not socket.is_output:
            copy = interface.new_socket("copy", socket_type="NodeSocketFloat" if socket.type == "VALUE" else "NodeSocketInt")
            copy.from_socket(node, socket)
            entry["range"] = plain((copy.min_value, copy.max_value))
            interface.remove(copy)
    return found


def shader_nodes():
    """Every shader node that can be made, by its class."""
    tree = harness.Nodes().tree
    interface = bpy.data.node_groups.new("ranges", "ShaderNodeTree").interface
    found = {}
    for name in sorted(dir(bpy.types)):
        kind = getattr(bpy.types, name)
        if not isinstance(kind, type) or not issubclass(kind, bpy.types.ShaderNode):
            continue
        try:
            node = tree.nodes.new(name)
        except RuntimeError:
            continue
        found[name] = {
            "label": node.bl_label,
            "property": settings_of(node, bpy.types.ShaderNode),
            "input": sockets_of(node.inputs, node, interface),
            "output": sockets_of(node.outputs, node, interface),
        }
    return found


def other_settings():
    """Settings of what is no node."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    owners = {f"{kind.lower()} lamp": bpy.data.lights.new("a", kind) for kind in ("POINT", "SPOT", "SUN", "AREA")}
    owners |= {"camera": bpy.data.cameras.new("a"), "world": bpy.data.worlds.new("a"), "material": bpy.data.materials.new("a")}
    found = {label: settings_of(owner, bpy.types.ID) for label, owner in owners.items()}
    mesh_object = bpy.data.objects.new("a", bpy.data.meshes.new("a"))
    owners |= {"scene": scene, "view layer": layer, "object": mesh_object}
    found |= {f"Cycles' {label}": settings_of(owner.cycles) for label, owner in owners.items() if hasattr(owner, "cycles")}
    found["image file"] = settings_of(scene.render.image_settings)
    found["passes"] = {name: entry for name, entry in settings_of(layer).items() if name.startswith("use_pass")}
    found["visibility"] = {name: entry for name, entry in settings_of(mesh_object).items() if name.startswith("visible_")}
    scene.render.engine = "CYCLES"
    for owner in (layer, layer.cycles):
        for name in owner.bl_rna.properties.keys():
            if "pass" in name and isinstance(getattr(owner, name), bool):
                setattr(owner, name, True)
    layer.update_render_passes()
    node = bpy.data.node_groups.new("passes", "CompositorNodeTree").nodes.new("CompositorNodeRLayers")
    found["names of passes"] = {output.name: {"kind": output.type} for output in node.outputs}
    return found


# --- six kinds of pictures


def material(kind, properties=None, **inputs):
    """A material of one node; of inputs that this Blender has not, nothing is set."""
    nodes = harness.Nodes(kind)
    node = nodes.add(kind)
    for name, value in (properties or {}).items():
        setattr(node, name, value)
    for name, value in inputs.items():
        socket = node.inputs.get(name.replace("_", " "))
        if socket is not None:
            socket.default_value = (*value, 1) if socket.type == "RGBA" else value
    return nodes.surface(node)


def new_scene(width, height):
    scene = harness.new_scene(width, height)
    scene.render.threads = 1
    scene.translucid.use_caustics = True


def see(width):
    harness.add_camera((0, 0, 100), type="ORTHO", ortho_scale=width)


def shine(*angles):
    """A sun whose light on a white plane comes back as 1."""
    harness.add_light("SUN", rotation=harness.radians(*angles), energy=math.pi, angle=0.0)


def numbers(samples, measure):
    """The mean of a measure of the picture, a dict of arrays, over the seeds, and its standard error."""
    found = [measure(harness.render_cycles(samples, seed)[..., :3].astype(np.float64)) for seed in SEEDS]
    stacks = {name: np.array([values[name] for values in found]) for name in found[0]}
    errors = {name: stack.std(axis=0, ddof=1) / len(SEEDS) ** 0.5 for name, stack in stacks.items()}
    return {name: {"mean": plain(stack.mean(axis=0)), "error": plain(errors[name])} for name, stack in stacks.items()}


def brightness(picture):
    return {"brightness": picture.mean(axis=(0, 1))}


def edge_of_light(picture):
    """The mean way of light into the dark half, in widths of the picture, and the lit quarter's brightness."""
    columns = picture.mean(axis=0)
    count = len(columns)
    lit = columns[-count // 4 :].mean(axis=0)
    return {"width": (columns[: count // 2] / lit).sum(axis=0) / count, "brightness": lit}


def an_edge(method, anisotropy):
    new_scene(64, 8)
    settings = dict(Color=(0.8, 0.5, 0.2), Scale=1.0, Radius=(2.0, 2.0, 2.0), Anisotropy=anisotropy)
    harness.add_plane(300, material=material("SubsurfaceScattering", {"falloff": method}, **settings))
    # It hides the sun from one half, and is black.
    harness.add_plane(300, z=250, material=harness.matte((0, 0, 0))).location.x = -300
    shine(0, 0, 0)
    see(16)
    return numbers(100, edge_of_light)


def a_sheet(is_thin_wall):
    """A sheet that is lit from behind."""
    new_scene(8, 8)
    harness.add_plane(material=material("BsdfPrincipled", Base_Color=(0.8, 0.5, 0.3), Subsurface_Weight=1.0, Thin_Wall=is_thin_wall))
    shine(180, 0, 0)
    see(1)
    return numbers(128, brightness)


def a_ball(kind, **inputs):
    """A ball between the sun and a world."""
    new_scene(32, 32)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material(kind, **inputs))
    shine(40, 20, 0)
    harness.set_world((0.3, 0.35, 0.4))
    see(2.2)
    return numbers(128, brightness)


def a_normal_map(convention):
    """A plane whose normals are tilted by atan(3/4) toward +v, where green is up."""
    new_scene(8, 8)
    nodes = harness.Nodes()
    normal = nodes.add("NormalMap", Color=(0.5, 0.8, 0.9))
    if convention is not None:
        normal.convention = convention
    harness.add_plane(material=nodes.surface(nodes.add("BsdfDiffuse", Color=(0.5, 0.5, 0.5), Normal=normal.outputs[0])))
    shine(20, 0, 0)
    see(1)
    return numbers(64, brightness)


WEIGHTS = ("Metallic", "Subsurface_Weight", "Transmission_Weight", "Coat_Weight", "Sheen_Weight", "Anisotropic", "Diffuse_Roughness")


def pictures():
    """The numbers of all pictures; settings that this Blender has not are left out."""
    found = {f"edge of light, {method}, anisotropy {g}": an_edge(method, g) for method in harness.SUBSURFACE_METHODS for g in (0.0, 0.6)}
    found["sheet"] = a_sheet(False)
    found["sheet, thin wall"] = a_sheet(True)
    found["ball, Principled as it is made"] = a_ball("BsdfPrincipled")
    found["ball, Principled with all weights 0.3"] = a_ball("BsdfPrincipled", **dict.fromkeys(WEIGHTS, 0.3))
    found["ball, Glossy"] = a_ball("BsdfAnisotropic", Color=(0.9, 0.6, 0.3), Roughness=0.3)
    found["ball, Glass"] = a_ball("BsdfGlass", Color=(0.9, 0.6, 0.3))
    found["ball, Emission"] = a_ball("Emission", Color=(0.9, 0.6, 0.3))
    conventions = bpy.types.ShaderNodeNormalMap.bl_rna.properties.get("convention")
    for convention in (None, *(conventions.enum_items.keys() if conventions else ())):
        found[f"normal map, {convention or 'as it is made'}"] = a_normal_map(convention)
    return found


def dump(path):
    """Writes what this Blender has."""
    # Properties on their way out are read, too.
    warnings.simplefilter("ignore", DeprecationWarning)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    found = {"version": bpy.app.version_string, "node": shader_nodes(), "settings": other_settings()}
    found["picture"] = pictures()
    Path(path).write_text(json.dumps(found, indent=1, sort_keys=True))
    print(f"{found['version']}: {len(found['node'])} nodes, {len(found['picture'])} pictures in {path}")


# --- what differs


def differences(before, after, path=()):
    """Paths with the values before and after; None where there was or is nothing."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in sorted(before.keys() | after.keys(), key=str):
            yield from differences(before.get(key), after.get(key), (*path, key))
    elif before != after:
        yield path, before, after


def worded(value):
    """A value in a line: of a thing that came or went its kind and default."""
    if not isinstance(value, dict):
        return json.dumps(value)
    if "label" in value:
        return ", ".join(("inputs: ", *value["input"])).replace(": , ", ": ") + "; properties: " + ", ".join(value["property"])
    parts = [value.get("kind", ""), f"default {json.dumps(value['default'])}" if "default" in value else ""]
    return ", ".join(part for part in (*parts, ", ".join(value.get("items", ()))) if part)


def lines_of_things(before, after):
    for path, old, new in differences(before, after):
        place = ": ".join(" ".join(path[i : i + 2]) for i in range(0, len(path), 2))
        if old is None:
            yield f"+ {place}: {worded(new)}"
        elif new is None:
            yield f"- {place}"
        else:
            yield f"  {place}: {worded(old)} -> {worded(new)}"


def lines_of_pictures(before, after):
    for name in sorted(before.keys() & after.keys()):
        for measure in before[name]:
            old, new = before[name][measure], after[name][measure]
            pairs = list(zip(old["mean"], new["mean"], old["error"], new["error"], strict=True))
            if any(abs(b - a) > max(RELATIVE * abs(a), ABSOLUTE, ERRORS * math.hypot(s, t)) for a, b, s, t in pairs):
                row = ", ".join(f"{a:.4f} -> {b:.4f} ± {math.hypot(s, t):.4f}" for a, b, s, t in pairs)
                yield f"  {name}, {measure}: {row}"
    yield from (f"+ {name}" for name in sorted(after.keys() - before.keys()))
    yield from (f"- {name}" for name in sorted(before.keys() - after.keys()))


def compare(paths):
    """Prints what differs from each dump to the next."""
    dumps = [json.loads(Path(path).read_text()) for path in paths]
    for before, after in itertools.pairwise(dumps):
        print(f"{before['version']} -> {after['version']}")
        for part, lines in (("node", lines_of_things), ("settings", lines_of_things), ("picture", lines_of_pictures)):
            found = list(lines(before[part], after[part]))
            print(f"\n{part}: {len(found)} differences", *found, sep="\n")
        print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("dump", help="write what this Blender has").add_argument("-o", "--output", required=True)
    commands.add_parser("compare", help="print what differs from one dump to the next").add_argument("dumps", nargs="+")
    arguments = parser.parse_args()
    if arguments.command == "dump":
        dump(arguments.output)
    else:
        compare(arguments.dumps)


if __name__ == "__main__":
    main()
