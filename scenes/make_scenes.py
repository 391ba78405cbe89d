"""Writes the example scenes: scenes/NAME/scene.xml with their meshes.

    python3 scenes/make_scenes.py

needs nothing but Python 3, and writes the same bytes each time. Lengths are metres, y is up.
"""

import math
from pathlib import Path

from bitmap import printed, write_png
from meshes import heightfield, polyline, revolution, torus, write_ply
from xml_writer import *

HERE = Path(__file__).resolve().parent

WHITE, RED, GREEN = (0.73, 0.73, 0.72), (0.60, 0.06, 0.05), (0.14, 0.42, 0.10)


def write(name, text, file="scene.xml", **meshes):
    """Writes one scene and its meshes into its folder."""
    folder = HERE / name
    folder.mkdir(exist_ok=True)
    (folder / file).write_text(text, encoding="utf-8", newline="\n")
    for mesh_name, mesh in meshes.items():
        write_ply(folder / f"{mesh_name}.ply", mesh)


def parameters(width, height, max_depth, **more):
    """The parameters that every scene has, then its own."""
    return {"integrator": "path", "max_depth": max_depth, "spp": 64, "resx": width, "resy": height} | more


def glass(name="Glass", ior=1.5):
    return bsdf("dielectric", number("int_ior", ior), number("ext_ior", 1), id=name)


def metal(name, material):
    return bsdf("conductor", string("material", material), id=name)


# ------------------------------------------------------------------------------------------------


def room_walls(half_width=1, front=1):
    """A room 2 m high on the floor y = 0, from z = -1 to the front, open there."""
    half_depth, z = (front + 1) / 2, (front - 1) / 2
    return section(
        "The room",
        matte("White", WHITE),
        matte("Red", RED),
        matte("Green", GREEN),
        wall("up", (0, 0, z), half_width, half_depth, material="White", name="Floor"),
        wall("down", (0, 2, z), half_width, half_depth, material="White", name="Ceiling"),
        wall("forward", (0, 1, -1), half_width, 1, material="White", name="BackWall"),
        wall("right", (-half_width, 1, z), half_depth, 1, material="Red", name="LeftWall"),
        wall("left", (half_width, 1, z), half_depth, 1, material="Green", name="RightWall"),
    )


def cornell():
    write("cornell", scene(
        "Two boxes under a lamp: nothing but diffuse surfaces.",
        parameters(384, 384, 8),
        camera((0, 1, 3.9), (0, 1, 0), 38.6),
        room_walls(),
        section(
            "What stands in it",
            box((-0.34, 0.6, -0.3), (0.29, 0.6, 0.29), rotate("y", 18), material="White", name="TallBox"),
            box((0.34, 0.3, 0.36), (0.3, 0.3, 0.3), rotate("y", -17), material="White", name="ShortBox"),
        ),
        section(
            "The lamp",
            wall("down", (0, 1.995, 0), 0.25, 0.2, area((46, 39, 27)), material="White", name="Lamp"),
        ),
    ))


def spheres():
    write("spheres", scene(
        "A glass and a mirror sphere under a small lamp: the caustic, and its mirror image.",
        parameters(400, 300, 10, light_size=0.03, light_radiance="2667, 2400, 2000"),
        camera((0, 1, 4.2), (0, 0.95, 0), 44),
        room_walls(1.33, front=4.5),
        section(
            "Behind the camera, and what stands in the room",
            wall("backward", (0, 1, 4.5), 1.33, 1, material="White", name="FrontWall"),
            glass(),
            metal("Mirror", "Ag"),
            sphere((0.42, 0.36, 0.42), 0.36, material="Glass", name="GlassSphere"),
            sphere((-0.52, 0.55, -0.3), 0.55, material="Mirror", name="MirrorSphere"),
        ),
        section(
            "The lamp, a square: its power goes with the radiance and the square of its size",
            shape(
                "rectangle",
                transform(scale("$light_size"), lookat((1.1, 1.7, 0.75), (0.1, 0.3, 0.2))),
                area("$light_radiance"),
                material="White",
                name="Lamp",
            ),
        ),
    ))


# ------------------------------------------------------------------------------------------------

