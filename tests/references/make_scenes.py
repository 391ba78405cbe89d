"""Writes the small scenes that hold each convention of the format: tests/references/scenes.

    python3 tests/references/make_scenes.py

Each scene has a few objects of one kind on a common stage. Needs nothing but Python 3, and writes
the same bytes each time.
"""

import math
import struct
import sys
import zlib
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scenes"))

from meshes import revolution, write_ply  # noqa: E402
from xml_writer import *  # noqa: E402, F403

FOLDER = HERE / "scenes"
EYE, TARGET, FOV = (0.3, 1.5, 4.2), (0, 0.55, 0), 42


# The stage ---------------------------------------------------------------------------------------


def sky(scale=1, *turns):
    """An environment in which no direction looks like another."""
    return element(
        "emitter", string("filename", "sky.hdr"), number("scale", scale), transform(*turns), type="envmap"
    )


def stage(note, *sections, eye=None, light="both", max_depth=6, method=(), **values):
    """A floor with objects on it; light is "sky", "lamp", "both", or "none" for a scene with its own."""
    lamp = wall("down", (0.8, 3.0, 1.2), 0.6, 0.5, area((5, 4.6, 4)), material="Floor")
    lights = {"sky": [sky()], "lamp": [lamp], "both": [sky(0.6), lamp], "none": []}[light]
    return scene(
        note,
        {"integrator": "path", "max_depth": max_depth, "spp": 64, "resx": 32, "resy": 24} | values,
        eye or camera(EYE, TARGET, FOV),
        section(
            "The stage",
            bsdf("diffuse", rgb("reflectance", (0.5, 0.52, 0.55)), id="Floor"),
            wall("up", (0, 0, 0), 3, 3, material="Floor"),
            *lights,
        ),
        section("What it is about", *sections),
        method=method,
    )


# Every twentieth value of the green wall of the Cornell box, and its lamp (Goral et al. 1984, as measured at
# Cornell University).
PAINT = "400:0.092, 440:0.097, 480:0.113, 520:0.285, 560:0.214, 600:0.134, 640:0.136, 680:0.184, 700:0.21"
LAMP = "400:0, 500:2, 600:3.9, 700:4.6"

PLACES = [(-1.05, 0.451, 0), (0, 0.451, 0), (1.05, 0.451, 0)]


def three_balls(*materials):
    """A sphere for each material, left to right."""
    return [
        shape("sphere", point("center", place), number("radius", 0.45), material_element)
        for place, material_element in zip(PLACES, materials)
    ]


def texture(kind, *parameters, name="reflectance"):
    return element("texture", *parameters, type=kind, name=name)


def picture(*parameters, name="reflectance"):
    return texture("bitmap", string("filename", "picture.png"), *parameters, name=name)


def diffuse(colour):
    return bsdf("diffuse", colour if isinstance(colour, list) else rgb("reflectance", colour))


def to_uv(*steps):
    return transform(*steps, name="to_uv")


def turn(axis, angle):
    """A rotation around any axis of unit length."""
    x, y, z = axis
    return element("rotate", x=fmt(x), y=fmt(y), z=fmt(z), angle=fmt(angle))


# Materials ---------------------------------------------------------------------------------------


