#!/usr/bin/env bash
# Blender's exporter of OBJ leaves out Kd where there is a map_Kd, and leaves out a packed image altogether.
#
# Version: bpy 5.2.3 (PyPI, Python 3.13); the same in 5.0.1.
# Expected: a textured Principled BSDF becomes "Kd 1 1 1" and "map_Kd …", since readers multiply the two and have a default
#           for Kd (0.8, 0.6 and 0.2 are common); a packed image is written beside the file with path_mode COPY.
# Seen: a map_Kd without a Kd, so a reader's default darkens every texture; of a packed image without a path neither a file
#       nor a map, but "Kd 0.8 0.8 0.8", the hidden value of the linked socket, without a message.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=${PYTHON:-python3.13}
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "bpy==5.2.3"

cat > "$folder/export.py" <<'PYTHON'
import sys
import bpy

folder, kind = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add()
image = bpy.data.images.new("texture", 2, 2)
if kind == "saved":
    image.filepath_raw, image.file_format = f"{folder}/texture.png", "PNG"
    image.save()
else:
    image.pack()
material = bpy.data.materials.new("paint")
material.use_nodes = True
tree = material.node_tree
tree.nodes.clear()
node, texture = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeTexImage")
texture.image = image
tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
bpy.context.object.data.materials.append(material)
bpy.ops.wm.obj_export(filepath=f"{folder}/{kind}.obj", path_mode="COPY")
PYTHON

for kind in saved packed; do
    "$folder/venv/bin/python" "$folder/export.py" "$folder" "$kind" > /dev/null 2>&1
    echo "$kind: $(grep -E '^(Kd|map_Kd)' "$folder/$kind.mtl" | paste -sd ';')"
done
grep -q '^map_Kd' "$folder/saved.mtl"
! grep -q '^Kd' "$folder/saved.mtl"
! grep -q '^map_Kd' "$folder/packed.mtl"
grep -q '^Kd 0.8' "$folder/packed.mtl"
