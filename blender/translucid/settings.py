# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's settings as keys of the renderer."""

# Share of Burley's profile beyond 16 d, where Cycles cuts it off and renormalizes the rest.
CYCLES_TAIL = 0.00362

# The renderer's own choice.
TAIL = 1e-3

# Diffuse events on a path: Cycles' default is four after the first.
_DIFFUSE_EVENTS = 5


def integrator_keys(scene, samples, model, method=None, is_denoised=False):
    """`model` takes the place of the transports that belong to the nodes' methods, `method` that of the scene's.

    Denoised pictures do not share: what sharing leaves is alike in neighboring pixels, and a denoiser takes it for detail.
    """
    settings = scene.translucid
    method = method or settings.method
    keys = {
        "samples_per_pixel": samples,
        "max_depth": settings.max_bounces + 1,
        "max_diffuse_depth": min(_DIFFUSE_EVENTS, settings.max_bounces + 1),
        "caustics": settings.use_caustics,
        "subsurface_method": method,
        "subsurface_sharing": settings.use_sharing and not is_denoised,
        "seed": seed_of(scene),
    }
    # An edit leaves what it does not name.
    keys["subsurface_tail"] = CYCLES_TAIL if model is None else TAIL
    if model is None and method == "ray-traced":
        keys["subsurface_method"] = "cycles-disk"
    return keys


def seed_of(scene):
    """The seed of a frame: the 32 bits above the setting's number the frames."""
    settings = scene.translucid
    frame = scene.frame_current + (1 << 20) if settings.use_animated_seed else 0
    return settings.seed + (frame << 32)


def film_keys(scene, width, height):
    # Cycles' filter of 1.5 pixels reaches 1.5 pixels to each side.
    return {"size": [width, height], "filter_radius": max(scene.render.filter_size, 0.01)}


def model_of(scene):
    """The model in place of the nodes' own, or None."""
    model = scene.translucid.model
    return None if model == "NODE" else model


def threads_of(scene):
    return scene.render.threads if scene.render.threads_mode == "FIXED" else None