# The waves of the pool: (wavelength, direction in degrees, amplitude, phase). Water of curvature c
# focuses parallel light at the depth n / ((n - 1) c), about 4 / c: the amplitudes give each wave a
# greatest curvature near 1.5 / m, so that where a few crests meet the focus lies on the floor.
WAVES = [
    (0.68, 12, 0.0152, 0.3), (0.58, 85, 0.0121, 2.6), (0.48, 135, 0.0092, 4.1), (0.41, -20, 0.0068, 2.7),
    (0.36, 105, 0.0053, 5.2), (0.32, 50, 0.0041, 0.9), (0.27, 165, 0.0027, 3.3),
]
WATER_LEVEL = -0.12


def wave_terms(x, z):
    for length, angle, amplitude, phase in WAVES:
        k = 2 * math.pi / length
        kx, kz = k * math.cos(math.radians(angle)), k * math.sin(math.radians(angle))
        yield amplitude, kx, kz, kx * x + kz * z + phase


def wave_height(x, z):
    return WATER_LEVEL + sum(a * math.sin(arg) for a, _, _, arg in wave_terms(x, z))


def wave_slope(x, z):
    terms = [(a * math.cos(arg), kx, kz) for a, kx, kz, arg in wave_terms(x, z)]
    return sum(c * kx for c, kx, _ in terms), sum(c * kz for c, _, kz in terms)


WATER = heightfield(wave_height, wave_slope, (-1.53, 1.53), (-1.02, 1.02), 131, 88)

POOL_X, POOL_Z, POOL_DEPTH = 1.5, 1.0, 1.1
POOL_CAMERA, POOL_FOV = ((0.3, 2.3, 2.3), (0.02, -0.46, 0)), 45
LAMP, LAMP_RADIUS, LAMP_RADIANCE = (-0.35, 2.6, 1.15), 0.08, (1150, 1075, 925)
TILE = ((0.30, 0.60, 0.66), (0.44, 0.74, 0.78))


def pool():
    lamp = section(
        "The lamp: its power goes with the radiance and the square of the radius",
        sphere(LAMP, "$light_radius", area("$light_radiance"), material="Stone", name="Lamp"),
    )
    lamp_parameters = {"light_radius": LAMP_RADIUS, "light_radiance": triple(LAMP_RADIANCE)}
    write("pool", pool_under("A small lamp", lamp, **lamp_parameters), water=WATER)
    # Of the same power: I = L pi r^2.
    intensity = tuple(math.pi * LAMP_RADIUS**2 * radiance for radiance in LAMP_RADIANCE)
    point_light = section(
        "A point light of the power of the lamp in scene.xml",
        element("emitter", point("position", LAMP), rgb("intensity", "$intensity"), type="point"),
    )
    text = pool_under("A point light", point_light, intensity=triple(intensity))
    write("pool", text, file="point.xml")


def pool_under(lamp_name, lamp, **lamp_parameters):
    middle, deck = -POOL_DEPTH / 2, 0.8
    return (
        scene(
            f"{lamp_name} over a pool: the caustics on its floor, seen through the waves that made them.",
            parameters(400, 300, 8, **lamp_parameters),
            camera(*POOL_CAMERA, POOL_FOV),
            section(
                "The basin and its edge",
                matte("FloorTiles", checkerboard(*TILE, 5 * POOL_X, 5 * POOL_Z)),
                matte("LongTiles", checkerboard(*TILE, 5 * POOL_X, 2.5 * POOL_DEPTH)),
                matte("ShortTiles", checkerboard(*TILE, 5 * POOL_Z, 2.5 * POOL_DEPTH)),
                matte("Stone", (0.62, 0.53, 0.43)),
                wall("up", (0, -POOL_DEPTH, 0), POOL_X, POOL_Z, material="FloorTiles", name="Floor"),
                wall("forward", (0, middle, -POOL_Z), POOL_X, -middle, material="LongTiles", name="FarWall"),
                wall("backward", (0, middle, POOL_Z), POOL_X, -middle, material="LongTiles", name="NearWall"),
                wall("right", (-POOL_X, middle, 0), POOL_Z, -middle, material="ShortTiles", name="LeftWall"),
                wall("left", (POOL_X, middle, 0), POOL_Z, -middle, material="ShortTiles", name="RightWall"),
                wall("up", (0, 0, -POOL_Z - deck), POOL_X + 2 * deck, deck, material="Stone", name="FarEdge"),
                wall("up", (0, 0, POOL_Z + deck), POOL_X + 2 * deck, deck, material="Stone", name="NearEdge"),
                wall("up", (-POOL_X - deck, 0, 0), deck, POOL_Z, material="Stone", name="LeftEdge"),
                wall("up", (POOL_X + deck, 0, 0), deck, POOL_Z, material="Stone", name="RightEdge"),
            ),
            section(
                "The water: one surface, water below it and air above",
                bsdf("dielectric", string("int_ior", "water"), string("ext_ior", "air"), id="Water"),
                ply("water.ply", material="Water", name="Surface"),
            ),
            lamp,
        )
    )


