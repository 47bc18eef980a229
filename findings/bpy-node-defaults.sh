#!/usr/bin/env bash
# The default that a property of a shader node states is not what a new node has (bpy 5.2.3; 5.3.0 states the right ones).
#
# Expectation: bl_rna.properties[NAME].default is the value of a node that has just been made, as for most properties.
# Seen: for Principled BSDF "GGX" and "BURLEY" are stated, and a new node has MULTI_GGX and RANDOM_WALK; twenty-odd menus and
# switches of shader nodes differ so. A tool that leaves out what equals the stated default loses them.
set -euo pipefail
version=5.2.3
# bpy is made for one version of Python each; a shim of pyenv may be there and not run.
for python in python3.13 "$HOME"/.pyenv/versions/3.13.*/bin/python; do
    if "$python" -c "import venv, ensurepip" 2>/dev/null; then break; fi
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "bpy==$version"
cat >"$folder/look.py" <<'PYTHON'
import sys

import bpy

print("bpy", bpy.app.version_string)
tree = bpy.data.materials.new("nodes").node_tree
base = set(bpy.types.ShaderNode.bl_rna.properties.keys())
found = {}
for name in sorted(dir(bpy.types)):
    kind = getattr(bpy.types, name)
    if not isinstance(kind, type) or not issubclass(kind, bpy.types.ShaderNode):
        continue
    try:
        node = tree.nodes.new(name)
    except RuntimeError:
        continue
    for prop in node.bl_rna.properties:
        if prop.identifier in base or prop.type not in {"ENUM", "BOOLEAN"} or prop.is_readonly or getattr(prop, "is_array", False):
            continue
        if getattr(node, prop.identifier) != prop.default:
            found[name.removeprefix("ShaderNode"), prop.identifier] = prop.default, getattr(node, prop.identifier)
for (name, prop), (stated, new) in found.items():
    print(f"{name}.{prop}: stated {stated!r}, a new node has {new!r}")
print(len(found), "differ")
seen = {
    ("BsdfPrincipled", "distribution"): ("GGX", "MULTI_GGX"),
    ("BsdfPrincipled", "subsurface_method"): ("BURLEY", "RANDOM_WALK"),
    ("MapRange", "clamp"): (False, True),
}
sys.exit(any(found.get(key) != value for key, value in seen.items()))
PYTHON
"$folder/venv/bin/python" "$folder/look.py"
