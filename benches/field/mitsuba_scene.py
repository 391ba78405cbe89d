"""Writes a scene as Mitsuba's XML, for Mitsuba and Metrolight."""

from scene import Checkerboard

# Paths are terminated by Russian roulette only: see docs/performance.md.
UNLIMITED = -1


def write(scene, directory):
    """Writes `scene.xml` and the meshes `0.ply`, `1.ply`, ... into `directory`, which must exist."""
    for index, surface in enumerate(scene.surfaces):
        surface.mesh.write_ply(directory / f"{index}.ply")
    lines = [
        '<scene version="3.0.0">',
        f'<integrator type="path"><integer name="max_depth" value="{UNLIMITED}"/></integrator>',
        *_sensor(scene.camera),
    ]
    for index, surface in enumerate(scene.surfaces):
        lines += _shape(index, surface)
    for position, intensity in scene.points:
        x, y, z = position
        point = f'<point name="position" x="{x!r}" y="{y!r}" z="{z!r}"/>'
        lines.append(f'<emitter type="point">{point}{_rgb("intensity", intensity)}</emitter>')
    if scene.sky is not None:
        lines.append(f'<emitter type="constant">{_rgb("radiance", scene.sky)}</emitter>')
    path = directory / "scene.xml"
    path.write_text("\n".join([*lines, "</scene>"]), encoding="utf-8")
    return path


def _numbers(values):
    return ", ".join(repr(float(value)) for value in values)


def _rgb(name, color):
    return f'<rgb name="{name}" value="{_numbers(color)}"/>'


def _float(name, value):
    return f'<float name="{name}" value="{float(value)!r}"/>'


def _sensor(camera):
    lens = camera.aperture_radius > 0
    matrix = " ".join(repr(float(value)) for value in camera.to_world.flatten())
    lines = [
        f'<sensor type="{"thinlens" if lens else "perspective"}">',
        '<string name="fov_axis" value="x"/>',
        _float("fov", camera.x_fov),
        f'<transform name="to_world"><matrix value="{matrix}"/></transform>',
    ]
    if lens:
        lines += [
            _float("aperture_radius", camera.aperture_radius),
            _float("focus_distance", camera.focus_distance),
        ]
    film = (
        f'<film type="hdrfilm"><integer name="width" value="{camera.width}"/>'
        f'<integer name="height" value="{camera.height}"/><rfilter type="box"/></film>'
    )
    return [*lines, '<sampler type="independent"/>', film, "</sensor>"]


def _shape(index, surface):
    flat = "true" if surface.mesh.normals is None else "false"
    lines = [
        '<shape type="ply">',
        f'<string name="filename" value="{index}.ply"/><boolean name="face_normals" value="{flat}"/>',
        _bsdf(surface.material),
    ]
    if surface.radiance is not None:
        lines.append(f'<emitter type="area">{_rgb("radiance", surface.radiance)}</emitter>')
    return [*lines, "</shape>"]


def _bsdf(material):
    ggx = '<string name="distribution" value="ggx"/>' + _float("alpha", material.alpha)
    indices = _float("int_ior", material.int_ior) + _float("ext_ior", material.ext_ior)
    bsdf = {
        "diffuse": lambda: f'<bsdf type="diffuse">{_reflectance(material.reflectance)}</bsdf>',
        "mirror": lambda: (
            '<bsdf type="conductor"><string name="material" value="none"/>'
            f'{_rgb("specular_reflectance", material.reflectance)}</bsdf>'
        ),
        "glass": lambda: f'<bsdf type="dielectric">{indices}</bsdf>',
        "rough_glass": lambda: f'<bsdf type="roughdielectric">{ggx}{indices}</bsdf>',
        "rough_metal": lambda: (
            f'<bsdf type="roughconductor">{ggx}{_rgb("eta", material.eta)}{_rgb("k", material.k)}</bsdf>'
        ),
    }[material.kind]()
    return f'<bsdf type="twosided">{bsdf}</bsdf>' if material.two_sided else bsdf


def _reflectance(reflectance):
    if not isinstance(reflectance, Checkerboard):
        return _rgb("reflectance", reflectance)
    u, v = reflectance.periods
    return (
        f'<texture type="checkerboard" name="reflectance">{_rgb("color0", reflectance.color0)}'
        f'{_rgb("color1", reflectance.color1)}<transform name="to_uv">'
        f'<scale x="{float(u)!r}" y="{float(v)!r}"/></transform></texture>'
    )
