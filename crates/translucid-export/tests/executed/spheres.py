"""A sphere shaded by an exported disk and by an exported pre-integrated table, beside the path tracer's.

`TRANSLUCID=target/release/translucid python spheres.py`, in the environment of `.ci/export`, prints how far each is from the
path tracer; with `--write` it makes the picture and the table of `docs/guide/export.md`, too.

The sphere has radius 1 and a distant light. The path tracer has the same profile on it. The shaders are C that includes the
exported text; they run at SUPER × SUPER points a pixel, whose mean is the pixel. relMSE is the mean of (a - b)²/(b² + 0.01)
over channels and over pixels that the sphere covers at least in part; b is the path tracer's.
"""

import argparse
import ctypes
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np
import OpenEXR

ROOT = Path(__file__).resolve().parents[4]
PROGRAM = Path(os.environ.get("TRANSLUCID", ROOT / "target/debug/translucid")).resolve()
PAGE, PICTURE = ROOT / "docs/guide/export.md", ROOT / "docs/images/export-spheres.png"
MARKS = ("<!-- measured: crates/translucid-export/tests/executed/spheres.py -->", "<!-- end of what was measured -->")

SURFACE_ALBEDO, MEAN_FREE_PATH = "0.9,0.7,0.5", "0.2,0.14,0.08"
# Toward the light, of length 1, and the width of the picture
LIGHT, WIDTH = np.array([0.8, 0.5, 0.3]) / np.sqrt(0.98), 2.1
TAPS, COLUMNS, ROWS, MOST_CURVATURE = 25, 128, 32, 2.0
SUPER = 4

SCENE = f"""
unit = "mm"
[camera]
position = [0, 0, 5]
target = [0, 0, 0]
projection = "orthographic"
width = {WIDTH}
[film]
filter = "box"
[[material]]
name = "wax"
specular_weight = 0
subsurface_weight = 1
subsurface_color = [{SURFACE_ALBEDO}]
subsurface_radius = 1
subsurface_radius_scale = [{MEAN_FREE_PATH}]
subsurface_model = "normalized-diffusion"
subsurface_configuration = "diffuse"
[[object]]
shape = "sphere"
radius = 1
segments = 256
material = "wax"
[[light]]
type = "distant"
direction = {LIGHT.tolist()}
irradiance = [{np.pi}, {np.pi}, {np.pi}]
"""

SHADERS = """
#include "export.h"
#include <stdint.h>

static const float SURFACE_ALBEDO[3] = {
    TRANSLUCID_SURFACE_ALBEDO_RED, TRANSLUCID_SURFACE_ALBEDO_GREEN, TRANSLUCID_SURFACE_ALBEDO_BLUE};

/* The normal of the sphere in a pixel, which is also its place; tells whether the sphere is there. */
static int normal_at(int x, int y, int side, float n[3]) {
    n[0] = WIDTH * ((x + 0.5f) / side - 0.5f);
    n[1] = WIDTH * (0.5f - (y + 0.5f) / side);
    float square = 1.0f - n[0] * n[0] - n[1] * n[1];
    n[2] = sqrtf(fmaxf(square, 0.0f));
    return x >= 0 && y >= 0 && x < side && y < side && square > 0.0f;
}

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The table at N.L on a surface of curvature 1, between its entries. */
void shade_lut(int side, const float light[3], float *picture) {
    for (int i = 0; i < side * side; ++i) {
        float n[3];
        if (!normal_at(i % side, i / side, side, n)) continue;
        float u = 0.5f * (dot(n, light) + 1.0f) * (COLUMNS - 1), v = (ROWS - 1) / MOST_CURVATURE;
        int column = (int)fminf(u, COLUMNS - 2), row = (int)fminf(v, ROWS - 2);
        float p = u - column, q = v - row;
        const float(*at)[3] = TRANSLUCID_LUT + row * COLUMNS + column;
        for (int c = 0; c < 3; ++c) {
            float above = (1 - p) * at[0][c] + p * at[1][c], below = (1 - p) * at[COLUMNS][c] + p * at[COLUMNS + 1][c];
            picture[3 * i + c] = SURFACE_ALBEDO[c] * ((1 - q) * above + q * below);
        }
    }
}

/* The disk on the tangent plane of each pixel, turned by a random angle. What a tap would find beside the sphere is left to
   the others. */
void shade_disk(int side, const float light[3], float *picture) {
    uint32_t state = 1;
    for (int i = 0; i < side * side; ++i) {
        float n[3], sums[3] = {0}, weights[3] = {0};
        if (!normal_at(i % side, i / side, side, n)) continue;
        state = state * 1664525u + 1013904223u;
        float turn = 6.2831853f * (state >> 8) / 16777216.0f, s = sinf(turn), c = cosf(turn);
        /* What is seen of two tangents, across the line of sight and along it */
        float across = fmaxf(sqrtf(n[0] * n[0] + n[1] * n[1]), 1e-6f);
        float t[2] = {-n[1] / across, n[0] / across}, b[2] = {n[0] / across * n[2], n[1] / across * n[2]};
        for (int k = 0; k < TAPS; ++k) {
            const float *offset = TRANSLUCID_DISK_OFFSETS[k];
            float p = c * offset[0] - s * offset[1], q = s * offset[0] + c * offset[1], m[3];
            int x = i % side + (int)floorf((p * t[0] + q * b[0]) * side / WIDTH + 0.5f);
            int y = i / side - (int)floorf((p * t[1] + q * b[1]) * side / WIDTH + 0.5f);
            if (!normal_at(x, y, side, m)) continue;
            for (int channel = 0; channel < 3; ++channel) {
                sums[channel] += TRANSLUCID_DISK_WEIGHTS[k][channel] * fmaxf(dot(m, light), 0.0f);
                weights[channel] += TRANSLUCID_DISK_WEIGHTS[k][channel];
            }
        }
        for (int channel = 0; channel < 3; ++channel)
            picture[3 * i + channel] = SURFACE_ALBEDO[channel] * sums[channel] / fmaxf(weights[channel], 1e-20f);
    }
}

/* No scattering. */
void shade_lambert(int side, const float light[3], float *picture) {
    for (int i = 0; i < side * side; ++i) {
        float n[3];
        if (!normal_at(i % side, i / side, side, n)) continue;
        for (int c = 0; c < 3; ++c) picture[3 * i + c] = SURFACE_ALBEDO[c] * fmaxf(dot(n, light), 0.0f);
    }
}
"""


