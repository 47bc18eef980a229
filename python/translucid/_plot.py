"""Plots, with matplotlib if it is installed."""

from __future__ import annotations

import numpy as np

LABELS = {
    "eval": "reflectance R(r)",
    "pdf": "density per length",
    "pdf_area": "density per area",
    "cdf": "share within r",
    "enclosed": "energy within r",
    "beyond": "energy beyond r",
}
LOGARITHMIC = ("eval", "pdf_area", "beyond")
# Lines beyond these would be a blot.
MOST_LINES = 100


def pyplot():
    """matplotlib.pyplot, or an error that says what to install."""
    try:
        import matplotlib.pyplot
    except ImportError as error:
        raise ImportError(
            'plot needs matplotlib, which is not installed: pip install "translucid[plot]"'
        ) from error
    return matplotlib.pyplot


def profile(profile, r=None, quantity="eval", ax=None, **line):
    """Draw profiles over the radius; see `Profile.plot`."""
    if quantity not in LABELS:
        raise ValueError(f"quantity is {quantity!r}, but must be one of {', '.join(LABELS)}")
    count = int(np.prod(profile.shape))
    if count > MOST_LINES:
        raise ValueError(f"the profile has the shape {profile.shape}, but at most {MOST_LINES} are drawn")
    plt = pyplot()
    if r is None:
        far = float(np.max(profile.quantile(0.999), initial=0.0))
        if not 0.0 < far < 1e300:
            far = 1.0
        r = np.linspace(far / 1000, far, 1000)
    r = np.asarray(r, dtype=float)
    if r.ndim != 1:
        raise ValueError(f"r has the shape {r.shape}, but must have one dimension")
    if ax is None:
        ax = plt.figure(layout="constrained").add_subplot()
    # The radius goes along a new last axis, the profiles along the others.
    values = getattr(profile, quantity)(r.reshape((-1,) + (1,) * len(profile.shape)))
    lines = ax.plot(r, np.reshape(values, (len(r), -1)), **line)
    if "label" not in line:
        for drawn, label in zip(lines, _labels(profile)):
            drawn.set_label(label)
    ax.set_xlabel("radius r")
    ax.set_ylabel(LABELS[quantity])
    if quantity in LOGARITHMIC:
        ax.set_yscale("log")
    return ax


def _labels(profile):
    """What tells the lines of a profile apart: the parameters that differ, or the model."""
    shape = profile.shape
    count = int(np.prod(shape))
    varied = {}
    for name in ("surface_albedo", "mfp", "dmfp", "g", "eta"):
        values = getattr(profile, name, None)
        values = None if values is None else np.broadcast_to(values, shape).reshape(-1)
        if values is not None and count > 1 and np.ptp(values) > 0:
            varied[name.replace("_", " ")] = values
    plain = profile.model or "profile"
    if not varied:
        return [plain] * count
    return [", ".join(f"{name} {values[i]:.3g}" for name, values in varied.items()) for i in range(count)]
