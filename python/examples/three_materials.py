"""Render a mesh in three materials, and show how far apart they are.

A bust-sized knot of wax, marble and plaster under one light: the same mesh from arrays, the same colors of its surface,
but light that travels 8 mm, 1.5 mm and not at all below it.

    python three_materials.py [PICTURE.png] [--quick]
"""

import sys

import numpy as np

import translucid

MATERIALS = {"wax": 8.0, "marble": 1.5, "plaster": 0.0}  # mean free path in mm
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
            {"type": "sphere", "center": [50, 45, -70], "radius": 18, "radiance": 60},
            {"type": "rectangle", "center": [-80, 60, 90], "target": [0, 0, 0], "size": [50, 50], "radiance": 2.5},
        ],
        film={"tone_mapping": "agx"},
    )
    scene.add_material("knot", specular_roughness=0.35, subsurface_color=COLOR, base_color=COLOR, subsurface_weight=1)
    vertices, triangles, normals = knot()
    scene.add_mesh("knot", vertices, triangles, normals=normals, material="knot")
    return scene


def main(path="three_materials.png", size=360, samples=96):
    """Render the pictures, write them side by side and print their differences."""
    session = translucid.Session(scene(), size=(size, size))
    pictures = {}
    for name, mean_free_path in MATERIALS.items():
        model = "normalized-diffusion-oblique" if mean_free_path else "none"
        session.edit_material("knot", subsurface_radius=mean_free_path or 1, subsurface_model=model)
        session.run(samples)
        pictures[name] = session.picture()
    plaster = pictures["plaster"]["radiance"]
    row, differences = [], []
    for name, picture in pictures.items():
        row.append(picture.tonemap()[..., :3])
        difference = (picture["radiance"] - plaster).mean(axis=2)
        share = np.abs(difference).mean() / plaster.mean()
        print(f"{name:8} mean radiance {picture['radiance'].mean():.4f}, {share:6.1%} of the light elsewhere than plaster's")
        # Where there is more light than on plaster is red, where there is less blue.
        tint = np.clip(difference / 0.5, -1, 1)[..., None]
        differences.append((255 * (1 - np.abs(tint) * np.where(tint > 0, [0.1, 0.8, 0.9], [0.9, 0.6, 0.1]))).astype(np.uint8))
    sheet = np.concatenate([np.concatenate(row, axis=1), np.concatenate(differences, axis=1)])
    write_png(path, sheet)
    print(f"wrote {path}: above {', '.join(pictures)}, below their differences from plaster")


def write_png(path, codes):
    """Write sRGB codes of 8 bits by matplotlib."""
    import matplotlib.image

    matplotlib.image.imsave(path, codes)


if __name__ == "__main__":
    arguments = [word for word in sys.argv[1:] if word != "--quick"]
    quick = {"size": 60, "samples": 4} if "--quick" in sys.argv else {}
    main(*arguments, **quick)
