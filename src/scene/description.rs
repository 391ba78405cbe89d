//! A scene as plain data, in the units of its file and with transforms in f64: what a loader
//! produces and [`SceneDescription::build`] makes ready to render.

use glam::{DMat4, DVec3};

use super::{Material, Texture, TriangleMesh};
use crate::film::Filter;
use crate::math::Rgb;
use crate::sampling::distribution::MAX_OUTCOMES;

/// Everything that a scene file says.
#[derive(Debug)]
pub struct SceneDescription {
    /// The sensor.
    pub camera: CameraDescription,
    /// Size of the image and its reconstruction filter.
    pub film: FilmSettings,
    /// How long paths may be.
    pub depth: DepthLimits,
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
}

/// Limits on path length, in Mitsuba 3's sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthLimits {
    /// Greatest number of edges of a path: 1 shows emitters alone, 2 adds direct light; `None` for
    /// no limit.
    pub max_depth: Option<u32>,
    /// Number of edges from which on Russian roulette may end a subpath.
    pub rr_depth: u32,
}

/// A perspective camera: pinhole, or thin lens.
#[derive(Clone, Debug)]
pub struct CameraDescription {
    /// Camera to world: looks along +z, +y is up and +x to the left of the image, as in Mitsuba.
    pub to_world: DMat4,
    /// Horizontal field of view in degrees, for the whole width of the film.
    pub fov_x: f64,
    /// Distance along the viewing axis before which nothing is seen.
    pub near_clip: f64,
    /// Distance along the viewing axis beyond which nothing is seen.
    pub far_clip: f64,
    /// `None` for a pinhole.
    pub lens: Option<ThinLens>,
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
    /// How messages call it: its id or, without one, its type and place in the file.
    pub name: String,
    /// In its own coordinates.
    pub geometry: ShapeGeometry,
    /// Its own coordinates to the world's.
    pub to_world: DMat4,
    /// Turn normals (and with them an area emitter's bright side) around.
    pub flip_normals: bool,
    /// Index into [`SceneDescription::materials`].
    pub material: u32,
    /// Radiance of an area emitter on its front side, W/(m^2 sr); `None` for none.
    pub emission: Option<Rgb>,
}

/// The form of a surface.
#[derive(Debug)]
pub enum ShapeGeometry {
    /// Triangles; rectangles and cubes are meshes too.
    Mesh(TriangleMesh),
    /// A true sphere; its transform may not shear or scale it unevenly.
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
    /// A point that shines equally in all directions.
    Point {
        /// Place in the world.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// Parallel light from infinitely far.
    Directional {
        /// Direction in which the light travels, any length.
        direction: DVec3,
        /// Irradiance on a plane that faces the light, W/m^2.
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
        /// Rows from the pole +y down; linear radiance.
        pixels: Vec<[f32; 3]>,
        /// Factor on all pixels.
        scale: f32,
        /// Environment to world; only its rotation counts.
        to_world: DMat4,
    },
}

/// Why a description cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A transform that has no inverse, or numbers that are not finite.
    #[error("{name}: the transform is singular or not finite")]
    SingularTransform {
        /// Shape or sensor.
        name: String,
    },
    /// A sensor or emitter so far away, or so large or strong, beside the shapes that squares of its
    /// numbers are out of range.
    #[error("{name}: beside shapes of this size its place, size or strength is beyond all numbers")]
    OutOfRange {
        /// Sensor or emitter.
        name: String,
    },
    /// A sphere under shear or uneven scale.
    #[error(
        "{name}: a sphere can be moved, turned and evenly scaled, but not stretched or sheared"
    )]
    StretchedSphere {
        /// The sphere.
        name: String,
    },
    /// An environment under shear or uneven scale.
    #[error("an envmap emitter can be turned and mirrored, but not stretched or sheared")]
    StretchedEnvironment,
    /// An environment image that cannot be wrapped around the scene.
    #[error(
        "the image of an envmap emitter must have at least 2 columns and 2 rows of pixels, and no \
         more than {most} of either",
        most = MAX_OUTCOMES
    )]
    EnvironmentSize,
    /// A surface that emits but has no area.
    #[error("{name}: an area emitter needs a surface with area, and this one has none")]
    EmitterWithoutArea {
        /// The shape.
        name: String,
    },
    /// A mesh that emits, of more triangles than random numbers can tell apart.
    #[error("{name}: an area emitter can have at most {most} triangles; split the mesh")]
    EmitterOfTooManyTriangles {
        /// The shape.
        name: String,
        /// How many there can be.
        most: usize,
    },
    /// A place that cannot be computed with.
    #[error(
        "{name}: coordinates reach {coordinate:e}; they must be below {largest:e} in size. Choose a \
         larger unit of length, or leave out what is so far away"
    )]
    TooLarge {
        /// Shape, emitter or sensor.
        name: String,
        /// Its largest coordinate, in the units of the scene file.
        coordinate: f64,
        /// What it must stay below.
        largest: f64,
    },
    /// A scene whose extent cannot be computed with.
    #[error(
        "the scene is too small: all shapes fit into a sphere of radius {radius:e}, which must be at \
         least {smallest:e}. Choose a smaller unit of length"
    )]
    TooSmall {
        /// Of the bounding sphere of all shapes, in the units of the scene file.
        radius: f64,
        /// The least that it may be.
        smallest: f64,
    },
    /// Nothing gives light.
    #[error(
        "the scene has no emitter: add an area, point, directional, constant or envmap emitter"
    )]
    NoEmitter,
    /// More than one emitter that surrounds the scene.
    #[error(
        "the scene has more than one environment emitter (constant or envmap); one is possible"
    )]
    SecondEnvironment,
}
