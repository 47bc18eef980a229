"""The Python on the pages runs."""

import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def mesh():
    """Arrays that a page calls by their names: a square of two triangles, and an image."""
    corners = np.array([[-10.0, -10, 0], [10, -10, 0], [10, 10, 0], [-10, 10, 0]])
    return {
        "vertices": corners,
        "triangles": np.array([[0, 1, 2], [0, 2, 3]]),
        "normals": np.tile([0.0, 0, 1], (4, 1)),
        "uv": corners[:, :2] / 20 + 0.5,
        "roughness_map": np.full((4, 4), 0.3, np.float32),
    }


@pytest.mark.parametrize("page", ["README.md", "python/README.md", "docs/guide/python.md"])
def test_pages(page, tmp_path, monkeypatch):
    """Each block goes on where the one before it on the page has ended."""
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    names = {"__name__": "page", **mesh()}
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), flags=re.M | re.S)
    assert blocks, f"{page} has no Python"
    for block in blocks:
        exec(compile(block, page, "exec"), names)
