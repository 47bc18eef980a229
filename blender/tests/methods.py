# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface scattering in Cycles beside the exact models, as the table of docs/guide/blender.md.

    PYTHON methods.py measure 5.2.3.json [--short]     with the Python of a bpy, for each version
    python methods.py table 5.0.1.json 5.2.3.json …    writes the table between its markers

A sun shines straight down on one half of a plane: the brightness of the lit half, and how far light gets into the dark half.
"""

import json
import sys
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs/guide/blender.md"
BEGIN, END = "<!-- measured: blender/tests/methods.py -->\n", "<!-- end of what was measured -->"

SAMPLES = 1000

# Color, and settings of a Subsurface Scattering node; the mean free path is 1 but in the skin mode.
SETTINGS = {
    "the defaults": ((0.8, 0.5, 0.2), {}),
    "bright": ((0.99, 0.95, 0.9), {}),
    "dark": ((0.1, 0.05, 0.01), {}),
    "Anisotropy 0.6": ((0.8, 0.5, 0.2), {"Anisotropy": 0.6}),
    "IOR 1.01": ((0.8, 0.5, 0.2), {"IOR": 1.01}),
    "IOR 2": ((0.8, 0.5, 0.2), {"IOR": 2.0}),
    "Roughness 0.1": ((0.8, 0.5, 0.2), {"Roughness": 0.1}),
}
SHORT = ("the defaults", "Anisotropy 0.6")
# Sockets that a method does not ask for.
IGNORED = {"BURLEY": ("Anisotropy 0.6", "IOR 1.01", "IOR 2", "Roughness 0.1"), "RANDOM_WALK_SKIN": ("Roughness 0.1",)}


def measure(names):
    import bpy
    import numpy as np
    from harness import SUBSURFACE_METHODS, combined, messages, render_cycles
    from test_subsurface import edge_of_light, edge_width

    rows = []
    for method in SUBSURFACE_METHODS:
        for name in names:
            if name in IGNORED.get(method, ()):
                continue
            color, settings = SETTINGS[name]
            edge_of_light(method, color=color, samples=SAMPLES, **settings)
            (width, lit), (of_cycles, lit_of_cycles) = (edge_width(picture) for picture in (combined(), render_cycles(SAMPLES)))
            assert messages() == []
            rows.append({
                "version": bpy.app.version_string, "method": method, "setting": name, "color": color,
                "brightness": np.asarray(lit_of_cycles).tolist(), "width": (np.asarray(of_cycles) * 16).tolist(),
                "brightness_ratio": np.asarray(lit / lit_of_cycles).tolist(), "width_ratio": np.asarray(width / of_cycles).tolist(),
            })
            print(rows[-1], flush=True)
    return rows


def table(rows):
    lines = [
        "| method, setting | version | brightness in Cycles | ours over it | width in Cycles | ours over it |",
        "|---|---|---|---|---|---|",
    ]
    for row in sorted(rows, key=lambda row: (row["method"], list(SETTINGS).index(row["setting"]), row["version"])):
        cells = [" ".join(f"{x:.3f}" for x in row[key]) for key in ("brightness", "brightness_ratio", "width", "width_ratio")]
        lines.append(f"| `{row['method']}`, {row['setting']} | {row['version'].split()[0]} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main():
    verb, *files = sys.argv[1:]
    if verb == "measure":
        names = SHORT if "--short" in files else tuple(SETTINGS)
        Path(files[0]).write_text(json.dumps(measure(names), indent=1))
    else:
        rows = [row for file in files for row in json.loads(Path(file).read_text())]
        before, rest = PAGE.read_text().split(BEGIN)
        PAGE.write_text(before + BEGIN + table(rows) + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
