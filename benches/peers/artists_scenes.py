"""Ten scenes of the kind that artists make, as Blender files: textures, gloss, skies and rooms around what scatters light.

Each function builds one in the empty scene at hand. `asset` finds a scan or an environment map, or None.
"""

import math
from pathlib import Path

import bpy
import numpy as np
from harness import LENGTH_PER_MFP, Nodes, add_camera, add_light, add_mesh, link, radians
from mathutils import Vector

BUST = Path(__file__).resolve().parents[2] / "scenes" / "bust.ply"


# --- materials


def picture(name, colors, space="sRGB"):
    """An image node's image of an array of shape (h, w, 3), the upper row first; kept in the file."""
    height, width, _ = colors.shape
    image = bpy.data.images.new(name, width, height, float_buffer=space == "float")
    image.colorspace_settings.name = "Non-Color" if space == "float" else space
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., :3] = colors[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def clouds(seed, height=256, width=256, roughness=0.55):
    """Noise of many scales in [0, 1] that repeats."""
    random, total, weight, cells = np.random.default_rng(seed), 0.0, 1.0, 4
    while cells <= width // 2:
        values = random.random((cells, cells))
        y, x = np.arange(height) * cells / height, np.arange(width) * cells / width
        i, j = y.astype(int), x.astype(int)
        t, s = (v * v * (3 - 2 * v) for v in ((y - i)[:, None], (x - j)[None, :]))
        at = lambda a, b: values[(i + a)[:, None] % cells, (j + b)[None, :] % cells]
        total = total + weight * ((at(0, 0) * (1 - s) + at(0, 1) * s) * (1 - t) + (at(1, 0) * (1 - s) + at(1, 1) * s) * t)
        weight, cells = weight * roughness, cells * 2
    return (total - total.min()) / (total.max() - total.min())


def between(mask, low, high):
    return np.array(low) * (1 - mask[..., None]) + np.array(high) * mask[..., None]


def normals(heights, slope):
    """The tangent-space normal map of heights."""
    dx, dy = (np.roll(heights, 1, axis) - np.roll(heights, -1, axis) for axis in (1, 0))
    normal = np.stack([dx * slope, -dy * slope, np.ones_like(heights)], axis=-1)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True) * 0.5 + 0.5


def principled(name, color, normal=None, **inputs):
    """A Principled BSDF; a color may be an image, or the name of a color attribute in brackets."""
    nodes = Nodes(name)
    if isinstance(color, bpy.types.Image):
        color = image_node(nodes, color).outputs["Color"]
    elif isinstance(color, list):
        attribute = nodes.add("VertexColor")
        attribute.layer_name = color[0]
        color = attribute.outputs["Color"]
    if normal is not None:
        inputs["Normal"] = nodes.add("NormalMap", Color=image_node(nodes, normal).outputs["Color"]).outputs["Normal"]
    node = nodes.add("BsdfPrincipled", Base_Color=color, **inputs)
    return nodes.surface(node), node


def image_node(nodes, image):
    node = nodes.add("TexImage")
    node.image = image
    return node


def scattering(name, color, mfp, g=0.0, **inputs):
    """What scatters light below its surface by a random walk of this mean free path."""
    scale = max(mfp) * LENGTH_PER_MFP["RANDOM_WALK"] / (1 - g if LENGTH_PER_MFP["RANDOM_WALK"] > 1 else 1)
    shares = [length / max(mfp) for length in mfp]
    lengths = {"Subsurface_Weight": 1.0, "Subsurface_Radius": shares, "Subsurface_Scale": scale, "Subsurface_Anisotropy": g}
    material, node = principled(name, color, **lengths, **inputs)
    node.subsurface_method = "RANDOM_WALK"
    return material


def skin(name, color, scale, **inputs):
    """Random Walk (Skin) with the radii that Blender has for it."""
    material, node = principled(name, color, Subsurface_Weight=1.0, Subsurface_Scale=scale, Subsurface_Radius=(1.0, 0.35, 0.2), **inputs)
    node.subsurface_method = "RANDOM_WALK_SKIN"
    return material


def plain(name, color, **inputs):
    return principled(name, color, **inputs)[0]


# --- shapes


def dress(owner, material, smooth=True, levels=0):
    """Gives an object its material, smooth faces and a subdivision."""
    owner.data.materials.clear()
    owner.data.materials.append(material)
    if smooth:
        owner.data.shade_smooth()
    if levels:
        modifier = owner.modifiers.new("subdivision", "SUBSURF")
        modifier.levels = modifier.render_levels = levels
    return owner


