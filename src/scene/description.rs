//! A scene as plain data, in the units of its file and with transforms in f64. A loader produces it, and
//! [`SceneDescription::build`] makes it ready to render.

use glam::{DMat4, DVec2, DVec3};

use super::{Material, Texture, TriangleMesh};
use crate::film::{Crop, Filter};
use crate::math::Rgb;
use crate::sampling::distribution::MAX_OUTCOMES;

/// The content of a scene file.
#[derive(Debug)]
pub struct SceneDescription {
    /// The sensor.
    pub camera: CameraDescription,
    /// Size of the image and its reconstruction filter.
    pub film: FilmSettings,
    /// Limits on the length of paths.
    pub depth: DepthLimits,
    /// Whether the camera sees past emitters: only their light is seen, and what is behind them.
    pub hide_emitters: bool,
    /// Indexed by the materials.
    pub textures: Vec<Texture>,
    /// Indexed by [`ShapeDescription::material`].
    pub materials: Vec<Material>,
    /// Surfaces, emitting or not.
    pub shapes: Vec<ShapeDescription>,
    /// Emitters that are not surfaces.
    pub emitters: Vec<EmitterDescription>,
}

/// Size of the image in pixels and its reconstruction filter.
#[derive(Clone, Debug)]
pub struct FilmSettings {
    /// Pixels in a row.
    pub width: u32,
    /// Pixels in a column.
    pub height: u32,
    /// Reconstruction filter.
    pub filter: Filter,
    /// The part of the image that is kept; `None` for all of it. The whole is rendered: its pixels, of any
    /// method, are those of the part.
    pub crop: Option<Crop>,
}

/// Limits on path length, in Mitsuba 3's sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthLimits {
    /// Maximum number of edges of a path: 1 shows only emitters, 2 adds direct light; `None` for no
    /// limit.
    pub max_depth: Option<u32>,
    /// Number of edges from which Russian roulette may end a subpath.
    pub rr_depth: u32,
}

/// A camera.
#[derive(Clone, Debug)]
pub struct CameraDescription {
    /// Camera to world: the view is along +z, +y is up and +x to the left of the image, as in Mitsuba.
    pub to_world: DMat4,
    /// How it maps directions, or points, to the film.
    pub projection: Projection,
    /// Where the viewing axis meets the film, from its centre: a fraction of its width to the left and of its
    /// height upward. (0, 0) unless the film is shifted.
    pub principal_point_offset: DVec2,
    /// Distance along the viewing axis of the near clipping plane.
    pub near_clip: f64,
    /// Distance along the viewing axis of the far clipping plane.
    pub far_clip: f64,
}

/// How a camera maps the scene to its film.
#[derive(Clone, Copy, Debug)]
pub enum Projection {
    /// By lines through a lens.
    Perspective {
        /// Horizontal field of view in degrees, for the whole width of the film.
        fov_x: f64,
        /// `None` for a pinhole.
        lens: Option<ThinLens>,
    },
    /// By lines parallel to the viewing axis.
    Orthographic {
        /// Half the width and half the height of what the film shows.
        half_extent: DVec2,
    },
}

/// The lens of a camera with depth of field.
#[derive(Clone, Copy, Debug)]
pub struct ThinLens {
    /// Radius of the aperture.
    pub aperture_radius: f64,
    /// Distance along the viewing axis of the plane in focus.
    pub focus_distance: f64,
}

/// One surface.
#[derive(Debug)]
pub struct ShapeDescription {
    /// Its name in messages: its id or, without one, its type and position in the file.
    pub name: String,
    /// In its own coordinates.
    pub geometry: ShapeGeometry,
    /// From its own coordinates to those of the world.
    pub to_world: DMat4,
    /// Whether normals, and with them the emitting side of an area emitter, are reversed.
    pub flip_normals: bool,
    /// Index into [`SceneDescription::materials`].
    pub material: u32,
    /// Radiance on the front side; `None` if the shape does not emit.
    pub emission: Option<Radiance>,
}

/// The radiance of a surface, W/(m^2 sr).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radiance {
    /// The same everywhere.
    Constant(Rgb),
    /// That of a texture: an index into [`SceneDescription::textures`].
    Texture(u32),
}

/// The geometry of a surface.
#[derive(Debug)]
pub enum ShapeGeometry {
    /// Triangles; rectangles and cubes are meshes too.
    Mesh(TriangleMesh),
    /// An exact sphere; its transform must not shear it or scale it non-uniformly.
    Sphere {
        /// Centre in its own coordinates.
        center: DVec3,
        /// Radius in its own coordinates.
        radius: f64,
    },
}

