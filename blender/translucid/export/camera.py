# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras: a place, and a projection that Blender calculates."""

import numpy as np


# Radius of the widest lens in distances to what is seen; those above 256 are refused.
WIDEST = 255


def camera_keys(world_from_camera, projection, lens=None):
    """The keys of a camera.

    `projection` is Blender's 4×4 matrix, which holds lens, sensor, shift, zoom and aspect at once; `lens` the radius of
    the lens and the distance in focus.
    """
    world = np.array(world_from_camera, dtype=np.float64)
    projection = np.array(projection, dtype=np.float64)
    right, up, back = (_unit(world[:3, i]) for i in range(3))
    position = world[:3, 3]
    keys = {
        "position": position.tolist(),
        "target": (position - back * max(1.0, float(np.abs(position).max()) * 1e-3)).tolist(),
        "up": up.tolist(),
    }
    if projection[3, 3] == 0:
        keys["fov"] = float(np.degrees(2 * np.arctan(1 / projection[0, 0])))
        shift = projection[:2, 2] / 2
    else:
        keys["projection"], keys["width"] = "orthographic", float(2 / projection[0, 0])
        shift = -projection[:2, 3] / 2
    # Blender's is in half widths and half heights of the picture, the renderer's in widths.
    shift = [float(shift[0]), float(shift[1] * projection[0, 0] / projection[1, 1])]
    if max(map(abs, shift)) > 1e-7:
        keys["shift"] = shift
    if lens is not None:
        radius, focus = lens
        reach = max(focus, float(np.linalg.norm(position - np.array(keys["target"]))))
        keys["lens_radius"], keys["focus_distance"] = min(radius, WIDEST * reach), focus
    return keys


def lens_of(camera_object):
    """The radius of a camera's lens and the distance in focus, or None of a pinhole."""
    camera = camera_object.data
    dof = camera.dof
    if not dof.use_dof:
        return None
    distance = dof.focus_distance
    if dof.focus_object is not None:
        world = np.array(camera_object.matrix_world)
        to_focus = np.array(dof.focus_object.matrix_world)[:3, 3] - world[:3, 3]
        distance = abs(float(to_focus @ _unit(world[:3, 2])))
    # The f-number is of the focal length, in mm; an orthographic camera's is taken as of one unit, as Cycles does.
    focal = camera.lens * 1e-3 if camera.type == "PERSP" else 1.0
    return focal / (2 * max(dof.aperture_fstop, 1e-5)), max(distance, 1e-5)


def scene_camera(camera_object, depsgraph, width, height, report, eye=None):
    """The keys of a scene's camera for a picture of so many pixels.

    `eye` is the matrix of one of two eyes, and its shift beside the camera's.
    """
    camera = camera_object.data
    where = f"camera {camera_object.name}"
    if camera.type not in {"PERSP", "ORTHO"}:
        report.add(where, None, f"a camera of type {camera.type.capitalize()} cannot be translated; it is perspective")
    if camera.type == "PERSP" and camera.dof.use_dof and camera.dof.aperture_ratio != 1:
        report.add(where, None, "an anamorphic lens cannot be translated; it is round")
    if camera.dof.use_dof and camera.dof.aperture_blades:
        report.add(where, None, "a lens with blades cannot be translated; it is round")
    projection = camera_object.calc_matrix_camera(depsgraph, x=width, y=height)
    lens = lens_of(camera_object)
    keys = camera_keys(eye[0] if eye else camera_object.matrix_world, projection, lens)
    if lens is not None and keys["lens_radius"] < lens[0]:
        report.add(where, None, f"a lens above {WIDEST} times the distance in focus cannot be rendered; it is that wide")
    if eye and eye[1] != 0:
        x, y = keys.get("shift", (0.0, 0.0))
        keys["shift"] = [x + eye[1], y]
    return keys


def _unit(vector):
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else vector


def depth_along_view(distance, keys, size, region):
    """The depth along the view of distances from the camera in a region of a picture.

    As Blender's pass has it, 1e10 where there is nothing.
    """
    width, height = size
    depth = distance[..., 0]
    if "fov" in keys:
        across = np.tan(np.radians(keys["fov"]) / 2)
        shift = keys.get("shift", (0.0, 0.0))
        left, top, right, bottom = region
        x = ((np.arange(left, right) + 0.5) / width - 0.5 + shift[0]) * 2 * across
        y = ((0.5 - (np.arange(top, bottom) + 0.5) / height) * height / width + shift[1]) * 2 * across
        depth = depth / np.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)
    return np.where(depth > 0, depth, np.float32(1e10)).astype(np.float32)
