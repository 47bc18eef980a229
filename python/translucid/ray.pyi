from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Literal

from .reference import WhiteTable

_Path = str | PathLike[str]
_Progress = None | bool | Literal["tqdm"] | Callable[[int, int], object]

def render(
    scene: _Path,
    output: _Path,
    *,
    size: Sequence[int] | None = None,
    spp: int | None = None,
    subsurface: str | None = None,
    seed: int | None = None,
    region: Sequence[int] | None = None,
    threads: int = 1,
    task_samples: int | None = None,
    parts: _Path | None = None,
    retries: int = -1,
    progress: _Progress = None,
) -> None: ...
def reference(
    photons: int,
    *,
    threads: int = 1,
    task_photons: int | None = None,
    retries: int = -1,
    progress: _Progress = None,
    **arguments: Any,
) -> WhiteTable: ...