# ------------------------------------------------------------------------------------------------


def torus_in_glass():
    write(
        "torus-in-glass",
        scene(
            "A torus cast in a block of glass under a sun: all light on it came through the glass.",
            parameters(400, 300, 12, light_radius=0.06, light_radiance="4200, 3700, 2900"),
            camera((1.3, 1.75, 2.7), (0.12, 0.38, -0.05), 44),
            section(
                "The floor",
                matte("Floor", checkerboard((0.58, 0.58, 0.56), (0.70, 0.70, 0.68), 8, 8)),
                wall("up", (0, 0, 0), 4, 4, material="Floor", name="Ground"),
            ),
            section(
                "The block, a hair above the floor, and the torus in it",
                glass(),
                bsdf("diffuse", rgb("reflectance", (0.80, 0.38, 0.09)), id="Orange"),
                box((0, 0.503, 0), (0.62, 0.5, 0.62), rotate("y", 12), material="Glass", name="Block"),
                ply(
                    "torus.ply",
                    rotate("x", 62), rotate("y", 30), translate(0, 0.5, 0),
                    material="Orange", name="Torus",
                ),
            ),
            section(
                "A small sun and a dim sky",
                sphere((-2.2, 3.6, 1.6), "$light_radius", area("$light_radiance"), material="Floor", name="Sun"),
                element("emitter", rgb("radiance", (0.14, 0.18, 0.26)), type="constant"),
            ),
        ),
        torus=torus(0.32, 0.13, 64, 32),
    )


# ------------------------------------------------------------------------------------------------


