//! `shapegroup` and `instance`: shapes that are placed several times. Each instance has triangles of its
//! own.

use super::{placed, to_world};
use crate::mitsuba::builder::Builder;
use crate::mitsuba::error::{LoadError, Located};
use crate::mitsuba::xml::Tag;

/// The type of a group of shapes.
pub const GROUP: &str = "shapegroup";
/// The type of an instance of a group.
pub const INSTANCE: &str = "instance";

/// Checks the group at `index`, which is seen only where an instance places it.
pub fn check_group(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    let object = builder.object(index);
    if !builder.is_referenced(index) {
        let text = "no instance refers to this group: it is not seen";
        builder.warnings.push(object.warning(text));
    }
    // Its shapes are read by each instance.
    builder.children(object, Tag::Shape);
    builder.finish(object)
}

/// Adds the shapes of the group that the instance at `index` refers to.
pub fn instance(builder: &mut Builder, index: usize) -> Result<(), LoadError> {
    let object = builder.object(index);
    let parent = to_world::to_world(object)?;
    let group = builder.child(object, Tag::Shape)?;
    builder.finish(object)?;
    let Some(group) = group.filter(|&group| builder.object(group).plugin == GROUP) else {
        return Err(object.missing("a reference to a shape of type `shapegroup`"));
    };
    for shape in builder.children(builder.object(group), Tag::Shape) {
        let added = match builder.object(shape) {
            nested if [GROUP, INSTANCE].contains(&nested.plugin.as_str()) => {
                Err(nested.not_modelled("groups within groups of shapes"))
            }
            _ => placed(builder, shape, parent),
        };
        builder.faults.check(added);
    }
    Ok(())
}
