"""A material from a photograph."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np

from . import _translucid


class Measured(NamedTuple):
    """A quantity with its confidence intervals.

    Of red, green and blue the value has the shape (3,) and the intervals, from and to, have (3, 2); of a number that all
    channels share they have () and (2,).
    """

    value: np.ndarray
    likely: np.ndarray
    sure: np.ndarray
    unit: str


class Measurement(dict):
    """A material that was measured in a photograph: ``measurement["mfp"].value``.

    The keys are those of the command's table: ``"mfp"`` and ``"surface_albedo"``, of a known scene ``"g"`` and
    ``"radiance_scale"``, too. `Measured` has the value, the interval of 68 % (``likely``) and that of 95 % (``sure``).

    Attributes
    ----------
    material : dict
        The material as keys of `Scene.add_material`: ``scene.add_material("soap", **measurement.material)``.
    is_seen : numpy.ndarray or None
        Whether scattering is seen in each channel. Where it is not, the mean free path is 0, and may be anything.
    blur : float or None
        Standard deviation of the camera's blur, and of a spot's soft edge [mm].
    misfit : float or None
        Residuals over the noise, 1 where the model is right.
    correlation : numpy.ndarray or None
        Correlation of the errors of mean free path and surface albedo in each channel.
    stray_light : numpy.ndarray or None
        Stray light over that of the lit side or the center of the spot in each channel.
    steps : int or None
        Steps that the fit of a known scene took.
    findings, notes, warnings : list of str
        What was found in the photograph, and what limits the measurement. Each warning is a `UserWarning`, too.
    """

    material: dict
    is_seen: np.ndarray | None
    blur: float | None
    misfit: float | None
    correlation: np.ndarray | None
    stray_light: np.ndarray | None
    steps: int | None
    findings: list[str]
    notes: list[str]
    warnings: list[str]

    def __init__(self, found: dict) -> None:
        super().__init__()
        for channel, name, unit, *numbers in found["rows"]:
            if channel is None:
                value, likely, sure = map(np.asarray, numbers)
                self[name] = Measured(value, likely, sure, unit)
                continue
            if name not in self:
                # A channel in which nothing is seen has no row
                anything = np.tile([0.0, np.finfo(float).max], (3, 1))
                self[name] = Measured(np.zeros(3), anything, anything.copy(), unit)
            for array, number in zip(self[name], numbers):
                array[channel] = number
        self.material = found["material"]
        for name in ("is_seen", "correlation", "stray_light"):
            setattr(self, name, np.array(found[name]) if name in found else None)
        for name in ("blur", "misfit", "steps"):
            setattr(self, name, found.get(name))
        self.findings, self.notes, self.warnings = found["findings"], found["notes"], found["warnings"]


def measure(
    photo,
    *,
    setup: str | None = None,
    thickness: float | None = None,
    mm_per_pixel: float | None = None,
    ruler=None,
    white=None,
    white_photo=None,
    white_reflectance=None,
    white_tolerance: float | None = None,
    surface_albedo=None,
    region=None,
    edge=None,
    center=None,
    card: str | None = None,
    exposure=None,
    dark=None,
    linear: bool = False,
    configuration: str | None = None,
    incidence: float | None = None,
    eta: float | None = None,
    g: float | None = None,
    scene=None,
    fit=None,
    material: str | None = None,
    subsurface: str | None = None,
    spp: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress=None,
) -> Measurement:
    """Measure the surface albedo and the mean free path of a material in a photograph.

    The photograph shows light that creeps below the surface: beside an edge, around a spot, through a slab; or, with
    `scene`, a thing of any known shape. docs/guide/measure.md describes how to take it.

    Parameters
    ----------
    photo : path-like, or array_like of shape (H, W, 3) or (H, W, 4)
        The photograph: a file, or linear red, green and blue.
    setup : {"edge", "spot", "slab"}, default "edge"
        The thing that shapes the light on the piece.
    thickness : float, optional
        Thickness of the slab [mm], in (0, 1e6].
    mm_per_pixel : float
        Width of a pixel on the piece [mm], in (0, 1e6].
    ruler : array_like of shape (5,)
        In its place two points and the distance between them: x0, y0, x1, y1 [pixels] and mm.
    white : (int, int, int, int), optional
        White card in the photograph, from (x0, y0) at the upper left to before (x1, y1).
    white_photo : as photo, optional
        The same view with white paper in place of the piece.
    white_reflectance : float or array_like of shape (3,), optional
        Reflectance of what is white, in (0, 1]; by default 0.9, or 1 for the panel behind a slab.
    white_tolerance : float, optional
        Relative standard error of that reflectance, in [0, 0.5]; by default 0.02, or 0 for the panel behind a slab.
    surface_albedo : float or array_like of shape (3,), optional
        Surface albedo where nothing white is seen, in (0, 1); by default it is not known, and intervals hold 0.1 to 0.98.
    region : (int, int, int, int), optional
        Part of the photograph to measure; by default all of it but the white card.
    edge : array_like of shape (4,), optional
        Two points of the card's edge, x0, y0, x1, y1; found by default.
    center : array_like of shape (2,), optional
        Center of the spot; found by default.
    card : {"hidden", "visible"}, optional
        What the dark side shows: the piece in shadow, or the card; found by default.
    exposure : iterable of photos, optional
        Other exposures of the same view, merged with the first.
    dark : as photo, optional
        The same exposure with the light off, which is subtracted.
    linear : bool, default False
        Take values of integers in files as linear instead of sRGB.
    configuration : {"diffuse", "searchlight"}, default "diffuse"
        How light falls on a matt piece, or on a clear one that is seen from straight above.
    incidence : float, optional
        Angle of a lamp on a clear piece [degrees], in (-90, 90).
    eta, g : float, default 1 and 0
        Relative refractive index of a smooth piece, in [0.5, 3]; mean cosine of scattering, in (-1, 1).
    scene : Scene or path-like, optional
        A scene whose picture the photograph is: shape, camera and lights are known. Then only `photo`, `region`, `linear`
        and the arguments below count.
    fit : str or iterable of str
        Parameters to find in the scene: "material.surface_albedo", "material.mfp", "material.g", "light.radiance".
    material : str, optional
        Name of the material that they belong to; by default the scene's translucent one.
    subsurface : str, optional
        Model of the transport under surfaces, in place of the scene's.
    spp, seed, threads : int, optional
        Samples per pixel of each picture, by default the scene's; seed of the random numbers; threads to render with.
    progress : bool, 'tqdm' or callable, optional
        For a scene: called with the numbers of paths that are traced and that a usual fit traces.

    Returns
    -------
    Measurement
        A dict of `Measured`, with the numbers of `translucid measure`, bit for bit. Lengths are in mm, for a scene in its
        own unit.

    Raises
    ------
    SceneError, ValueError
        An argument is out of its range, or the photograph does not show what it must; the message says what is allowed.
    TypeError
        An argument has the wrong type.
    KeyboardInterrupt
        Ctrl-C was pressed.

    Examples
    --------
    >>> x = np.arange(120) - 60.0
    >>> light = 0.3 + 0.25 * np.tanh(x / 10) + 1e-3 * np.random.default_rng(1).normal(size=(60, 120))
    >>> found = translucid.measure(np.stack([light] * 3, axis=2), mm_per_pixel=0.1, surface_albedo=0.8)
    >>> found["mfp"].value.shape, found["mfp"].sure.shape
    ((3,), (3, 2))
    """
    keys = {name: value for name, value in locals().items() if value is not None and name != "progress"}
    of_scene = ("scene", "fit", "material", "subsurface", "spp", "seed", "threads")
    if scene is not None:
        for name in keys:
            if name not in ("photo", "region", "linear", *of_scene):
                raise ValueError(f"{name} cannot be used with scene")
        measurement = Measurement(_translucid._measure_scene(keys, progress))
    else:
        for name in of_scene:
            if name in keys:
                raise ValueError(f"{name} needs a scene")
        measurement = Measurement(_translucid._measure(keys))
    for warning in measurement.warnings:
        warnings.warn(warning, stacklevel=2)
    return measurement
