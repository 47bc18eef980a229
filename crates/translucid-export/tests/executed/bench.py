"""Time per sample of the exported samplers on this machine, beside a Newton iteration and a look-up in a table.

Run as `.ci/export` runs the tests: `TRANSLUCID_EXPORT_POINTS=… python bench.py`. Compiled languages run on one core, shaders
on the Vulkan device, all its threads, without the transfer.
"""

import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import wgpu
from points import functions, text
from test_compiled import FOR_CPP, METAL_LIBRARY, STANDARDS
from test_device import WORKGROUP, glsl, hlsl

SAMPLERS = ["burley_sample", "burley_quantile", "refined_sample"]

PROGRAM = """#include "export.h"
#include <math.h>
#include <stdio.h>
#include <time.h>
USING
#define N 4000000
static float table[1025];
static float by_table(float u) {
    float at = 1024.0f * u;
    int i = (int)at;
    return table[i] + (at - (float)i) * (table[i + 1] - table[i]);
}
/* The usual way: Newton's method on the cdf until a step is small */
static float by_newton(float u) {
    float r = 1.0f;
    for (int i = 0; i < 30; ++i) {
        float a = expf(-r), b = expf(-r / 3.0f);
        float step = (1.0f - 0.25f * a - 0.75f * b - u) / (0.25f * a + 0.25f * b);
        r = r - step > 0.0f ? r - step : 0.5f * r;
        if (fabsf(step) < 1e-5f * r) break;
    }
    return r;
}
static volatile float sink;
#define TIME(name, call) do { \\
    float sum = 0.0f; clock_t start = clock(); \\
    for (int i = 0; i < N; ++i) { float u = (float)(((unsigned)i * 2654435769u) >> 8) / 16777216.0f; sum += call; } \\
    sink = sum; \\
    printf("%s %.2f\\n", name, 1e9 * (double)(clock() - start) / CLOCKS_PER_SEC / N); } while (0)
int main(void) {
    for (int i = 0; i <= 1024; ++i) table[i] = QUANTILE(fminf((float)i / 1024.0f, 0.9999f), 1.0f);
    TIME("newton", by_newton(u));
    TIME("table", by_table(u));
TIMES
    return 0;
}
"""
CALLS = {
    "burley_sample": "{}(u, 1.0f)",
    "burley_quantile": "{}(u, 1.0f)",
    "refined_sample": "{}({}(0.5f, 1.0f), u)",
}


def compiled(language, driver):
    every = {f.name: f for f in functions("diffuse")}
    lines = []
    for name in SAMPLERS:
        called = [part.split("(")[0].strip() for part in every[name].calls[language].split("(")[:-1]]
        names = [called[0], called[1].split(",")[-1].strip() if len(called) > 1 else ""]
        lines.append(f'    TIME("{name}", {CALLS[name].format(*names)});')
    quantile = every["burley_quantile"].calls[language].split("(")[0]
    program = PROGRAM.replace("TIMES", "\n".join(lines)).replace("QUANTILE", quantile)
    program = program.replace("USING", "using namespace translucid;" if language == "cpp" else "")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        source = folder / ("main.c" if language == "c" else "main.cpp")
        source.write_text(program)
        (folder / "export.h").write_text(text("diffuse", language))
        (folder / "metal_stdlib").write_text(METAL_LIBRARY)
        command = [driver, f"-std={STANDARDS[language]}", "-O2", f"-I{folder}", source, "-o", folder / "main", "-lm"]
        subprocess.run(command, check=True)
        return subprocess.run([folder / "main"], check=True, capture_output=True, text=True).stdout.splitlines()


def on_device(device, language, function, repeats=20):
    inputs = np.ascontiguousarray(np.tile(function.inputs, (10, 1)))
    usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    arguments = device.create_buffer_with_data(data=inputs, usage=usage)
    results = device.create_buffer(size=4 * len(inputs), usage=usage)
    if language == "wgsl":
        module, entry = device.create_shader_module(code=text("diffuse", "wgsl")), f"each_{function.name}"
    else:
        with tempfile.TemporaryDirectory() as folder:
            source, binary = Path(folder) / "source", Path(folder) / "binary"
            shader = {"glsl": glsl, "hlsl": hlsl}[language]("diffuse", function)
            source.write_text(shader.replace(f"i >= {len(function.inputs)}", f"i >= {len(inputs)}"))
            flags = {"glsl": [], "hlsl": ["-D", "-e", "main", "--hlsl-offsets"]}[language]
            compiler = ["glslangValidator", "-V", "--target-env", "vulkan1.1", "-S", "comp", *flags]
            subprocess.run([*compiler, source, "-o", binary], check=True, capture_output=True)
            module, entry = device.create_shader_module(code=binary.read_bytes()), "main"
    pipeline = device.create_compute_pipeline(layout="auto", compute={"module": module, "entry_point": entry})
    entries = [
        {"binding": i, "resource": {"buffer": buffer, "offset": 0, "size": buffer.size}}
        for i, buffer in enumerate([arguments, results])
    ]
    group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)

    def run(count):
        start = time.perf_counter()
        encoder = device.create_command_encoder()
        for _ in range(count):
            compute = encoder.begin_compute_pass()
            compute.set_pipeline(pipeline)
            compute.set_bind_group(0, group)
            compute.dispatch_workgroups(-(-len(inputs) // WORKGROUP))
            compute.end()
        device.queue.submit([encoder.finish()])
        device.queue.read_buffer(results, size=4)
        return time.perf_counter() - start

    run(1)
    return 1e9 * (run(repeats + 1) - run(1)) / repeats / len(inputs)


def main():
    for language, driver in [("c", "gcc"), ("c", "clang"), ("cpp", FOR_CPP["gcc"]), ("cpp", FOR_CPP["clang"])]:
        for line in compiled(language, driver):
            name, nanoseconds = line.split()
            print(f"{language:<5} {driver:<8} {name:<16} {nanoseconds:>7} ns")
    device = wgpu.gpu.request_adapter_sync(power_preference="low-power").request_device_sync()
    every = {f.name: f for f in functions("diffuse")}
    for language in ["wgsl", "glsl", "hlsl"]:
        for name in SAMPLERS:
            print(f"{language:<5} {'device':<8} {name:<16} {on_device(device, language, every[name]):>7.2f} ns")


if __name__ == "__main__":
    main()
