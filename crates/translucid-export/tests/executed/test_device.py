"""WGSL, and GLSL and HLSL through glslang, on a Vulkan device; Mesa's lavapipe is one without hardware."""

import subprocess

import numpy as np
import pytest
import wgpu
from points import CONFIGURATIONS, DIRECTORY, functions, text

WORKGROUP = 64


@pytest.fixture(scope="session")
def device():
    adapter = wgpu.gpu.request_adapter_sync(power_preference="low-power")
    print(adapter.info["device"], adapter.info["description"])
    return adapter.request_device_sync()


def compute(device, module, entry, function):
    """Results of an entry point for all points."""
    inputs = np.ascontiguousarray(function.inputs)
    count = len(inputs)
    usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    arguments = device.create_buffer_with_data(data=inputs, usage=usage)
    results = device.create_buffer(size=4 * count * len(function.outputs), usage=usage)
    pipeline = device.create_compute_pipeline(layout="auto", compute={"module": module, "entry_point": entry})
    group = device.create_bind_group(
        layout=pipeline.get_bind_group_layout(0),
        entries=[
            {"binding": i, "resource": {"buffer": buffer, "offset": 0, "size": buffer.size}}
            for i, buffer in enumerate([arguments, results])
        ],
    )
    encoder = device.create_command_encoder()
    run = encoder.begin_compute_pass()
    run.set_pipeline(pipeline)
    run.set_bind_group(0, group)
    run.dispatch_workgroups(-(-count // WORKGROUP))
    run.end()
    device.queue.submit([encoder.finish()])
    return np.frombuffer(device.queue.read_buffer(results), np.float32)


@pytest.mark.parametrize("configuration", CONFIGURATIONS)
def test_wgsl_agrees_with_double_precision(device, configuration):
    module = device.create_shader_module(code=text(configuration, "wgsl"))
    faults = []
    for function in functions(configuration):
        faults += function.fault(compute(device, module, f"each_{function.name}", function), "WGSL", "wgsl")
    assert not faults


def glsl(configuration, function):
    inputs, outputs = len(function.arguments), len(function.outputs)
    arguments = "".join(f"    float {name} = argumentsOfAll[{inputs}u * i + {j}u];\n" for j, name in enumerate(function.arguments))
    fields = [f".{output}" if output else "" for output in function.outputs]
    results = "".join(
        f"    resultsOfAll[{outputs}u * i + {j}u] = {function.calls['glsl']}{field};\n" for j, field in enumerate(fields)
    )
    return f"""#version 450
layout(local_size_x = {WORKGROUP}) in;
layout(std430, binding = 0) buffer Arguments {{ float argumentsOfAll[]; }};
layout(std430, binding = 1) buffer Results {{ float resultsOfAll[]; }};
{text(configuration, "glsl")}
void main() {{
    uint i = gl_GlobalInvocationID.x;
    if (i * {outputs}u >= uint(resultsOfAll.length())) return;
{arguments}{results}}}
"""


def hlsl(configuration, function):
    inputs, outputs = len(function.arguments), len(function.outputs)
    arguments = "".join(f"    float {name} = argumentsOfAll[{inputs} * i + {j}];\n" for j, name in enumerate(function.arguments))
    fields = [f".{output}" if output else "" for output in function.outputs]
    results = "".join(
        f"    resultsOfAll[{outputs} * i + {j}] = {function.calls['hlsl']}{field};\n" for j, field in enumerate(fields)
    )
    count = len(function.inputs)
    return f"""[[vk::binding(0)]] RWStructuredBuffer<float> argumentsOfAll : register(u0);
[[vk::binding(1)]] RWStructuredBuffer<float> resultsOfAll : register(u1);
{text(configuration, "hlsl")}
[numthreads({WORKGROUP}, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {{
    uint i = id.x;
    if (i >= {count}) return;
{arguments}{results}}}
"""


@pytest.mark.parametrize("language", ["glsl", "hlsl"])
@pytest.mark.parametrize("configuration", CONFIGURATIONS)
def test_shader_agrees_with_double_precision(device, configuration, language, tmp_path):
    flags = {"glsl": [], "hlsl": ["-D", "-e", "main", "--hlsl-offsets"]}[language]
    write = {"glsl": glsl, "hlsl": hlsl}[language]
    faults = []
    for function in functions(configuration):
        source, binary = tmp_path / f"{function.name}.{language}", tmp_path / f"{function.name}.spv"
        source.write_text(write(configuration, function))
        compiler = ["glslangValidator", "-V", "--target-env", "vulkan1.1", "-S", "comp", *flags]
        done = subprocess.run([*compiler, source, "-o", binary], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout
        subprocess.run(["spirv-val", "--target-env", "vulkan1.1", binary], check=True)
        module = device.create_shader_module(code=binary.read_bytes())
        faults += function.fault(compute(device, module, "main", function), language.upper(), language)
    assert not faults
