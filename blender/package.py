#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension with the wheels that it brings along, by Blender's own tool.

    python3 blender/package.py --wheel translucid-….whl [--wheel …] --tool …/blender_ext.py -o DIR

The tool lies in Blender's folder `scripts/addons_core/bl_pkg/cli` and needs no Blender to run.
Prints the path of the extension, a .zip that Blender installs from disk.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

SOURCES = Path(__file__).parent / "translucid"

# Platforms of wheels in the words of Blender.
PLATFORMS = (
    (r"manylinux.*x86_64", "linux-x64"),
    (r"manylinux.*aarch64", "linux-arm64"),
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
    text = (SOURCES / "blender_manifest.toml").read_text()
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    platforms = ", ".join(f'"{name}"' for name in sorted({platform_of(wheel) for wheel in wheels}))
    return text.replace("\n[permissions]", f"\nplatforms = [{platforms}]\nwheels = [{listed}]\n\n[permissions]", 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheel", type=Path, action="append", required=True)
    parser.add_argument("--tool", type=Path, required=True)
    parser.add_argument("-o", "--output", type=Path, default=Path("."))
    arguments = parser.parse_args()
    version = tomllib.loads((SOURCES / "blender_manifest.toml").read_text())["version"]
    for wheel in arguments.wheel:
        if not wheel.is_file():
            sys.exit(f"{wheel} does not exist")
        if wheel.name.split("-")[:2] != ["translucid", version]:
            sys.exit(f"{wheel.name} is not of translucid {version}, which the manifest states")
    arguments.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        staged = Path(folder) / "translucid"
        shutil.copytree(SOURCES, staged, ignore=shutil.ignore_patterns("__pycache__"))
        (staged / "wheels").mkdir()
        for wheel in arguments.wheel:
            shutil.copy(wheel, staged / "wheels")
        (staged / "blender_manifest.toml").write_text(manifest_with(arguments.wheel))
        target = arguments.output / f"translucid-{version}.zip"
        run = lambda *words: subprocess.run([sys.executable, arguments.tool, *map(str, words)], check=True, stdout=sys.stderr)
        run("validate", staged)
        run("build", "--source-dir", staged, "--output-filepath", target)
        run("validate", target)
    print(target)


if __name__ == "__main__":
    main()
