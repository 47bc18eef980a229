"""Pictures and tables of photons by many machines, through Ray.

`render` and `reference` divide their work into many small tasks, which whatever machine is free takes next. A task whose
machine dies is done again by another one. The result has the bits of one run: of `translucid render` or `reference.walk`
on one machine, whatever the machines, their threads, and their fate.

Ray is not installed along with this module: ``pip install ray``.

>>> import translucid.ray
>>> translucid.ray.render("head.toml", "head.exr", spp=1024)  # doctest: +SKIP
"""

import hashlib
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import ray

from . import _translucid, reference as _reference
from ._progress import reporter
from ._render import Session

__all__ = ["reference", "render"]

_TASKS = 64
"""Tasks that work is divided into by default, at least: the last of them is what all others wait for."""

_PATIENCE = 5
"""Seconds that a task may take besides four times the longest so far, before it is begun again elsewhere."""


class _Files:
    """The files of a scene: sent to a machine once, however many tasks need them."""

    def __init__(self, scene):
        paths = [Path(path).resolve() for path in _translucid.Scene._files(scene)]
        root = Path(os.path.commonpath([path.parent for path in paths]))
        self.scene = str(Path(scene).resolve().relative_to(root))
        stored = {}
        digest = hashlib.sha256()
        self.contents = {}
        for path in sorted(paths):
            content = path.read_bytes()
            key = hashlib.sha256(content).hexdigest()
            name = str(path.relative_to(root))
            digest.update(f"{name} {key}\n".encode())
            if key not in stored:
                stored[key] = ray.put(content)
            self.contents[name] = stored[key]
        self.key = digest.hexdigest()

    def lay_out(self):
        """Write them into a folder of this machine, unless they are there, and return the path of the scene."""
        folder = Path(tempfile.gettempdir()) / f"translucid-{self.key[:32]}"
        if not folder.exists():
            draft = Path(tempfile.mkdtemp(prefix="translucid-"))
            for name, content in self.contents.items():
                path = draft / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(ray.get(content))
            try:
                draft.rename(folder)
            except OSError:  # Another process was sooner
                shutil.rmtree(draft)
        return folder / self.scene


_sessions = {}
"""The session that this process renders with, by what it was made of."""


def _shard(samples, files, options, notes, threads):
    """Render samples and return the bytes of the shard."""
    key = (files.key, repr(sorted(options.items())), threads)
    session = _sessions.get(key)
    if session is None:
        _sessions.clear()  # A worker has memory for one scene
        session = _sessions[key] = Session(files.lay_out(), threads=threads, **options)
    session.set_region(options["region"])  # The film begins anew
    session.run(samples)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.shard"
        session.save(path, **notes)
        return path.read_bytes()


def _table(photons, arguments, threads):
    return _reference.walk(photons, threads=threads, **arguments)


def _parts(count, size):
    return [range(start, min(start + size, count)) for start in range(0, count, size)]


