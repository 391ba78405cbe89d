//! Small scenes in code: a builder, shapes, lights and a camera.

use glam::{DMat4, DVec2, DVec3};
use metrolight::film::Filter;
use metrolight::math::Rgb;
use metrolight::scene::{
    CameraDescription, DepthLimits, EmitterDescription, FilmSettings, Material,
    MicrofacetDistribution, Projection, Radiance, Roughness, Scene, SceneDescription,
    ShapeDescription, ShapeGeometry, Texture, ThinLens, TriangleMesh,
};

/// A scene under construction: fields to fill in, and methods that add to them. By default it is empty,
/// and a pinhole at the origin looks along +z.
pub struct SceneBuilder {
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub shapes: Vec<ShapeDescription>,
    pub emitters: Vec<EmitterDescription>,
    /// Greatest number of edges of a path.
    pub depth: Option<u32>,
    /// Horizontal field of view in degrees.
    pub fov_x: f64,
    /// Camera to world.
    pub camera: DMat4,
    pub near_clip: f64,
    pub far_clip: f64,
    pub lens: Option<ThinLens>,
    /// Width and height in pixels.
    pub film: [u32; 2],
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self {
            materials: vec![],
            textures: vec![],
            shapes: vec![],
            emitters: vec![],
            depth: None,
            fov_x: 45.0,
            camera: DMat4::IDENTITY,
            near_clip: 1e-3,
            far_clip: 1e4,
            lens: None,
            film: [6, 4],
        }
    }
}

impl SceneBuilder {
    /// An empty scene seen from `from` toward `to`, upright unless the view is vertical.
    pub fn seen(from: DVec3, to: DVec3, fov_x: f64, film: [u32; 2]) -> Self {
        let is_vertical = (to - from).normalize().y.abs() > 0.999;
        let up = if is_vertical { DVec3::Z } else { DVec3::Y };
        Self {
            camera: look_at(from, to, up),
            fov_x,
            film,
            ..Self::default()
        }
    }

    /// Limits the number of edges of a path.
    pub fn depth(mut self, max_depth: u32) -> Self {
        self.depth = Some(max_depth);
        self
    }

    /// Adds a grey texture.
    fn grey(&mut self, value: f32) -> u32 {
        self.textures.push(Texture::Constant(Rgb::splat(value)));
        self.textures.len() as u32 - 1
    }

    /// Adds a material, for shapes to refer to.
    pub fn material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Adds a material that is diffuse on the front and black on the back.
    pub fn diffuse(&mut self, albedo: f32) -> u32 {
        let reflectance = self.grey(albedo);
        self.material(Material::Diffuse { reflectance })
    }

    /// Adds a material that is diffuse on both sides.
    pub fn diffuse_sheet(&mut self, albedo: f32) -> u32 {
        let reflectance = self.grey(albedo);
        let side = Box::new(Material::Diffuse { reflectance });
        self.material(Material::TwoSided {
            front: side.clone(),
            back: side,
        })
    }

    /// Adds a smooth dielectric without absorption; `eta` is the index inside over outside.
    pub fn glass(&mut self, eta: f32) -> u32 {
        let white = self.grey(1.0);
        self.material(Material::Dielectric {
            eta,
            specular_reflectance: white,
            specular_transmittance: white,
        })
    }

    /// As [`Self::glass`], rough.
    pub fn rough_glass(
        &mut self,
        distribution: MicrofacetDistribution,
        eta: f32,
        alpha: f32,
    ) -> u32 {
        let white = self.grey(1.0);
        self.material(Material::RoughDielectric {
            distribution,
            roughness: Roughness::Constant(alpha),
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
        let name = format!("shape {}", self.shapes.len());
        self.shapes.push(ShapeDescription {
            name,
            geometry,
            to_world,
            flip_normals: false,
            material,
            emission: None,
        });
        self.shapes.last_mut().expect("it has just been added")
    }

    /// Adds a sphere.
    pub fn sphere(&mut self, center: DVec3, radius: f64, material: u32) -> &mut ShapeDescription {
        let geometry = ShapeGeometry::Sphere { center, radius };
        self.shape(geometry, DMat4::IDENTITY, material)
    }

    /// Adds a mesh.
    pub fn mesh(
        &mut self,
        mesh: TriangleMesh,
        to_world: DMat4,
        material: u32,
    ) -> &mut ShapeDescription {
        self.shape(ShapeGeometry::Mesh(mesh), to_world, material)
    }

    /// Adds a horizontal square of half-width `half` around `center` that faces up.
    pub fn floor(&mut self, center: DVec3, half: f64, material: u32) -> &mut ShapeDescription {
        let to_world = DMat4::from_translation(center)
            * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2)
            * DMat4::from_scale(DVec3::splat(half));
        self.mesh(TriangleMesh::rectangle(), to_world, material)
    }

    /// As [`Self::floor`], facing down.
    pub fn ceiling(&mut self, center: DVec3, half: f64, material: u32) -> &mut ShapeDescription {
        let to_world = DMat4::from_translation(center)
            * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2)
            * DMat4::from_scale(DVec3::splat(half));
        self.mesh(TriangleMesh::rectangle(), to_world, material)
    }