def materials():
    yield "diffuse", stage(
        "Diffuse: a ball; one side only, seen from behind; both sides.",
        *three_balls(diffuse((0.8, 0.3, 0.1)))[:1],
        shape("rectangle", transform(scale(0.45), rotate("y", 150), translate(0, 0.5, 0)), diffuse((0.2, 0.7, 0.3))),
        shape(
            "rectangle",
            transform(scale(0.45), rotate("y", 150), translate(1.05, 0.5, 0)),
            bsdf("twosided", diffuse((0.2, 0.3, 0.8))),
        ),
    )
    yield "conductor", stage(
        "Conductors: by name, by numbers with a colour, and the perfect mirror.",
        *three_balls(
            bsdf("conductor", string("material", "Au")),
            bsdf(
                "conductor",
                rgb("eta", (0.2, 0.9, 1.3)), rgb("k", (3.6, 2.6, 2.3)),
                rgb("specular_reflectance", (0.9, 0.8, 0.7)),
            ),
            bsdf("conductor", string("material", "none")),
        ),
    )
    yield "roughconductor", stage(
        "Rough conductors: Beckmann and GGX.",
        *three_balls(
            bsdf("roughconductor", string("material", "Cu"), number("alpha", 0.3)),
            bsdf(
                "roughconductor",
                string("material", "Ag"), string("distribution", "ggx"), number("alpha", 0.15),
                rgb("specular_reflectance", (0.5, 0.8, 0.9)),
            ),
            bsdf(
                "roughconductor",
                rgb("eta", (1.3, 0.9, 0.6)), rgb("k", (7.5, 6.3, 5.4)),
                string("distribution", "ggx"), number("alpha", 0.5),
            ),
        ),
    )
    yield "dielectric", stage(
        "Dielectrics: glass, coloured glass, and a bubble of air in a ball of water.",
        *three_balls(
            bsdf("dielectric"),
            bsdf(
                "dielectric",
                number("int_ior", 1.7), string("ext_ior", "air"),
                rgb("specular_transmittance", (0.9, 0.6, 0.3)), rgb("specular_reflectance", (0.4, 0.7, 1)),
            ),
            bsdf("dielectric", string("int_ior", "water"), string("ext_ior", "air")),
        ),
        shape(
            "sphere",
            point("center", PLACES[2]), number("radius", 0.3),
            bsdf("dielectric", string("int_ior", "air"), string("ext_ior", "water")),
        ),
        light="sky",
        max_depth=9,
    )
    yield "roughdielectric", stage(
        "Rough dielectrics: a slab, and balls with Beckmann and GGX.",
        *three_balls(
            bsdf("roughdielectric", number("alpha", 0.3), string("int_ior", "bk7"), string("ext_ior", "air")),
            bsdf("roughdielectric", number("alpha", 0.1), string("distribution", "ggx"), number("int_ior", 1.4)),
        ),
        box(
            (1.05, 0.5, 0), (0.4, 0.45, 0.08), rotate("y", 25),
            material="Slab",
        ),
        bsdf(
            "roughdielectric",
            string("distribution", "ggx"), number("alpha", 0.4), number("int_ior", 1.6),
            rgb("specular_transmittance", (0.6, 0.9, 0.7)), rgb("specular_reflectance", (0.9, 0.7, 0.8)),
            id="Slab",
        ),
        light="sky",
        max_depth=9,
    )
    yield "plastic", stage(
        "Plastic: plain, nonlinear, and with another index of refraction and a tinted gloss.",
        *three_balls(
            bsdf("plastic", rgb("diffuse_reflectance", (0.1, 0.3, 0.7))),
            bsdf("plastic", rgb("diffuse_reflectance", (0.8, 0.3, 0.2)), boolean("nonlinear", True)),
            bsdf(
                "plastic",
                rgb("diffuse_reflectance", (0.3, 0.6, 0.2)), number("int_ior", 1.9),
                rgb("specular_reflectance", (0.9, 0.5, 0.4)),
            ),
        ),
    )
    yield "roughplastic", stage(
        "Rough plastic: Beckmann, nonlinear GGX, and a tinted gloss.",
        *three_balls(
            bsdf("roughplastic", rgb("diffuse_reflectance", (0.1, 0.3, 0.7)), number("alpha", 0.1)),
            bsdf(
                "roughplastic",
                rgb("diffuse_reflectance", (0.8, 0.3, 0.2)), boolean("nonlinear", True),
                string("distribution", "ggx"), number("alpha", 0.3),
            ),
            bsdf(
                "roughplastic",
                rgb("diffuse_reflectance", (0.3, 0.6, 0.2)), number("int_ior", 1.9), number("alpha", 0.2),
                rgb("specular_reflectance", (0.9, 0.5, 0.4)),
            ),
        ),
    )
    yield "twosided", stage(
        "Two materials on the two sides of one surface: each side, and one with flipped normals.",
        *[
            shape(
                "rectangle",
                boolean("flip_normals", True) if flipped else None,
                transform(scale(0.45), rotate("y", angle), translate(x, 0.5, 0)),
                bsdf(
                    "twosided",
                    # Not the same colour: Mitsuba 3.9 joins meshes of one material, and then
                    # refuses those whose flip_normals differ.
                    diffuse((0.7, 0.3, 0.1) if flipped else (0.8, 0.2, 0.1)),
                    bsdf("roughconductor", string("material", "Al"), number("alpha", 0.25)),
                ),
            )
            for x, angle, flipped in ((-1.05, 25, False), (0, 205, False), (1.05, 25, True))
        ],
    )