def made(operator, **options):
    operator(**options)
    return bpy.context.object


def turned(name, outline, material, segments=64, levels=1):
    """The body of revolution of an outline of (radius, height), which may begin and end on the axis."""
    vertices, faces, rings = [], [], []
    for radius, height in outline:
        count = segments if radius > 0 else 1
        rings.append(range(len(vertices), len(vertices) + count))
        angles = np.arange(count) * 2 * math.pi / segments
        vertices += [(radius * math.cos(a), radius * math.sin(a), height) for a in angles]
    for low, high in zip(rings, rings[1:]):
        for k in range(segments):
            corners = [low[k % len(low)], low[(k + 1) % len(low)], high[(k + 1) % len(high)], high[k % len(high)]]
            faces.append(tuple(dict.fromkeys(corners)))
    return dress(add_mesh(name, vertices, faces), material, levels=levels)


def wrap(owner, repeats=1.0):
    """Texture coordinates around the z axis, from the vertices' places; the seam is behind."""
    mesh = owner.data
    corners = np.array([v.co for v in mesh.vertices])
    corners = corners[np.array([loop.vertex_index for loop in mesh.loops])]
    center = (corners.max(axis=0) + corners.min(axis=0)) / 2
    extent = (corners.max(axis=0) - corners.min(axis=0)).max()
    u = np.arctan2(corners[:, 0] - center[0], -(corners[:, 1] - center[1])) / (2 * math.pi) + 0.5
    starts = np.array([polygon.loop_start for polygon in mesh.polygons])
    counts = np.array([polygon.loop_total for polygon in mesh.polygons])
    # Faces across the seam go on beyond it
    first = np.repeat(u[starts], counts)
    u = u + np.round(first - u)
    v = (corners[:, 2] - center[2]) / extent + 0.5
    layer = mesh.uv_layers[0] if mesh.uv_layers else mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", np.stack([u * 2 * repeats, v * repeats], axis=-1).astype(np.float32).ravel())
    return owner


def settle(owner, height, z=0.0):
    """Scales an object of one mesh to a height, and puts it onto z, its middle at the origin."""
    points = np.array([owner.matrix_basis @ v.co for v in owner.data.vertices])
    low, high = points.min(axis=0), points.max(axis=0)
    scale = height / (high[2] - low[2])
    center = (low + high) / 2
    moved = (points - [center[0], center[1], low[2]]) * scale + [0, 0, z]
    owner.matrix_basis.identity()
    owner.location, owner.rotation_euler, owner.scale = (0, 0, 0), (0, 0, 0), (1, 1, 1)
    owner.data.vertices.foreach_set("co", moved.astype(np.float32).ravel())
    owner.data.update()
    return owner


def scan(path, height, up="Z"):
    """A mesh file of one object."""
    if path.endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=path)
    else:
        axes = {"forward_axis": "Y", "up_axis": "Z"} if up == "Z" else {"forward_axis": "NEGATIVE_Z", "up_axis": "Y"}
        bpy.ops.wm.ply_import(filepath=path, **axes)
    return settle(bpy.context.selected_objects[0], height)


def floor(material, half=8.0, z=0.0, repeats=1.0):
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * repeats
    return add_mesh("floor", corners, [(0, 1, 2, 3)], material, uv=uv)


def room(half, height, window, material):
    """A closed room without thickness, with a hole (from and to, in y and z) in the wall at -x; faces point inward."""
    (y0, y1), (z0, z1) = window
    box = [(x, y, z) for x in (-half, half) for y in (-half, half) for z in (0, height)]
    hole = [(-half, y, z) for y in (y0, y1) for z in (z0, z1)]
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (4, 5, 7, 6)]
    faces += [(0, 2, 10, 8), (2, 3, 11, 10), (3, 1, 9, 11), (1, 0, 8, 9)]
    return add_mesh("room", box + hole, faces, material)


# --- light and camera


def look(owner, target):
    owner.rotation_euler = (Vector(target) - owner.location).to_track_quat("-Z", "Y").to_euler()
    return owner


def camera(location, target, lens=50.0):
    return look(add_camera(location, lens=lens), target)


def lamp(location, target, size, energy, color=(1, 1, 1)):
    """A square lamp."""
    return look(add_light("AREA", location, size=size, energy=energy, color=color), target)


def background(strength):
    """A new world's tree, and the node of its light."""
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    if not world.node_tree:
        world.use_nodes = True
    node = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    node.inputs["Strength"].default_value = strength
    return world.node_tree, node


