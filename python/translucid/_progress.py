"""Progress of long calls: a callback, a bar by tqdm, or a line of text."""

import contextlib
import sys


@contextlib.contextmanager
def reporter(progress, description, unit):
    """Give the callback ``(done, total)`` that a ``progress`` argument asks for, or None.

    Parameters
    ----------
    progress : None, bool, 'tqdm' or callable
        Nothing, a bar (``True``: by tqdm if that is installed, else a line of text), or the caller's own.
    description, unit : str
        What goes on, and what is counted.
    """
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    elif progress is True or progress == "tqdm":
        try:
            from tqdm.auto import tqdm  # type: ignore[import-untyped]
        except ImportError:
            if progress == "tqdm":
                raise
            yield _text(description)
            return
        with tqdm(desc=description, unit=unit, unit_scale=True, leave=False) as bar:

            def report(done, total):
                bar.total = total
                bar.update(done - bar.n)

            yield report
    else:
        raise TypeError(f"progress is {progress!r}, but must be a function, True, False, None or 'tqdm'")


def _text(description):
    shown = None

    def report(done, total):
        nonlocal shown
        percent = 100 * done // max(total, 1)
        if percent != shown:
            shown = percent
            end = "\n" if done >= total else ""
            print(f"\r{description}: {percent} %", end=end, file=sys.stderr, flush=True)

    return report