# Textures ----------------------------------------------------------------------------------------


    yield "spectrum", stage(
        "Spectra: a painted wall of the Cornell box and its lamp, a ramp, and metal by numbers.",
        *three_balls(
            diffuse([f'<spectrum name="reflectance" value="{PAINT}"/>']),
            diffuse(['<spectrum name="reflectance" value="400:0.1, 500:0.3, 600:0.6, 700:0.8"/>']),
            bsdf(
                "conductor",
                ['<spectrum name="eta" value="0.24873"/>'],
                ['<spectrum name="k" value="400:1.9, 500:1.8, 600:3.0, 700:4.0"/>'],
            ),
        ),
        wall(
            "down", (-0.6, 2.4, 0.6), 0.4, 0.4,
            element("emitter", [f'<spectrum name="radiance" value="{LAMP}"/>'], type="area"), diffuse(0),
        ),
    )


def textures():
    yield "bitmap", stage(
        "A picture on a rectangle, a sphere and a mesh with texture coordinates of its own.",
        shape("rectangle", transform(scale(0.48), rotate("y", 10), translate(-1.05, 0.5, 0)), diffuse(picture())),
        shape(
            "sphere",
            transform(scale(0.48), rotate("y", 40), rotate("x", 35), translate(0, 0.5, 0)),
            diffuse(picture(string("filter_type", "nearest"))),
        ),
        shape(
            "obj", string("filename", "fold.obj"),
            transform(translate(1.05, 0.05, 0)),
            bsdf("twosided", diffuse(picture(string("wrap_mode", "mirror"), boolean("raw", True)))),
        ),
    )
    steps = [scale(2), element("rotate", z="1", angle="30"), element("translate", x="0.3", y="0.1")]
    yield "to_uv", stage(
        "A picture whose coordinates are scaled, turned and moved; repeated, mirrored and clamped.",
        *[
            shape(
                "rectangle",
                transform(scale(0.48), translate(x, 0.5, 0)),
                diffuse(picture(string("wrap_mode", wrap), to_uv(*steps))),
            )
            for x, wrap in ((-1.05, "repeat"), (0, "mirror"), (1.05, "clamp"))
        ],
    )
    squares = [rgb("color0", (0.1, 0.2, 0.6)), rgb("color1", (0.9, 0.7, 0.2))]
    yield "checkerboard", stage(
        "Squares on a sphere, a cube, and a mesh without texture coordinates.",
        *three_balls(diffuse(texture("checkerboard", *squares, to_uv(element("scale", x="8", y="4")))))[:1],
        shape(
            "cube",
            transform(scale(0.38), rotate("y", 30), translate(0, 0.4, 0)),
            diffuse(texture("checkerboard", *squares, to_uv(scale(2)))),
        ),
        shape(
            "ply", string("filename", "coarse.ply"),
            transform(scale(0.45), translate(1.05, 0.46, 0)),
            diffuse(texture("checkerboard", *squares)),
        ),
    )
    yield "specular_textures", stage(
        "Textures where a material takes a reflectance other than the diffuse one.",
        *three_balls(
            bsdf("roughconductor", string("material", "Ag"), number("alpha", 0.2), picture(name="specular_reflectance")),
            bsdf("plastic", picture(name="diffuse_reflectance")),
            bsdf("dielectric", texture("checkerboard", to_uv(scale(6)), name="specular_transmittance")),
        ),
        max_depth=8,
        light="sky",
    )


# Materials made of others, and anisotropic ones --------------------------------------------------


def mask(opacity, nested):
    return bsdf("mask", opacity, nested)


