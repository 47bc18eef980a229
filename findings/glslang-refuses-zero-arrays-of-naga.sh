#!/usr/bin/env bash
# naga clears local arrays in HLSL by a cast of 0, `uint kept[4] = (uint[4])0;`, which glslang's HLSL front end refuses.
#
# Version: naga-cli 30.0.1 (crates.io) with glslang 11.13 or later (Debian 12: glslang-tools 12.0.0), and Microsoft's DXC 1.7
#          (`libdxcompiler` in compushady 0.17.5, PyPI).
# Expected: whoever has no Windows checks naga's HLSL with glslangValidator -D, which reads HLSL; what DXC compiles it compiles.
# Seen: every variable of WGSL that is an array without a value becomes a cast of 0 to an array. DXC takes it. glslang 12 says
#       "array constructor needs one argument per array element" and "cannot convert from ' const float' to ' temp 4-element
#       array of uint'". Structures (`(Pair)0`) it takes, so a shader can pass for months until its first local array.
# Fails if that changes. Takes cargo, g++ and glslangValidator.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cargo install --quiet --locked --root "$folder" naga-cli@30.0.1
cd "$folder"
"${PYTHON:-python3}" -m pip download --quiet --disable-pip-version-check --no-deps \
    compushady==0.17.5 2> pip.log || { cat pip.log >&2; exit 1; }
tar xzf compushady-0.17.5.tar.gz --strip-components=3 compushady-0.17.5/compushady/backends/{dxcapi.h,WinAdapter.h,libdxcompiler_x86_64.so.3.7}

shader() { # declarations, a value
    cat <<WGSL
struct Pair { a: u32, b: vec2f }
@group(0) @binding(0) var<storage, read_write> words: array<u32>;
@compute @workgroup_size(1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    $1
    words[id.x] = $2;
}
WGSL
}
shader "var kept: array<u32, 4>; kept[id.x & 3u] = words[0];" "kept[1]" > array.wgsl
shader "var kept: array<u32, 4> = array<u32, 4>(0u, 0u, 0u, 0u); kept[id.x & 3u] = words[0];" "kept[1]" > stated.wgsl
shader "var pair: Pair; pair.a = words[0];" "pair.a + u32(pair.b.x)" > structure.wgsl

cat > dxc.cpp <<'CPP'
#include "WinAdapter.h"
#include "dxcapi.h"
#include <dlfcn.h>
#include <fstream>
#include <iterator>
#include <string>

int main(int, char **names) {
    void *library = dlopen(names[1], RTLD_NOW);
    auto create = reinterpret_cast<DxcCreateInstanceProc>(dlsym(library, "DxcCreateInstance"));
    IDxcCompiler3 *compiler = nullptr;
    create(CLSID_DxcCompiler, __uuidof(IDxcCompiler3), reinterpret_cast<void **>(&compiler));
    std::ifstream file(names[2]);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    DxcBuffer buffer{text.data(), text.size(), DXC_CP_UTF8};
    LPCWSTR options[] = {L"-E", L"main", L"-T", L"cs_6_0", L"-HV", L"2018", L"-Vd"};
    IDxcResult *result = nullptr;
    compiler->Compile(&buffer, options, 7, nullptr, __uuidof(IDxcResult), reinterpret_cast<void **>(&result));
    HRESULT status = 1;
    result->GetStatus(&status);
    return status != 0;
}
CPP
g++ -fms-extensions -w -o dxc dxc.cpp -ldl

status=0
glslangValidator --version | head -1
for name in array stated structure; do
    bin/naga "$name.wgsl" "$name.hlsl" --shader-stage compute > /dev/null 2>&1 || bin/naga "$name.wgsl" "$name.hlsl" > /dev/null
    glslang=taken dxc=taken
    glslangValidator -D -S comp -e main -V "$name.hlsl" -o "$name.spv" > "$name.log" || glslang=refused
    ./dxc ./libdxcompiler_x86_64.so.3.7 "$name.hlsl" || dxc=refused
    echo "$name: glslang $glslang, DXC $dxc; $(grep -c '\])0;' "$name.hlsl" || true) casts of 0 to an array"
    expected=taken
    if [ "$name" = array ]; then
        expected=refused
        grep ERROR "$name.log" | head -2 || true
    fi
    if [ "$glslang $dxc" != "$expected taken" ]; then status=1; fi
done
exit $status
