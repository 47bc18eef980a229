# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a scene is rendered as something else, in words, each thing once."""


class Report:
    """Messages in the order in which they came up.

    `where` is a material, an object or a light, `what` its part, if there is one.
    """

    def __init__(self):
        self._messages, self._said = {}, set()

    def add(self, where, what, text):
        place = f"{where}: {what}" if what else where
        self._messages[f"{place}: {text}" if place else text] = None

    def unsaid(self):
        """The messages since the last call."""
        new = [message for message in self._messages if message not in self._said]
        self._said.update(new)
        return new

    @property
    def messages(self):
        return list(self._messages)
