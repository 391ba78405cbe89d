//! `scene`: assembles the objects of all kinds.

use std::collections::HashSet;

use super::builder::{Builder, Overrides};
use super::error::{Cause, LoadError, Located, Warning};
use super::texture::Range;
use super::xml::{Property, Tag, Tree, Value};
use super::{bsdf, emitter, integrator, sensor, shape, texture};
use crate::math::Rgb;
use crate::scene::{CameraDescription, EmitterDescription, FilmSettings, SceneDescription};

/// The objects of which a scene has one each.
#[derive(Default)]
struct Single {
    sensor: Option<Option<(CameraDescription, FilmSettings)>>,
    integrator: Option<integrator::Settings>,
}

/// Builds the scene from the objects of `tree`.
pub fn build(
    tree: &Tree,
    overrides: Overrides,
    warnings: &mut Vec<Warning>,
) -> Result<SceneDescription, LoadError> {
    let mut builder = Builder::new(tree, overrides, warnings);
    let scene = builder.object(0);
    let mut single = Single::default();
    let mut seen = HashSet::new();
    for property in &scene.properties {
        if let Value::Object(index) = property.value {
            property.used.set(true);
            let is_repetition = !seen.insert(index);
            let added = add(&mut builder, &mut single, index, property, is_repetition);
            builder.faults.check(added);
        }
    }
    let finished = builder.finish(scene);
    builder.faults.check(finished);
    if single.sensor.is_none() {
        builder.faults.add(scene.error(Cause::NoSensor));
    }
    add_darkness(&mut builder);
    builder.warnings.extend(builder.ignored());
    let integrator = single.integrator.unwrap_or_default();
    let view = builder.faults.or(single.sensor.flatten())?;
    let (camera, film) = view.ok_or_else(|| scene.error(Cause::NoSensor))?;
    Ok(SceneDescription {
        camera,
        film,
        depth: integrator.depth,
        hide_emitters: integrator.hide_emitters,
        textures: builder.textures,
        materials: builder.materials,
        shapes: builder.shapes,
        emitters: builder.emitters,
    })
}

/// Adds the object at `index`, which the scene holds as `property`.
fn add(
    builder: &mut Builder,
    single: &mut Single,
    index: usize,
    property: &Property,
    is_repetition: bool,
) -> Result<(), LoadError> {
    let object = builder.object(index);
    match object.tag {
        Tag::Bsdf => bsdf::material(builder, index).map(drop),
        Tag::Texture => texture::texture(builder, index, Range::Any).map(drop),
        _ if is_repetition => {
            let title = object.title();
            Err(property.conflict(format!("the {title} is already part of the scene")))
        }
        Tag::Shape => shape::shape(builder, index),
        // A shape refers to it.
        Tag::Emitter if object.plugin == "area" && builder.is_referenced(index) => Ok(()),
        Tag::Emitter => emitter::emitter(builder, index),
        Tag::Sensor if single.sensor.is_some() => {
            let only = "only the first sensor of a scene is used; this one is ignored";
            builder.warnings.push(object.warning(only));
            Ok(())
        }
        Tag::Sensor => {
            single.sensor = Some(None);
            let view = sensor::sensor(builder, index)?;
            single.sensor = Some(Some(view));
            Ok(())
        }
        Tag::Integrator if single.integrator.is_some() => {
            Err(object.conflict("a scene may have only one integrator"))
        }
        Tag::Integrator => {
            single.integrator = Some(integrator::settings(builder, index)?);
            Ok(())
        }
        Tag::Film | Tag::Sampler | Tag::Rfilter | Tag::Medium | Tag::Phase | Tag::Volume => {
            if !builder.is_referenced(index) {
                let text = format!("nothing refers to the {}: it has no effect", object.title());
                builder.warnings.push(object.warning(text));
            }
            Ok(())
        }
        Tag::Scene => Err(property.conflict("a scene cannot contain a scene")),
    }
}

/// A scene without emitter is black: its surroundings emit nothing.
fn add_darkness(builder: &mut Builder) {
    if builder.emitters.is_empty() && builder.shapes.iter().all(|s| s.emission.is_none()) {
        builder.warnings.push(Warning {
            place: None,
            text: "the scene has no emitter: its image is black".into(),
        });
        let radiance = Rgb::ZERO;
        builder
            .emitters
            .push(EmitterDescription::Constant { radiance });
    }
}
