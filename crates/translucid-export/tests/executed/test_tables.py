"""Disks, kernels and pre-integrated tables, read back from every language that has them, against an independent twin.

The material is normalized diffusion of d = 2, 1, 0.5, whose disk and kernel are computed here once more: the disk in double
precision, the kernel by a singular value decomposition of counted light.
"""

import ctypes
import functools
import os
import struct
import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import wgpu
from test_compiled import FOR_CPP, METAL_LIBRARY, STANDARDS, WARNINGS
from test_device import device  # noqa: F401 (a fixture)

PROGRAM = Path(os.environ.get("TRANSLUCID", Path(__file__).resolve().parents[4] / "target/debug/translucid")).resolve()
WIDTHS = [2.0, 1.0, 0.5]
# s(0.8) for diffuse light is 1.1
MATERIAL = ["--surface-albedo", "0.8", "--mfp", ",".join(str(1.1 * d) for d in WIDTHS)]
TAPS, COLUMNS, ROWS = 17, 33, 5
MOST_THICKNESS = 10.0
# Single precision keeps 6e-8 of a number
ROUNDING = 1.2e-7


def export(language, what, *options):
    """An exported text of the material."""
    command = [PROGRAM, "export", "--to", language, "--what", what, *MATERIAL, *map(str, options)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def transmittance_twin(thickness, a):
    """T of diffuse light through a slab of isotropic scatterers of the mean free path 1: discrete ordinates, as a boundary value problem.

    a is the single-scattering albedo. Directions are double Gaussian, 24 in each half; the slab is halved until its cells are
    thin, and doubled again.
    """
    mu, weight = np.polynomial.legendre.leggauss(24)
    mu, weight = 0.5 * (mu + 1.0), 0.5 * weight
    doublings = max(0, int(np.ceil(np.log2(thickness / 1e-5))))
    step = thickness / 2**doublings
    # One scattering in a cell: radiance that leaves per radiance that arrives, direction by direction
    scatter = 0.5 * a * step * weight[None, :] / mu[:, None]
    r, t = scatter.copy(), scatter + np.diag(1.0 - step / mu)
    for _ in range(doublings):
        between = np.linalg.inv(np.eye(len(mu)) - r @ r)
        r, t = r + t @ r @ between @ t, t @ between @ t
    return 2.0 * np.sum(weight * mu * t.sum(axis=1))


def single_scattering_albedo(surface_albedo):
    """By halving: the half space's total of diffuse light, as a slab that passes nothing."""
    mu, weight = np.polynomial.legendre.leggauss(64)
    mu, weight = 0.5 * (mu + 1.0), 0.5 * weight

    def total(a):
        # H of isotropic scattering by its integral equation
        h = np.ones_like(mu)
        for _ in range(2000):
            new = 1.0 / (np.sqrt(1.0 - a) + 0.5 * a * np.sum(weight * mu * h / (mu[:, None] + mu), axis=1))
            if np.abs(new - h).max() < 1e-14:
                break
            h = new
        return 1.0 - 2.0 * np.sqrt(1.0 - a) * np.sum(weight * mu * h)

    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if total(middle) < surface_albedo else (low, middle)
    return 0.5 * (low + high)


def check_transmittances(values, most):
    """Transmittances of a material whose mean free paths are 1.1 times the widths, at a surface albedo of 0.8."""
    a = single_scattering_albedo(0.8)
    for i in range(len(values)):
        thickness = most * (i / (len(values) - 1)) ** 2
        expected = [1.0 if i == 0 else transmittance_twin(thickness / (1.1 * d), a) for d in WIDTHS]
        # The inversion is good to 2e-5 of the surface albedo, the twin's directions and cells to less than 3e-4
        assert np.allclose(values[i], expected, rtol=0.0, atol=5e-4), (i, values[i], expected)


def cdf(r, d):
    return 1.0 - 0.25 * np.exp(-r / d) - 0.75 * np.exp(-r / (3.0 * d))


def density(r, d):
    return (np.exp(-r / d) + np.exp(-r / (3.0 * d))) / (8.0 * np.pi * d * r)


def radius(share, widths):
    """Where the mean of the profiles' shares is one, by halving."""
    low, high = 0.0, 1e3
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.mean([cdf(middle, d) for d in widths]) < share else (low, middle)
    return low


def disk_twin():
    """Offsets and weights: radii by strata of the mean profile's energy, azimuths by the golden angle."""
    i = np.arange(TAPS)
    r = np.array([radius((k + 0.5) / TAPS, WIDTHS) for k in i])
    angle = i * np.pi * (3.0 - np.sqrt(5.0))
    densities = np.array([density(r, d) for d in WIDTHS])
    weights = densities / densities.mean(axis=0)
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1), (weights / weights.sum(axis=1, keepdims=True)).T


