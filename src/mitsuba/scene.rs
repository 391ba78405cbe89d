//! The scene as a whole.

use std::collections::{HashMap, HashSet};

use super::error::{Cause, LoadError, Warning};
use super::object::{Object, Tag};
use super::property::Value;
use super::tree::Tree;
use super::{Overrides, bsdf, emitter, integrator, sensor, shape, texture};
use crate::scene::{
    DepthLimits, EmitterDescription, Material, SceneDescription, ShapeDescription, Texture,
};

/// What has been made of the objects so far.
pub struct Builder<'a> {
    /// Source.
    pub tree: &'a Tree,
    /// Indexed by the materials.
    pub textures: Vec<Texture>,
    /// Indexed by the shapes.
    pub materials: Vec<Material>,
    /// Textures made of objects: object to texture.
    pub texture_of: HashMap<usize, u32>,
    /// Materials made of objects: object to material.
    pub material_of: HashMap<usize, u32>,
    /// Surfaces.
    pub shapes: Vec<ShapeDescription>,
    /// Emitters that are not surfaces.
    pub emitters: Vec<EmitterDescription>,
    /// What is strange.
    pub warnings: &'a mut Vec<Warning>,
}

impl<'a> Builder<'a> {
    /// An object by its index.
    pub fn object(&self, index: usize) -> &'a Object {
        &self.tree.objects[index]
    }

    /// Checks that everything in the object has been used.
    pub fn finish(&self, object: &Object) -> Result<(), LoadError> {
        object.finish(&self.tree.objects)
    }
}

/// The description of the scene that `tree` holds.
pub fn build(
    tree: &Tree,
    overrides: Overrides,
    warnings: &mut Vec<Warning>,
) -> Result<SceneDescription, LoadError> {
    let scene = &tree.objects[0];
    let mut builder = Builder {
        tree,
        textures: Vec::new(),
        materials: Vec::new(),
        texture_of: HashMap::new(),
        material_of: HashMap::new(),
        shapes: Vec::new(),
        emitters: Vec::new(),
        warnings,
    };
    let mut view = None;
    let mut depth = None;
    let mut seen = HashSet::new();
    for property in &scene.properties {
        let Value::Object(index) = property.value else {
            continue;
        };
        property.used.set(true);
        let object = builder.object(index);
        let is_repetition = !seen.insert(index);
        match object.tag {
            Tag::Bsdf => drop(bsdf::material(&mut builder, index)?),
            Tag::Texture => drop(texture::texture(&mut builder, index)?),
            _ if is_repetition => {
                return Err(property.error(Cause::Conflict(format!(
                    "the {} is part of the scene already",
                    object.title()
                ))));
            }
            Tag::Shape => shape::shape(&mut builder, index)?,
            Tag::Emitter => emitter::emitter(&mut builder, index)?,
            Tag::Sensor if view.is_some() => builder.warnings.push(Warning {
                place: Some(object.place.clone()),
                text: "only the first sensor of a scene is used, and this is another".into(),
            }),
            Tag::Sensor => view = Some(sensor::sensor(tree, index, overrides)?),
            Tag::Integrator if depth.is_some() => {
                let problem = "a scene may have one integrator only, and this is another";
                return Err(object.error(Cause::Conflict(problem.into())));
            }
            Tag::Integrator => depth = Some(integrator::depth_limits(&mut builder, index)?),
            Tag::Scene | Tag::Film | Tag::Sampler | Tag::Rfilter => property.used.set(false),
        }
    }
    builder.finish(scene)?;
    let (camera, film) = view.ok_or_else(|| scene.error(Cause::NoSensor))?;
    if builder.emitters.is_empty() && builder.shapes.iter().all(|s| s.emission.is_none()) {
        return Err(scene.error(Cause::NoEmitter));
    }
    Ok(SceneDescription {
        camera,
        film,
        depth: depth.unwrap_or(DepthLimits {
            max_depth: None,
            rr_depth: integrator::DEFAULT_RR_DEPTH,
        }),
        textures: builder.textures,
        materials: builder.materials,
        shapes: builder.shapes,
        emitters: builder.emitters,
    })
}
