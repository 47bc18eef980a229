# SPDX-License-Identifier: GPL-3.0-or-later
class Viewport:
    def __init__(self, engine): pass
    def update(self, c, d): pass
    def draw(self, c, d): pass
    def end(self): pass
