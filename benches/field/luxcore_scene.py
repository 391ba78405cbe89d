"""Writes a scene as LuxCore properties: lines `name = value ...`.

The conventions of LuxCore were taken from its sources (src/slg) and checked by rendering; where it matters, the source
file is named.
"""

import math

from scene import Checkerboard


def write(scene, directory):
    """Writes `scene.scn` into `directory`, which holds the meshes of `mitsuba_scene.write`."""
    lines = _camera(scene.camera)
    for index, surface in enumerate(scene.surfaces):
        lines += _material(f"m{index}", surface)
        lines += [
            f'scene.shapes.s{index}.type = "mesh"',
            f'scene.shapes.s{index}.ply = "{directory / f"{index}.ply"}"',
            f'scene.objects.o{index}.shape = "s{index}"',
            f'scene.objects.o{index}.material = "m{index}"',
        ]
    for index, (position, intensity) in enumerate(scene.points):
        light = f"scene.lights.p{index}"
        lines += [
            f'{light}.type = "point"',
            f"{light}.position = {_numbers(position)}",
            # LuxCore's value is the flux over all directions.
            *_light_color(light, [4 * math.pi * value for value in intensity]),
        ]
    if scene.sky is not None:
        lines += ['scene.lights.sky.type = "constantinfinite"', *_light_color("scene.lights.sky", scene.sky)]
    path = directory / "scene.scn"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _numbers(values):
    return " ".join(repr(float(value)) for value in values)


def _light_color(light, color):
    return [f"{light}.color = {_numbers(color)}", f"{light}.gain = 1 1 1", f"{light}.power = 0"]


def _camera(camera):
    """The screen window is one row of pixels lower than the film. LuxCore's camera rays pass through `height - y - 1` where
    y is continuous (cameras/perspective.cpp), which is one row too high."""
    _, up, forward, position = camera.to_world[:3].T
    half_height = camera.height / camera.width
    row = 2 * half_height / camera.height
    window = (-1, 1, -half_height - row, half_height - row)
    return [
        'scene.camera.type = "perspective"',
        f"scene.camera.lookat.orig = {_numbers(position)}",
        f"scene.camera.lookat.target = {_numbers(position + forward)}",
        f"scene.camera.up = {_numbers(up)}",
        f"scene.camera.fieldofview = {camera.x_fov!r}",
        f"scene.camera.screenwindow = {_numbers(window)}",
        "scene.camera.autofocus.enable = 0",
        f"scene.camera.lensradius = {camera.aperture_radius!r}",
        f"scene.camera.focaldistance = {camera.focus_distance!r}",
    ]


def _material(name, surface):
    material, key = surface.material, f"scene.materials.{name}"
    lines = {
        "diffuse": lambda: [f'{key}.type = "matte"', *_diffuse(name, material.reflectance)],
        "mirror": lambda: [f'{key}.type = "mirror"', f"{key}.kr = {_numbers(material.reflectance)}"],
        "glass": lambda: [f'{key}.type = "glass"', *_glass(key, material)],
        "rough_glass": lambda: [
            f'{key}.type = "roughglass"',
            *_glass(key, material),
            *_roughness(key, material),
        ],
        "rough_metal": lambda: [
            f'{key}.type = "metal2"',
            f"{key}.n = {_numbers(material.eta)}",
            f"{key}.k = {_numbers(material.k)}",
            *_roughness(key, material),
        ],
    }[material.kind]()
    if surface.radiance is not None:
        lines += [
            f"{key}.emission = {_numbers(surface.radiance)}",
            f"{key}.emission.gain = 1 1 1",
            f"{key}.emission.power = 0",
            # By default, next event estimation is disabled for lamps of more than 256 triangles.
            f'{key}.emission.directlightsampling.type = "ENABLED"',
        ]
    return lines


def _diffuse(name, reflectance):
    key = f"scene.materials.{name}.kd"
    if not isinstance(reflectance, Checkerboard):
        return [f"{key} = {_numbers(reflectance)}"]
    # The squares have side 1 in LuxCore and 1/2 in Mitsuba.
    texture = f"scene.textures.{name}"
    scale = [2 * period for period in reflectance.periods]
    return [
        f'{texture}.type = "checkerboard2d"',
        f"{texture}.texture1 = {_numbers(reflectance.color0)}",
        f"{texture}.texture2 = {_numbers(reflectance.color1)}",
        f'{texture}.mapping.type = "uvmapping2d"',
        f"{texture}.mapping.uvscale = {_numbers(scale)}",
        f'{key} = "{name}"',
    ]


def _glass(key, material):
    return [
        f"{key}.kr = 1 1 1",
        f"{key}.kt = 1 1 1",
        f"{key}.interiorior = {material.int_ior!r}",
        f"{key}.exteriorior = {material.ext_ior!r}",
    ]


def _roughness(key, material):
    """Schlick's distribution, with r the product of both roughnesses, equals GGX with alpha^2 = r."""
    return [f"{key}.uroughness = {material.alpha!r}", f"{key}.vroughness = {material.alpha!r}"]