def composites():
    metal = bsdf("roughconductor", string("material", "Cu"), number("alpha", 0.3))
    squares = texture("checkerboard", to_uv(element("scale", x="8", y="4")), name="opacity")
    yield "mask", stage(
        "Masks: half of a metal, a chequered diffuse ball, a picture on a sheet.",
        *three_balls(mask(number("opacity", 0.5), metal), mask(squares, bsdf("twosided", diffuse((0.8, 0.3, 0.1))))),
        shape(
            "rectangle",
            transform(scale(0.45), rotate("y", 20), translate(1.05, 0.5, 0)),
            mask(picture(name="opacity"), bsdf("twosided", diffuse((0.2, 0.3, 0.8)))),
        ),
    )
    panes = [
        shape("rectangle", transform(scale(0.45), rotate("y", angle), translate(x, 0.5, 0.3)), material)
        for x, angle, material in (
            (-1.05, 25, bsdf("thindielectric")),
            (0, 0, bsdf("thindielectric", rgb("specular_transmittance", (0.9, 0.5, 0.3)), number("int_ior", 2.2))),
        )
    ]
    yield "thindielectric", stage(
        "Panes of glass, clear and coloured, before a wall; a thin bubble.",
        shape("rectangle", transform(scale(1.6, 0.5, 1), translate(0, 0.5, -0.8)), diffuse((0.6, 0.5, 0.3))),
        *panes,
        shape("sphere", point("center", PLACES[2]), number("radius", 0.45), bsdf("thindielectric")),
    )
    blend = texture("checkerboard", to_uv(element("scale", x="6", y="3")), name="weight")
    yield "blendbsdf", stage(
        "Blends: by a number, by a texture, and of blends.",
        *three_balls(
            bsdf("blendbsdf", number("weight", 0.3), diffuse((0.8, 0.3, 0.1)), metal),
            bsdf("blendbsdf", blend, diffuse((0.2, 0.7, 0.3)), bsdf("roughplastic", number("alpha", 0.2))),
            bsdf(
                "blendbsdf", number("weight", 0.6),
                bsdf("blendbsdf", number("weight", 0.5), diffuse((0.2, 0.3, 0.8)), metal),
                bsdf("roughdielectric", number("alpha", 0.3)),
            ),
        ),
    )
    yield "anisotropic", stage(
        "Roughness that differs along u and v, and varies: on spheres, and on a mesh with smooth normals.",
        *three_balls(
            bsdf(
                "roughconductor", string("material", "Au"), string("distribution", "ggx"),
                number("alpha_u", 0.1), number("alpha_v", 0.5),
            ),
            bsdf("roughdielectric", number("alpha_u", 0.4), number("alpha_v", 0.1)),
        ),
        shape(
            "obj", string("filename", "fold.obj"),
            transform(translate(1.05, 0.05, 0)),
            bsdf(
                "twosided",
                bsdf("roughconductor", picture(boolean("raw", True), name="alpha_u"), number("alpha_v", 0.15)),
            ),
        ),
    )
    bumps = picture(boolean("raw", True), to_uv(scale(2)), name="normalmap")
    yield "normalmap", stage(
        "Normal maps on a sphere, on a sheet, and on a mesh with smooth normals.",
        *three_balls(bsdf("normalmap", bumps, diffuse((0.8, 0.6, 0.4)))),
        shape(
            "rectangle",
            transform(scale(0.45), rotate("y", 20), translate(0, 0.5, 0)),
            bsdf("normalmap", bumps, bsdf("roughconductor", string("material", "Ag"), number("alpha", 0.2))),
        ),
        shape(
            "obj", string("filename", "fold.obj"),
            transform(translate(1.05, 0.05, 0)),
            bsdf("normalmap", bumps, bsdf("twosided", diffuse((0.3, 0.5, 0.8)))),
        ),
    )
    height = picture(boolean("raw", True), to_uv(scale(2)), name="displacement")
    yield "bumpmap", stage(
        "Bump maps on a sphere, on a sheet, and on a mesh with smooth normals.",
        *three_balls(bsdf("bumpmap", height, number("scale", 0.3), diffuse((0.8, 0.6, 0.4)))),
        shape(
            "rectangle",
            transform(scale(0.45), rotate("y", 20), translate(0, 0.5, 0)),
            bsdf(
                "bumpmap", height, number("scale", 0.2),
                bsdf("roughconductor", string("material", "Ag"), number("alpha", 0.2)),
            ),
        ),
        shape(
            "obj", string("filename", "fold.obj"),
            transform(translate(1.05, 0.05, 0)),
            bsdf("bumpmap", height, number("scale", 0.2), bsdf("twosided", diffuse((0.3, 0.5, 0.8)))),
        ),
    )
    yield "principled", stage(
        "Disney's solid materials: metal and clearcoat, sheen and subsurface, glass.",
        *three_balls(
            bsdf(
                "principled", rgb("base_color", (0.8, 0.5, 0.2)), number("roughness", 0.4), number("metallic", 0.7),
                number("anisotropic", 0.6), number("clearcoat", 1), number("clearcoat_gloss", 0.3),
                number("spec_tint", 0.5),
            ),
            bsdf(
                "principled", picture(name="base_color"), number("roughness", 0.7), number("flatness", 0.6),
                number("sheen", 0.8), number("sheen_tint", 0.5), number("specular", 0.8),
            ),
            bsdf(
                "principled", rgb("base_color", (0.6, 0.8, 0.9)), number("roughness", 0.4), number("spec_trans", 0.9),
                number("eta", 1.4),
            ),
        ),
    )
    thin = [
        bsdf("principledthin", rgb("base_color", (0.8, 0.5, 0.2)), number("sheen", 0.5), number("flatness", 0.5)),
        bsdf("principledthin", picture(name="base_color"), number("diff_trans", 1.2)),
        bsdf(
            "principledthin", rgb("base_color", (0.6, 0.8, 0.9)), number("spec_trans", 0.8), number("roughness", 0.5),
            number("eta", 1.4), number("spec_tint", 0.5), number("anisotropic", 0.5),
        ),
    ]
    yield "principledthin", stage(
        "Disney's thin materials: reflection, diffuse transmission, rough transmission.",
        *[
            shape("rectangle", transform(scale(0.45), rotate("y", angle), translate(x, 0.5, 0)), material)
            for x, angle, material in zip((-1.05, 0, 1.05), (20, 150, -20), thin)
        ],
    )


