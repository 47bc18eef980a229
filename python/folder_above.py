"""Build backend of `pip install ./python`: maturin in the folder above, whose `pyproject.toml` has the package."""

import os
import pathlib

from maturin import *  # noqa: F403

os.chdir(pathlib.Path(__file__).resolve().parents[1])
