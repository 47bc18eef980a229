# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of lamps: by formulas where there are some, and beside Cycles for every kind and shape."""

import math

import bpy
import numpy as np
import pytest
from harness import add_camera, add_light, add_mesh, add_plane, combined, matte, new_scene, radians, regions, render_cycles, set_world

ALBEDO = 0.5


def irradiance():
    """Irradiance of the floor in the middle of the picture, from its radiance."""
    picture = combined()
    height, width = picture.shape[:2]
    return picture[height // 2 - 2 : height // 2 + 2, width // 2 - 2 : width // 2 + 2, 0].mean() * math.pi / ALBEDO


def floor(samples=64):
    new_scene(32, 32, samples)
    add_plane(20.0, material=matte((ALBEDO,) * 3))
    # So narrow a view that the middle of the picture is the point below.
    add_camera((0, 0, 6), type="ORTHO", ortho_scale=0.1)


def test_a_point_shines_its_watts_in_all_directions():
    floor()
    add_light("POINT", (0, 0, 2), energy=100.0, shadow_soft_size=0.0)
    assert irradiance() == pytest.approx(100 / (4 * math.pi * 2**2), rel=1e-3)


def test_a_ball_shines_as_a_point_does():
    floor()
    add_light("POINT", (0, 0, 2), energy=100.0, shadow_soft_size=0.3)
    assert irradiance() == pytest.approx(100 / (4 * math.pi * 2**2), rel=2e-3)


def test_a_spot_has_the_intensity_of_a_point():
    floor()
    add_light("SPOT", (0, 0, 2), energy=100.0, shadow_soft_size=0.0)
    assert irradiance() == pytest.approx(100 / (4 * math.pi * 2**2), rel=1e-3)


def test_a_sun_states_its_irradiance():
    floor()
    add_light("SUN", rotation=radians(60, 0, 20), energy=3.0, angle=0.01)
    assert irradiance() == pytest.approx(3.0 * math.cos(math.radians(60)), rel=2e-3)


def test_an_area_shines_its_watts_as_a_lambertian_disk_does():
    floor(256)
    add_light("AREA", (0, 0, 2), energy=50.0, shape="DISK", size=1.5)
    # Above the middle of a disk: π L sin², and L = P / (π · area).
    radiance = 50 / (math.pi * math.pi * 0.75**2)
    assert irradiance() == pytest.approx(math.pi * radiance * 0.75**2 / (0.75**2 + 2**2), rel=3e-3)


def test_a_world_lights_by_pi_times_its_radiance():
    floor(256)
    set_world((0.2, 0.2, 0.2), 2.5)
    assert irradiance() == pytest.approx(math.pi * 0.5, rel=3e-3)


def test_color_and_exposure_of_lamps():
    floor()
    lamp = add_light("POINT", (0, 0, 2), energy=100.0, shadow_soft_size=0.0, color=(0.5, 1, 1))
    assert irradiance() == pytest.approx(50 / (4 * math.pi * 2**2), rel=1e-3)
    if hasattr(lamp.data, "exposure"):
        lamp.data.exposure = 1.0
        assert irradiance() == pytest.approx(100 / (4 * math.pi * 2**2), rel=1e-3)


LAMPS = {
    "point": ("POINT", dict(energy=100.0), {}),
    "ball": ("POINT", dict(energy=100.0, shadow_soft_size=0.15), {}),
    "spot": ("SPOT", dict(energy=100.0, spot_size=1.4, spot_blend=0.5), {}),
    "spot with a radius": ("SPOT", dict(energy=100.0, spot_size=1.4, spot_blend=0.5, shadow_soft_size=0.1), {}),
    "sun": ("SUN", dict(energy=2.0, angle=0.3), {}),
    "square": ("AREA", dict(energy=100.0, size=0.7), {}),
    "rectangle": ("AREA", dict(energy=100.0, shape="RECTANGLE", size=0.9, size_y=0.3), {}),
    "disk": ("AREA", dict(energy=100.0, shape="DISK", size=0.7), {}),
    "ellipse": ("AREA", dict(energy=100.0, shape="ELLIPSE", size=0.9, size_y=0.3), {}),
    "stretched square": ("AREA", dict(energy=100.0, size=0.7), dict(scale=(2, 0.5, 1))),
}
if "normalize" in bpy.types.Light.bl_rna.properties:
    LAMPS |= {
        "ball, not normalized": ("POINT", dict(energy=100.0, shadow_soft_size=0.15, normalize=False), {}),
        "sun, not normalized": ("SUN", dict(energy=20.0, angle=0.3, normalize=False), {}),
        "ellipse, not normalized": ("AREA", dict(energy=100.0, shape="ELLIPSE", size=0.9, size_y=0.3, normalize=False), {}),
        "warm point": ("POINT", dict(energy=100.0, use_temperature=True, temperature=3000.0), {}),
    }


@pytest.mark.parametrize("kind, settings, place", LAMPS.values(), ids=LAMPS.keys())
def test_lamps_shine_on_matte_surfaces_as_in_cycles(kind, settings, place):
    new_scene(64, 48, 64)
    material = matte((0.5, 0.5, 0.5))
    add_plane(5.0, material=material)
    # Something that throws a shadow.
    add_mesh("blind", [(-0.6, -0.3, 0.5), (-0.2, -0.3, 0.5), (-0.2, 0.3, 0.6), (-0.6, 0.3, 0.6)], [(0, 1, 2, 3)], material)
    add_camera((0, 0, 6))
    lamp = add_light(kind, (0.5, 0.3, 2), (0.3, 0.2, 0.4), **settings)
    for key, value in place.items():
        setattr(lamp, key, value)
    ours, theirs = regions(combined())[..., :3], regions(render_cycles(256))[..., :3]
    lit = theirs > 0.05 * theirs.max()
    assert lit.sum() > 6
    ratio = ours.sum() / theirs.sum()
    print(f"whole {ratio:.5f}, regions {(ours[lit] / theirs[lit]).min():.5f} to {(ours[lit] / theirs[lit]).max():.5f}")
    assert ratio == pytest.approx(1, abs=0.005)
    # 192 pixels of 64 and 256 samples: what is beyond noise is in the picture.
    assert np.abs(ours[lit] / theirs[lit] - 1).max() < 0.01
