"""Render a mesh in three materials, and show how far apart they are.

A knot the size of a fist, of wax, marble and plaster under one light: the same mesh from arrays, the same color of its
surface, but light with a mean free path of 2 mm, 0.4 mm and none below it.

    python three_materials.py [PICTURE.png] [--quick]
"""

import sys

import matplotlib.image
import numpy as np

import translucid

MATERIALS = {"wax": 2.0, "marble": 0.4, "plaster": 0.0}  # mean free path in mm
COLOR = [0.88, 0.78, 0.66]


def knot(turns=320, sides=48, radius=22.0, thickness=8.5):
    """Vertices, triangles and normals of a trefoil knot around the z axis, in mm."""
    t = np.linspace(0, 2 * np.pi, turns, endpoint=False)
    center = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)
    center *= radius / 3
    along = np.roll(center, -1, axis=0) - np.roll(center, 1, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, along)
    a = np.linspace(0, 2 * np.pi, sides, endpoint=False)[:, None]
    normals = np.cos(a) * side[:, None] + np.sin(a) * up[:, None]
    vertices = (center[:, None] + thickness * normals).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(turns), np.arange(sides), indexing="ij")
    corner = lambda di, dj: ((i + di) % turns * sides + (j + dj) % sides).ravel()  # noqa: E731
    quad = [corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)]
    triangles = np.concatenate([np.stack([quad[0], quad[1], quad[2]], 1), np.stack([quad[0], quad[2], quad[3]], 1)])
    return vertices, triangles, normals.reshape(-1, 3)


def scene():
    """The knot before a dark wall, lit from behind."""
    scene = translucid.Scene(
        unit="mm",
        camera={"position": [0, 0, 150], "target": [0, 0, 0], "fov": 30},
        environment={"radiance": 0.06},
        lights=[
            {"type": "sphere", "center": [50, 45, -70], "radius": 18, "radiance": 60, "visible": False},
            {"type": "rectangle", "center": [-80, 60, 90], "target": [0, 0, 0], "size": [50, 50], "radiance": 2.5, "visible": False},
        ],
        film={"exposure": 1},
    )
    scene.add_material(
        "knot",
        base_color=COLOR,
        specular_roughness=0.35,
        subsurface_weight=1,
        subsurface_color=COLOR,
        subsurface_radius_scale=[1, 0.8, 0.6],
    )
    vertices, triangles, normals = knot()
    scene.add_mesh("knot", vertices, triangles, normals=normals, material="knot")
    return scene


def main(path="three_materials.png", size=240, samples=192):
    """Render the pictures, write them side by side and print their differences."""
    session = translucid.Session(scene(), size=(size, size))
    pictures = {}
    for name, mean_free_path in MATERIALS.items():
        model = "normalized-diffusion-oblique" if mean_free_path else "none"
        session.edit_material("knot", subsurface_radius=mean_free_path or 1, subsurface_model=model)
        session.run(samples)
        pictures[name] = session.picture(["radiance"])
    colors = [picture.tonemap() for picture in pictures.values()]
    pairs = [("wax", "plaster"), ("marble", "plaster"), ("wax", "marble")]
    differences = [tinted(pictures[one]["radiance"] - pictures[other]["radiance"]) for one, other in pairs]
    sheet = np.concatenate([np.concatenate(colors, axis=1), np.concatenate(differences, axis=1)])
    matplotlib.image.imsave(path, sheet)
    for one, other in pairs:
        light, reference = (pictures[name]["radiance"].astype(float) for name in (one, other))
        print(f"{one} against {other}: mean difference {np.abs(light - reference).mean() / reference.mean():.1%}")
    print(f"wrote {path}: above {', '.join(pictures)}, below {', '.join(f'{one} - {other}' for one, other in pairs)}")


def tinted(difference):
    """Codes of a difference of radiance: red where there is more light, blue where there is less."""
    share = np.clip(difference.mean(axis=2, keepdims=True) / 0.15, -1, 1)
    lost = np.where(share > 0, [0.1, 0.8, 0.9], [0.9, 0.6, 0.1])
    return (255 * (1 - np.abs(share) * lost)).astype(np.uint8)


if __name__ == "__main__":
    arguments = [word for word in sys.argv[1:] if word != "--quick"]
    quick = {"size": 60, "samples": 4} if "--quick" in sys.argv else {}
    main(*arguments, **quick)