def even_sky(color, strength=1.0):
    background(strength)[1].inputs["Color"].default_value = (*color, 1)


def sky(strength, path=None, turn=0.0):
    """A world of an environment map, or of a painted sky: bright at the horizon, with a hazy sun of 8 degrees."""
    tree, light = background(strength)
    texture, mapping, coordinates = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Mapping", "TexCoord"))
    texture.image = bpy.data.images.load(path) if path else picture("sky", painted_sky(), "float")
    mapping.inputs["Rotation"].default_value = (0, 0, turn)
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], light.inputs["Color"])


def painted_sky():
    height = np.cos((np.arange(256) + 0.5) / 256 * math.pi)[:, None] + np.zeros((1, 512))
    around = (np.arange(512) + 0.5) / 512 * 2 * math.pi
    above = between(np.clip(height, 0, 1) ** 0.5, (1.0, 0.95, 0.85), (0.25, 0.45, 0.9))
    of_sun = np.sqrt(1 - height**2) * math.cos(0.6) * np.cos(around - 2.0) + height * math.sin(0.6)
    sun = np.exp((of_sun - 1) / 0.0025)[..., None] * np.array([90.0, 75.0, 50.0])
    return np.where(height[..., None] > 0, above, (0.2, 0.18, 0.15)) + sun


# --- the scenes


def head(asset):
    """A scanned head with a color texture, Random Walk (Skin), gloss, a sky and two lamps."""
    scanned, colors = asset("head/head_70k.obj"), asset("head/color.jpg")
    if not (scanned and colors):
        return False
    owner = scan(scanned, 4.0)
    dress(owner, skin("skin", bpy.data.images.load(colors), 0.06, Roughness=0.4, IOR=1.4))
    sky(0.5, asset("env/spruit_sunrise_small.hdr"), 1.0)
    lamp((-4, -4, 5), (0, 0, 2.3), 1.5, 350, (1.0, 0.9, 0.8))
    lamp((5, 2, 4), (0, 0, 2.3), 0.8, 250, (0.8, 0.9, 1.0))
    camera((1.5, -9, 3.0), (0, 0, 2.2), 75)


def figure(asset):
    """A subdivided monkey of wax with gloss, under a sky alone."""
    owner = dress(made(bpy.ops.mesh.primitive_monkey_add), None, levels=3)
    owner.rotation_euler, owner.location = radians(-25, 0, 25), (0, 0, 0.85)
    owner.data.materials[0] = scattering("wax", (0.92, 0.76, 0.5), (0.05, 0.03, 0.012), Roughness=0.25, IOR=1.45)
    floor(plain("ground", (0.35, 0.33, 0.3), Roughness=0.8))
    sky(1.0, asset("env/spruit_sunrise_small.hdr"), 2.0)
    camera((0.5, -6, 2.2), (0, 0, 0.85), 60)


def milk(asset):
    """A bowl of milk in a closed matte room with one window, the sky behind it."""
    room(2.0, 2.6, ((-0.7, 0.5), (0.9, 2.1)), plain("walls", (0.7, 0.66, 0.6), Roughness=1.0, Specular_IOR_Level=0.0))
    table = made(bpy.ops.mesh.primitive_cylinder_add, vertices=96, radius=0.6, depth=0.04, location=(0, 0, 0.68))
    dress(table, plain("table", (0.3, 0.18, 0.1), Roughness=0.45), smooth=False)
    outer = [(0.0, 0.7), (0.07, 0.7), (0.075, 0.715), (0.13, 0.75), (0.165, 0.81), (0.172, 0.835), (0.165, 0.838)]
    inner = [(0.155, 0.81), (0.12, 0.757), (0.07, 0.725), (0.0, 0.72)]
    turned("bowl", outer + inner, plain("ceramic", (0.25, 0.35, 0.5), Roughness=0.15))
    drink = [(0.0, 0.722), (0.068, 0.727), (0.117, 0.759), (0.148, 0.802), (0.146, 0.808), (0.13, 0.806), (0.0, 0.806)]
    turned("milk", drink, scattering("milk", (0.95, 0.93, 0.87), (0.012, 0.009, 0.006), Roughness=0.15, IOR=1.35))
    even_sky((0.75, 0.87, 1.0), 14.0)
    camera((0.55, -0.85, 1.25), (0, 0, 0.76), 60)


