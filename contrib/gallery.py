#!/usr/bin/env python3
"""Makes the pictures of docs/guide/gallery.md again, with the commands that stand below them there.

    python3 contrib/gallery.py               # all of them
    python3 contrib/gallery.py still-life    # those that a word names

`translucid` must be on the path, and where a command says --denoise Open Image Denoise installed or named by
TRANSLUCID_OIDN. Needs Pillow, for pictures that are JPEG files.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/guide/gallery.md"


def pictures():
    """Each picture of the page and the words of its command."""
    block = re.compile(r"^!\[[^\]]*\]\((\S+)\)\n\n```sh\n(translucid render .*)\n```$", re.MULTILINE)
    for target, command in block.findall(PAGE.read_text()):
        yield (PAGE.parent / target).resolve(), shlex.split(command)


def main():
    for target, words in pictures():
        if sys.argv[1:] and target.stem not in sys.argv[1:]:
            continue
        with tempfile.TemporaryDirectory() as directory:
            rendered = Path(directory) / "picture.png"
            words[words.index("-o") + 1] = str(rendered)
            subprocess.run(words, cwd=ROOT, check=True)
            # Full chroma: light from inside is a matter of color
            Image.open(rendered).convert("RGB").save(target, quality=92, subsampling=0, optimize=True)
        print(f"{target.relative_to(ROOT)}: {target.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