@functools.cache
def kernel_twin():
    """Weights and offsets: the leading singular vector of the light in cells between taps, by 4e6 random points."""
    random = np.random.default_rng(1)
    t = np.linspace(-1.0, 1.0, TAPS)
    offsets = radius(0.98, [max(WIDTHS)]) * t * np.abs(t)
    edges = np.concatenate([[-np.inf], 0.5 * (offsets[1:] + offsets[:-1]), [np.inf]])
    columns = []
    for d in WIDTHS:
        r = random.exponential(np.where(random.random(4_000_000) < 0.25, d, 3.0 * d))
        angle = 2.0 * np.pi * random.random(r.size)
        cells = np.histogram2d(r * np.cos(angle), r * np.sin(angle), [edges, edges])[0]
        leading = np.abs(np.linalg.svd(cells + cells.T)[0][:, 0])
        columns.append(leading / leading.sum())
    return np.stack([*columns, offsets], axis=1)


def check(offsets, weights, kernel):
    """A disk and a kernel that were read back."""
    offsets, weights, kernel = (np.asarray(table, np.float64) for table in (offsets, weights, kernel))
    expected_offsets, expected_weights = disk_twin()
    # Quantiles are found to 1e-12 of the share
    assert np.abs(offsets - expected_offsets).max() < 1e-6 * np.abs(expected_offsets).max()
    assert np.allclose(weights, expected_weights, rtol=1e-6, atol=0.0)
    assert np.abs(weights.sum(axis=0) - 1.0).max() < TAPS * ROUNDING
    expected = kernel_twin()
    assert np.abs(kernel[:, :3].sum(axis=0) - 1.0).max() < TAPS * ROUNDING
    assert np.allclose(kernel[:, 3], expected[:, 3], rtol=1e-6, atol=1e-6)
    # Of 4e6 points the standard error of a weight is at most 2.5e-4, and their seed is fixed
    assert np.abs(kernel[:, :3] - expected[:, :3]).max() < 1e-3


# Metal's, without their padding
VECTORS = """struct float2 { float x, y; float2(float a, float b) : x(a), y(b) {} };
struct float3 { float x, y, z; float3(float a, float b, float c) : x(a), y(b), z(c) {} };
struct float4 { float x, y, z, w; float4(float a, float b, float c, float d) : x(a), y(b), z(c), w(d) {} };
"""