# Emitters ----------------------------------------------------------------------------------------


def emitters():
    objects = [
        *three_balls(diffuse((0.7, 0.5, 0.3)), bsdf("roughplastic", number("alpha", 0.2)))[:2],
        shape("cube", transform(scale(0.38), rotate("y", 30), translate(1.05, 0.39, 0)), diffuse((0.3, 0.6, 0.4))),
    ]

    def lit_by(note, *lights, **more):
        return stage(note, *objects, *lights, light="none", **more)

    yield "point", lit_by(
        "Two point lights: by position, and by transform.",
        element("emitter", point("position", (1, 2.5, 1.5)), rgb("intensity", (9, 8, 6)), type="point"),
        element("emitter", transform(translate(-2, 1, 1)), rgb("intensity", (1, 2, 4)), type="point"),
    )
    yield "directional", lit_by(
        "Two directional lights: by direction, and by transform.",
        element(
            "emitter",
            element("vector", name="direction", x="-1", y="-2", z="-0.8"),
            rgb("irradiance", (2.5, 2.2, 1.6)), type="directional",
        ),
        element(
            "emitter",
            transform(lookat((0, 2, 0), (2, 0, -1))),
            rgb("irradiance", (0.2, 0.4, 0.8)), type="directional",
        ),
    )
    yield "spot", lit_by(
        "Two spots: the edge of one is soft, that of the other sharp.",
        element(
            "emitter",
            transform(lookat((0.5, 2.6, 1.6), (-0.4, 0.2, 0))),
            rgb("intensity", (16, 14, 10)), number("cutoff_angle", 25), type="spot",
        ),
        element(
            "emitter",
            transform(lookat((2, 1.5, 1.5), (0.9, 0.3, 0))),
            rgb("intensity", (2, 5, 9)), number("cutoff_angle", 18), number("beam_width", 17), type="spot",
        ),
    )
    yield "projector", lit_by(
        "A projector without an image: a square of light.",
        element(
            "emitter",
            transform(lookat((0.6, 2.6, 2.0), (0, 0.3, 0), (0.3, 1, 0))),
            rgb("irradiance", (2.5, 2.2, 1.6)), number("scale", 1.2), number("fov", 40), type="projector",
        ),
    )
    yield "constant", lit_by(
        "The same radiance from everywhere.",
        element("emitter", rgb("radiance", (0.7, 0.8, 1)), type="constant"),
    )
    yield "envmap", lit_by("A turned environment.", sky(1.5, turn((0.36, 0.8, 0.48), 70)))
    yield "envmap_seen", stage(
        "The environment as the camera sees it, with a mirror in it.",
        bsdf("conductor", string("material", "none"), id="Mirror"),
        sphere((0, 1.2, 0), 1.0, material="Mirror"),
        eye=camera((0, 1.2, 4), (0, 1.2, 0), 80),
        light="sky",
    )
    black = diffuse(0)
    yield "area", lit_by(
        "Area lights on a sphere, a cube and a mesh.",
        shape("sphere", point("center", (-1.2, 2, 0.5)), number("radius", 0.3), area((6, 5, 4)), black),
        shape("cube", transform(scale(0.2, 0.1, 0.3), turn((0.6, 0.8, 0), 30), translate(1, 1.9, 0.8)), area((3, 6, 4)), black),
        # Flat: Mitsuba lets an emitter's shading normals decide which side shines, not the surface.
        shape(
            "ply", string("filename", "coarse.ply"), boolean("face_normals", True),
            transform(scale(0.2, 0.3, 0.2), translate(0.1, 1.7, -0.6)), area((3, 4, 8)), black,
        ),
    )
    yield "area_texture", lit_by(
        "Area lights with a picture: on a sphere, and on a rectangle.",
        shape(
            "sphere",
            transform(rotate("x", 40), translate(-1.2, 1.9, 0.5)),
            number("radius", 0.4),
            element("emitter", picture(name="radiance"), type="area"), black,
        ),
        shape(
            "rectangle",
            transform(scale(1, 0.8, 1), rotate("x", 70), translate(0.4, 2.2, 0.3)),
            element("emitter", picture(name="radiance"), type="area"), black,
        ),
    )
    yield "area_sides", stage(
        "Which side shines: plain, flipped, mirrored, mirrored and flipped.",
        *[
            shape(
                "rectangle",
                boolean("flip_normals", True) if flipped else None,
                transform(scale(0.3 * mirrored, 0.3, 0.3), rotate("y", 20), rotate("x", 60), translate(x, 0.8, z)),
                area(colour), black,
            )
            for x, z, flipped, mirrored, colour in (
                (-1.1, 0.3, False, 1, (4, 1, 1)), (-0.4, -0.5, True, 1, (1, 4, 1)),
                (0.4, 0.3, False, -1, (1, 1, 4)), (1.1, -0.5, True, -1, (3, 3, 1)),
            )
        ],
        light="none",
    )
    yield "area_inside", lit_by(
        "Lit from within: a sphere with flipped normals that holds the whole stage, and a mirrored mesh.",
        shape("sphere", boolean("flip_normals", True), point("center", (0, 1, 0)), number("radius", 6), area((0.5, 0.6, 0.7)), black),
        shape("ply", string("filename", "coarse.ply"), boolean("face_normals", True), transform(scale(-0.25, 0.25, 0.25), translate(0.5, 1.6, -0.3)), area((5, 4, 2)), black),
    )


