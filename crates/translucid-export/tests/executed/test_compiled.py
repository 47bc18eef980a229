"""The headers in C and C++, by gcc and clang, with every warning an error, and under UBSan."""

import subprocess

import numpy as np
import pytest
from points import CONFIGURATIONS, DIRECTORY, functions

STANDARDS = {"c": "c99", "cpp": "c++17"}
COMPILERS = {("gcc", "c"): "gcc", ("gcc", "cpp"): "g++", ("clang", "c"): "clang", ("clang", "cpp"): "clang++"}
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
        float row[8], result[8];
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
@pytest.mark.parametrize("language", ["c", "cpp"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("configuration", CONFIGURATIONS)
def test_header_agrees_with_double_precision(configuration, compiler, language, flags, tmp_path):
    every = functions(configuration)
    source, binary = tmp_path / f"main.{language}", tmp_path / "main"
    source.write_text(program(language, every))
    (tmp_path / "export.h").write_text((DIRECTORY / configuration / f"export.{language}").read_text())
    command = [COMPILERS[compiler, language], f"-std={STANDARDS[language]}", *WARNINGS, *flags, str(source)]
    subprocess.run([*command, "-o", str(binary), "-lm"], check=True)
    faults = []
    for function in every:
        arguments = DIRECTORY / configuration / f"{function.name}.arguments"
        results = tmp_path / "results"
        subprocess.run([binary, function.name, arguments, results], check=True)
        faults += function.fault(np.fromfile(results, np.float32), f"{compiler} {language} {flags[-1][:8]}")
    assert not faults
