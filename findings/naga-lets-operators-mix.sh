#!/usr/bin/env bash
# naga takes WGSL whose operators are mixed without parentheses, which WGSL's grammar does not have and Dawn refuses.
#
# Version: wgpu 0.32.0 (PyPI: wgpu-native, naga) and webgpu 0.4.0 (npm: Dawn without a device).
# Expected: the same programs are refused by both: "a || b && c", "a ^ b * c", "a << b + c" are no expressions of WGSL, whose
#           binary operators are grouped by kind in its grammar (Operator Precedence and Associativity).
# Seen: naga takes nine of them and groups as C does; Dawn, and so Chromium, refuses all: "mixing '||' and '&&' requires
#       parenthesis". A shader that runs by wgpu on every native device then ends with an error in a browser. What would
#       compare a truth value with a number both refuse, for its types.
# Fails if that changes. Takes a Vulkan driver (Mesa's llvmpipe will do) for wgpu.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python=${PYTHON:-python3}
"$python" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check "wgpu==0.32.0" "numpy<3"
echo '{"private": true, "type": "module"}' > package.json
npm install --no-audit --no-fund --silent "webgpu@0.4.0"

cat > expressions.json <<'JSON'
{
    "mixed": [
        "bool(a) || bool(b) && bool(c)", "bool(a) && bool(b) || bool(c)", "(a ^ b * c) != 0u", "(a & b | c) != 0u",
        "(a | b ^ c) != 0u", "(a & b + c) != 0u", "(a << b + c) != 0u", "(a << b << c) != 0u", "(a * b << c) != 0u"
    ],
    "grouped": ["bool(a) || (bool(b) && bool(c))", "(a & b & c) != 0u", "(a << (b + c)) != 0u"],
    "compared": ["a < b < c", "a == b == c"]
}
JSON
cat > naga.py <<'PYTHON'
import json

from wgpu.utils import get_default_device

device = get_default_device()


def is_taken(expression):
    code = f"""
        @group(0) @binding(0) var<storage, read_write> words: array<u32>;
        @compute @workgroup_size(1)
        fn main() {{
            let a = words[0]; let b = words[1]; let c = words[2];
            if ({expression}) {{ words[3] = 1u; }}
        }}"""
    try:
        device.create_shader_module(code=code)
    except Exception:
        return False
    return True


expressions = json.load(open("expressions.json"))
print(json.dumps({kind: [is_taken(each) for each in list] for kind, list in expressions.items()}))
PYTHON
cat > dawn.mjs <<'JS'
import { readFileSync } from "node:fs";

import { create } from "webgpu";

const adapter = await create(["backend=null"]).requestAdapter();
const device = await adapter.requestDevice();

async function isTaken(expression) {
    const code = `
        @group(0) @binding(0) var<storage, read_write> words: array<u32>;
        @compute @workgroup_size(1)
        fn main() {
            let a = words[0]; let b = words[1]; let c = words[2];
            if (${expression}) { words[3] = 1u; }
        }`;
    device.pushErrorScope("validation");
    const { messages } = await device.createShaderModule({ code }).getCompilationInfo();
    await device.popErrorScope();
    return !messages.some(({ type }) => type === "error");
}

const found = {};
for (const [kind, list] of Object.entries(JSON.parse(readFileSync("expressions.json")))) {
    found[kind] = [];
    for (const each of list) found[kind].push(await isTaken(each));
}
console.log(JSON.stringify(found));
process.exit(0);
JS
naga=$(XDG_RUNTIME_DIR=${XDG_RUNTIME_DIR:-/tmp} venv/bin/python naga.py | tail -n 1)
dawn=$(node dawn.mjs 2>/dev/null | tail -n 1)
echo "naga $naga"
echo "Dawn $dawn"
"$python" - "$naga" "$dawn" <<'PYTHON'
import json
import sys

naga, dawn = map(json.loads, sys.argv[1:])
for found in naga, dawn:
    assert all(found["grouped"]) and not any(found["compared"]), found
assert all(naga["mixed"]) and not any(dawn["mixed"])
PYTHON
echo "as described"
