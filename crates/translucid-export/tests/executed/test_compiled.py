"""The headers in C and C++, by gcc and clang, with every warning an error, and under UBSan.

MSL does not run here. It is C++ with names of its own, so its text is compiled too, with a few lines in the place of Metal's
library.
"""

import subprocess

import numpy as np
import pytest
from points import CONFIGURATIONS, DIRECTORY, functions

STANDARDS = {"c": "c99", "cpp": "c++17", "msl": "c++14"}
FOR_CPP = {"gcc": "g++", "clang": "clang++"}
METAL_LIBRARY = """#include <cmath>
#define constant static const
namespace metal {
using std::cos;
using std::exp;
using std::log;
using std::sin;
using std::sqrt;
inline float abs(float x) { return std::fabs(x); }
inline float max(float x, float y) { return std::fmax(x, y); }
inline float min(float x, float y) { return std::fmin(x, y); }
}
"""
WARNINGS = ["-Wall", "-Wextra", "-pedantic", "-Wshadow", "-Werror"]
SANITIZER = ["-fsanitize=undefined,float-cast-overflow,float-divide-by-zero", "-fno-sanitize-recover=all"]


def program(language, all_functions):
    """A program that reads arguments from one file and writes results to another: FUNCTION ARGUMENTS RESULTS."""
    cases = []
    for function in all_functions:
        arguments = "".join(f"        float {name} = row[{i}];\n" for i, name in enumerate(function.arguments))
        fields = [f".{output}" if output else "" for output in function.outputs]
        cases.append(
            f"""static void each_{function.name}(const float *row, float *result) {{
{arguments}
        {"; ".join(f"result[{i}] = {function.calls[language]}{field}" for i, field in enumerate(fields))};
}}
"""
        )
    table = ",\n".join(
        f'    {{"{f.name}", {len(f.arguments)}, {len(f.outputs)}, each_{f.name}}}' for f in all_functions
    )
    using = "using namespace translucid;\n" if language == "cpp" else ""
    return f"""#include "export.h"
#include <stdio.h>
#include <string.h>
{using}
{"".join(cases)}
struct entry {{
    const char *name;
    unsigned long inputs;
    unsigned long outputs;
    void (*call)(const float *, float *);
}};
static const struct entry TABLE[] = {{
{table}
}};

int main(int count, char **words) {{
    if (count != 4) return 2;
    for (unsigned long i = 0; i < sizeof TABLE / sizeof *TABLE; ++i) {{
        if (strcmp(TABLE[i].name, words[1]) != 0) continue;
        FILE *in = fopen(words[2], "rb");
        FILE *out = fopen(words[3], "wb");
        if (!in || !out) return 3;
        float row[16], result[16];
        while (fread(row, sizeof(float), TABLE[i].inputs, in) == TABLE[i].inputs) {{
            TABLE[i].call(row, result);
            fwrite(result, sizeof(float), TABLE[i].outputs, out);
        }}
        return fclose(out) == 0 && fclose(in) == 0 ? 0 : 4;
    }}
    return 5;
}}
"""


@pytest.mark.parametrize("flags", [["-O2"], ["-O1", *SANITIZER]], ids=["O2", "UBSan"])
@pytest.mark.parametrize("language", ["c", "cpp", "msl"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("configuration", CONFIGURATIONS)
def test_header_agrees_with_double_precision(configuration, compiler, language, flags, tmp_path):
    every = functions(configuration)
    source, binary = tmp_path / ("main.c" if language == "c" else "main.cpp"), tmp_path / "main"
    (tmp_path / "metal_stdlib").write_text(METAL_LIBRARY)
    source.write_text(program(language, every))
    (tmp_path / "export.h").write_text((DIRECTORY / configuration / f"export.{language}").read_text())
    driver = compiler if language == "c" else FOR_CPP[compiler]
    command = [driver, f"-std={STANDARDS[language]}", f"-I{tmp_path}", *WARNINGS, *flags, source, "-o", binary, "-lm"]
    subprocess.run(command, check=True)
    faults = []
    for function in every:
        arguments = DIRECTORY / configuration / f"{function.name}.arguments"
        results = tmp_path / "results"
        subprocess.run([binary, function.name, arguments, results], check=True)
        faults += function.fault(np.fromfile(results, np.float32), f"{compiler} {language} {flags[0]}", language)
    assert not faults