# Shapes, normals, transforms ---------------------------------------------------------------------


def shapes():
    coarse = string("filename", "coarse.ply")
    yield "normals", stage(
        "A coarse mesh: with its own normals, with flat faces, and with computed normals.",
        bsdf("diffuse", rgb("reflectance", 0.7), id="Chalk"),
        shape("ply", coarse, transform(scale(0.45), translate(*PLACES[0])), material="Chalk"),
        shape("ply", coarse, boolean("face_normals", True), transform(scale(0.45), translate(*PLACES[1])), material="Chalk"),
        shape("ply", string("filename", "bare.ply"), transform(scale(0.45), translate(*PLACES[2])), material="Chalk"),
    )
    yield "glass_normals", stage(
        "The same in glass.",
        bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1), id="Glass"),
        shape("ply", coarse, transform(scale(0.45), translate(*PLACES[0])), material="Glass"),
        shape("ply", coarse, boolean("face_normals", True), transform(scale(0.45), translate(*PLACES[1])), material="Glass"),
        shape("ply", string("filename", "bare.ply"), transform(scale(0.45), translate(*PLACES[2])), material="Glass"),
        light="sky",
        max_depth=8,
    )
    yield "flipped_glass", stage(
        "Glass with flipped normals, which is air in glass: a sphere, a cube and a mesh.",
        bsdf("dielectric", number("int_ior", 1.3), number("ext_ior", 1), id="Glass"),
        shape("sphere", boolean("flip_normals", True), point("center", PLACES[0]), number("radius", 0.45), material="Glass"),
        shape("cube", boolean("flip_normals", True), transform(scale(0.35), rotate("y", 30), translate(*PLACES[1])), material="Glass"),
        shape("ply", coarse, boolean("flip_normals", True), transform(scale(0.45), translate(*PLACES[2])), material="Glass"),
        light="sky",
        max_depth=8,
    )
    yield "mirrored", stage(
        "Shapes under mirroring transforms, in glass and in one-sided paint.",
        bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1), id="Glass"),
        shape("cube", transform(scale(-0.35, 0.35, 0.35), rotate("y", 30), translate(*PLACES[0])), material="Glass"),
        shape("ply", coarse, boolean("face_normals", True), transform(scale(0.45, 0.45, -0.45), translate(*PLACES[1])), diffuse((0.7, 0.4, 0.2))),
        shape("rectangle", transform(scale(-0.45, 0.45, 1), rotate("y", -20), translate(*PLACES[2])), diffuse(picture())),
        light="sky",
        max_depth=8,
    )
    yield "transforms", stage(
        "Chains of transforms in every notation.",
        bsdf("diffuse", picture(), id="Picture"),
        shape(
            "cube",
            transform(
                scale(0.3, 0.2, 0.4), turn((0.48, 0.64, 0.6), 50), translate(0.1, 0.2, -0.1),
                element("rotate", z="1", angle="-20"), scale(1.3), translate(-1.05, 0.4, 0),
            ),
            material="Picture",
        ),
        shape(
            "rectangle",
            transform(scale(0.5), matrix(0.8, 0.3, 0, 0, -0.2, 0.9, 0.4, 0.6, 0.1, -0.5, 0.8, 0, 0, 0, 0, 1)),
            material="Picture",
        ),
        shape(
            "sphere",
            number("radius", 0.3), point("center", (0.1, 0, 0)),
            transform(scale(1.5), lookat((1.05, 0.5, 0), (2, 1.5, 2), (0.2, 1, 0))),
            material="Picture",
        ),
    )
    yield "cylinder", stage(
        "Cylinders: painted outside and inside, of metal, in glass; one that shines.",
        shape(
            "cylinder",
            transform(scale(0.4, 0.4, 0.8), rotate("x", -90), rotate("z", 10), translate(-1.05, 0, 0)),
            bsdf("twosided", diffuse(picture())),
        ),
        shape(
            "cylinder",
            point("p0", (0, 0.02, 0.2)), point("p1", (0.2, 0.7, -0.2)), number("radius", 0.3),
            bsdf("twosided", bsdf("roughconductor", string("material", "Au"), number("alpha", 0.2))),
        ),
        shape(
            "cylinder",
            boolean("flip_normals", True), point("p0", (1.05, 0.02, 0)), point("p1", (1.05, 0.6, 0)), number("radius", 0.3),
            diffuse((0.2, 0.3, 0.8)),
        ),
        shape(
            "cylinder",
            point("p0", (-0.6, 1.5, 0.3)), point("p1", (0.6, 1.6, 0.1)), number("radius", 0.06),
            area((4, 6, 8)), diffuse(0),
        ),
    )
    yield "disk", stage(
        "Disks: a picture, an ellipse of one-sided paint from behind and before, and one that shines.",
        shape("disk", transform(scale(0.45), rotate("y", 25), translate(*PLACES[0])), diffuse(picture())),
        shape(
            "disk", boolean("flip_normals", True),
            transform(scale(0.45, 0.25, 1), rotate("y", 150), translate(*PLACES[1])), diffuse((0.7, 0.4, 0.2)),
        ),
        shape("disk", transform(scale(0.3, 0.45, 1), rotate("y", 150), translate(*PLACES[2])), diffuse((0.2, 0.7, 0.3))),
        shape("disk", transform(scale(0.4), rotate("x", 100), translate(0.2, 1.8, 0.4)), area((6, 5, 3)), diffuse(0)),
    )
    yield "instances", stage(
        "A group of shapes, placed three times.",
        shape(
            "shapegroup",
            sphere((0, 0, 0), 0.2, diffuse((0.8, 0.3, 0.1))),
            shape("cube", transform(scale(0.15), translate(0, 0.35, 0)), diffuse(picture())),
            name="Group",
        ),
        shape("instance", element("ref", id="Group"), transform(rotate("z", 20), translate(*PLACES[0]))),
        shape("instance", element("ref", id="Group"), transform(scale(1.4), rotate("y", 40), translate(*PLACES[1]))),
        shape("instance", element("ref", id="Group"), transform(rotate("x", 50), translate(*PLACES[2]))),
    )
    yield "in_glass", stage(
        "Things in glass: paint in a ball, metal in a cube, a ball of glass in a ball of water.",
        bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1), id="Glass"),
        *three_balls(
            bsdf("dielectric"),
            bsdf("dielectric"),
            bsdf("dielectric", string("int_ior", "water"), string("ext_ior", "air")),
        )[::2],
        sphere(PLACES[0], 0.25, diffuse((0.8, 0.3, 0.1))),
        shape("cube", transform(scale(0.4), rotate("y", 20), translate(*PLACES[1])), material="Glass"),
        sphere(PLACES[1], 0.25, bsdf("roughconductor", string("material", "Au"), number("alpha", 0.3))),
        sphere(PLACES[2], 0.25, bsdf("dielectric", number("int_ior", 1.5), string("ext_ior", "water"))),
        light="sky",
        max_depth=12,
    )


