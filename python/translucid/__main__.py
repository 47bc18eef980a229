"""The command ``translucid``: also ``python -m translucid``."""

import signal
import sys

from . import _translucid


def main():
    """Run the command with the arguments of this process and return its exit code."""
    # Python would note Ctrl-C and wait for the command to end; the command knows better what to do.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _translucid.command(["translucid", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
