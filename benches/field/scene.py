"""A scene in the common subset of the three programs: triangles, five materials, three kinds of light.

`load` reads one of Metrolight's scenes with Mitsuba's parser and converts it to this subset:

- Every shape becomes triangles in world space; analytic spheres are not used. Spheres that do not emit light are
  finely tessellated and have smooth normals. Spheres that emit light are coarse and flat-shaded, with the area of the
  true sphere, so that they have its power.
- Plastics become diffuse with the same diffuse reflectance: LuxCore has a different plastic model.
- A smooth conductor becomes a mirror with its reflectance at normal incidence: LuxCore has no smooth conductor.
- Rough conductors and rough glass have the GGX distribution, which all three have.

Lengths, radiance and intensity are in the units of the scene (W/m^2/sr and W/sr if it is physical), colours in linear
RGB.
"""

from dataclasses import dataclass, field
from pathlib import Path

import mitsuba as mi
import numpy as np

from meshes import Mesh, cube, from_file, rectangle, sphere
from problem import Problem

# Mitsuba's default values.
DEFAULT_REFLECTANCE = (0.5, 0.5, 0.5)
DEFAULT_ROUGHNESS = 0.1

# Number of rows of triangles from pole to pole.
SPHERE_ROWS = 64
LAMP_ROWS = 12


@dataclass(frozen=True)
class Checkerboard:
    """`color0` where both or neither of u and v are in the upper half of a period, else `color1`."""

    color0: tuple
    color1: tuple
    periods: tuple


@dataclass(frozen=True)
class Material:
    """`kind` is `diffuse`, `mirror`, `glass`, `rough_metal` or `rough_glass`."""

    kind: str
    reflectance: tuple | Checkerboard | None = None
    two_sided: bool = False
    int_ior: float = 1.0
    ext_ior: float = 1.0
    # Roughness of GGX, and a metal's complex index of refraction eta + ik in R, G and B.
    alpha: float = 0.0
    eta: tuple | None = None
    k: tuple | None = None


@dataclass(frozen=True)
class Surface:
    mesh: Mesh
    material: Material
    # Radiance on the side of the normal, None if it does not emit light.
    radiance: tuple | None


@dataclass(frozen=True)
class Camera:
    """`to_world` has the columns left, up, forward, position; angles are in degrees."""

    to_world: np.ndarray
    x_fov: float
    width: int
    height: int
    aperture_radius: float
    focus_distance: float


@dataclass
class Scene:
    name: str
    camera: Camera
    surfaces: list = field(default_factory=list)
    # Pairs of position and intensity.
    points: list = field(default_factory=list)
    # Radiance of a constant environment.
    sky: tuple | None = None

    def has_rough_materials(self):
        return any(surface.material.kind.startswith("rough") for surface in self.surfaces)


def load(path, longer_side):
    """Loads the scene file `path`, with the film scaled such that its longer side has `longer_side` pixels."""
    path = Path(path)
    mi.set_variant("scalar_rgb")
    state = mi.parser.parse_file(mi.parser.ParserConfig("scalar_rgb"), str(path))
    reader = _Reader(state, path)
    return reader.scene(path.parent.name, longer_side)


