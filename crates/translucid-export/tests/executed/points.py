"""The points of `examples/points.rs`, and the verdict on what a program makes of them."""

import json
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

DIRECTORY = Path(os.environ["TRANSLUCID_EXPORT_POINTS"])
CONFIGURATIONS = ["diffuse", "searchlight"]


@dataclass
class Function:
    """A function of the exported texts, and what double precision says of it."""

    configuration: str
    name: str
    arguments: list[str]
    outputs: list[str]
    errors: dict[str, float]
    calls: dict[str, str]

    def rows(self, kind, dtype, count):
        path = DIRECTORY / self.configuration / f"{self.name}.{kind}"
        return np.fromfile(path, dtype).reshape(-1, count)

    @property
    def inputs(self):
        """A row of arguments for each call."""
        return self.rows("arguments", np.float32, len(self.arguments))

    def worst(self, results):
        """The largest relative error of the results; infinite where one is no finite number."""
        results = np.asarray(results, np.float64).reshape(-1, len(self.outputs))
        least, greatest, floor = (self.rows(kind, np.float64, len(self.outputs)) for kind in ("least", "greatest", "floor"))
        assert results.shape == least.shape
        if not np.isfinite(results).all():
            self.worst_at = int((~np.isfinite(results)).any(axis=1).argmax())
            return np.inf
        off = np.maximum(np.maximum(least - results, results - greatest), 0.0)
        size = np.maximum(np.abs(least), np.abs(greatest))
        beyond = np.maximum(off - floor, 0.0)
        relative = np.divide(beyond, size, out=np.where(beyond > 0.0, np.inf, 0.0), where=size > 0.0)
        self.worst_at = int(relative.max(axis=1).argmax())
        return relative.max()

    def fault(self, results, where, language):
        """What is wrong with the results: nothing within the error that the texts state."""
        worst, error = self.worst(results), self.errors[language]
        print(f"{where:<16} {self.configuration:<12} {self.name:<32} {worst:.1e} of {error:.1e}")
        if worst <= error:
            return []
        i = self.worst_at
        shown = np.asarray(results, np.float64).reshape(-1, len(self.outputs))[i]
        return [f"{where}: {self.name}{tuple(map(float, self.inputs[i]))} = {shown}, off by {worst:.2e}, allowed {error:.1e}"]


def functions(configuration):
    """All functions of a configuration's texts."""
    entries = json.loads((DIRECTORY / configuration / "functions.json").read_text())
    return [Function(configuration, **entry) for entry in entries]


def text(configuration, language):
    """An exported text."""
    return (DIRECTORY / configuration / f"export.{language}").read_text()
