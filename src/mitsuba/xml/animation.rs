//! `<animation>` of version 0.x: transforms at given times. Nothing moves in a still image: all must be equal.

use glam::DMat4;
use roxmltree::Node;

use super::attributes::Attributes;
use super::document::File;
use super::substitution::Substitution;
use super::transform::transform;
use super::value;
use crate::mitsuba::error::{LoadError, Located, Warning};

/// The transform of the `<animation>` element `node`.
pub fn animation(
    node: Node,
    file: &File,
    variables: &mut Substitution,
    warnings: &mut Vec<Warning>,
) -> Result<DMat4, LoadError> {
    let mut first = None;
    for child in node.children().filter(Node::is_element) {
        if child.tag_name().name() != "transform" {
            let known = ["transform"].into_iter();
            return Err(file.unknown_element(child, "animation", known));
        }
        let mut attributes = Attributes::new(child, file, variables)?;
        attributes.parse("time", value::float)?;
        let matrix = transform(child, file, variables, warnings)?;
        if *first.get_or_insert(matrix) != matrix {
            return Err(attributes.not_modelled("motion: an animation with different transforms"));
        }
        attributes.finish()?;
    }
    first.ok_or_else(|| {
        let place = file.start_tag(node);
        place.conflict("an animation needs a <transform time=\"...\">")
    })
}