class _Reader:
    """Traverses the nodes that Mitsuba's parser makes from a file."""

    def __init__(self, state, path):
        self.nodes = state.nodes
        self.by_id = dict(state.id_to_index)
        self.path = path

    def scene(self, name, longer_side):
        nodes = self._children(self.nodes[0].props)
        kinds = [(node, str(node.type).rsplit(".", 1)[-1]) for node in nodes]
        cameras = [node.props for node, kind in kinds if kind == "Sensor"]
        if len(cameras) != 1:
            raise self._error(f"one sensor is required, found {len(cameras)}")
        scene = Scene(name, self._camera(cameras[0], longer_side))
        for node, kind in kinds:
            if kind == "Shape":
                scene.surfaces.append(self._surface(node.props))
            elif kind == "Emitter":
                self._add_emitter(scene, node.props)
        return scene

    def _error(self, problem):
        return Problem(f"{self.path}: {problem}")

    def _child(self, value):
        """The node to which a property refers, None if it refers to none."""
        if isinstance(value, mi.Properties.ResolvedReference):
            return self.nodes[value.index()]
        if isinstance(value, mi.Properties.Reference):
            return self.nodes[self.by_id[value.id()]]
        return None

    def _children(self, props):
        found = (self._child(props[key]) for key in props.keys())
        return [node for node in found if node is not None]

    def _camera(self, props, longer_side):
        if props.get("fov_axis", "x") != "x":
            raise self._error("fov_axis must be x")
        film = next(node.props for node in self._children(props) if node.props.plugin_name() == "hdrfilm")
        width, height = film["width"], film["height"]
        scale = longer_side / max(width, height)
        thin_lens = props.plugin_name() == "thinlens"
        return Camera(
            to_world=np.array(props["to_world"].matrix, dtype=float),
            x_fov=props["fov"],
            width=round(width * scale),
            height=round(height * scale),
            aperture_radius=props["aperture_radius"] if thin_lens else 0.0,
            focus_distance=props["focus_distance"] if thin_lens else 0.0,
        )

    def _surface(self, props):
        material, radiance = None, None
        for node in self._children(props):
            if node.props.plugin_name() == "area":
                radiance = _triple(node.props["radiance"])
            else:
                material = self._material(node.props)
        if material is None:
            raise self._error(f"shape {props.id()!r} has no bsdf")
        return Surface(self._mesh(props, radiance is not None), material, radiance)

    def _mesh(self, props, emits):
        kind = props.plugin_name()
        to_world = np.eye(4)
        if "to_world" in props:
            to_world = np.array(props["to_world"].matrix, dtype=float)
        if np.linalg.det(to_world[:3, :3]) <= 0:
            raise self._error(f"shape {props.id()!r} is mirrored")
        if kind == "rectangle":
            return rectangle().transformed(to_world)
        if kind == "cube":
            return cube().transformed(to_world)
        if kind == "ply":
            return from_file(self.path.parent / props["filename"]).transformed(to_world)
        if kind == "sphere":
            ball = sphere(LAMP_ROWS).flat_with_area(4 * np.pi) if emits else sphere(SPHERE_ROWS)
            return ball.scaled(props["radius"]).moved(np.array(props["center"])).transformed(to_world)
        raise self._error(f"shape {kind!r} is not in the common subset")

    def _material(self, props, two_sided=False):
        kind = props.plugin_name()
        if kind == "twosided":
            return self._material(self._children(props)[0].props, two_sided=True)
        if kind == "diffuse":
            return Material("diffuse", self._reflectance(props, "reflectance"), two_sided)
        if kind in ("plastic", "roughplastic"):
            return Material("diffuse", self._reflectance(props, "diffuse_reflectance"), two_sided)
        if kind in ("dielectric", "roughdielectric"):
            inside, outside = (_ior(props, name) for name in ("int_ior", "ext_ior"))
            if kind == "dielectric":
                return Material("glass", int_ior=inside, ext_ior=outside)
            return Material("rough_glass", int_ior=inside, ext_ior=outside, alpha=_alpha(props))
        if kind in ("conductor", "roughconductor"):
            if "specular_reflectance" in props and set(_triple(props["specular_reflectance"])) != {1.0}:
                raise self._error("specular_reflectance other than 1 is not in the common subset")
            eta, k = _metal(props["material"])
            if kind == "conductor":
                return Material("mirror", _normal_reflectance(eta, k), two_sided)
            return Material("rough_metal", None, two_sided, alpha=_alpha(props), eta=eta, k=k)
        raise self._error(f"bsdf {kind!r} is not in the common subset")

    def _reflectance(self, props, name):
        if name not in props:
            return DEFAULT_REFLECTANCE
        node = self._child(props[name])
        if node is None:
            return _triple(props[name])
        texture = node.props
        if texture.plugin_name() != "checkerboard":
            raise self._error(f"texture {texture.plugin_name()!r} is not in the common subset")
        matrix = np.array(texture["to_uv"].matrix)
        periods = (float(matrix[0, 0]), float(matrix[1, 1]))
        return Checkerboard(_triple(texture["color0"]), _triple(texture["color1"]), periods)

    def _add_emitter(self, scene, props):
        kind = props.plugin_name()
        if kind == "point":
            scene.points.append((_triple(props["position"]), _triple(props["intensity"])))
        elif kind == "constant":
            scene.sky = _triple(props["radiance"])
        else:
            raise self._error(f"emitter {kind!r} is not in the common subset")


def _triple(value):
    return tuple(float(v) for v in np.array(value))


def _alpha(props):
    return props.get("alpha", DEFAULT_ROUGHNESS)


# Mitsuba's named indices of refraction (its ior.h), as far as the scenes use them.
_IOR = {"air": 1.000277, "water": 1.3330}


def _ior(props, name):
    value = props[name]
    return _IOR[value] if isinstance(value, str) else float(value)


def _metal(name):
    """Mitsuba's eta and k of a metal in R, G and B."""
    bsdf = mi.load_dict({"type": "roughconductor", "material": name})
    params = mi.traverse(bsdf)
    return _triple(params["eta.value"]), _triple(params["k.value"])


def _normal_reflectance(eta, k):
    """The Fresnel reflectance at normal incidence."""
    return tuple(((n - 1) ** 2 + x**2) / ((n + 1) ** 2 + x**2) for n, x in zip(eta, k))