    /// Adds an axis-aligned box of half-widths `half` that faces outward.
    pub fn cube(&mut self, center: DVec3, half: DVec3, material: u32) -> &mut ShapeDescription {
        let to_world = DMat4::from_translation(center) * DMat4::from_scale(half);
        self.mesh(TriangleMesh::cube(), to_world, material)
    }

    /// Adds constant environment light.
    pub fn sky(&mut self, radiance: f32) {
        let radiance = Rgb::splat(radiance);
        self.emitters
            .push(EmitterDescription::Constant { radiance });
    }

    /// Scales the scene by `scale` around the origin, then moves it by `offset`; radiances are unchanged.
    pub fn placed(mut self, scale: f64, offset: DVec3) -> Self {
        let transform = DMat4::from_translation(offset) * DMat4::from_scale(DVec3::splat(scale));
        for shape in &mut self.shapes {
            shape.to_world = transform * shape.to_world;
        }
        for emitter in &mut self.emitters {
            if let EmitterDescription::Point {
                position,
                intensity,
            } = emitter
            {
                *position = transform.transform_point3(*position);
                *intensity *= (scale * scale) as f32;
            }
        }
        // The camera's axes keep unit length.
        self.camera = transform * self.camera * DMat4::from_scale(DVec3::splat(1.0 / scale));
        self.near_clip *= scale;
        self.far_clip *= scale;
        if let Some(lens) = &mut self.lens {
            lens.aperture_radius *= scale;
            lens.focus_distance *= scale;
        }
        self
    }

    /// The scene as data.
    pub fn description(self) -> SceneDescription {
        let [width, height] = self.film;
        SceneDescription {
            camera: CameraDescription {
                to_world: self.camera,
                projection: Projection::Perspective {
                    fov_x: self.fov_x,
                    lens: self.lens,
                },
                principal_point_offset: DVec2::ZERO,
                near_clip: self.near_clip,
                far_clip: self.far_clip,
            },
            film: FilmSettings {
                width,
                height,
                filter: Filter::Box,
                crop: None,
            },
            depth: DepthLimits {
                max_depth: self.depth,
                rr_depth: 5,
            },
            hide_emitters: false,
            textures: self.textures,
            materials: self.materials,
            shapes: self.shapes,
            emitters: self.emitters,
        }
    }

    /// The scene, which must be valid.
    pub fn build(self) -> Scene {
        self.description().build().expect("a valid scene")
    }
}

/// A sphere of material 0 that faces outward.
pub fn sphere(center: DVec3, radius: f64) -> ShapeDescription {
    ShapeDescription {
        name: "sphere".into(),
        geometry: ShapeGeometry::Sphere { center, radius },
        to_world: DMat4::IDENTITY,
        flip_normals: false,
        material: 0,
        emission: None,
    }
}

/// A parallelogram of material 0: `corner` + [0, 1] `a` + [0, 1] `b`, facing along a x b.
pub fn parallelogram(corner: DVec3, a: DVec3, b: DVec3) -> ShapeDescription {
    let positions = [corner, corner + a, corner + a + b, corner + b];
    ShapeDescription {
        name: "parallelogram".into(),
        geometry: ShapeGeometry::Mesh(TriangleMesh {
            positions: positions.map(|p| p.as_vec3().to_array()).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..TriangleMesh::default()
        }),
        to_world: DMat4::IDENTITY,
        flip_normals: false,
        material: 0,
        emission: None,
    }
}

/// A square of material 0 in the plane y = 0, centred at the origin and facing up.
pub fn floor(half_side: f64) -> ShapeDescription {
    parallelogram(
        DVec3::new(-half_side, 0.0, half_side),
        DVec3::X * (2.0 * half_side),
        DVec3::NEG_Z * (2.0 * half_side),
    )
}

/// The unit sphere as a mesh of 2n x n patches, without normals.
pub fn sphere_mesh(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let count = 2 * n;
    for j in 0..=n {
        for i in 0..count {
            let theta = std::f64::consts::PI * f64::from(j) / f64::from(n);
            let phi = std::f64::consts::TAU * f64::from(i) / f64::from(count);
            let p = DVec3::new(
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            );
            mesh.positions.push(p.as_vec3().to_array());
            let at = |j: u32, i: u32| j * count + i % count;
            if j < n {
                mesh.triangles
                    .push([at(j, i), at(j + 1, i + 1), at(j + 1, i)]);
                mesh.triangles
                    .push([at(j, i), at(j, i + 1), at(j + 1, i + 1)]);
            }
        }
    }
    mesh
}

/// Makes a shape emit the same radiance in all channels on its front.
pub fn emit(shape: &mut ShapeDescription, radiance: f32) {
    shape.emission = Some(Radiance::Constant(Rgb::splat(radiance)));
}

/// A camera at `eye` that looks at `target`.
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let forward = (target - eye).normalize();
    let left = up.cross(forward).normalize();
    DMat4::from_cols(
        left.extend(0.0),
        forward.cross(left).extend(0.0),
        forward.extend(0.0),
        eye.extend(1.0),
    )
}

/// A texture of one grey value.
pub fn grey(value: f64) -> Texture {
    Texture::Constant(Rgb::splat(value as f32))
}
