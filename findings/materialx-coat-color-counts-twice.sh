#!/usr/bin/env bash
# MaterialX: the translation of a coated dielectric from Standard Surface to OpenPBR.
#
# In Standard Surface `coat_color` tints what lies under the coat, once; so it does in OpenPBR. The graph
# `standard_surface_to_open_pbr_surface` multiplies `base_color` by it and passes it on as `coat_color` besides. For metals
# the graph sets the coat's weight to 0, "so that the color is not added redundantly"; for others both count.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m venv "$folder/environment"
"$folder/environment/bin/pip" install --quiet --disable-pip-version-check "MaterialX==1.39.5"
seen=$("$folder/environment/bin/python" - <<'END'
import MaterialX as mx

document = mx.createDocument()
mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), document)
graph = document.getNodeGraph("NG_standard_surface_to_open_pbr_surface")


def inputs_of(name):
    """The inputs of the translation that an output depends on."""
    todo, found = [graph.getOutput(name).getConnectedNode()], set()
    while todo:
        for socket in todo.pop().getInputs():
            if socket.getInterfaceName():
                found.add(socket.getInterfaceName())
            elif socket.getConnectedNode():
                todo.append(socket.getConnectedNode())
    return found


outputs = ["base_color_out", "coat_color_out"]
print(" and ".join(name for name in outputs if "coat_color" in inputs_of(name)))
END
)
before="base_color_out and coat_color_out"
echo "MaterialX 1.39.5: expected coat_color in coat_color_out alone; seen before in $before; seen now in $seen"
[ "$seen" = "$before" ]
