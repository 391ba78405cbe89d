//! From a scene's description to the scene: world coordinates to scene units, once and in f64, so
//! that neither the scale of a scene nor its distance from the origin costs precision.

use glam::{DMat3, DMat4, DVec3};

use super::camera::Camera;
use super::geometry::{Geometry, GeometryBuilder, ShapeSurface};
use super::light::{
    AreaEmitter, DirectionalEmitter, Emitter, Emitters, Environment, EnvironmentMap, PointEmitter,
};
use super::{
    EmitterDescription, MAX_DISTANCE, SCENE_RADIUS, Scene, SceneDescription, SceneError,
    ShapeDescription, ShapeGeometry, TriangleMesh,
};
use crate::math::Rgb;
use crate::sampling::distribution::MAX_OUTCOMES;

/// Relative deviation from a similarity that a transform may have by the rounding of its numbers in a
/// scene file.
const SIMILARITY_TOLERANCE: f64 = 1e-4;

/// Coordinates of a scene file stay below this in size and its scene has at least that radius, in
/// its own unit of length. Between them intensities over the square of a scene unit, from 1e-15 to
/// 1e12 in size, are far from the ends of f32, and nothing that is computed in f64 overflows.
const MAX_COORDINATE: f64 = 1e15;
const MIN_RADIUS: f64 = 1e-12;

impl SceneDescription {
    /// The scene, ready to be rendered. Materials and textures are taken as they are.
    ///
    /// # Errors
    /// If a transform is singular, or stretches a sphere or environment; if an area emitter has no
    /// area; if there is no emitter, or more than one environment; if coordinates are too large, or
    /// the scene is too small, for f32.
    pub fn build(self) -> Result<Scene, SceneError> {
        for shape in &self.shapes {
            check_transform(shape)?;
        }
        check_places(&self)?;
        let units = Units::of(&self.shapes)?;
        let aspect = f64::from(self.film.width) / f64::from(self.film.height);
        let camera = Camera::new(&self.camera, aspect, units.center, units.unit)?;
        let emissions: Vec<Option<Rgb>> = self.shapes.iter().map(|s| s.emission).collect();
        let mut geometry = GeometryBuilder::default();
        for shape in self.shapes {
            add_shape(shape, &units, &mut geometry);
        }
        let geometry = geometry.build();
        let mut emitters = area_emitters(&geometry, &emissions)?;
        for emitter in self.emitters {
            emitters.push(place_emitter(emitter, &units)?);
        }
        Ok(Scene {
            camera,
            emitters: Emitters::new(emitters, geometry.shape_count())?,
            geometry,
            materials: self.materials,
            textures: self.textures,
            film: self.film,
            depth: self.depth,
            unit: units.unit,
            center: units.center,
        })
    }
}

/// How world coordinates become scene units: p to (p - `center`) / `unit`.
struct Units {
    center: DVec3,
    unit: f64,
}

impl Units {
    /// Those in which the shapes have a bounding sphere of [`SCENE_RADIUS`] around the origin. A
    /// scene without extent keeps its own units.
    fn of(shapes: &[ShapeDescription]) -> Result<Self, SceneError> {
        let mut min = DVec3::INFINITY;
        let mut max = DVec3::NEG_INFINITY;
        for shape in shapes {
            for_each_extreme(shape, |center, radius| {
                min = min.min(center - radius);
                max = max.max(center + radius);
            });
        }
        let center = if min.cmple(max).all() {
            0.5 * (min + max)
        } else {
            DVec3::ZERO
        };
        let mut bounding_radius: f64 = 0.0;
        for shape in shapes {
            for_each_extreme(shape, |extreme, radius| {
                bounding_radius = bounding_radius.max(extreme.distance(center) + radius);
            });
        }
        if bounding_radius == 0.0 {
            return Ok(Self { center, unit: 1.0 });
        }
        if bounding_radius < MIN_RADIUS {
            return Err(SceneError::TooSmall {
                radius: bounding_radius,
                smallest: MIN_RADIUS,
            });
        }
        let unit = bounding_radius / f64::from(SCENE_RADIUS);
        Ok(Self { center, unit })
    }