# Cameras -----------------------------------------------------------------------------------------


def cameras():
    objects = [
        *three_balls(diffuse((0.8, 0.3, 0.1)), diffuse((0.2, 0.7, 0.3)), diffuse((0.2, 0.3, 0.8))),
        shape(
            "rectangle",
            transform(scale(1.6, 1.2, 1), translate(0, 1.2, -1.5)),
            diffuse(texture("checkerboard", to_uv(element("scale", x="4", y="3")))),
        ),
    ]

    def seen_by(note, eye, **values):
        return stage(note, *objects, eye=eye, light="lamp", max_depth=3, **values)

    yield "camera", seen_by(
        "The field of view along another axis; rolled, with a near and a far plane.",
        camera(
            EYE, TARGET, FOV, number("near_clip", 4.0), number("far_clip", 5.6),
            fov_axis="$fov_axis", up=(0.3, 1, 0.1),
        ),
        fov_axis="x",
    )
    yield "thinlens", seen_by(
        "A wide aperture, focused on the ball in the middle.",
        camera(EYE, TARGET, FOV, lens=(0.25, 4.0)),
    )
    yield "orthographic", seen_by(
        "Parallel rays: no perspective.",
        camera((0.8, 2.2, 4.2), (0, 0.7, 0), None, width=4.2, up=(0.2, 1, 0)),
    )
    yield "principal_point", seen_by(
        "A shifted film.",
        camera(
            EYE, TARGET, FOV,
            number("principal_point_offset_x", 0.15), number("principal_point_offset_y", -0.25),
        ),
    )
    yield "hidden", stage(
        "Emitters that the camera does not see: an area light before the objects, and the sky behind them.",
        *objects,
        # Behind it only meshes: Mitsuba 3.9 takes the distance beyond a hidden emitter for the whole distance,
        # and shades spheres there at wrong places.
        shape("sphere", point("center", (-0.5, 1.65, 0.8)), number("radius", 0.25), area((4, 3, 5)), diffuse(0.5)),
        method=[boolean("hide_emitters", True)],
        max_depth=4,
    )
    yield "tent", seen_by(
        "A tent filter.", camera(EYE, TARGET, FOV, rfilter=("tent", number("radius", 1.5)))
    )
    yield "gaussian", seen_by(
        "A Gaussian filter.", camera(EYE, TARGET, FOV, rfilter=("gaussian", number("stddev", 0.7)))
    )