def jade(asset):
    """A dragon of jade, g = 0.6, under a coat, between a small lamp behind and one in front."""
    material = scattering("jade", (0.45, 0.78, 0.5), (0.08, 0.12, 0.08), g=0.6, Roughness=0.35, Coat_Weight=1.0, Coat_Roughness=0.05, IOR=1.5)
    scanned = asset("dragon/dragon_198k.ply")
    if scanned:
        dress(scan(scanned, 2.0, up="Y"), material)
    else:
        owner = made(bpy.ops.mesh.primitive_torus_add, major_radius=0.8, minor_radius=0.25, rotation=radians(80, 0, 30), location=(0, 0, 1.05))
        dress(owner, material, levels=2)
    floor(plain("ground", (0.15, 0.14, 0.13), Roughness=0.5))
    lamp((1.5, 3.0, 2.2), (0, 0, 1), 0.25, 160, (1.0, 0.92, 0.8))
    lamp((-2.0, -3.0, 3.0), (0, 0, 1), 0.25, 60)
    even_sky((0.02, 0.022, 0.03))
    camera((0.3, -7, 2.2), (0, 0, 0.95), 65)


def candle(asset):
    """A candle, lit by its own small and bright flame."""
    outline = [(0.0, 0.0), (0.38, 0.0), (0.4, 0.02), (0.4, 1.5), (0.38, 1.55), (0.33, 1.53), (0.22, 1.45), (0.0, 1.42)]
    turned("candle", outline, scattering("wax", (0.93, 0.85, 0.68), (0.06, 0.04, 0.02), Roughness=0.3, IOR=1.45))
    turned("wick", [(0.0, 1.4), (0.012, 1.4), (0.012, 1.56), (0.0, 1.56)], plain("wick", (0.03, 0.03, 0.03)), 12)
    flame = [(0.0, 1.54), (0.03, 1.57), (0.042, 1.62), (0.03, 1.7), (0.012, 1.78), (0.0, 1.82)]
    turned("flame", flame, plain("flame", (0, 0, 0), Emission_Color=(1.0, 0.55, 0.2, 1), Emission_Strength=500.0), 24)
    floor(plain("table", (0.35, 0.22, 0.13), Roughness=0.35))
    even_sky((0.012, 0.014, 0.02))
    camera((0.4, -5, 2.4), (0, 0, 0.9), 60)


def marble(asset):
    """A bust of veined marble with chisel marks, by sun and sky."""
    veins = np.abs(np.sin(6 * clouds(3, 512, 512) * math.pi)) ** 0.35
    colors = picture("veins", between(veins, (0.45, 0.43, 0.42), (0.88, 0.86, 0.82)))
    marks = picture("marks", normals(clouds(4, 512, 512, 0.75), 3.0), "Non-Color")
    owner = wrap(scan(str(BUST), 2.4, up="Y"), 2.0)
    dress(owner, scattering("marble", colors, (0.03, 0.022, 0.016), normal=marks, Roughness=0.4, IOR=1.5))
    floor(plain("ground", (0.4, 0.38, 0.34), Roughness=0.9))
    look(add_light("SUN", (4, -3, 5), energy=3.0, angle=math.radians(0.53), color=(1.0, 0.93, 0.82)), (0, 0, 0))
    even_sky((0.4, 0.55, 0.8), 0.7)
    camera((0.8, -7.5, 1.9), (0, 0, 1.2), 70)


