"""Examples run, and print what the guide says."""

import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
GUIDE = (ROOT / "docs/guide/python.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["profile_against_truth", "fit_measured"])
def test_example_prints_what_the_guide_says(name, tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "picture.png"
    words = [sys.executable, ROOT / f"python/examples/{name}.py", picture]
    done = subprocess.run(words, capture_output=True, text=True, check=True, env={"MPLBACKEND": "Agg"})
    assert done.stdout in GUIDE
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_blocks_of_the_guide_run(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    names = {}
    # Pictures have tests of their own, and take longer
    numbers = GUIDE[: GUIDE.index("## Pictures")]
    for block in re.findall(r"```python\n(.*?)```", numbers, re.DOTALL):
        exec(block, names)
    assert names["conversion"]["cycles-burley"]["subsurface_scale"] > 0


def test_materials_differ_by_how_far_light_travels(tmp_path):
    pytest.importorskip("matplotlib")
    words = [sys.executable, ROOT / "python/examples/three_materials.py", tmp_path / "sheet.png", "--quick"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    wax, marble = (float(share) for share in re.findall(r"against plaster: mean difference (.*)%", done.stdout))
    assert wax > 1.5 * marble > 0
    assert (tmp_path / "sheet.png").read_bytes().startswith(b"\x89PNG")
