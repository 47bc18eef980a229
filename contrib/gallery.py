#!/usr/bin/env python3
"""Makes the pictures of docs/guide/gallery.md again, with the commands that stand below them there.

    python3 contrib/gallery.py               # all of them
    python3 contrib/gallery.py still-life    # those that a word names

`translucid` must be on the path, and where a command says --denoise Open Image Denoise installed or named by
TRANSLUCID_OIDN. Needs Pillow. Pictures of several commands stand below each other in one file, each with the name that
its command gives it.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/guide/gallery.md"


def pictures():
    """Each picture of the page and the words of its commands."""
    block = re.compile(r"^!\[[^\]]*\]\((\S+)\)\n\n```sh\n((?:translucid render .*\n)+)```$", re.MULTILINE)
    for target, commands in block.findall(PAGE.read_text()):
        yield (PAGE.parent / target).resolve(), [shlex.split(command) for command in commands.splitlines()]


def render(words):
    """The picture of a command, and the name that the command gives it."""
    place = words.index("-o") + 1
    with tempfile.TemporaryDirectory() as directory:
        rendered = Path(directory) / "picture.png"
        subprocess.run([*words[:place], str(rendered), *words[place + 1 :]], cwd=ROOT, check=True)
        return Image.open(rendered).convert("RGB"), Path(words[place]).stem


def sheet(named):
    """Pictures of one size below each other with their names."""
    width, height = named[0][0].size
    whole = Image.new("RGB", (width, height * len(named)))
    draw = ImageDraw.Draw(whole)
    for row, (picture, name) in enumerate(named):
        whole.paste(picture, (0, row * height))
        at = (width - 24, row * height + 20)
        draw.text(at, name, fill="white", anchor="ra", font=ImageFont.load_default(30))
    return whole


def main():
    for target, commands in pictures():
        if sys.argv[1:] and target.stem not in sys.argv[1:]:
            continue
        named = [render(words) for words in commands]
        picture = sheet(named) if len(named) > 1 else named[0][0]
        # Full chroma: light from inside is a matter of color
        picture.save(target, quality=92, subsampling=0, optimize=True)
        print(f"{target.relative_to(ROOT)}: {target.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
