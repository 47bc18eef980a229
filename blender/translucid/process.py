# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory of the process, and libraries that Blender brings along."""

import os
import sys
from pathlib import Path

import bpy

_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096


def memory_in_use():
    """The memory of the process and its peak, MiB; 0 where the system does not say."""
    try:
        import resource
    except ImportError:
        return 0.0, 0.0
    # Kilobytes on Linux, bytes on macOS.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform != "darwin" else 1 << 20)
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except OSError:
        return peak, peak
    return pages * _PAGE / (1 << 20), peak


def find_denoiser():
    """Points the renderer to Blender's own Open Image Denoise, unless the user has named another."""
    if "TRANSLUCID_OIDN" in os.environ:
        return
    beside = [Path(bpy.app.binary_path).parent] if bpy.app.binary_path else []
    if getattr(bpy, "__file__", None):
        beside.append(Path(bpy.__file__).parent)
    names = {"win32": "OpenImageDenoise.dll", "darwin": "libOpenImageDenoise*.dylib"}
    pattern = names.get(sys.platform, "libOpenImageDenoise.so*")
    for folder in beside:
        for inner in ("lib", "blender.shared", "../Resources/lib", "."):
            found = sorted((folder / inner).glob(pattern))
            if found:
                os.environ["TRANSLUCID_OIDN"] = str(found[0])
                return
