#!/usr/bin/env bash
# The manifest of Cycles' Cryptomatte is no JSON where a name has a quotation mark, and some of its ids are in no pixel.
#
# Version: bpy 5.2.3 (PyPI, Python 3.13); the same in 5.0.1.
# Expected: a manifest is JSON, as the specification (1.2.0) has it, and its ids are the bits of the numbers in the pixels.
# Seen: names are not escaped, so that of an object called 5" pipe is {"5" pipe":…}. Where the hash of a name has an exponent of 0
#       or 255, as one name in 128 has, the manifest has the hash (of "sheet 348" 7f864c77) and the pixels have 7f064c77, in
#       which a bit is changed for it to be a number. Programs that take ids from the manifest find no such pixel.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=${PYTHON:-python3.13}
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "bpy==5.2.3"

cat > "$folder/manifest.py" <<'PYTHON'
import json
import struct
import sys
import bpy

path = sys.argv[1]

def render(name):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 8, 8
    scene.cycles.device, scene.cycles.samples = "CPU", 4
    bpy.context.view_layer.use_pass_cryptomatte_object = True
    bpy.ops.mesh.primitive_plane_add(size=100)
    bpy.context.object.name = name
    bpy.ops.object.camera_add(location=(0, 0, 5))
    scene.camera = bpy.context.object
    settings = render.image_settings
    settings.media_type, settings.file_format = "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER"
    settings.color_depth, settings.exr_codec, settings.use_exr_interleave = "32", "NONE", True
    render.filepath, render.use_file_extension = path, False
    bpy.ops.render.render(write_still=True)
    return open(path, "rb").read()

def header(data):
    found, at = {}, 8
    while data[at]:
        name, kind, _ = data[at : at + 512].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<I", data, at)
        found[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return found, at + 1

def first_pixel(data, channel):
    # Without compression a line has all values of the first channel, then those of the next.
    found, at = header(data)
    channels, place, names = found["channels"], 0, []
    while channels[place]:
        names.append(channels[place:].split(b"\0", 1)[0].decode())
        place += len(names[-1]) + 17
    line, = struct.unpack_from("<Q", data, at)
    return struct.unpack_from("<I", data, line + 8 + 4 * 8 * names.index(channel))[0]

def manifest(data):
    return next(value.decode() for name, value in header(data)[0].items() if name.endswith("/manifest"))

text = manifest(render('5" pipe'))
try:
    json.loads(text)
    is_json = True
except ValueError:
    is_json = False
data = render("sheet 348")
print("found", bpy.app.version_string, "|", text, "|", is_json, "|", json.loads(manifest(data))["sheet 348"], "|",
      f"{first_pixel(data, 'ViewLayer.CryptoObject00.r'):08x}")
PYTHON

result=$("$folder/venv/bin/python" "$folder/manifest.py" "$folder/picture.exr" 2>/dev/null | sed -n 's/^found //p')
IFS='|' read -r version manifest is_json hash pixel <<< "$result"
echo "version:          $version"
echo "manifest:        $manifest"
echo "is it JSON?      $is_json"
echo "id in manifest:  $hash"
echo "id in the pixel: $pixel"
[ "${is_json// /}" = False ]
[ "${hash// /}" = 7f864c77 ]
[ "${pixel// /}" = 7f064c77 ]