def door():
    opening, lintel = 0.45, 2.0
    write(
        "door",
        scene(
            "A room lit through a door ajar: every path must find the gap.",
            parameters(400, 300, 12),
            camera((1.35, 1.35, 1.85), (-0.35, 0.82, -1.2), 62),
            section(
                "The room",
                matte("Plaster", (0.72, 0.70, 0.66)),
                matte("Wood", (0.42, 0.25, 0.13)),
                bsdf(
                    "roughplastic",
                    rgb("diffuse_reflectance", (0.36, 0.24, 0.15)),
                    number("alpha", 0.1),
                    id="Parquet",
                ),
                wall("up", (0, 0, 0), 2, 2, material="Parquet", name="Floor"),
                wall("down", (0, 2.6, 0), 2, 2, material="Plaster", name="Ceiling"),
                wall("right", (-2, 1.3, 0), 2, 1.3, material="Plaster", name="LeftWall"),
                wall("left", (2, 1.3, 0), 2, 1.3, material="Plaster", name="RightWall"),
                wall("backward", (0, 1.3, 2), 2, 1.3, material="Plaster", name="NearWall"),
            ),
            section(
                "The wall with the doorway, from x = -1.4 to -0.5, and the door on its hinge at -0.5",
                wall("forward", (-1.7, 1.3, -2), 0.3, 1.3, material="Plaster", name="WallLeftOfDoor"),
                wall("forward", (0.75, 1.3, -2), 1.25, 1.3, material="Plaster", name="WallRightOfDoor"),
                wall("forward", (-0.95, 2.3, -2), opening, 0.3, material="Plaster", name="WallOverDoor"),
                shape(
                    "cube",
                    transform(
                        scale(opening, lintel / 2 - 0.004, 0.02),
                        translate(-opening, lintel / 2, 0.02),
                        rotate("y", 26),
                        translate(-0.5, 0, -2),
                    ),
                    material="Wood",
                    name="Door",
                ),
            ),
            section(
                "The corridor behind it, with the only lamp",
                wall("up", (0, 0, -3), 2, 1, material="Plaster", name="CorridorFloor"),
                wall("down", (0, 2.6, -3), 2, 1, material="Plaster", name="CorridorCeiling"),
                wall("forward", (0, 1.3, -4), 2, 1.3, material="Plaster", name="CorridorWall"),
                wall("right", (-2, 1.3, -3), 1, 1.3, material="Plaster", name="CorridorLeft"),
                wall("left", (2, 1.3, -3), 1, 1.3, material="Plaster", name="CorridorRight"),
                wall("down", (0.2, 2.59, -3.2), 1.2, 0.3, area((420, 378, 306)), material="Plaster", name="Lamp"),
            ),
            section(
                "A table and what stands on it",
                glass(),
                bsdf(
                    "roughconductor",
                    string("material", "Cu"),
                    number("alpha", 0.08),
                    id="Copper",
                ),
                bsdf(
                    "plastic",
                    rgb("diffuse_reflectance", (0.09, 0.21, 0.42)),
                    number("int_ior", 1.5),
                    id="Glaze",
                ),
                box((-0.05, 0.66, -0.75), (0.75, 0.03, 0.42), material="Wood", name="TableTop"),
                *[
                    box((-0.05 + x, 0.315, -0.75 + z), (0.03, 0.315, 0.03), material="Wood")
                    for x in (-0.68, 0.68) for z in (-0.35, 0.35)
                ],
                sphere((-0.42, 0.851, -0.78), 0.16, material="Glass", name="GlassBall"),
                sphere((0.40, 0.851, -0.92), 0.16, material="Glaze", name="GlazedBall"),
                ply("torus.ply", translate(0.02, 0.752, -0.62), material="Copper", name="Ring"),
            ),
        ),
        torus=torus(0.15, 0.06, 64, 24),
    )


# ------------------------------------------------------------------------------------------------


def egg(length, width, rows, columns):
    """An egg that stands on the origin, blunt end down."""
    profile = []
    for row in range(rows + 1):
        angle = math.pi * row / rows
        # An ellipse, drawn in toward its upper end; the derivatives are those of radius and y.
        taper = 1 - 0.18 * math.cos(angle)
        radius, y = width * math.sin(angle) * taper, length * (1 + math.cos(angle))
        slope = width * (math.cos(angle) * taper + 0.18 * math.sin(angle) ** 2)
        profile.append((max(radius, 0.0) if 0 < row < rows else 0.0, y, length * math.sin(angle), slope))
    return revolution(profile, columns)


def housing(radius, height, thickness, columns):
    """A can around the y axis, open at its top."""
    inner = radius - thickness
    outline = [(0, thickness), (inner, thickness), (inner, height), (radius, height), (radius, 0), (0, 0)]
    return revolution(polyline(outline), columns)


