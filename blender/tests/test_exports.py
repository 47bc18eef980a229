# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that Blender writes, rendered from disk beside the same scene in the extension."""

import bpy
import numpy as np
import pytest
import translucid
from mathutils import Vector
from harness import Nodes, add_camera, add_light, combined, messages, new_scene, radians, set_world

COLOR, ROUGHNESS = (0.8, 0.3, 0.1), 0.6
SIZE, SAMPLES = 48, 128


def checker(folder):
    """A texture whose colors are far apart, in a file: OBJ's exporter forgets an image that is packed."""
    image = bpy.data.images.new("checker", 8, 8)
    x, y = np.meshgrid(np.arange(8), np.arange(8))
    # Different along x and y, so that a mirrored texture is seen.
    colors = np.stack([x / 8, y / 8, (x + y) % 2, np.ones_like(x)], axis=-1)
    image.pixels.foreach_set(colors.astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(folder / "checker.png"), "PNG"
    image.save()
    return image


def suzanne(folder, is_textured):
    """Suzanne, turned, moved and stretched, with smooth faces and a UV map."""
    new_scene(SIZE, SIZE, SAMPLES)
    bpy.ops.mesh.primitive_monkey_add(location=(0.2, 0.1, -0.1), rotation=(0.2, 0.1, 0.4))
    bpy.ops.object.shade_smooth()
    bpy.context.object.scale = (1.2, 1.0, 0.9)
    nodes = Nodes("paint")
    color = COLOR
    if is_textured:
        texture = nodes.add("TexImage")
        texture.image = checker(folder)
        color = texture.outputs["Color"]
    bpy.context.object.data.materials.append(nodes.surface(nodes.add("BsdfPrincipled", Base_Color=color, Roughness=ROUGHNESS)))
    add_camera((0, -6, 0), radians(90, 0, 0), type="ORTHO", ortho_scale=3.2)
    add_light("SUN", rotation=radians(50, 0, 30), energy=2.0, angle=0.0)
    set_world((0.4, 0.5, 0.6))


def export(kind, path):
    if kind == "glb":
        bpy.ops.export_scene.gltf(filepath=path, export_format="GLB", use_selection=True)
    elif kind == "gltf":
        bpy.ops.export_scene.gltf(filepath=path, export_format="GLTF_SEPARATE", use_selection=True)
    elif kind == "usd":
        # Who has USD goes through Blender.
        bpy.ops.wm.usd_export(filepath=path.replace(".glb", ".usdc"), selected_objects_only=True)
        bpy.ops.object.delete()
        bpy.ops.wm.usd_import(filepath=path.replace(".glb", ".usdc"))
        export("glb", path)
    elif kind == "obj":
        bpy.ops.wm.obj_export(filepath=path, export_selected_objects=True, forward_axis="Y", up_axis="Z", path_mode="COPY")
    else:
        operator = {"ply": bpy.ops.wm.ply_export, "stl": bpy.ops.wm.stl_export}[kind]
        operator(filepath=path, export_selected_objects=True, forward_axis="Y", up_axis="Z")


def picture_of(path, is_upright, **keys):
    """What the renderer makes of a file in the scene of `suzanne`, whose z points along `up` of the file."""
    turn = (lambda x, y, z: [x, z, -y]) if is_upright else (lambda x, y, z: [x, y, z])
    scene = translucid.Scene(unit="m")
    if keys:
        scene.add_material("paint", **keys)
    scene.add_object("body", file=path, **({"material": "paint"} if keys else {}))
    scene.set_camera(position=turn(0, -6, 0), target=turn(0, 0, 0), up=turn(0, 0, 1), projection="orthographic", width=3.2)
    # Toward the lamp, whose light goes along -z
    sun = bpy.data.objects["lamp"].matrix_world.to_3x3() @ Vector((0, 0, 1))
    scene.add_light("distant", direction=turn(*sun), irradiance=[2.0] * 3)
    scene.set_environment(radiance=[0.4, 0.5, 0.6])
    scene.set_film(size=[SIZE, SIZE], filter_radius=bpy.context.scene.render.filter_size)
    scene.set_integrator(samples_per_pixel=SAMPLES)
    return translucid.render(scene)["radiance"]


@pytest.mark.parametrize("kind, is_textured", [("glb", False), ("glb", True), ("gltf", True), ("usd", True), ("obj", False), ("obj", True), ("ply", False), ("stl", False)])
def test_files_look_as_the_scene_that_they_were_written_from(kind, is_textured, tmp_path):
    suzanne(tmp_path, is_textured)
    whole = combined()[..., :3]
    assert messages() == []
    lamp = bpy.data.objects["lamp"]
    for owner in bpy.data.objects:
        owner.select_set(owner.type == "MESH")
    bpy.context.view_layer.objects.active = next(owner for owner in bpy.data.objects if owner.type == "MESH")
    path = str(tmp_path / f"file.{'glb' if kind == 'usd' else kind}")
    export(kind, path)
    assert lamp.name in bpy.data.objects
    # PLY and STL have no material, STL no smooth faces, and PLY no normals: those of seams are made by the angle between faces.
    keys = {"base_color": list(COLOR), "specular_roughness": ROUGHNESS} if kind in {"ply", "stl"} else {}
    ours = picture_of(path, kind in {"glb", "gltf", "usd"}, **keys)
    ratio = ours.mean(axis=(0, 1)) / whole.mean(axis=(0, 1))
    differences = np.abs(ours - whole).mean() / whole.mean()
    print(f"{kind} {is_textured}: ratio {ratio.round(4)}, differences {differences:.4f}")
    assert np.abs(ratio - 1).max() < {"obj": 0.03, "stl": 0.03, "ply": 0.01}.get(kind, 0.005)
    assert differences < (0.06 if kind in {"obj", "stl"} else 0.02)