    /// World coordinates to scene units.
    fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }

    /// A shape's own coordinates to scene units.
    fn placed(&self, to_world: &DMat4) -> DMat4 {
        DMat4::from_scale(DVec3::splat(1.0 / self.unit))
            * DMat4::from_translation(-self.center)
            * *to_world
    }
}

/// Calls `visit` with spheres in the world (points have radius 0) that together bound the shape.
fn for_each_extreme(shape: &ShapeDescription, mut visit: impl FnMut(DVec3, f64)) {
    match &shape.geometry {
        ShapeGeometry::Mesh(mesh) => {
            // Only what triangles use: a stray vertex must not shrink the scene.
            for &vertex in mesh.triangles.iter().flatten() {
                let p = DVec3::from_array(mesh.positions[vertex as usize].map(f64::from));
                visit(shape.to_world.transform_point3(p), 0.0);
            }
        }
        ShapeGeometry::Sphere { center, radius } => {
            let scale = DMat3::from_mat4(shape.to_world).x_axis.length();
            visit(
                shape.to_world.transform_point3(*center),
                scale * radius.abs(),
            );
        }
    }
}

/// Checks that shapes, emitters and the sensor are at places that can be computed with.
fn check_places(description: &SceneDescription) -> Result<(), SceneError> {
    let check = |name: &str, farthest: f64| {
        // Not a comparison with `>=`: NaN is too large as well.
        if farthest < MAX_COORDINATE {
            return Ok(());
        }
        Err(SceneError::TooLarge {
            name: name.into(),
            coordinate: farthest,
            largest: MAX_COORDINATE,
        })
    };
    for shape in &description.shapes {
        let mut farthest: f64 = 0.0;
        for_each_extreme(shape, |center, radius| {
            let reach = center.abs().max_element() + radius;
            farthest = farthest.max(if reach.is_nan() { f64::INFINITY } else { reach });
        });
        check(&shape.name, farthest)?;
    }
    for emitter in &description.emitters {
        if let EmitterDescription::Point { position, .. } = emitter {
            check("point emitter", position.abs().max_element())?;
        }
    }
    let camera = description.camera.to_world.w_axis.truncate();
    check("sensor", camera.abs().max_element())
}

/// Checks that a shape's transform has an inverse, and is a similarity if the shape is a sphere.
fn check_transform(shape: &ShapeDescription) -> Result<(), SceneError> {
    let name = || shape.name.clone();
    let linear = DMat3::from_mat4(shape.to_world);
    let invertible = linear.determinant() != 0.0 && linear.inverse().is_finite();
    if !(shape.to_world.is_finite() && invertible) {
        return Err(SceneError::SingularTransform { name: name() });
    }
    match &shape.geometry {
        ShapeGeometry::Mesh(_) => Ok(()),
        ShapeGeometry::Sphere { center, radius } => {
            if !center.is_finite() || !radius.is_finite() {
                return Err(SceneError::SingularTransform { name: name() });
            }
            match orthogonal(linear) {
                Some(_) => Ok(()),
                None => Err(SceneError::StretchedSphere { name: name() }),
            }
        }
    }
}

/// The orthogonal matrix that `linear` is a positive multiple of, if it is one.
fn orthogonal(linear: DMat3) -> Option<DMat3> {
    let scale = linear.determinant().abs().cbrt();
    let unit = linear * (1.0 / scale);
    let deviation = (unit.transpose() * unit - DMat3::IDENTITY).to_cols_array();
    let similar = deviation.iter().all(|x| x.abs() <= SIMILARITY_TOLERANCE);
    similar.then_some(unit)
}