def _collect(task, arguments, parts, threads, retries, report, take):
    """Run a task for each part, as many at a time as the cluster has room for, and have `take` take each result.

    A task that takes much longer than all others is begun again elsewhere, and the first result counts: its machine is slow,
    or cannot be reached, which Ray is sure of only after minutes.
    """
    remote = ray.remote(num_cpus=threads, max_retries=retries)(task)
    waiting = list(reversed(parts))
    running = {}  # part and time of the beginning of each task
    late = set()
    finished = set()
    total, done, longest = sum(map(len, parts)), 0, None
    try:
        while len(finished) < len(parts):
            # Twice what fits, so that nobody waits for this process; not all, or a million would be queued
            slots = max(1, int(ray.cluster_resources().get("CPU", 1) // threads))
            while waiting and len(running) - len(late) < 2 * slots:
                part = waiting.pop()
                if part not in finished:
                    running[remote.remote(part, *arguments)] = part, time.monotonic()
            ready, _ = ray.wait(list(running), timeout=0.5)
            for reference in ready:
                part, start = running.pop(reference)
                late.discard(reference)
                if part not in finished:
                    take(part, ray.get(reference))
                    finished.add(part)
                    done += len(part)
                    longest = max(longest or 0, time.monotonic() - start)
            for reference, (part, start) in running.items():
                is_late = longest is not None and time.monotonic() - start > _PATIENCE + 4 * longest
                if is_late and reference not in late:
                    late.add(reference)
                    waiting.append(part)
            if report is not None:
                report(done, total)
    finally:
        for reference in running:
            ray.cancel(reference, force=True)


def render(
    scene,
    output,
    *,
    size=None,
    spp=None,
    subsurface=None,
    seed=None,
    region=None,
    threads=1,
    task_samples=None,
    parts=None,
    retries=-1,
    progress=None,
):
    """Render a scene on the machines of a Ray cluster.

    Ray is started here, on this machine alone, unless `ray.init` was called. The files of the scene are sent to each machine
    once. Ctrl-C cancels the tasks.

    Parameters
    ----------
    scene : path-like
        A scene file or mesh. The files that it names must be reachable by relative paths.
    output : path-like
        Picture to write, ``.exr`` or ``.png``, or ``.shard``.
    size, spp, subsurface, seed, region
        As of `translucid.render`.
    threads : int, default 1
        Threads of a task, which takes as many of Ray's CPUs.
    task_samples : int, optional
        Samples of all pixels that a task renders. By default so few that there are 64 tasks or more, if there are as many
        samples. Each brings a file of 168 bytes a pixel.
    parts : path-like, optional
        Directory that keeps the shards of finished tasks, which another call goes on from. By default they are deleted with
        the end of the call.
    retries : int, default -1
        How often a task whose machine dies is done again; -1 for any number.
    progress : bool, 'tqdm' or callable, optional
        Called now and then with the number of samples per pixel that are done and that there are in all; ``True`` and
        ``'tqdm'`` show a bar.

    Raises
    ------
    SceneError
        The scene is wrong.
    ValueError
        An argument is wrong, or the shards in `parts` are of another scene or other settings.

    Examples
    --------
    >>> translucid.ray.render("head.toml", "head.exr", spp=256, threads=8, progress=True)  # doctest: +SKIP
    """
    output = Path(output)
    if output.suffix.lower() not in (".exr", ".png", ".shard"):
        raise ValueError(f"output is {str(output)!r}, but must end in .exr, .png or .shard")
    _require_whole("threads", threads, 1, 1024)
    options = {"size": size, "subsurface": subsurface, "seed": seed, "region": region}
    # A wrong scene or option is said before anything is sent
    first = Session(scene, threads=1, **options)
    spp = first._samples_per_pixel if spp is None else spp
    _require_whole("spp", spp, 1, 2**24)
    if task_samples is None:
        task_samples = max(1, spp // _TASKS)
    _require_whole("task_samples", task_samples, 1, 2**24)
    del first
    _start()
    files = ray.put(_Files(scene))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder if parts is None else parts)
        folder.mkdir(parents=True, exist_ok=True)

        def path(part):
            return folder / f"{part.start:08}-{part.stop:08}.shard"

        def take(part, content):
            draft = path(part).with_suffix(".part")
            draft.write_bytes(content)
            draft.replace(path(part))

        all_parts = _parts(spp, task_samples)
        missing = [part for part in all_parts if not path(part).exists()]
        with reporter(progress, "rendering", "sample") as report:
            notes = {"scene": str(scene), "samples_per_pixel": spp}
            _collect(_shard, (files, options, notes, threads), missing, threads, retries, report, take)
        # A process of its own: the command takes Ctrl-C for itself
        words = [sys.executable, "-m", "translucid", "merge", "-q", output, *map(path, all_parts)]
        merging = subprocess.run(words, capture_output=True, text=True)
        if merging.returncode != 0:
            raise ValueError(f"the shards in {str(folder)!r} cannot be merged: {merging.stderr}")


def reference(photons, *, threads=1, task_photons=None, retries=-1, progress=None, **arguments):
    """Walk photons on the machines of a Ray cluster.

    Parameters
    ----------
    photons : int
        How many.
    threads : int, default 1
        Threads of a task, which takes as many of Ray's CPUs.
    task_photons : int, optional
        Photons of a task. By default so few that there are 64 tasks, and a million or more.
    retries, progress
        As of `render`; progress is of photons.
    **arguments
        As of `translucid.reference.walk`.

    Returns
    -------
    WhiteTable
        That of `translucid.reference.walk` with the same arguments, bit for bit.

    Examples
    --------
    >>> table = translucid.ray.reference(10**12, radii=[1.0], surface_albedo=0.5)  # doctest: +SKIP
    """
    _require_whole("threads", threads, 1, 1024)
    _require_whole("photons", photons, 1, 2**63 - 1)
    if task_photons is None:
        task_photons = max(10**6, math.ceil(photons / _TASKS))
    _require_whole("task_photons", task_photons, 1, 2**63 - 1)
    # Wrong arguments are said here, and an empty table is where all begins
    table = _reference.walk(0, threads=1, **arguments)
    _start()

    def take(_, part):
        nonlocal table
        table = table + part

    with reporter(progress, "walk", "photons") as report:
        parts = _parts(photons, task_photons)
        _collect(_table, (arguments, threads), parts, threads, retries, report, take)
    return table


def _start():
    if not ray.is_initialized():
        ray.init(include_dashboard=False, log_to_driver=False)


def _require_whole(name, value, least, most):
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"{name} is {value!r}, but must be a whole number")
    if not least <= value <= most:
        raise ValueError(f"{name} is {value}, but must be in [{least}, {most}]")