# Files that the scenes use -----------------------------------------------------------------------


def write_png(path, rows):
    """8-bit RGB, stored without compression so that the bytes do not depend on a library's version."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width = len(rows), len(rows[0])
    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(raw, 0))
        + chunk(b"IEND", b"")
    )


def write_hdr(path, rows):
    """Radiance RGBE with plain scanlines; the values here are exact in it."""
    data = bytearray()
    for row in rows:
        for pixel in row:
            exponent = math.frexp(max(pixel))[1]
            data += bytes(int(value * 256 / 2**exponent) for value in pixel) + bytes([exponent + 128])
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {len(rows)} +X {len(rows[0])}\n"
    path.write_bytes(header.encode("ascii") + bytes(data))


def picture_rows():
    """A letter F on a gradient, so that no turn or reflection looks like another."""
    letter = ["........", ".#####..", ".#......", ".####...", ".#......", ".#......"]
    return [
        [(230, 210, 60) if mark == "#" else (20 + 25 * x, 40 + 30 * y, 120) for x, mark in enumerate(line)]
        for y, line in enumerate(letter)
    ]


def sky_rows():
    """Blue above, brown below, red to one side and a bright patch."""
    rows = []
    for y in range(8):
        row = []
        for x in range(16):
            base = (0.25, 0.375, 0.625) if y < 4 else (0.25, 0.1875, 0.125)
            side = 0.5 if 3 <= x < 6 else 0.0
            row.append((base[0] + side, base[1], base[2]) if (x, y) not in ((10, 1), (11, 1)) else (4.0, 3.75, 3.0))
        rows.append(row)
    return rows


FOLD = """# Two quads that meet at an edge, with texture coordinates beyond the unit square.
v -0.45 0 0
v 0 0 0.25
v 0.45 0 0
v -0.45 0.9 0
v 0 0.9 0.25
v 0.45 0.9 0
vt -0.5 0
vt 0.5 0
vt 1.5 0
vt -0.5 1.5
vt 0.5 1.5
vt 1.5 1.5
f 1/1 2/2 5/5 4/4
f 2/2 3/3 6/6 5/5
"""


def coarse_ball():
    """A unit sphere of few triangles with the normals of the sphere."""
    profile = []
    for row in range(6):
        angle = math.pi * row / 5
        radius, y = math.sin(angle), math.cos(angle)
        profile.append((radius if 0 < row < 5 else 0.0, y, radius, y))
    return revolution(profile, 8)


def main():
    FOLDER.mkdir(exist_ok=True)
    write_png(FOLDER / "picture.png", picture_rows())
    write_hdr(FOLDER / "sky.hdr", sky_rows())
    (FOLDER / "fold.obj").write_text(FOLD, encoding="ascii", newline="\n")
    write_ply(FOLDER / "coarse.ply", coarse_ball())
    write_ply(FOLDER / "bare.ply", coarse_ball(), normals=False)
    for family in (materials, textures, composites, emitters, shapes, cameras):
        for name, text in family():
            (FOLDER / f"{name}.xml").write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
