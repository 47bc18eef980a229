"""Blender as a worker of artists.py: reads one JSON command a line, answers one JSON line.

    {"do": "build", "scene": "head", "file": "head.blend"}      answers {"made": true}, or what is missing
    {"do": "export", "file": "head.blend", "size": 384, "folder": "head"}      writes the files of the command translucid
    {"do": "render", "file": "head.blend", "engine": "CYCLES", "size": 384, "spp": 8, "seed": 1, "out": "a.npy"}
                                        answers {"cpu": seconds, "said": messages of the extension}

Images are float32 arrays of rows from the top, RGBA. Needs the packages bpy and translucid.
"""

import json
import os
import sys
from pathlib import Path

# Blender prints to stdout: keep that free for answers.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)

sys.path.append(str(Path(__file__).resolve().parents[2] / "blender" / "tests"))

import artists_files  # noqa: E402
import artists_scenes  # noqa: E402
import bpy  # noqa: E402
import numpy as np  # noqa: E402
from harness import combined, messages, new_scene, render_cycles  # noqa: E402

ASSETS = Path(os.environ.get("TRANSLUCID_ASSETS", ""))


class Clock:
    """CPU time of this process between the beginning and the end of a rendering, without writing its file."""

    def __init__(self):
        self.seconds = 0.0
        for handlers, sign in ((bpy.app.handlers.render_pre, -1), (bpy.app.handlers.render_post, 1)):
            handlers.clear()
            handlers.append(lambda *_, sign=sign: self._add(sign))

    def _add(self, sign):
        times = os.times()
        self.seconds += sign * (times.user + times.system)


def denoised():
    """What Cycles renders, by Open Image Denoise with Blender's own settings."""
    bpy.context.scene.cycles.use_denoising = True
    return combined()


class Worker:
    """Keeps the last file open, so that only rendering is timed."""

    def __init__(self):
        self.opened = None

    def build(self, command):
        missing = []

        def asset(name):
            path = ASSETS / name
            if os.environ.get("TRANSLUCID_ASSETS") and path.is_file():
                return str(path)
            missing.append(name)

        self.opened = None
        scene = new_scene(transparent=True)
        made = artists_scenes.SCENES[command["scene"]](asset) is not False
        scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
        bpy.ops.wm.save_as_mainfile(filepath=command["file"])
        return {"made": made, "missing": missing, "version": bpy.app.version_string}

    def open(self, command):
        if self.opened != command["file"]:
            bpy.ops.wm.open_mainfile(filepath=command["file"])
            self.opened = command["file"]
        scene = bpy.context.scene
        scene.render.resolution_x = scene.render.resolution_y = command["size"]
        return scene.translucid

    def export(self, command):
        self.open(command)
        return {"said": artists_files.write(Path(command["folder"]))}

    def render(self, command):
        ours = self.open(command)
        ours.samples, ours.seed = command["spp"], command["seed"]
        for name, value in command.get("settings", {}).items():
            setattr(ours, name, value)
        clock = Clock()
        if command["engine"] == "CYCLES":
            take = denoised if ours.use_denoising else combined
            image, said = render_cycles(command["spp"], command["seed"], take), []
        else:
            image, said = combined(), messages()
        np.save(command["out"], image)
        return {"cpu": clock.seconds, "said": said}


def main():
    worker = Worker()
    for line in sys.stdin:
        command = json.loads(line)
        answer = {"build": worker.build, "export": worker.export, "render": worker.render}[command["do"]](command)
        print(json.dumps(answer), file=answers, flush=True)


main()
