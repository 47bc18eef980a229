"""The examples in docstrings and pages run and print what they say."""

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import pytest
import translucid

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["README.md", "docs/guide/python.md"]
MODULES = ["translucid"] + [
    f"translucid.{module.name}" for module in pkgutil.iter_modules(translucid.__path__) if module.name != "__main__"
]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    module = importlib.import_module(name)
    # What is compiled says that it is from the package, which makes doctest skip it where it is defined
    finder = doctest.DocTestFinder(exclude_empty=True)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    found = {test.name: test for test in finder.find(module, module=False)}
    for test in found.values():
        runner.run(test)
    assert runner.failures == 0


@pytest.mark.parametrize("page", PAGES)
def test_pages(page, tmp_path, monkeypatch):
    """Each block goes on where the one before it on the page has ended."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    names = {"__name__": "page"}
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), flags=re.M | re.S)
    assert blocks, f"{page} has no Python"
    for block in blocks:
        exec(compile(block, page, "exec"), names)
