#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension with the wheels that it brings along.

    python3 blender/package.py --wheel translucid-….whl [--wheel …] [--tool …/blender_ext.py] -o DIR

Prints the path of the extension, a .zip that Blender installs from disk.
With `--tool` Blender's own tool validates it, which lies in Blender's folder `scripts/addons_core/bl_pkg/cli` and needs no
Blender to run.
"""

import argparse
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

SOURCES = Path(__file__).parent / "translucid"
MANIFEST = SOURCES / "blender_manifest.toml"

# Platforms of wheels in the words of Blender.
PLATFORMS = (
    (r"linux.*x86_64", "linux-x64"),
    (r"linux.*aarch64", "linux-arm64"),
    (r"macosx.*arm64", "macos-arm64"),
    (r"macosx.*x86_64", "macos-x64"),
    (r"win_amd64", "windows-x64"),
    (r"win_arm64", "windows-arm64"),
)


def platform_of(wheel):
    """The platform of a wheel."""
    for pattern, platform in PLATFORMS:
        if re.search(pattern, wheel.stem):
            return platform
    sys.exit(f"{wheel.name} is for no platform that Blender has: {', '.join(name for _, name in PLATFORMS)}")


def manifest_with(wheels):
    """The manifest, with the wheels and their platforms."""
    text = MANIFEST.read_text()
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    platforms = ", ".join(f'"{name}"' for name in sorted({platform_of(wheel) for wheel in wheels}))
    return text.replace("\n[permissions]", f"\nplatforms = [{platforms}]\nwheels = [{listed}]\n\n[permissions]", 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheel", type=Path, action="append", required=True)
    parser.add_argument("--tool", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("."))
    arguments = parser.parse_args()
    version = tomllib.loads(MANIFEST.read_text())["version"]
    for wheel in arguments.wheel:
        if not wheel.is_file():
            sys.exit(f"{wheel} does not exist")
        if wheel.name.split("-")[:2] != ["translucid", version]:
            sys.exit(f"{wheel.name} is not of translucid {version}, which the manifest states")
    arguments.output.mkdir(parents=True, exist_ok=True)
    target = arguments.output / f"translucid-{version}.zip"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        add = lambda name, data: archive.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
        for path in sorted(path for path in SOURCES.rglob("*") if path.is_file() and "__pycache__" not in path.parts):
            if path != MANIFEST:
                add(path.relative_to(SOURCES).as_posix(), path.read_bytes())
        add(MANIFEST.name, manifest_with(arguments.wheel))
        for wheel in arguments.wheel:
            add(f"wheels/{wheel.name}", wheel.read_bytes())
    if arguments.tool:
        subprocess.run([sys.executable, arguments.tool, "validate", target], check=True, stdout=sys.stderr)
    print(target)


if __name__ == "__main__":
    main()
