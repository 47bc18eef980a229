#!/usr/bin/env python3
"""Makes the pictures of docs/guide/presets.md, and those of the page's menu.

    python3 contrib/presets.py            # all groups
    python3 contrib/presets.py stone milk # those that a word names, as the page's markers do

`translucid` must be on the path, and Open Image Denoise installed or named by TRANSLUCID_OIDN. Needs Pillow. What is
rendered stays in target/presets, where an interrupted run goes on; empty it after a change of presets.
"""

import subprocess
import sys
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
RENDERED = ROOT / "target/presets"
SHEETS = ROOT / "docs/images/presets"
MENU = ROOT / "crates/translucid-view/page/presets.jpg"
# Pixels of a picture of the guide and of one of the menu, and pictures in a row; material.js knows the last.
SIZE, SMALL = 184, 56
LABEL = 22
COLUMNS, MENU_COLUMNS = 5, 10


def groups():
    """Names of presets by their groups, in the order of the list."""
    found = {}
    for line in subprocess.run(["translucid", "render", "--preset", "list"], capture_output=True, text=True, check=True).stdout.splitlines()[1:]:
        if line.startswith("# "):
            names = found.setdefault(line[2:].split()[0], [])
        elif line:
            names.append(line.split()[0])
    return found


def picture(name, group):
    unit = "mm" if group == "drinks" else "cm"
    path = RENDERED / f"{name}.png"
    if not path.exists():
        RENDERED.mkdir(parents=True, exist_ok=True)
        size = f"{SIZE}x{SIZE}"
        words = ["--preset", name, "--unit", unit, "--size", size, "--zoom", "1.35", "--spp", "24", "--denoise", "-q"]
        subprocess.run(["translucid", "render", "scenes/bust.ply", *words, "-o", path], cwd=ROOT, check=True)
    return Image.open(path).convert("RGB")


def sheet(named):
    """Pictures beside each other with their names below."""
    columns, high = min(COLUMNS, len(named)), SIZE + LABEL
    whole = Image.new("RGB", (SIZE * columns, high * -(-len(named) // columns)), "white")
    draw = ImageDraw.Draw(whole)
    for i, (name, each) in enumerate(named):
        x, y = SIZE * (i % columns), high * (i // columns)
        whole.paste(each, (x, y))
        draw.text((x + SIZE // 2, y + SIZE + LABEL // 2), name, fill="#333333", anchor="mm", font=ImageFont.load_default(12))
    return whole


def main():
    of_group = groups()
    SHEETS.mkdir(parents=True, exist_ok=True)
    for group, names in of_group.items():
        if not sys.argv[1:] or group in sys.argv[1:]:
            named = [(name, picture(name, group)) for name in names]
            sheet(named).save(SHEETS / f"{group}.jpg", quality=90, optimize=True)
    if sys.argv[1:]:
        return
    all_names = [(name, group) for group, names in of_group.items() for name in names]
    menu = Image.new("RGB", (SMALL * MENU_COLUMNS, SMALL * -(-len(all_names) // MENU_COLUMNS)))
    for i, (name, group) in enumerate(all_names):
        # Head and shoulders
        side = SIZE * 0.62
        left, top = (SIZE - side) / 2, SIZE * 0.03
        small = picture(name, group).resize((SMALL, SMALL), Image.LANCZOS, (left, top, left + side, top + side))
        menu.paste(small, (SMALL * (i % MENU_COLUMNS), SMALL * (i // MENU_COLUMNS)))
    menu.save(MENU, quality=82, optimize=True)


if __name__ == "__main__":
    main()
