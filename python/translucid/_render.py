"""Pictures of scenes."""

import numpy as np

from . import _translucid
from ._progress import reporter


class Picture(dict):
    """Layers of a picture by their names, which shows itself in a notebook.

    Every layer is an array of shape (height, width, channels), float32; see `Session.snapshot`.

    Attributes
    ----------
    exposure : float
        Exposure in stops with which it is shown.
    tone_mapping : str
        Tone mapping with which it is shown, see `tonemap`.
    """

    def __init__(self, layers=(), *, exposure=0.0, tone_mapping="neutral"):
        super().__init__(layers)
        self.exposure = exposure
        self.tone_mapping = tone_mapping

    def _colors(self):
        color = self["denoised"] if "denoised" in self else self["radiance"]
        return np.concatenate([color, self["alpha"]], axis=2) if "alpha" in self else color

    def tonemap(self, **arguments):
        """Return what a display shows of it: `tonemap` of its radiance and coverage.

        Parameters
        ----------
        **arguments
            As of the function, in place of the picture's own.

        Returns
        -------
        numpy.ndarray
        """
        settings = {"exposure": self.exposure, "tone_mapping": self.tone_mapping} | arguments
        return _translucid.tonemap(self._colors(), **settings)

    def _repr_png_(self):
        if "radiance" not in self and "denoised" not in self:
            return None
        return _translucid.png_bytes(self._colors(), exposure=self.exposure, tone_mapping=self.tone_mapping)

    def save(self, path):
        """Write it: all layers to a ``.exr`` file, what a display shows to a ``.png`` file.

        Parameters
        ----------
        path : path-like
            The file.

        Raises
        ------
        ValueError
            The path ends in neither.
        OSError
            The file cannot be written.
        """
        text = str(path)
        if text.endswith(".exr"):
            _translucid.write_exr(path, self)
        elif text.endswith(".png"):
            png = self._repr_png_()
            if png is None:
                raise ValueError("a .png shows the layer radiance or denoised, but the picture has neither")
            with open(path, "wb") as file:
                file.write(png)
        else:
            raise ValueError(f"path is {text!r}, but must end in .exr or .png")

    def __repr__(self):
        layers = ", ".join(f"{name} {array.shape}" for name, array in self.items())
        return f"<translucid.Picture: {layers}>"


class Session(_translucid.Session):
    __doc__ = _translucid.Session.__doc__

    def run(self, samples=None, *, progress=None):
        with reporter(progress, "rendering", "path") as report:
            super().run(samples, progress=report)

    def step(self, samples=1, *, progress=None):
        with reporter(progress, "rendering", "path") as report:
            super().step(samples, progress=report)

    def wait(self, *, progress=None):
        with reporter(progress, "rendering", "path") as report:
            super().wait(progress=report)

    run.__doc__ = _translucid.Session.run.__doc__
    step.__doc__ = _translucid.Session.step.__doc__
    wait.__doc__ = _translucid.Session.wait.__doc__

    def picture(self, layers=("radiance", "alpha")):
        """Take several layers at once.

        Parameters
        ----------
        layers : list of str
            As in `snapshot`.

        Returns
        -------
        Picture
        """
        if isinstance(layers, str):
            raise TypeError(f"layers is {layers!r}, but must be a list of names")
        exposure, tone_mapping = self._display
        taken = {name: self.snapshot(name) for name in layers}
        return Picture(taken, exposure=exposure, tone_mapping=tone_mapping)

    def cryptomatte(self, kind="object", *, levels=6, names=None):
        """Find the names that each pixel shows, and the shares of it that they cover (Cryptomatte).

        What counts is the first surface that the picture's samples see, at most 256 of them, or the one behind where it is
        not opaque. What runs in the background is ended.

        Parameters
        ----------
        kind : str
            ``'object'`` or ``'material'``.
        levels : int
            Most names of a pixel, at most 64; the least of more are dropped.
        names : dict of str to str, optional
            Other names for those in the scene, whose shares are added up where several have one.

        Returns
        -------
        numpy.ndarray
            Shape (height, width, levels, 2), float32: ids (see `cryptomatte_id`) and shares, the greatest first, 0 behind
            the last. The shares add up to alpha, but for lights and a visible environment, which have no id.

        Raises
        ------
        KeyboardInterrupt
            Ctrl-C was pressed.
        RuntimeError
            The session was cancelled meanwhile.

        Examples
        --------
        >>> scene = translucid.Scene()
        >>> scene.add_object("ball", shape="sphere")
        >>> session = translucid.Session(scene, size=(32, 24))
        >>> session.run(4)
        >>> pairs = session.cryptomatte()
        >>> pairs.shape
        (24, 32, 6, 2)
        >>> matte = (pairs[..., 1] * (pairs[..., 0] == translucid.cryptomatte_id("ball"))).sum(axis=2)
        >>> float(matte[12, 16])
        1.0
        """
        return self._cryptomatte(kind, levels, dict(names or {}))

    def _repr_png_(self):
        return self.picture()._repr_png_()


def render(
    scene,
    *,
    size=None,
    spp=None,
    subsurface=None,
    seed=None,
    threads=None,
    device="cpu",
    region=None,
    layers=("radiance", "alpha"),
    progress=None,
):
    """Render a scene.

    The values are those of the command with the same scene, size and seed, bit for bit, whatever the number of threads.

    Parameters
    ----------
    scene : Scene or path-like
        A scene, or a scene file or mesh.
    size : (int, int), optional
        Width and height in pixels, each in [1, 16384]; by default the scene's.
    spp : int, optional
        Samples per pixel, in [1, 2**24]; by default the scene's.
    subsurface : str, optional
        Model of the transport under all surfaces, in place of the materials' own: the name of a profile,
        ``'random-walk'``, ``'random-walk-diffuse'``, ``'random-walk-rough'``, ``'random-walk-skin'``,
        ``'layers'`` or ``'none'``.
    seed : int, optional
        Seed of the random numbers; by default the scene's.
    threads : int, optional
        Threads to render with; by default one per processor.
    device : str, optional
        Who traces the paths: see `Session`.
    region : (int, int, int, int), optional
        Render these pixels only: from (x0, y0) at the upper left to just before (x1, y1).
    layers : list of str
        Layers to return, see `Session.snapshot`.
    progress : bool, 'tqdm' or callable, optional
        Called now and then with the numbers of paths done and in all; ``True`` and ``'tqdm'`` show a bar.

    Returns
    -------
    Picture
        A dict of arrays of shape (height, width, channels), float32.

    Raises
    ------
    SceneError
        The scene cannot be used; the message says where and why.
    ValueError, TypeError
        Another argument is not allowed.
    KeyboardInterrupt
        Ctrl-C was pressed.

    Examples
    --------
    >>> scene = translucid.Scene(environment={"radiance": 1.0})
    >>> scene.add_object("ball", shape="sphere")
    >>> picture = translucid.render(scene, size=(32, 24), spp=4)
    >>> picture["radiance"].shape
    (24, 32, 3)
    """
    names = list(layers) if not isinstance(layers, str) else [layers]
    known = [*_translucid.LAYERS, "denoised"]
    for name in names:
        if name not in known:
            raise ValueError(f"layers has {name!r}, but must be of {', '.join(known)}")
    session = Session(
        scene, size=size, subsurface=subsurface, seed=seed, threads=threads, device=device, region=region
    )
    session.run(spp, progress=progress)
    return session.picture(names)
