//! Builds a scene from its description. World coordinates are converted to scene units once and in f64,
//! so that neither the scale of a scene nor its distance from the origin costs precision.

use std::f32::consts::PI;

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3A};

use super::camera::Camera;
use super::geometry::{Geometry, GeometryBuilder, ShapeSurface};
use super::light::{
    AreaEmitter, DirectionalEmitter, Emitter, Emitters, Environment, EnvironmentMap, PointEmitter,
    Profile,
};
use super::{
    Casters, EmitterDescription, MAX_DISTANCE, Radiance, SCENE_RADIUS, Scene, SceneDescription,
    SceneError, ShapeDescription, ShapeGeometry, Texture, TriangleMesh,
};
use crate::math::{Frame, Rgb};
use crate::sampling::distribution::MAX_OUTCOMES;

/// Relative deviation from a similarity transform that the rounding of numbers in a scene file may
/// cause.
const SIMILARITY_TOLERANCE: f64 = 1e-4;

/// Upper bound on the absolute value of coordinates, and lower bound on the radius of the scene, both in
/// the unit of length of the scene file. A scene unit is then between 1e-15 and 1e12 of these: intensities
/// over its square are within the range of f32, and nothing that is computed in f64 overflows.
const MAX_COORDINATE: f64 = 1e15;
const MIN_RADIUS: f64 = 1e-12;

impl SceneDescription {
    /// The scene, ready to be rendered. Materials and textures are taken as they are.
    ///
    /// # Errors
    /// If a transform is singular, or stretches a sphere or environment; if an area emitter has no area
    /// or too many triangles; if an environment image has a wrong size; if there is no emitter, or more
    /// than one environment; if coordinates are too large or the scene is too small.
    pub fn build(self) -> Result<Scene, SceneError> {
        for shape in &self.shapes {
            check_transform(shape)?;
        }
        check_coordinates(&self)?;
        let units = Units::of(&self.shapes)?;
        let aspect = f64::from(self.film.width) / f64::from(self.film.height);
        let camera = Camera::new(&self.camera, aspect, units.center, units.unit)?;
        let texture = |radiance| match radiance {
            Radiance::Constant(radiance) => Texture::Constant(radiance),
            Radiance::Texture(index) => self.textures[index as usize].clone(),
        };
        let emissions: Vec<Option<Texture>> = self
            .shapes
            .iter()
            .map(|s| s.emission.map(texture))
            .collect();
        let mut geometry = GeometryBuilder::default();
        for shape in self.shapes {
            add_shape(shape, &units, &mut geometry);
        }
        let geometry = geometry.build();
        let mut emitters = area_emitters(&geometry, emissions)?;
        for emitter in self.emitters {
            emitters.push(build_emitter(emitter, &units)?);
        }
        let mut materials = self.materials;
        for material in &mut materials {
            material.scale_lengths(units.unit.recip() as f32);
        }
        let casters = Casters::new(&geometry, &materials);
        let emitters = Emitters::new(emitters, geometry.shape_count(), casters.bounds())?;
        Ok(Scene {
            camera,
            casters,
            emitters,
            geometry,
            materials,
            textures: self.textures,
            film: self.film,
            depth: self.depth,
            hide_emitters: self.hide_emitters,
            unit: units.unit,
            center: units.center,
        })
    }
}

/// The conversion of world coordinates to scene units: p becomes (p - `center`) / `unit`.
struct Units {
    center: DVec3,
    unit: f64,
}