def shaders(folder, taps):
    """The shaders, compiled with the exported text."""
    words = ["--surface-albedo", SURFACE_ALBEDO, "--mfp", MEAN_FREE_PATH, "--taps", str(taps)]
    words += ["--size", f"{COLUMNS}x{ROWS}", "--most-curvature", str(MOST_CURVATURE), "-o", folder / "export.h"]
    subprocess.run([PROGRAM, "export", "--to", "c", "--what", "disk,lut", *words], check=True)
    constants = [f"-D{name}={globals()[name]}" for name in ("COLUMNS", "ROWS")]
    constants += [f"-DTAPS={taps}"] + [f"-D{name}={globals()[name]}f" for name in ("WIDTH", "MOST_CURVATURE")]
    source, library = folder / "shaders.c", folder / "shaders.so"
    source.write_text(SHADERS)
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, *constants, source, "-o", library, "-lm"], check=True)
    return ctypes.CDLL(str(library))


def shaded(library, name, size):
    """Linear radiance of a shader, black beside the sphere."""
    side = SUPER * size
    picture, light = np.zeros((side, side, 3), np.float32), LIGHT.astype(np.float32)
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (light, picture)]
    getattr(library, f"shade_{name}")(side, *pointers)
    return picture.reshape(size, SUPER, size, SUPER, 3).mean(axis=(1, 3), dtype=np.float64)


def path_traced(folder, size, samples):
    """Linear radiance of the path tracer, and the part of each pixel that the sphere covers."""
    (folder / "scene.toml").write_text(SCENE)
    words = ["--size", f"{size}x{size}", "--spp", str(samples), "-q", "-o", folder / "truth.exr"]
    subprocess.run([PROGRAM, "render", folder / "scene.toml", *words], check=True)
    with OpenEXR.File(str(folder / "truth.exr")) as file:
        rgba = file.channels()["RGBA"].pixels.astype(np.float64)
    return rgba[..., :3], rgba[..., 3]


def compared(size, samples, taps=TAPS):
    """Pictures by name, the part of each pixel that the sphere covers, and relMSE of each picture."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        truth, coverage = path_traced(folder, size, samples)
        library = shaders(folder, taps)
    pictures = {name: shaded(library, name, size) for name in ("lut", "disk", "lambert")}
    errors = {name: ((p - truth) ** 2 / (truth**2 + 0.01))[coverage > 0.0] for name, p in pictures.items()}
    return {"path tracer": truth, **pictures}, coverage, errors


def png(path, pixels):
    """Writes a picture of 8 bits a channel."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b"")]
    parts = [struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def codes(linear, coverage):
    """Eight bits of sRGB over grey."""
    linear = np.clip(linear + 0.05 * (1.0 - coverage[..., None]), 0.0, 1.0)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return np.round(255.0 * coded).astype(np.uint8)


NAMES = {
    "lut": f"pre-integrated table, {COLUMNS} × {ROWS}",
    "disk": "disk of {} taps in screen space",
    "lambert": "no scattering",
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=240)
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--taps", type=int, default=TAPS)
    parser.add_argument("--write", action="store_true", help="make the picture and the table of the page")
    arguments = parser.parse_args()
    pictures, coverage, errors = compared(arguments.size, arguments.samples, arguments.taps)
    lines = ["| shaded by | relMSE | red | green | blue |", "|---|---|---|---|---|"]
    for name, error in errors.items():
        numbers = [error.mean(), *error.mean(axis=0)]
        lines.append(f"| {NAMES[name].format(arguments.taps)} | {' | '.join(f'{number:.5f}' for number in numbers)} |")
    table = "\n".join(lines)
    print(table)
    if arguments.write:
        before, mark, rest = PAGE.read_text().partition(MARKS[0])
        _, end, after = rest.partition(MARKS[1])
        if not (mark and end):
            sys.exit(f"{PAGE} lacks the lines {MARKS[0]} and {MARKS[1]}")
        PAGE.write_text(f"{before}{mark}\n{table}\n{end}{after}")
        png(PICTURE, np.concatenate([codes(p, coverage) for p in pictures.values()], axis=1))


if __name__ == "__main__":
    main()
