//! Scenes in a few words, for tests that need many small ones.

use glam::{DMat4, DVec3, Vec3A};
use metrolight::film::Filter;
use metrolight::math::Rgb;
use metrolight::scene::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material, Scene,
    SceneDescription, ShapeDescription, ShapeGeometry, Texture, TriangleMesh,
};

/// A scene in the making; [`World::build`] makes it ready to render.
pub struct World(pub SceneDescription);

impl World {
    /// An empty world: a pinhole of `fov` degrees at `from` looks at `to`; paths of any length.
    pub fn seen(from: DVec3, to: DVec3, fov: f64, [width, height]: [u32; 2]) -> Self {
        Self(SceneDescription {
            camera: CameraDescription {
                to_world: look_at(from, to),
                fov_x: fov,
                near_clip: 1e-3,
                far_clip: 1e4,
                lens: None,
            },
            film: FilmSettings {
                width,
                height,
                filter: Filter::Box,
            },
            depth: DepthLimits {
                max_depth: None,
                rr_depth: 5,
            },
            textures: Vec::new(),
            materials: Vec::new(),
            shapes: Vec::new(),
            emitters: Vec::new(),
        })
    }

    /// Limits the number of edges of a path.
    pub fn depth(mut self, max_depth: u32) -> Self {
        self.0.depth.max_depth = Some(max_depth);
        self
    }

    fn grey(&mut self, value: f32) -> u32 {
        self.0.textures.push(Texture::Constant(Rgb::splat(value)));
        self.0.textures.len() as u32 - 1
    }

    /// A material, for shapes to refer to.
    pub fn material(&mut self, material: Material) -> u32 {
        self.0.materials.push(material);
        self.0.materials.len() as u32 - 1
    }

    /// Diffuse on the front, black behind.
    pub fn diffuse(&mut self, albedo: f32) -> u32 {
        let reflectance = self.grey(albedo);
        self.material(Material::Diffuse { reflectance })
    }

    /// Diffuse on both sides.
    pub fn diffuse_sheet(&mut self, albedo: f32) -> u32 {
        let reflectance = self.grey(albedo);
        let side = Box::new(Material::Diffuse { reflectance });
        self.material(Material::TwoSided {
            front: side.clone(),
            back: side,
        })
    }

    /// A smooth interface that absorbs nothing; `eta` is the index inside over outside.
    pub fn glass(&mut self, eta: f32) -> u32 {
        let white = self.grey(1.0);
        self.material(Material::Dielectric {
            eta,
            specular_reflectance: white,
            specular_transmittance: white,
        })
    }

    /// As [`World::glass`], rough.
    pub fn rough_glass(&mut self, eta: f32, alpha: f32) -> u32 {
        let white = self.grey(1.0);
        self.material(Material::RoughDielectric {
            distribution: metrolight::scene::MicrofacetDistribution::Ggx,
            alpha,
            eta,
            specular_reflectance: white,
            specular_transmittance: white,
        })
    }

    fn shape(
        &mut self,
        geometry: ShapeGeometry,
        to_world: DMat4,
        material: u32,
    ) -> &mut ShapeDescription {
        let name = format!("shape {}", self.0.shapes.len());
        self.0.shapes.push(ShapeDescription {
            name,
            geometry,
            to_world,
            flip_normals: false,
            material,
            emission: None,
        });
        self.0.shapes.last_mut().expect("it has just been added")
    }

    /// A sphere.
    pub fn sphere(&mut self, center: DVec3, radius: f64, material: u32) -> &mut ShapeDescription {
        let geometry = ShapeGeometry::Sphere { center, radius };
        self.shape(geometry, DMat4::IDENTITY, material)
    }

    /// A mesh.
    pub fn mesh(
        &mut self,
        mesh: TriangleMesh,
        to_world: DMat4,
        material: u32,
    ) -> &mut ShapeDescription {
        self.shape(ShapeGeometry::Mesh(mesh), to_world, material)
    }

    /// A horizontal square of half-width `half` around `center` that faces up.
    pub fn floor(&mut self, center: DVec3, half: f64, material: u32) -> &mut ShapeDescription {
        let to_world = DMat4::from_translation(center)
            * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2)
            * DMat4::from_scale(DVec3::splat(half));
        self.mesh(TriangleMesh::rectangle(), to_world, material)
    }

    /// A horizontal square that faces down.
    pub fn ceiling(&mut self, center: DVec3, half: f64, material: u32) -> &mut ShapeDescription {
        let to_world = DMat4::from_translation(center)
            * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2)
            * DMat4::from_scale(DVec3::splat(half));
        self.mesh(TriangleMesh::rectangle(), to_world, material)
    }

    /// A box of half-widths `half`, parallel to the axes, that faces outward.
    pub fn cube(&mut self, center: DVec3, half: DVec3, material: u32) -> &mut ShapeDescription {
        let to_world = DMat4::from_translation(center) * DMat4::from_scale(half);
        self.mesh(TriangleMesh::cube(), to_world, material)
    }

    /// The same radiance from everywhere.
    pub fn sky(&mut self, radiance: f32) {
        let radiance = Rgb::splat(radiance);
        self.0
            .emitters
            .push(EmitterDescription::Constant { radiance });
    }

    /// Everything made larger by `scale` around the origin, then moved by `offset`; radiances stay.
    pub fn placed(mut self, scale: f64, offset: DVec3) -> Self {
        let transform = DMat4::from_translation(offset) * DMat4::from_scale(DVec3::splat(scale));
        for shape in &mut self.0.shapes {
            shape.to_world = transform * shape.to_world;
        }
        for emitter in &mut self.0.emitters {
            if let EmitterDescription::Point {
                position,
                intensity,
            } = emitter
            {
                *position = transform.transform_point3(*position);
                *intensity *= (scale * scale) as f32;
            }
        }
        let camera = &mut self.0.camera;
        // A camera has no size: its axes stay of unit length.
        camera.to_world =
            transform * camera.to_world * DMat4::from_scale(DVec3::splat(1.0 / scale));
        camera.near_clip *= scale;
        camera.far_clip *= scale;
        if let Some(lens) = &mut camera.lens {
            lens.aperture_radius *= scale;
            lens.focus_distance *= scale;
        }
        self
    }

    /// The scene, which must make sense.
    pub fn build(self) -> Scene {
        self.0.build().expect("a valid scene")
    }
}

/// Makes a shape shine on its front with the same radiance in all channels.
pub fn shine(shape: &mut ShapeDescription, radiance: f32) {
    shape.emission = Some(Vec3A::splat(radiance));
}

/// A camera at `from` that looks at `to`, upright unless it looks straight up or down.
pub fn look_at(from: DVec3, to: DVec3) -> DMat4 {
    let forward = (to - from).normalize();
    let up = if forward.y.abs() > 0.999 {
        DVec3::Z
    } else {
        DVec3::Y
    };
    let left = up.cross(forward).normalize();
    let up = forward.cross(left);
    DMat4::from_cols(
        left.extend(0.0),
        up.extend(0.0),
        forward.extend(0.0),
        from.extend(1.0),
    )
}