def bidir():
    write(
        "bidir",
        scene(
            "An egg of glass in a spotlight and a lamp in a sconce: the lamps are hidden in their"
            " housings, so that nearly all light is indirect. After the scene of Veach (1997).",
            parameters(
                400, 300, 10,
                bulb_radius=0.04, bulb_radiance="900, 710, 450", spot_radiance="1600, 1480, 1280",
                housing_reflectance=1,
            ),
            camera((0.1, 1.5, 2.9), (-0.02, 0.98, 0), 46),
            section(
                "The room",
                matte("Wall", (0.68, 0.64, 0.56)),
                matte("Carpet", (0.36, 0.22, 0.18)),
                wall("up", (0, 0, 0.6), 1.9, 2.6, material="Carpet", name="Floor"),
                wall("down", (0, 2.5, 0.6), 1.9, 2.6, material="Wall", name="Ceiling"),
                wall("forward", (0, 1.25, -2), 1.9, 1.25, material="Wall", name="BackWall"),
                wall("backward", (0, 1.25, 3.2), 1.9, 1.25, material="Wall", name="FrontWall"),
                wall("right", (-1.9, 1.25, 0.6), 2.6, 1.25, material="Wall", name="LeftWall"),
                wall("left", (1.9, 1.25, 0.6), 2.6, 1.25, material="Wall", name="RightWall"),
            ),
            section(
                "A table with the egg",
                bsdf(
                    "roughplastic",
                    rgb("diffuse_reflectance", (0.46, 0.30, 0.17)),
                    number("alpha", 0.2),
                    id="Wood",
                ),
                glass(),
                box((0, 0.72, 0), (0.8, 0.03, 0.5), material="Wood", name="TableTop"),
                *[
                    box((x, 0.345, z), (0.035, 0.345, 0.035), material="Wood")
                    for x in (-0.7, 0.7) for z in (-0.4, 0.4)
                ],
                ply("egg.ply", translate(0.05, 0.751, 0.05), material="Glass", name="Egg"),
            ),
            section(
                "The sconce on the back wall shines at the ceiling",
                bsdf(
                    "twosided",
                    bsdf(
                        "roughconductor",
                        string("material", "Al"),
                        number("alpha", 0.3),
                        rgb("specular_reflectance", "$housing_reflectance"),
                    ),
                    id="Steel",
                ),
                ply("sconce.ply", translate(-0.95, 1.35, -1.85), material="Steel", name="Sconce"),
                sphere((-0.95, 1.47, -1.85), "$bulb_radius", area("$bulb_radiance"), material="Wall", name="Bulb"),
            ),
            section(
                "The spotlight on its pole, aimed at the egg",
                box((0.99, 0.85, 0.42), (0.015, 0.85, 0.015), material="Steel", name="Pole"),
                box((0.99, 0.01, 0.42), (0.16, 0.01, 0.16), material="Steel", name="Foot"),
                ply("spot.ply", rotate("x", 90), lookat(SPOT, EGG), material="Steel", name="Spot"),
                shape(
                    "rectangle",
                    transform(scale(0.045), translate(0, 0, 0.02), lookat(SPOT, EGG)),
                    area("$spot_radiance"),
                    material="Wall",
                    name="SpotLamp",
                ),
            ),
        ),
        egg=egg(0.2, 0.145, 40, 48),
        sconce=housing(0.12, 0.24, 0.01, 40),
        spot=housing(0.08, 0.26, 0.01, 40),
    )


SPOT, EGG = (0.95, 1.7, 0.4), (0.05, 0.95, 0.05)


# ------------------------------------------------------------------------------------------------


def rough_glass():
    alphas = (0.3, 0.1, 0.03, 0.01)
    places = [-1.05 + 0.7 * i for i in range(4)]
    eye, focus = (0.0, 2.0, 3.1), (0, 0.15, 0.15)
    write(
        "rough-glass",
        scene(
            "Rough glass and rough copper, from the left alpha = 0.3, 0.1, 0.03 and 0.01: caustics"
            " from broad to nearly singular, through a thin lens.",
            parameters(420, 300, 10, light_radius=0.04, light_radiance="4600, 4250, 3700"),
            camera(eye, focus, 50, lens=(0.035, math.dist(eye, focus))),
            section(
                "Floor and back wall",
                matte("Grey", (0.62, 0.62, 0.62)),
                wall("up", (0, 0, 0.6), 4, 3.4, material="Grey", name="Floor"),
                wall("forward", (0, 2, -2.8), 4, 2, material="Grey", name="Wall"),
            ),
            section(
                "Four spheres of glass",
                *[
                    bsdf(
                        "roughdielectric",
                        string("distribution", "ggx"),
                        number("alpha", alpha),
                        number("int_ior", 1.5),
                        number("ext_ior", 1),
                        id=f"Glass{alpha}",
                    )
                    for alpha in alphas
                ],
                *[
                    sphere((x, 0.272, -0.3), 0.27, material=f"Glass{alpha}")
                    for x, alpha in zip(places, alphas)
                ],
            ),
            section(
                "Four rings of copper",
                *[
                    bsdf(
                        "twosided",
                        bsdf(
                            "roughconductor",
                            string("material", "Cu"),
                            string("distribution", "ggx"),
                            number("alpha", alpha),
                        ),
                        id=f"Copper{alpha}",
                    )
                    for alpha in alphas
                ],
                *[
                    ply("ring.ply", translate(x, 0, 0.75), material=f"Copper{alpha}")
                    for x, alpha in zip(places, alphas)
                ],
            ),
            section(
                "The lamp",
                sphere((-0.6, 2.4, -2.0), "$light_radius", area("$light_radiance"), material="Grey", name="Lamp"),
            ),
        ),
        ring=revolution(polyline([(0.25, 0), (0.25, 0.16), (0.26, 0.16), (0.26, 0)]), 72),
    )