def fruit(asset):
    """A textured strawberry with seeds, two materials of one mesh, between softboxes in a small studio."""
    flesh = picture("flesh", between(clouds(5) ** 1.5, (0.72, 0.03, 0.02), (0.9, 0.3, 0.12)))
    outline = [(0.0, 0.0), (0.2, 0.05), (0.42, 0.3), (0.62, 0.7), (0.72, 1.05), (0.66, 1.3), (0.4, 1.45), (0.0, 1.38)]
    berry = turned("berry", outline, scattering("flesh", flesh, (0.08, 0.025, 0.015), Roughness=0.2, IOR=1.4), 48)
    wrap(berry)
    seed = scattering("seed", (0.85, 0.6, 0.2), (0.012, 0.01, 0.006), Roughness=0.3)
    heights, radii = [z for _, z in outline], [r for r, _ in outline]
    kernels = []
    for k in range(140):
        z, around = 0.12 + 1.25 * (k + 0.5) / 140, k * 2.399963
        r = np.interp(z, heights[:6], radii[:6]) * 0.985
        kernel = made(bpy.ops.mesh.primitive_uv_sphere_add, segments=10, ring_count=6, radius=0.03, location=(r * math.cos(around), r * math.sin(around), z))
        kernel.scale, kernel.rotation_euler = (0.55, 0.7, 1.0), (0, 0, around)
        kernels.append(dress(kernel, seed))
    bpy.context.view_layer.update()
    bpy.ops.object.select_all(action="DESELECT")
    for owner in [berry, *kernels]:
        owner.select_set(True)
    bpy.context.view_layer.objects.active = berry
    bpy.ops.object.join()
    berry.rotation_euler, berry.location = radians(0, 35, -30), (-0.25, 0, 0.25)
    curve = [(-4.0, 0.0), (1.5, 0.0), (2.6, 0.25), (3.1, 1.2), (3.2, 5.0)]
    sweep = add_mesh("backdrop", [(x, y, z) for y, z in curve for x in (-6, 6)], [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(4)])
    dress(sweep, plain("backdrop", (0.75, 0.75, 0.75), Roughness=0.6), levels=2)
    lamp((-3, -2, 3), (0, 0, 0.8), 1.8, 90)
    lamp((3, -1, 2.2), (0, 0, 0.8), 1.2, 45, (0.9, 0.95, 1.0))
    lamp((0.5, 1.8, 3.5), (0, 0, 0.8), 1.0, 50, (1.0, 0.9, 0.8))
    even_sky((0.05, 0.05, 0.055))
    camera((0.2, -5.5, 1.8), (0, 0, 0.8), 65)


def soap(asset):
    """Two bars of soap with vertex colors, under an environment map alone."""
    for number, (place, turn) in enumerate([((-0.35, 0.2, 0.3), 20), ((0.45, -0.3, 0.3), -35)]):
        bar = made(bpy.ops.mesh.primitive_cube_add, size=1.0, location=place, rotation=radians(0, 0, turn))
        bar.scale = (1.3, 0.8, 0.6)
        bpy.ops.object.transform_apply(location=False, rotation=False)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.bevel(offset=0.15, segments=4)
        bpy.ops.mesh.subdivide(number_cuts=5)
        bpy.ops.object.mode_set(mode="OBJECT")
        points = np.array([v.co for v in bar.data.vertices])
        swirl = (0.5 + 0.5 * np.sin(points @ [9.0, 7.0, 5.0] + 2 * np.sin(points @ [3.0, -8.0, 4.0])))[:, None]
        ends = [((0.6, 0.85, 0.9), (0.95, 0.95, 0.92)), ((0.9, 0.55, 0.6), (0.97, 0.92, 0.85))][number]
        colors = np.ones((len(points), 4))
        colors[:, :3] = np.array(ends[0]) * (1 - swirl) + np.array(ends[1]) * swirl
        attribute = bar.data.color_attributes.new("swirl", "FLOAT_COLOR", "POINT")
        attribute.data.foreach_set("color", colors.astype(np.float32).ravel())
        dress(bar, scattering(f"soap {number}", ["swirl"], (0.06, 0.05, 0.04), Roughness=0.35, IOR=1.45))
    floor(plain("tiles", (0.5, 0.52, 0.55), Roughness=0.2))
    sky(1.0, asset("env/urban_alley_01_1k.hdr"), 0.5)
    camera((0.3, -4, 2.6), (0, 0, 0.25), 60)


def hand(asset):
    """A hand in front of a lamp, with a texture and Random Walk (Skin)."""
    bpy.ops.object.metaball_add(type="ELLIPSOID", location=(0, 0, 0))
    ball = bpy.context.object
    ball.data.resolution = ball.data.render_resolution = 0.035
    palm = ball.data.elements[0]
    palm.radius, palm.size_x, palm.size_y, palm.size_z = 1.2, 0.85, 0.28, 1.0
    fingers = [(-0.42, 1.05, -14, 0.5), (-0.13, 1.22, -4, 0.58), (0.15, 1.2, 4, 0.55), (0.42, 1.0, 14, 0.42), (-0.75, 0.05, -50, 0.4)]
    for x, z, lean, length in fingers:
        element = ball.data.elements.new(type="CAPSULE")
        element.co, element.radius, element.size_x = (x, 0, z), 0.26, length
        element.rotation = Vector((1, 0, 0)).rotation_difference(Vector((math.sin(math.radians(lean)), 0, math.cos(math.radians(lean)))))
    wrist = ball.data.elements.new(type="CAPSULE")
    wrist.co, wrist.radius, wrist.size_x = (0.05, 0, -1.2), 0.55, 0.9
    wrist.rotation = Vector((1, 0, 0)).rotation_difference(Vector((0, 0, 1)))
    bpy.context.view_layer.update()
    bpy.ops.object.convert(target="MESH")
    owner = wrap(bpy.context.object)
    tone = picture("tone", between(clouds(8), (0.62, 0.33, 0.24), (0.85, 0.6, 0.48)))
    dress(owner, skin("skin", tone, 0.25, Roughness=0.45, IOR=1.4))
    owner.rotation_euler = radians(0, 0, 20)
    lamp((0.6, 3.0, 1.2), (0, 0, 0.4), 0.6, 500, (1.0, 0.92, 0.82))
    sky(0.25)
    camera((0, -7.5, 0.6), (0, 0, 0.3), 70)


