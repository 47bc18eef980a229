"""Docstrings: every public name has one in NumPy's style, and their examples hold."""

import doctest
import inspect

import numpy as np
import pytest

import translucid
from translucid import _conversion, _cryptomatte, _plot, _presets, _render, _translucid, reference

PUBLIC = [translucid, reference]
try:
    import translucid.ray

    PUBLIC.append(translucid.ray)
except ImportError:  # Ray comes apart
    pass
MODULES = [*PUBLIC, _conversion, _cryptomatte, _plot, _presets, _render]


def public():
    """Public functions, classes and their methods and properties, by name."""
    for module in PUBLIC:
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.ismodule(thing) or not (callable(thing)):
                continue
            yield f"{module.__name__}.{name}", thing
            if inspect.isclass(thing) and thing.__module__.startswith("translucid"):
                for part, member in vars(thing).items():
                    if not part.startswith("_"):
                        yield f"{module.__name__}.{name}.{part}", member


def test_everything_public_is_documented():
    for name, thing in public():
        text = inspect.getdoc(thing)
        assert text and text[0].isupper() or text.startswith(("dict", "(")), name
        is_function = callable(thing) and not inspect.isclass(thing)
        if is_function and inspect.signature(thing).parameters.keys() - {"self", "cls"}:
            assert "Parameters" in text, name
        if is_function and len(text.splitlines()) >= 8:
            assert "Returns\n-------" in text or "Raises" in text, name


def examples():
    finder = doctest.DocTestFinder(exclude_empty=True)
    names = {"np": np, "translucid": translucid}
    for module in MODULES:
        yield from finder.find(module, extraglobs=names)
    for name, thing in public():
        if not inspect.ismodule(thing):
            text = inspect.getdoc(thing) or ""
            if ">>>" in text and not inspect.isfunction(thing):
                yield doctest.DocTestParser().get_doctest(text, dict(names), name, None, 0)


@pytest.mark.parametrize("test", list({test.name: test for test in examples() if test.examples}.values()), ids=lambda test: test.name)
def test_examples_hold(test):
    result = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS).run(test)
    assert result.failed == 0


def test_signatures_can_be_read():
    assert str(inspect.signature(translucid.Profile.eval)) == "(self, /, r, *, out=None)"
    assert "surface_albedo" in inspect.signature(translucid.Profile).parameters
    assert "photons" in inspect.signature(_translucid.walk).parameters
