#!/usr/bin/env python3
"""Runs the notebook compare.ipynb and prints what it prints; ends with 1 if a difference is more than its errors allow.

    .ci/wheel release
    python3 examples/mitsuba/run.py

The first run installs mitsuba and a kernel of Jupyter from PyPI into target/peers/notebook, every run the wheel of target/wheel.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
VENV = ROOT / "target" / "peers" / "notebook"
PACKAGES = ["mitsuba==3.9.1", "numpy", "nbclient", "ipykernel"]


def enter_environment():
    """Goes on in the virtual environment that has the packages and the module."""
    python = VENV / "bin" / "python"
    if Path(sys.prefix).resolve() == VENV.resolve():
        return
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", VENV], check=True)
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    if subprocess.run([python, "-c", "import mitsuba, nbclient, ipykernel"], capture_output=True).returncode != 0:
        print(f"installing {', '.join(PACKAGES)} into {VENV}", flush=True)
        subprocess.run([*pip, *PACKAGES], check=True)
    wheels = sorted((ROOT / "target" / "wheel").glob("translucid-*.whl"))
    if wheels:
        subprocess.run([*pip, "--force-reinstall", "--no-deps", wheels[-1]], check=True)
    elif subprocess.run([python, "-c", "import translucid"], capture_output=True).returncode != 0:
        sys.exit("error: there is no module translucid: run `.ci/wheel release` first")
    os.execv(python, [str(python), *sys.argv])


def main():
    import nbformat
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError

    notebook = nbformat.read(HERE / "compare.ipynb", as_version=4)
    begin, failure = time.monotonic(), None
    try:
        NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(HERE)}}).execute()
    except CellExecutionError as error:
        failure = f"{error.ename}: {error.evalue}"
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            print(output.get("text", ""), end="")
    print(f"{time.monotonic() - begin:.0f} s")
    if failure:
        sys.exit(f"error: {failure}")


enter_environment()
main()
