#!/usr/bin/env bash
# Blender 5.2 gave the subsurface method RANDOM_WALK another meaning under the same name.
#
# Versions: bpy 5.1.2 and 5.2.3 (PyPI, Python 3.13).
# Expected: the same node, method RANDOM_WALK, radius 4π, scatters light as far in both, as a script's materials are to look
#           the same.
# Seen: 5.2.3 takes the radius itself for the mean free path, so a radius of 1 there is about one of 4π in 5.1.2, and one of 4π
#       lights most of the dark half. What 5.1 calls RANDOM_WALK is RANDOM_WALK_LEGACY in 5.2, number 4 of the enumeration;
#       the name RANDOM_WALK has gone to number 6.
# Fails if a width or a number is another.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=${PYTHON:-python3.13}

cat > "$folder/edge.py" <<'PYTHON'
import sys
import bpy, numpy as np

method, radius, path = sys.argv[1], float(sys.argv[2]), sys.argv[3]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
render = scene.render
render.engine, render.resolution_x, render.resolution_y = "CYCLES", 96, 16
scene.cycles.device, scene.cycles.samples, scene.cycles.seed = "CPU", 512, 1
scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False

def plane(x, z, shader, **inputs):
    mesh = bpy.data.meshes.new(shader)
    mesh.from_pydata([(x - 300, -300, z), (x + 300, -300, z), (x + 300, 300, z), (x - 300, 300, z)], [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new(shader)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(shader)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new(shader, mesh))
    return node

node = plane(0, 0, "ShaderNodeSubsurfaceScattering", Color=(0.8, 0.8, 0.8, 1), Radius=(radius,) * 3, Scale=1.0)
node.falloff = method
plane(-300, 250, "ShaderNodeBsdfDiffuse", Color=(0, 0, 0, 1))
sun = bpy.data.lights.new("sun", "SUN")
sun.angle = 0.0
scene.collection.objects.link(bpy.data.objects.new("sun", sun))
camera = bpy.data.cameras.new("camera")
camera.type, camera.ortho_scale = "ORTHO", 16.0
owner = bpy.data.objects.new("camera", camera)
owner.location = (0, 0, 100)
scene.collection.objects.link(owner)
scene.camera = owner
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.filepath = path
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(path)
pixels = np.array(image.pixels).reshape(16, 96, -1)[..., 0].mean(axis=0)
items = node.bl_rna.properties["falloff"].enum_items
print("found", items[method].value, (pixels[:48] / pixels[-24:].mean()).sum() * 16 / 96)
PYTHON

width() {
    local version=$1 method=$2 radius=$3
    if [ ! -d "$folder/$version" ]; then
        "$python" -m venv "$folder/$version"
        "$folder/$version/bin/pip" install --quiet --disable-pip-version-check "bpy==$version"
    fi
    "$folder/$version/bin/python" "$folder/edge.py" "$method" "$radius" "$folder/edge.exr" 2>/dev/null | sed -n 's/^found //p'
}

read -r number_old old <<< "$(width 5.1.2 RANDOM_WALK 12.566)"
read -r number_new new <<< "$(width 5.2.3 RANDOM_WALK 12.566)"
read -r _ short <<< "$(width 5.2.3 RANDOM_WALK 1)"
read -r number_legacy legacy <<< "$(width 5.2.3 RANDOM_WALK_LEGACY 12.566)"
echo "5.1.2 RANDOM_WALK (number $number_old), radius 4π: width $old"
echo "5.2.3 RANDOM_WALK (number $number_new), radius 4π: width $new"
echo "5.2.3 RANDOM_WALK, radius 1: width $short"
echo "5.2.3 RANDOM_WALK_LEGACY (number $number_legacy), radius 4π: width $legacy"
"$python" - "$number_old $number_new $number_legacy" "$old" "$new" "$short" "$legacy" <<'PYTHON'
import sys
numbers, old, new, short, legacy = sys.argv[1], *map(float, sys.argv[2:])
assert numbers == "4 6 4", numbers
assert new > 3 * old, new / old
assert abs(short / old - 1) < 0.06, short / old
assert abs(legacy / old - 1) < 0.03, legacy / old
PYTHON
