# SPDX-License-Identifier: GPL-3.0-or-later
"""Work of the renderer on a thread of its own, so that Blender's can look whether the user wants it."""

import threading
import warnings


class Task:
    """A call on a thread. It must not touch Blender's data."""

    def __init__(self, call):
        self._call, self._value, self._error = call, None, None
        self.warnings = []
        # A task that nobody waits for must not keep Blender from ending.
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                self._value = self._call()
            self.warnings = [str(warning.message) for warning in caught]
        except BaseException as error:
            self._error = error

    @property
    def is_done(self):
        return not self._thread.is_alive()

    def wait(self, seconds):
        """Whether it is done, after at most so many seconds."""
        self._thread.join(seconds)
        return self.is_done

    def result(self):
        """What the call returned, or its exception."""
        if self._error is not None:
            raise self._error
        return self._value
