//! `scene`: assembles the objects of all kinds.

use std::collections::HashSet;

use super::builder::{Builder, Overrides};
use super::error::{Cause, LoadError, Located, Warning};
use super::texture::Range;
use super::xml::{Tag, Tree, Value};
use super::{bsdf, emitter, integrator, sensor, shape, texture};
use crate::scene::SceneDescription;

/// Builds the scene from the objects of `tree`.
pub fn build(
    tree: &Tree,
    overrides: Overrides,
    warnings: &mut Vec<Warning>,
) -> Result<SceneDescription, LoadError> {
    let mut builder = Builder::new(tree, overrides, warnings);
    let scene = builder.object(0);
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
            Tag::Texture => drop(texture::texture(&mut builder, index, Range::Any)?),
            _ if is_repetition => {
                let title = object.title();
                return Err(property.conflict(format!("the {title} is already part of the scene")));
            }
            Tag::Shape => shape::shape(&mut builder, index)?,
            Tag::Emitter => emitter::emitter(&mut builder, index)?,
            Tag::Sensor if view.is_some() => builder.warnings.push(
                object.warning("only the first sensor of a scene is used; this one is ignored"),
            ),
            Tag::Sensor => view = Some(sensor::sensor(&builder, index)?),
            Tag::Integrator if depth.is_some() => {
                return Err(object.conflict("a scene may have only one integrator"));
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
        depth: depth.unwrap_or(integrator::DEFAULT_DEPTH_LIMITS),
        textures: builder.textures,
        materials: builder.materials,
        shapes: builder.shapes,
        emitters: builder.emitters,
    })
}