@pytest.mark.parametrize("compiler, language", [("gcc", "c"), ("clang", "c"), ("gcc", "cpp"), ("clang", "cpp"), ("gcc", "msl")])
def test_tables_of_headers_are_the_twins(compiler, language, tmp_path):
    names = {"c": "TRANSLUCID_{}", "cpp": "translucid::{}", "msl": "{}"}[language]
    tables = {"DISK_OFFSETS": (TAPS, 2), "DISK_WEIGHTS": (TAPS, 3), "KERNEL": (TAPS, 4), "TRANSMITTANCE": (COLUMNS, 3), "LUT": (COLUMNS * ROWS, 3)}
    whats = ["disk", "kernel", "transmittance", "lut"]
    if language == "msl":
        tables.pop("LUT")
        whats.pop()
    options = ["--taps", TAPS, "--size", f"{COLUMNS}x{ROWS}", "--most-thickness", MOST_THICKNESS]
    (tmp_path / "export.h").write_text(export(language, ",".join(whats), *options))
    (tmp_path / "metal_stdlib").write_text(METAL_LIBRARY.replace("namespace metal {", "namespace metal {\n" + VECTORS))
    linkage = "" if language == "c" else 'extern "C" '
    readers = "".join(
        f"{linkage}void read_{name}(float *to);\n{linkage}void read_{name}(float *to) {{ memcpy(to, {names.format(name)}, sizeof {names.format(name)}); }}\n"
        for name in tables
    )
    source, library = tmp_path / ("main.c" if language == "c" else "main.cpp"), tmp_path / "main.so"
    source.write_text(f'#include "export.h"\n#include <string.h>\n{readers}')
    driver = compiler if language == "c" else FOR_CPP[compiler]
    flags = [f"-std={STANDARDS[language]}", f"-I{tmp_path}", *WARNINGS, "-O2", "-shared", "-fPIC"]
    subprocess.run([driver, *flags, source, "-o", library], check=True)
    opened, found = ctypes.CDLL(str(library)), {}
    for name, shape in tables.items():
        found[name] = np.full(shape, np.nan, np.float32)
        getattr(opened, f"read_{name}")(found[name].ctypes.data_as(ctypes.c_void_p))
    check(found["DISK_OFFSETS"], found["DISK_WEIGHTS"], found["KERNEL"])
    check_transmittances(found["TRANSMITTANCE"], MOST_THICKNESS)
    if "LUT" in found:
        assert np.allclose(found["LUT"].reshape(ROWS, COLUMNS, 3), lut(tmp_path), rtol=ROUNDING, atol=1e-9)


def lut(folder):
    """The pre-integrated table in double precision."""
    image(folder, "npz")
    return np.load(folder / "lut.npz")["lut"]


def image(folder, kind):
    path = folder / f"lut.{kind}"
    export(kind, "lut", "--size", f"{COLUMNS}x{ROWS}", "-o", path)
    return path


def test_images_of_transmittances_are_equal(tmp_path):
    def of(kind):
        path = tmp_path / f"transmittance.{kind}"
        export(kind, "transmittance", "--size", f"{COLUMNS}x2", "--most-thickness", MOST_THICKNESS, "-o", path)
        return path

    exact = np.load(of("npz"))
    expected = exact["transmittance"]
    assert expected.shape == (1, COLUMNS, 3) and exact["most_thickness"] == MOST_THICKNESS
    check_transmittances(expected[0], MOST_THICKNESS)
    with OpenEXR.File(str(of("exr")), separate_channels=True) as file:
        found = np.stack([file.channels()[c].pixels for c in "RGB"], axis=2)
    assert np.allclose(found, expected, rtol=ROUNDING, atol=1e-9)
    found = np.frombuffer(of("dds").read_bytes()[128:], "<f4").reshape(1, COLUMNS, 4)
    assert np.allclose(found[..., :3], expected, rtol=ROUNDING, atol=1e-9)


def test_images_of_tables_are_equal(tmp_path):
    expected = lut(tmp_path)
    assert expected.shape == (ROWS, COLUMNS, 3)
    with OpenEXR.File(str(image(tmp_path, "exr")), separate_channels=True) as file:
        found = np.stack([file.channels()[c].pixels for c in "RGB"], axis=2)
    assert np.allclose(found, expected, rtol=ROUNDING, atol=1e-9)
    # As DirectXTex reads it: magic, a header of 124 bytes, FourCC 116 without a second header, four floats a pixel
    data = image(tmp_path, "dds").read_bytes()
    magic, size, _, height, width, pitch = struct.unpack("<4s5I", data[:24])
    assert (magic, size, height, width, pitch) == (b"DDS ", 124, ROWS, COLUMNS, 16 * COLUMNS)
    assert struct.unpack("<3I", data[76:88]) == (32, 4, 116)
    found = np.frombuffer(data[128:], "<f4").reshape(ROWS, COLUMNS, 4)
    assert np.allclose(found[..., :3], expected, rtol=ROUNDING, atol=1e-9) and (found[..., 3] == 1.0).all()


