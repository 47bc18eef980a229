#!/usr/bin/env bash
# Two Vulkan drivers rearrange sums of WGSL so that compensated sums and rounding by a large number do nothing.
#
# Version: wgpu 0.32.0 (PyPI) on Mesa's llvmpipe 22.3.6 (Debian 12, mesa-vulkan-drivers); the same but for the first on
#          Chromium's SwiftShader, which VK_ICD_FILENAMES takes.
# Expected: + and * of f32 rounded once each, as WGSL's table of accuracy has them, so that (x + y) − x is what y became in the
#           sum (Kahan's and Knuth's error-free sums live by that) and (x + 1e6) − 1e6 is x rounded to a multiple of 1/16.
# Seen: llvmpipe returns y for (x + y) − x, so a compensated sum is a plain one. Both drivers return x for (x + 1e6) − 1e6, and
#       x·15 for (x·3)·5; x·y + x·x becomes x·(x + y). An exclusive or with a 0 that the compiler does not know, through
#       bitcast, keeps each of them as written.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=${PYTHON:-python3}
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "wgpu==0.32.0" "numpy<3"

cat > "$folder/sums.py" <<'PYTHON'
import numpy as np
import wgpu
from wgpu.utils.compute import compute_with_buffers

COUNT = 1 << 16
random = np.random.default_rng(1)
x, y = (random.uniform(-0.5, 0.5, COUNT).astype(np.float32) for _ in range(2))
zero = np.zeros(1, dtype=np.uint32)
f = np.float32


def shader(expression):
    code = """
        @group(0) @binding(0) var<storage, read> xs: array<f32>;
        @group(0) @binding(1) var<storage, read> ys: array<f32>;
        @group(0) @binding(2) var<storage, read> zero: array<u32>;
        @group(0) @binding(3) var<storage, read_write> results: array<f32>;

        fn kept(a: f32) -> f32 { return bitcast<f32>(bitcast<u32>(a) ^ zero[0]); }

        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            let x = xs[id.x];
            let y = ys[id.x];
            results[id.x] = EXPRESSION;
        }""".replace("EXPRESSION", expression)
    out = compute_with_buffers({0: x, 1: y, 2: zero}, {3: (COUNT, "f")}, code, n=COUNT // 64)
    return np.frombuffer(out[3], np.float32)


name = wgpu.gpu.request_adapter_sync().info["device"]
print(name)
swift = "swiftshader" in name.lower()
for written, kept, rounded, rearranged, alike in [
    ("x + y - x", "kept(x + y) - x", (x + y) - x, y, swift),
    ("(x + 1e6) - 1e6", "kept(x + 1e6) - 1e6", (x + f(1e6)) - f(1e6), x, False),
    ("(x * 3.0) * 5.0", "kept(x * 3.0) * 5.0", (x * f(3)) * f(5), x * f(15), False),
    ("x * y + x * x", "kept(x * y) + kept(x * x)", x * y + x * x, x * (x + y), False),
]:
    found = shader(written)
    as_rounded, as_rearranged = (found == rounded).all(), (found == rearranged).all()
    print(f"{written}: as written {(found == rounded).mean():.0%}, rearranged {(found == rearranged).mean():.0%}")
    assert as_rounded if alike else as_rearranged and not as_rounded, written
    assert (shader(kept) == rounded).all(), kept
PYTHON
XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}" "$folder/venv/bin/python" "$folder/sums.py"
