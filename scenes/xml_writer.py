"""Mitsuba 3 scene files as nested lists of lines, written the way one would write them by hand."""


def element(tag, *children, **attributes):
    """An element; children are elements (lists of lines) or None, which is left out."""
    words = [tag] + [f'{name}="{value}"' for name, value in attributes.items()]
    lines = [line for child in children if child for line in child]
    if not lines:
        return [f"<{' '.join(words)}/>"]
    return [f"<{' '.join(words)}>", *("    " + line for line in lines), f"</{tag}>"]


def comment(text):
    """A comment on a line of its own."""
    return [f"<!-- {text} -->"]


def fmt(value):
    """A number in its shortest form; a string, such as $name, as it is."""
    return value if isinstance(value, str) else f"{value:.6g}"


def triple(values):
    """Numbers separated by commas."""
    return ", ".join(fmt(value) for value in values)


def number(name, value):
    return element("float", name=name, value=fmt(value))


def integer(name, value):
    return element("integer", name=name, value=value)


def string(name, value):
    return element("string", name=name, value=value)


def boolean(name, value):
    return element("boolean", name=name, value="true" if value else "false")


def rgb(name, value):
    """A colour: one number for grey, three, or the name of a parameter."""
    if isinstance(value, str):
        return element("rgb", name=name, value=value)
    return element("rgb", name=name, value=triple(value) if isinstance(value, tuple) else fmt(value))


def vector(name, values):
    x, y, z = values
    return element("vector", name=name, x=fmt(x), y=fmt(y), z=fmt(z))


def point(name, values):
    x, y, z = values
    return element("point", name=name, x=fmt(x), y=fmt(y), z=fmt(z))


def transform(*steps, name="to_world"):
    return element("transform", *steps, name=name) if steps else None


def scale(x, y=None, z=None):
    if y is None:
        return element("scale", value=fmt(x))
    return element("scale", x=fmt(x), y=fmt(y), z=fmt(z))


def rotate(axis, angle):
    return element("rotate", **{axis: "1"}, angle=fmt(angle)) if angle else None


def translate(x, y, z):
    return element("translate", x=fmt(x), y=fmt(y), z=fmt(z))


def matrix(*values):
    return element("matrix", value=" ".join(fmt(value) for value in values))


def lookat(origin, target, up=(0, 1, 0)):
    return element("lookat", origin=triple(origin), target=triple(target), up=triple(up))


def bsdf(kind, *parameters, **attributes):
    return element("bsdf", *parameters, type=kind, **attributes)


def matte(name, reflectance):
    """A named diffuse material, the same on both sides; reflectance is a colour or a texture."""
    colour = reflectance if isinstance(reflectance, list) else rgb("reflectance", reflectance)
    return bsdf("twosided", bsdf("diffuse", colour), id=name)


def checkerboard(color0, color1, u_repeats, v_repeats, name="reflectance"):
    """Squares of two colours; one repeat holds two squares each way."""
    return element(
        "texture",
        rgb("color0", color0),
        rgb("color1", color1),
        transform(element("scale", x=fmt(u_repeats), y=fmt(v_repeats)), name="to_uv"),
        type="checkerboard",
        name=name,
    )


def shape(kind, *children, material=None, name=None):
    """A shape with a reference to a named material; name becomes its id."""
    attributes = {"type": kind} | ({"id": name} if name else {})
    return element("shape", *children, element("ref", id=material) if material else None, **attributes)


def area(radiance):
    return element("emitter", rgb("radiance", radiance), type="area")


def sphere(center, radius, *children, **names):
    return shape("sphere", point("center", center), number("radius", radius), *children, **names)


def ply(filename, *steps, **names):
    return shape("ply", string("filename", filename), transform(*steps), **names)


def box(center, half, *turns, **names):
    """A box from the cube [-1, 1]^3: its half sizes, turned, then moved to its centre."""
    return shape("cube", transform(scale(*half), *turns, translate(*center)), **names)


TURN = {
    "up": ("x", -90), "down": ("x", 90),
    "right": ("y", 90), "left": ("y", -90),
    "forward": ("y", 0), "backward": ("y", 180),
}


def wall(facing, center, half_width, half_height, *children, **names):
    """A rectangle whose normal points up (+y), down, right (+x), left, forward (+z) or backward."""
    placed = transform(scale(half_width, half_height, 1), rotate(*TURN[facing]), translate(*center))
    return shape("rectangle", placed, *children, **names)


def defaults(**values):
    return [line for name, value in values.items() for line in element("default", name=name, value=value)]


def camera(origin, target, fov, *more, fov_axis="x", lens=None, width=None, up=(0, 1, 0), rfilter=("box",)):
    """The sensor with its film; lens is (aperture_radius, focus_distance) of a thin lens, width that of what
    an orthographic camera shows, rfilter the type of the reconstruction filter followed by its parameters."""
    return element(
        "sensor",
        None if width else string("fov_axis", fov_axis),
        None if width else number("fov", fov),
        number("aperture_radius", lens[0]) if lens else None,
        number("focus_distance", lens[1]) if lens else None,
        *more,
        transform(*([scale(width / 2, width / 2, 1)] if width else []), lookat(origin, target, up)),
        element("sampler", integer("sample_count", "$spp"), type="independent"),
        element(
            "film",
            integer("width", "$resx"),
            integer("height", "$resy"),
            element("rfilter", *rfilter[1:], type=rfilter[0]),
            type="hdrfilm",
        ),
        type="orthographic" if width else "thinlens" if lens else "perspective",
    )


def integrator(*parameters):
    return element("integrator", integer("max_depth", "$max_depth"), *parameters, type="$integrator")


def scene(note, values, *sections, method=()):
    """A whole file as text: a note, the parameters with their defaults, and sections of elements; `method`
    are further parameters of the integrator."""
    lines = ['<scene version="3.0.0">']
    lines += ["    " + line for line in comment(note)]
    blocks = [defaults(**values), integrator(*method), *sections]
    for block in blocks:
        lines.append("")
        lines += ["    " + line if line else "" for line in block]
    return "\n".join([*lines, "</scene>", ""])


def section(title, *elements):
    return comment(title) + [line for item in elements if item for line in item]