# ------------------------------------------------------------------------------------------------


def lost_caustic():
    write("lost-caustic", scene(
        "A point light, a pinhole and smooth glass: light that reaches a diffuse surface through"
        " glass and is seen through glass is found by no local path sampler.",
        parameters(400, 300, 10),
        camera((0.3, 1.7, 2.5), (0, 0.12, 0.05), 40),
        section(
            "The floor",
            matte("Floor", checkerboard((0.34, 0.40, 0.46), (0.72, 0.70, 0.64), 10, 10)),
            wall("up", (0, 0, 0), 2.5, 2.5, material="Floor", name="Ground"),
        ),
        section(
            "A slab of glass over the floor, a lens beside it, and a ball cast in glass",
            glass(),
            bsdf("diffuse", rgb("reflectance", (0.75, 0.16, 0.10)), id="Red"),
            box((-0.45, 0.09, 0.25), (0.42, 0.04, 0.34), rotate("y", 14), material="Glass", name="Slab"),
            sphere((0.62, 0.201, 0.42), 0.2, material="Glass", name="Lens"),
            sphere((0.28, 0.302, -0.45), 0.3, material="Glass", name="Shell"),
            sphere((0.28, 0.302, -0.45), 0.17, material="Red", name="Ball"),
        ),
        section(
            "The light",
            element(
                "emitter",
                point("position", (-0.7, 1.9, -0.6)),
                rgb("intensity", (14, 13, 11.5)),
                type="point",
            ),
        ),
    ))


# ------------------------------------------------------------------------------------------------

TEXT = """A LENS BENDS EVERY RAY
THAT PASSES THROUGH IT.
THE SUN GATHERS BENEATH
THE GLASS AND DRAWS ON
THE PAGE A CURVE OF FIRE
THAT WE CAN ONLY SEE
THROUGH THE SAME GLASS:
SPECULAR, DIFFUSE AND
SPECULAR AGAIN."""


def lens():
    base, height = 0.6, 0.52
    radius = (base**2 + height**2) / (2 * height)
    write_png(HERE / "lens" / "page.png", printed(TEXT.split("\n"), 4))
    write(
        "lens",
        scene(
            "A plano-convex lens on a page in the sun: all sunlight beneath the lens came through it,"
            " and is seen through it.",
            parameters(400, 300, 8, sun="4.2, 3.8, 3.2"),
            camera((0.25, 2.0, 1.75), (0.0, 0.0, 0.02), 42),
            section(
                "The page",
                matte("Page", element(
                    "texture", string("filename", "page.png"), type="bitmap", name="reflectance",
                )),
                wall("up", (0, 0, 0), 1.5, 1.125, material="Page", name="Sheet"),
            ),
            section(
                "The lens: its flat side lies on the page, so that the page is in the glass",
                glass(),
                ply("dome.ply", material="Glass", name="Lens"),
            ),
            section(
                "The sun, and a dim sky",
                element(
                    "emitter",
                    vector("direction", (-0.62, -0.62, -0.35)),
                    rgb("irradiance", "$sun"),
                    type="directional",
                ),
                element("emitter", rgb("radiance", (0.10, 0.13, 0.18)), type="constant"),
            ),
        ),
        dome=dome(base, height, radius),
    )


def dome(base, height, radius):
    """A spherical cap over y = 0 that goes on a little below, so that no ray passes between it and the page."""
    centre = height - radius
    low = math.acos(-(centre + 0.004) / radius)
    angles = [low * (1 - i / 48) for i in range(49)]
    profile = [
        (radius * math.sin(a), centre + radius * math.cos(a), math.sin(a), math.cos(a)) for a in angles
    ]
    return revolution(profile, 128)


if __name__ == "__main__":
    for make in (lens, cornell, spheres, pool, torus_in_glass, door, bidir, rough_glass, lost_caustic):
        make()