def food(asset):
    """A plate of grapes, cheese and rice on a wooden table, under a sky and beside a window."""
    random = np.random.default_rng(11)
    rings = np.sin(40 * np.linspace(0, 1, 512)[:, None] + 9 * clouds(9, 512, 512, 0.4)) * 0.5 + 0.5
    wood = picture("wood", between(rings * 0.7 + 0.3 * clouds(10, 512, 512), (0.2, 0.1, 0.05), (0.5, 0.3, 0.16)))
    floor(plain("table", wood, Roughness=0.35), half=3.0, repeats=2.0)
    plate = [(0.0, 0.02), (0.55, 0.02), (0.6, 0.04), (0.95, 0.14), (1.0, 0.16), (0.98, 0.18), (0.6, 0.08), (0.5, 0.06), (0.0, 0.06)]
    turned("plate", plate, plain("ceramic", (0.8, 0.8, 0.78), Roughness=0.1))
    grape = scattering("grape", (0.5, 0.62, 0.2), (0.06, 0.08, 0.03), Roughness=0.15, IOR=1.4)
    cheese = scattering("cheese", picture("rind", between(clouds(12), (0.9, 0.6, 0.18), (0.95, 0.75, 0.35))), (0.02, 0.014, 0.006), Roughness=0.3)
    rice = scattering("rice", (0.9, 0.88, 0.8), (0.012, 0.011, 0.009), Roughness=0.3)
    ball = dress(made(bpy.ops.mesh.primitive_uv_sphere_add, segments=32, ring_count=16, radius=0.12), grape, levels=1)
    cube = dress(made(bpy.ops.mesh.primitive_cube_add, size=0.24), cheese, smooth=False)
    edges = cube.modifiers.new("edges", "BEVEL")
    edges.width, edges.segments = 0.02, 3
    grain = dress(made(bpy.ops.mesh.primitive_uv_sphere_add, segments=16, ring_count=10, radius=0.02), rice)
    grain.scale = (1, 1, 2.8)

    def place(original, location, turn):
        owner = original.copy()
        bpy.context.scene.collection.objects.link(owner)
        owner.location, owner.rotation_euler = location, turn

    for k in range(16):
        layer, along = divmod(k, 7) if k < 14 else (2, k - 14)
        angle = along * 0.9 + layer * 0.45
        r = 0.26 - 0.09 * layer if along else 0.02
        place(ball, (-0.32 + r * math.cos(angle), 0.12 + r * math.sin(angle), 0.18 + 0.18 * layer), (0, 0, angle))
    for k in range(7):
        spot = (0.3 + 0.26 * (k % 3) - 0.1 * (k // 3), 0.28 - 0.25 * (k % 2) + 0.05 * (k // 3), 0.19 + 0.24 * (k // 5))
        place(cube, spot, (0, 0, random.uniform(0, 1.5)))
    for k in range(260):
        r, angle = 0.3 * math.sqrt(random.random()), random.uniform(0, 2 * math.pi)
        pile = 0.08 + (0.3 - r) * 0.5 * random.random()
        place(grain, (0.12 + r * math.cos(angle), -0.4 + r * 0.7 * math.sin(angle), pile), tuple(random.uniform(0, 3.1, 3)))
    for owner in (ball, cube, grain):
        bpy.data.objects.remove(owner)
    lamp((-3.2, 0.5, 1.6), (0, 0, 0.2), 1.4, 160, (0.9, 0.95, 1.0))
    sky(0.5)
    camera((0.4, -3.0, 2.1), (0.02, -0.02, 0.15), 62)


SCENES = {build.__name__: build for build in (head, figure, milk, jade, candle, marble, fruit, soap, hand, food)}
