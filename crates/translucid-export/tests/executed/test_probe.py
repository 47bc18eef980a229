"""The probe as a whole: steps 1 to 3 in C bring the light through a plane and a slab that theory says.

Under uniform light from above an infinite plane sends back the surface albedo. Of light that enters a slab's far side at
the depth t, A (e^(-t/d) + 3 e^(-t/3d))/4 leaves: the profile's energy beyond the radius t.
"""

import math
import subprocess

import pytest
from points import text

# Six comparisons at five standard errors: a false alarm in 3e5 runs, of a fixed seed
ERRORS = 5.0
COUNT = 400_000
WIDTHS, CHANCES, ALBEDOS = [1.0, 0.5, 0.2], [0.4, 0.35, 0.25], [0.9, 0.6, 0.3]
MOST_RADIUS = 8.0

PROGRAM = """#include "export.h"
#include <stdint.h>
#include <stdio.h>
static uint64_t state = 88172645463325252u;
static float next(void) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (float)(state >> 40) / 16777216.0f;
}
int main(void) {
    TranslucidRedGreenBlue widths = translucid_channels(WIDTHS), chances = translucid_channels(CHANCES);
    float albedos[3] = {ALBEDOS}, depth = DEPTH, most = MOST_RADIUS;
    double sums[3] = {0.0, 0.0, 0.0}, squares[3] = {0.0, 0.0, 0.0};
    for (long i = 0; i < COUNT; ++i) {
        float u_axis = next(), u_channel = next(), u_radius = next(), u_turn = next();
        TranslucidSegment s = translucid_probe_segment(widths, chances, most, u_axis, u_channel, u_radius, u_turn);
        if (s.start_z == s.end_z) continue;
        float share = (s.start_z + depth) / (s.start_z - s.end_z);
        if (share < 0.0f || share > 1.0f) continue;
        float x = s.start_x + share * (s.end_x - s.start_x), y = s.start_y + share * (s.end_y - s.start_y);
        float density = translucid_probe_density(widths, chances, most, x, y, -depth, 0.0f, 0.0f, 1.0f);
        if (density <= 0.0f) continue;
        float distance = sqrtf(x * x + y * y + depth * depth), d[3] = {widths.red, widths.green, widths.blue};
        for (int c = 0; c < 3; ++c) {
            double weight = translucid_probe_weight(albedos[c], d[c], most, distance, density);
            sums[c] += weight;
            squares[c] += weight * weight;
        }
    }
    for (int c = 0; c < 3; ++c) {
        double mean = sums[c] / COUNT;
        printf("%.9g %.9g\\n", mean, sqrt((squares[c] / COUNT - mean * mean) / COUNT));
    }
    return 0;
}
"""


@pytest.mark.parametrize("depth", [0.0, 0.7])
def test_probe_keeps_energy(depth, tmp_path):
    program = PROGRAM
    for name, value in [("WIDTHS", WIDTHS), ("CHANCES", CHANCES), ("ALBEDOS", ALBEDOS), ("DEPTH", [depth])]:
        program = program.replace(f"({name})", f"({', '.join(f'{v}f' for v in value)})")
        program = program.replace(f"{{{name}}}", f"{{{', '.join(f'{v}f' for v in value)}}}")
        program = program.replace(f" {name},", f" {', '.join(f'{v}f' for v in value)},")
    program = program.replace("MOST_RADIUS", f"{MOST_RADIUS}f").replace("COUNT", str(COUNT))
    (tmp_path / "main.c").write_text(program)
    (tmp_path / "export.h").write_text(text("diffuse", "c"))
    subprocess.run(["gcc", "-std=c99", "-O2", tmp_path / "main.c", "-o", tmp_path / "main", "-lm"], check=True)
    lines = subprocess.run([tmp_path / "main"], check=True, capture_output=True, text=True).stdout.splitlines()
    for line, d, albedo in zip(lines, WIDTHS, ALBEDOS):
        mean, error = map(float, line.split())
        beyond = lambda r: 0.25 * math.exp(-r / d) + 0.75 * math.exp(-r / (3.0 * d))
        expected = albedo * (beyond(depth) - beyond(MOST_RADIUS)) / (1.0 - beyond(MOST_RADIUS))
        print(f"depth {depth} d {d}: {mean:.5f} ± {error:.5f}, expected {expected:.5f}")
        assert abs(mean - expected) <= ERRORS * error + 1e-6
        assert error < 0.01 * expected