SHADERS = {
    "wgsl": """{text}
@group(0) @binding(0) var<storage, read_write> results: array<f32>;
@compute @workgroup_size(1)
fn main() {{
    for (var i: i32 = 0; i < {taps}; i++) {{
        results[5 * i] = DISK_OFFSETS[i].x;
        results[5 * i + 1] = DISK_OFFSETS[i].y;
        results[5 * i + 2] = DISK_WEIGHTS[i].x;
        results[5 * i + 3] = DISK_WEIGHTS[i].y;
        results[5 * i + 4] = DISK_WEIGHTS[i].z;
    }}
    for (var i: i32 = 0; i < {taps}; i++) {{
        for (var c: i32 = 0; c < 4; c++) {{
            results[5 * {taps} + 4 * i + c] = KERNEL[i][c];
        }}
    }}
    for (var i: i32 = 0; i < {columns}; i++) {{
        for (var c: i32 = 0; c < 3; c++) {{
            results[9 * {taps} + 3 * i + c] = TRANSMITTANCE[i][c];
        }}
    }}
}}
""",
    "glsl": """#version 450
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Results {{ float results[]; }};
{text}
void main() {{
    for (int i = 0; i < {taps}; i++) {{
        for (int c = 0; c < 2; c++) results[5 * i + c] = DISK_OFFSETS[i][c];
        for (int c = 0; c < 3; c++) results[5 * i + 2 + c] = DISK_WEIGHTS[i][c];
    }}
    for (int i = 0; i < {taps}; i++) for (int c = 0; c < 4; c++) results[5 * {taps} + 4 * i + c] = KERNEL[i][c];
    for (int i = 0; i < {columns}; i++) for (int c = 0; c < 3; c++) results[9 * {taps} + 3 * i + c] = TRANSMITTANCE[i][c];
}}
""",
    "hlsl": """[[vk::binding(0)]] RWStructuredBuffer<float> results : register(u0);
{text}
[numthreads(1, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {{
    int i, c;
    for (i = 0; i < {taps}; i++) {{
        for (c = 0; c < 2; c++) results[5 * i + c] = DISK_OFFSETS[i][c];
        for (c = 0; c < 3; c++) results[5 * i + 2 + c] = DISK_WEIGHTS[i][c];
    }}
    for (i = 0; i < {taps}; i++) for (c = 0; c < 4; c++) results[5 * {taps} + 4 * i + c] = KERNEL[i][c];
    for (i = 0; i < {columns}; i++) for (c = 0; c < 3; c++) results[9 * {taps} + 3 * i + c] = TRANSMITTANCE[i][c];
}}
""",
}


@pytest.mark.parametrize("language", SHADERS)
def test_tables_of_shaders_are_the_twins(device, language, tmp_path):  # noqa: F811
    options = ["--taps", TAPS, "--size", f"{COLUMNS}x2", "--most-thickness", MOST_THICKNESS]
    text = export(language, "disk,kernel,transmittance", *options)
    source = SHADERS[language].format(text=text, taps=TAPS, columns=COLUMNS)
    if language != "wgsl":
        flags = {"glsl": [], "hlsl": ["-D", "-e", "main", "--hlsl-offsets"]}[language]
        path, binary = tmp_path / f"tables.{language}", tmp_path / "tables.spv"
        path.write_text(source)
        compiler = ["glslangValidator", "-V", "--target-env", "vulkan1.1", "-S", "comp", *flags]
        subprocess.run([*compiler, path, "-o", binary], check=True)
        source = binary.read_bytes()
    module = device.create_shader_module(code=source)
    pipeline = device.create_compute_pipeline(layout="auto", compute={"module": module, "entry_point": "main"})
    results = device.create_buffer(size=4 * (9 * TAPS + 3 * COLUMNS), usage=wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC)
    entries = [{"binding": 0, "resource": {"buffer": results, "offset": 0, "size": results.size}}]
    group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)
    encoder = device.create_command_encoder()
    run = encoder.begin_compute_pass()
    run.set_pipeline(pipeline)
    run.set_bind_group(0, group)
    run.dispatch_workgroups(1)
    run.end()
    device.queue.submit([encoder.finish()])
    found = np.frombuffer(device.queue.read_buffer(results), np.float32)
    disk, kernel = found[: 5 * TAPS].reshape(TAPS, 5), found[5 * TAPS : 9 * TAPS].reshape(TAPS, 4)
    check(disk[:, :2], disk[:, 2:], kernel)
    check_transmittances(found[9 * TAPS :].reshape(COLUMNS, 3), MOST_THICKNESS)