fn add_shape(shape: ShapeDescription, units: &Units, geometry: &mut GeometryBuilder) {
    let ShapeDescription {
        name,
        material,
        flip_normals,
        ..
    } = shape;
    let to_scene = units.placed(&shape.to_world);
    match shape.geometry {
        ShapeGeometry::Mesh(mesh) => {
            let mesh = place_mesh(mesh, &to_scene);
            geometry.add_mesh(name, material, flip_normals, mesh);
        }
        ShapeGeometry::Sphere { center, radius } => {
            // A negative radius is a reflection in the centre, as in Mitsuba.
            let linear = DMat3::from_mat4(to_scene) * radius;
            let inward = flip_normals != (linear.determinant() < 0.0);
            let center = to_scene.transform_point3(center).as_vec3a();
            let radius = linear.determinant().abs().cbrt() as f32;
            let to_local = orthogonal(linear).unwrap_or(DMat3::IDENTITY).transpose();
            let to_local = to_local.as_mat3().into();
            geometry.add_sphere(name, material, inward, (center, radius), to_local);
        }
    }
}

/// The shapes that shine; `emissions` are the radiances of all shapes.
fn area_emitters(
    geometry: &Geometry,
    emissions: &[Option<Rgb>],
) -> Result<Vec<Emitter>, SceneError> {
    let surfaces = geometry.surfaces(|shape| emissions[shape as usize].is_some());
    let mut emitters = Vec::new();
    for ((shape, surface), emission) in (0..).zip(surfaces).zip(emissions) {
        let &Some(radiance) = emission else { continue };
        let name = || geometry.shape_name(shape).to_owned();
        if let ShapeSurface::Triangles(triangles) = &surface
            && triangles.len() > MAX_OUTCOMES
        {
            return Err(SceneError::EmitterOfTooManyTriangles {
                name: name(),
                most: MAX_OUTCOMES,
            });
        }
        let light = AreaEmitter::new(radiance, surface)
            .ok_or_else(|| SceneError::EmitterWithoutArea { name: name() })?;
        emitters.push(Emitter::Area { light, shape });
    }
    Ok(emitters)
}

/// The mesh in scene units, its normals of unit length.
fn place_mesh(mut mesh: TriangleMesh, to_scene: &DMat4) -> TriangleMesh {
    for position in &mut mesh.positions {
        let p = DVec3::from_array(position.map(f64::from));
        *position = to_scene.transform_point3(p).as_vec3().to_array();
    }
    let normal_to_scene = DMat3::from_mat4(*to_scene).inverse().transpose();
    for normal in &mut mesh.normals {
        let n = DVec3::from_array(normal.map(f64::from));
        *normal = (normal_to_scene * n)
            .normalize_or_zero()
            .as_vec3()
            .to_array();
    }
    mesh
}

/// An emitter that is not a surface, in scene units.
fn place_emitter(emitter: EmitterDescription, units: &Units) -> Result<Emitter, SceneError> {
    Ok(match emitter {
        EmitterDescription::Point {
            position,
            intensity,
        } => {
            let position = units.point(position).as_vec3a();
            // Irradiance I/d^2 must not change with the unit of d.
            let intensity = (intensity.as_dvec3() / (units.unit * units.unit)).as_vec3a();
            if !(position.length() < MAX_DISTANCE && intensity.is_finite()) {
                let name = "point emitter".into();
                return Err(SceneError::OutOfRange { name });
            }
            Emitter::Point(PointEmitter {
                position,
                intensity,
            })
        }
        EmitterDescription::Directional {
            direction,
            irradiance,
        } => Emitter::Directional(DirectionalEmitter {
            direction: direction
                .try_normalize()
                .ok_or_else(|| SceneError::SingularTransform {
                    name: "directional emitter".into(),
                })?
                .as_vec3a(),
            irradiance,
        }),
        EmitterDescription::Constant { radiance } => {
            Emitter::Environment(Environment::Constant(radiance))
        }
        EmitterDescription::Environment {
            width,
            mut pixels,
            scale,
            to_world,
        } => {
            for pixel in &mut pixels {
                *pixel = (Rgb::from_array(*pixel) * scale).to_array();
            }
            let to_scene = orthogonal(DMat3::from_mat4(to_world))
                .ok_or(SceneError::StretchedEnvironment)?
                .as_mat3()
                .into();
            let map = EnvironmentMap::new(width, pixels).ok_or(SceneError::EnvironmentSize)?;
            Emitter::Environment(Environment::Map { map, to_scene })
        }
    })
}

#[cfg(test)]
mod tests;
