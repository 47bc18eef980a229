from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | PathLike[str]
_Unit = Literal["mm", "cm", "m"]
_Progress = bool | Literal["tqdm"] | Callable[[int, int], object] | None
_ToneMapping = Literal["neutral", "agx", "srgb"]

class SceneError(ValueError):
    message: str
    path: str | None
    line: int | None
    part: str | None
    help: str | None

class Scene:
    def __new__(
        cls,
        unit: _Unit = "mm",
        *,
        camera: dict[str, Any] | None = None,
        environment: dict[str, Any] | None = None,
        film: dict[str, Any] | None = None,
        integrator: dict[str, Any] | None = None,
        lights: Iterable[dict[str, Any]] | None = None,
        subsurface_grouping: Literal["object", "material"] | None = None,
    ) -> Scene: ...
    @classmethod
    def load(
        cls,
        path: _Path,
        *,
        preset: str | None = None,
        unit: _Unit | None = None,
        size: Sequence[int] | None = None,
        subsurface: str | None = None,
    ) -> Scene: ...
    def add_material(self, name: str, **keys: Any) -> None: ...
    def add_mesh(
        self,
        name: str,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        **keys: Any,
    ) -> None: ...
    def add_object(self, name: str | None = None, **keys: Any) -> None: ...
    def add_light(
        self,
        type: Literal["rectangle", "sphere", "distant", "spot", "point", "beam"] | None = None,
        **keys: Any,
    ) -> None: ...
    def set_environment(self, **keys: Any) -> None: ...
    def set_camera(self, **keys: Any) -> None: ...
    def set_film(self, **keys: Any) -> None: ...
    def set_integrator(self, **keys: Any) -> None: ...
    @property
    def unit(self) -> _Unit: ...
    @property
    def objects(self) -> list[str]: ...
    @property
    def materials(self) -> list[str]: ...
    @property
    def size(self) -> tuple[int, int]: ...

class Session:
    def __new__(
        cls,
        scene: Scene | _Path,
        *,
        size: Sequence[int] | None = None,
        subsurface: str | None = None,
        seed: int | None = None,
        threads: int | None = None,
        region: Sequence[int] | None = None,
    ) -> Session: ...
    def run(self, samples: int | None = None, *, progress: _Progress = None) -> None: ...
    def step(self, samples: int = 1, *, progress: _Progress = None) -> None: ...
    def start(self, samples: int | None = None) -> None: ...
    def wait(self, *, progress: _Progress = None) -> None: ...
    def cancel(self) -> None: ...
    def snapshot(self, layer: str = "radiance") -> NDArray[np.float32]: ...
    def picture(self, layers: Iterable[str] = ("radiance", "alpha")) -> Picture: ...
    def edit_material(self, name: str, **keys: Any) -> None: ...
    def edit_mesh(
        self,
        name: str,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
    ) -> None: ...
    def set_camera(self, **keys: Any) -> None: ...
    def set_lights(self, lights: Iterable[dict[str, Any]]) -> None: ...
    def set_environment(self, **keys: Any) -> None: ...
    def set_integrator(self, **keys: Any) -> None: ...
    @property
    def samples(self) -> int: ...
    @property
    def is_running(self) -> bool: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def seconds(self) -> float: ...
    def _repr_png_(self) -> bytes | None: ...

class Picture(dict[str, NDArray[np.float32]]):
    exposure: float
    tone_mapping: str
    def __init__(
        self,
        layers: Mapping[str, NDArray[np.float32]] | Iterable[tuple[str, NDArray[np.float32]]] = (),
        *,
        exposure: float = 0.0,
        tone_mapping: str = "neutral",
    ) -> None: ...
    def tonemap(self, **arguments: Any) -> NDArray[Any]: ...
    def save(self, path: _Path) -> None: ...
    def _repr_png_(self) -> bytes | None: ...

def render(
    scene: Scene | _Path,
    *,
    size: Sequence[int] | None = None,
    spp: int | None = None,
    subsurface: str | None = None,
    seed: int | None = None,
    threads: int | None = None,
    region: Sequence[int] | None = None,
    layers: Iterable[str] = ("radiance", "alpha"),
    progress: _Progress = None,
) -> Picture: ...
def tonemap(
    array: ArrayLike,
    *,
    exposure: float = 0.0,
    tone_mapping: _ToneMapping = "neutral",
    dtype: Literal["uint8", "float32"] = "uint8",
) -> NDArray[Any]: ...
def write_exr(
    path: _Path,
    picture: ArrayLike | Mapping[str, ArrayLike],
    *,
    half: Sequence[str] | None = None,
) -> None: ...
def read_exr(path: _Path) -> dict[str, NDArray[np.float32]]: ...
