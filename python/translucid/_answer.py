"""Answers of the desk."""

from __future__ import annotations

import os
import warnings
from typing import Any

from . import _translucid


class Answer(dict):
    """An answer: columns of its table by their names, numbers as arrays and words as lists.

    A notebook shows its picture, if there is one.

    Attributes
    ----------
    text : str or None
        The answer for people, numbers rounded.
    files : dict of str to bytes
        Files by their names: pictures, for example.
    notes : list of str
        Remarks on the answer. Reasons to doubt it are `UserWarning`s.
    """

    text: str | None
    files: dict[str, bytes]
    notes: list[str]

    def __init__(self, found: dict[str, Any]) -> None:
        super().__init__(found["columns"])
        self.text, self.files, self.notes = found["text"], found["files"], found["notes"]

    def _repr_svg_(self) -> str | None:
        return next((data.decode() for name, data in self.files.items() if name.endswith(".svg")), None)


def answer(question: str, arguments: dict[str, Any]) -> Answer:
    """Asks a question: arguments that are None, and flags that are False, are not said."""
    threads, progress = arguments.pop("threads"), arguments.pop("progress")
    said = {
        name: os.fspath(value) if isinstance(value, os.PathLike) else value
        for name, value in arguments.items()
        if value is not None and value is not False
    }
    found = _translucid._ask(question, said, threads, progress)
    for warning in found["warnings"]:
        warnings.warn(warning, stacklevel=3)
    return Answer(found)