/// An emitter that is not a surface.
#[derive(Debug)]
pub enum EmitterDescription {
    /// A point that emits uniformly in all directions.
    Point {
        /// In world coordinates.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// A point that emits into a cone around its axis.
    Spot {
        /// In world coordinates.
        position: DVec3,
        /// The axis, of any length.
        direction: DVec3,
        /// Radiant intensity within the beam, W/sr.
        intensity: Rgb,
        /// Angle between the axis and the edge of the beam, in degrees. From there on the intensity falls
        /// linearly with the angle.
        beam_width: f64,
        /// Angle at which it is 0, in degrees; at least `beam_width` and below 180.
        cutoff_angle: f64,
    },
    /// A point that lights a square.
    Projector {
        /// Light to world: the light is along +z.
        to_world: DMat4,
        /// Width of the square, as an angle in degrees.
        fov: f64,
        /// Mitsuba's irradiance: what a plane across the axis at distance 1 receives, over pi.
        irradiance: Rgb,
    },
    /// Parallel light from infinity.
    Directional {
        /// Direction in which the light travels, of any length.
        direction: DVec3,
        /// Irradiance on a plane perpendicular to the light, W/m^2.
        irradiance: Rgb,
    },
    /// The same radiance from every direction.
    Constant {
        /// W/(m^2 sr).
        radiance: Rgb,
    },
    /// Radiance by direction, from a latitude-longitude image in Mitsuba's orientation.
    Environment {
        /// Width of the image in pixels.
        width: usize,
        /// Linear radiance, in rows from the pole +y down.
        pixels: Vec<[f32; 3]>,
        /// Factor on all pixels.
        scale: f32,
        /// Environment to world; only its rotation and reflection matter.
        to_world: DMat4,
    },
}

/// The reasons why a description cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A transform without an inverse, or numbers that are not finite.
    #[error("{name}: the transform is singular or not finite")]
    SingularTransform {
        /// Shape, emitter or sensor.
        name: String,
    },
    /// A sensor or emitter whose distance, size or intensity overflows f32 in scene units, or whose
    /// square does.
    #[error(
        "{name}: its distance, size or intensity overflows single precision relative to the size of the \
         shapes. Move it closer, or leave it out"
    )]
    OutOfRange {
        /// Sensor or emitter.
        name: String,
    },
    /// A sphere under shear or non-uniform scale.
    #[error(
        "{name}: a sphere can be translated, rotated and scaled uniformly, but not stretched or sheared"
    )]
    StretchedSphere {
        /// The sphere.
        name: String,
    },
    /// An environment under shear or non-uniform scale.
    #[error("an envmap emitter can be rotated and reflected, but not stretched or sheared")]
    StretchedEnvironment,
    /// An environment image that is too small or too large.
    #[error(
        "the image of an envmap emitter must have at least 2 columns and 2 rows of pixels, and at most \
         {max} of each",
        max = MAX_OUTCOMES
    )]
    EnvironmentSize,
    /// A surface that emits but has no area.
    #[error("{name}: the surface of an area emitter must have positive area")]
    EmitterWithoutArea {
        /// The shape.
        name: String,
    },
    /// A mesh that emits and has more triangles than random numbers can choose between.
    #[error("{name}: an area emitter can have at most {max} triangles; split the mesh")]
    EmitterOfTooManyTriangles {
        /// The shape.
        name: String,
        /// The maximum number of triangles.
        max: usize,
    },
    /// Coordinates that are too large to compute with.
    #[error(
        "{name}: coordinates reach {coordinate:e}; they must be below {limit:e} in absolute value. Use a \
         larger unit of length, or remove distant objects"
    )]
    TooLarge {
        /// Shape, emitter or sensor.
        name: String,
        /// Its largest coordinate, in the units of the scene file.
        coordinate: f64,
        /// The value that it must stay below.
        limit: f64,
    },
    /// A scene that is too small to compute with.
    #[error(
        "the scene is too small: the bounding sphere of all shapes has radius {radius:e}, which must be at \
         least {min:e}. Use a smaller unit of length"
    )]
    TooSmall {
        /// Radius of the bounding sphere of all shapes, in the units of the scene file.
        radius: f64,
        /// Its minimum.
        min: f64,
    },
    /// No emitter.
    #[error(
        "the scene has no emitter: add an area, point, directional, constant or envmap emitter"
    )]
    NoEmitter,
    /// More than one environment emitter.
    #[error(
        "the scene has more than one environment emitter (constant or envmap); remove all but one"
    )]
    SecondEnvironment,
}
