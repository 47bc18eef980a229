#!/usr/bin/env bash
# Numbers in Blender's MTL files are on scales of Blender's own, which neither the extension's text nor Phong's exponent has.
#
# Version: bpy 5.0.1 (PyPI, Python 3.11).
# Expected: Pc (the PBR extension's clearcoat) is the coat's weight; Ns is an exponent, some 2/r⁴ − 2 of the roughness r, and so
#           unbounded; illum 9 (glass, by the format) stands for transmission, d for opacity.
# Seen: Pc is four times the coat's weight, so a full coat is 4; Ns is 1000 (1 − r)², at most 1000; illum 9 is what Alpha below 1
#       gets, with no transmission at all, while Transmission 1 gets illum 2 and, with the PBR extension, "Tf 1 1 1".
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=${PYTHON:-python3.11}
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "bpy==5.0.1"

cat > "$folder/export.py" <<'PYTHON'
import sys
import bpy

folder, name, *words = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add()
material = bpy.data.materials.new("paint")
material.use_nodes = True
node = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
for word in words:
    socket, value = word.split("=")
    node.inputs[socket].default_value = float(value)
bpy.context.object.data.materials.append(material)
bpy.ops.wm.obj_export(filepath=f"{folder}/{name}.obj", export_pbr_extensions=name.startswith("pbr"))
PYTHON

line() { # NAME KEY SOCKET=VALUE…: the line of a key in the MTL of a material
    "$folder/venv/bin/python" "$folder/export.py" "$folder" "$1" "${@:3}" > /dev/null 2>&1
    grep -E "^$2 " "$folder/$1.mtl" || echo none
}
same() { # EXPECTED FOUND
    echo "$2"
    [ "$1" = "$2" ]
}
same "Pc 0.400000" "$(line pbr-coat10 Pc "Coat Weight=0.1")"
same "Pc 4.000000" "$(line pbr-coat100 Pc "Coat Weight=1")"
same "Ns 250.000000" "$(line rough50 Ns "Roughness=0.5")"
same "Ns 1000.000000" "$(line rough0 Ns "Roughness=0")"
same "illum 9" "$(line alpha20 illum "Alpha=0.2")"
same "d 0.200000" "$(grep '^d ' "$folder/alpha20.mtl")"
same "illum 2" "$(line pbr-glass illum "Transmission Weight=1")"
same "Tf 1.000000 1.000000 1.000000" "$(grep '^Tf ' "$folder/pbr-glass.mtl")"