impl Units {
    /// The units in which the bounding sphere of the shapes has its centre at the origin and the radius
    /// [`SCENE_RADIUS`]. A scene without extent keeps the units of its file.
    fn of(shapes: &[ShapeDescription]) -> Result<Self, SceneError> {
        let mut min = DVec3::INFINITY;
        let mut max = DVec3::NEG_INFINITY;
        for shape in shapes {
            for_each_bounding_sphere(shape, |center, radius| {
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
            for_each_bounding_sphere(shape, |point, radius| {
                bounding_radius = bounding_radius.max(point.distance(center) + radius);
            });
        }
        if bounding_radius == 0.0 {
            return Ok(Self { center, unit: 1.0 });
        }
        if bounding_radius < MIN_RADIUS {
            return Err(SceneError::TooSmall {
                radius: bounding_radius,
                min: MIN_RADIUS,
            });
        }
        let unit = bounding_radius / f64::from(SCENE_RADIUS);
        Ok(Self { center, unit })
    }

    /// World coordinates to scene units.
    fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }

    /// The transform of a shape's own coordinates to scene units.
    fn shape_to_scene(&self, to_world: &DMat4) -> DMat4 {
        DMat4::from_scale(DVec3::splat(1.0 / self.unit))
            * DMat4::from_translation(-self.center)
            * *to_world
    }
}

/// Calls `visit` with spheres, in world coordinates, that together bound the shape; points are spheres of
/// radius 0.
fn for_each_bounding_sphere(shape: &ShapeDescription, mut visit: impl FnMut(DVec3, f64)) {
    match &shape.geometry {
        ShapeGeometry::Mesh(mesh) => {
            // Only vertices of triangles: an unused vertex must not shrink the scene.
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

/// Checks that the coordinates of shapes, emitters and the sensor are below [`MAX_COORDINATE`].
fn check_coordinates(description: &SceneDescription) -> Result<(), SceneError> {
    let check = |name: &str, coordinate: f64| {
        // Not `>=`, so that NaN is an error too.
        if coordinate < MAX_COORDINATE {
            return Ok(());
        }
        Err(SceneError::TooLarge {
            name: name.into(),
            coordinate,
            limit: MAX_COORDINATE,
        })
    };
    for shape in &description.shapes {
        let mut largest: f64 = 0.0;
        for_each_bounding_sphere(shape, |center, radius| {
            let reach = center.abs().max_element() + radius;
            largest = largest.max(if reach.is_nan() { f64::INFINITY } else { reach });
        });
        check(&shape.name, largest)?;
    }
    for emitter in &description.emitters {
        match emitter {
            EmitterDescription::Point { position, .. }
            | EmitterDescription::Spot { position, .. } => {
                check("point emitter", position.abs().max_element())?;
            }
            EmitterDescription::Projector { to_world, .. } => {
                let position = to_world.w_axis.truncate();
                check("projector emitter", position.abs().max_element())?;
            }
            EmitterDescription::Directional { .. }
            | EmitterDescription::Constant { .. }
            | EmitterDescription::Environment { .. } => {}
        }
    }
    let camera = description.camera.to_world.w_axis.truncate();
    check("sensor", camera.abs().max_element())
}

/// Checks that the transform of a shape has an inverse, and that the transform of a sphere is a
/// similarity.
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

/// The orthogonal matrix of which `linear` is a positive multiple; `None` if there is none.
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
    let to_scene = units.shape_to_scene(&shape.to_world);
    match shape.geometry {
        ShapeGeometry::Mesh(mesh) => {
            let mesh = transform_mesh(mesh, &to_scene);
            geometry.add_mesh(name, material, flip_normals, mesh);
        }
        ShapeGeometry::Sphere { center, radius } => {
            // A negative radius reflects the sphere in its centre, as in Mitsuba.
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

/// The shapes that emit, as emitters; `emissions` are the radiances of all shapes.
fn area_emitters(
    geometry: &Geometry,
    emissions: Vec<Option<Texture>>,
) -> Result<Vec<Emitter>, SceneError> {
    let surfaces = geometry.surfaces(|shape| emissions[shape as usize].is_some());
    let mut emitters = Vec::new();
    for ((shape, surface), emission) in (0..).zip(surfaces).zip(emissions) {
        let Some(radiance) = emission else { continue };
        let name = || geometry.shape_name(shape).to_owned();
        if let ShapeSurface::Triangles(triangles) = &surface
            && triangles.len() > MAX_OUTCOMES
        {
            return Err(SceneError::EmitterOfTooManyTriangles {
                name: name(),
                max: MAX_OUTCOMES,
            });
        }
        let light = AreaEmitter::new(radiance, surface)
            .ok_or_else(|| SceneError::EmitterWithoutArea { name: name() })?;
        emitters.push(Emitter::Area { light, shape });
    }
    Ok(emitters)
}

/// The mesh in scene units, its normals of unit length.
fn transform_mesh(mut mesh: TriangleMesh, to_scene: &DMat4) -> TriangleMesh {
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
fn build_emitter(emitter: EmitterDescription, units: &Units) -> Result<Emitter, SceneError> {
    Ok(match emitter {
        EmitterDescription::Point {
            position,
            intensity,
        } => point_emitter(
            "point emitter",
            position,
            intensity,
            Profile::Uniform,
            units,
        )?,
        EmitterDescription::Spot {
            position,
            direction,
            intensity,
            beam_width,
            cutoff_angle,
        } => {
            let profile = Profile::Spot {
                frame: Frame::from_normal(unit_vector("spot emitter", direction)?),
                beam: beam_width.to_radians() as f32,
                cutoff: cutoff_angle.to_radians() as f32,
            };
            point_emitter("spot emitter", position, intensity, profile, units)?
        }
        EmitterDescription::Projector {
            to_world,
            fov,
            irradiance,
        } => {
            let axis = |axis| unit_vector("projector emitter", to_world.transform_vector3(axis));
            let profile = Profile::Projector {
                right: axis(DVec3::X)?,
                up: axis(DVec3::Y)?,
                forward: axis(DVec3::Z)?,
                half_extent: Vec2::splat((0.5 * fov.to_radians()).tan() as f32),
            };
            let position = to_world.transform_point3(DVec3::ZERO);
            let intensity = irradiance * PI;
            point_emitter("projector emitter", position, intensity, profile, units)?
        }
        EmitterDescription::Directional {
            direction,
            irradiance,
        } => Emitter::Directional(DirectionalEmitter {
            direction: unit_vector("directional emitter", direction)?,
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

/// A point emitter in scene units.
fn point_emitter(
    name: &str,
    position: DVec3,
    intensity: Rgb,
    profile: Profile,
    units: &Units,
) -> Result<Emitter, SceneError> {
    let position = units.point(position).as_vec3a();
    // The irradiance I/d^2 does not depend on the unit of d.
    let intensity = (intensity.as_dvec3() / (units.unit * units.unit)).as_vec3a();
    if !(position.length() < MAX_DISTANCE && intensity.is_finite()) {
        let name = name.into();
        return Err(SceneError::OutOfRange { name });
    }
    Ok(Emitter::Point(PointEmitter {
        position,
        intensity,
        profile,
    }))
}

/// `vector` with length 1.
fn unit_vector(name: &str, vector: DVec3) -> Result<Vec3A, SceneError> {
    let unit = vector.try_normalize();
    unit.map(|v| v.as_vec3a())
        .ok_or_else(|| SceneError::SingularTransform { name: name.into() })
}

#[cfg(test)]
mod tests;
