//! Elements that give an object a parameter: `<float>`, `<rgb>`, `<transform>`, ...

use glam::{DMat4, DVec3};
use roxmltree::Node;

use super::attributes::{Attributes, start_tag};
use super::error::{Cause, LoadError, Warning};
use super::property::Value;
use super::source::Place;
use super::substitution::Substitution;
use super::tree::File;
use super::{transform, value};

/// The value of the element `node`, whose own attributes are `attributes`.
pub fn value(
    node: Node,
    attributes: &mut Attributes,
    file: &File,
    variables: &mut Substitution,
    warnings: &mut Vec<Warning>,
) -> Result<Value, LoadError> {
    Ok(match node.tag_name().name() {
        "float" => Value::Float(attributes.parse("value", value::float)?),
        "integer" => Value::Integer(attributes.parse("value", value::integer)?),
        "boolean" => Value::Boolean(attributes.parse("value", value::boolean)?),
        "string" => Value::Text(attributes.text("value")?.0),
        "rgb" => Value::Rgb(attributes.parse("value", value::one_or_three)?),
        "spectrum" => Value::Spectrum(spectrum(attributes)?),
        "transform" => Value::Transform(transform(node, file, variables, warnings)?),
        _ => Value::Vector(point(attributes)?),
    })
}

/// The steps in a `<transform>`, put together.
fn transform(
    node: Node,
    file: &File,
    variables: &mut Substitution,
    warnings: &mut Vec<Warning>,
) -> Result<DMat4, LoadError> {
    let mut matrix = DMat4::IDENTITY;
    for child in node.children().filter(Node::is_element) {
        let mut attributes = Attributes::new(child, &file.source, variables)?;
        let name = child.tag_name().name();
        let Some(step) = transform::step(name, &mut attributes, file.legacy, warnings)? else {
            return Err(LoadError::at(
                attributes.place(),
                Cause::UnknownElement {
                    found: name.to_owned(),
                    parent: "transform".into(),
                    known: transform::STEPS.map(str::to_owned).to_vec(),
                },
            ));
        };
        no_elements_in(child, file)?;
        attributes.finish()?;
        matrix = step * matrix;
    }
    if matrix.is_finite() {
        return Ok(matrix);
    }
    Err(LoadError::at(
        &start_tag(node, &file.source),
        Cause::OutOfRange {
            name: "transform".into(),
            found: "beyond the largest numbers".into(),
            range: "finite".into(),
        },
    ))
}

/// `x`, `y` and `z`, or `value` with one or three numbers.
fn point(attributes: &mut Attributes) -> Result<DVec3, LoadError> {
    if let Some(vector) = attributes.parse_optional("value", value::one_or_three)? {
        return Ok(vector);
    }
    let x = attributes.parse("x", value::float)?;
    let y = attributes.parse("y", value::float)?;
    let z = attributes.parse("z", value::float)?;
    Ok(DVec3::new(x, y, z))
}

/// The same value at all wavelengths.
fn spectrum(attributes: &mut Attributes) -> Result<f64, LoadError> {
    const ADVICE: &str = "spectra by wavelength; give <rgb value=\"red, green, blue\">, or a \
                          <spectrum> with one value";
    let not_modelled = |place: &Place| LoadError::at(place, Cause::NotModelled(ADVICE.into()));
    for name in ["type", "filename"] {
        if let Some((_, place)) = attributes.text_optional(name) {
            return Err(not_modelled(&place));
        }
    }
    let (text, place) = attributes.text("value")?;
    if text.contains(':') || value::tokens(&text).len() > 1 {
        return Err(not_modelled(&place));
    }
    value::float(&text).map_err(|cause| LoadError::at(&place, cause))
}

/// Complains of elements in an element that has only attributes.
pub fn no_elements_in(node: Node, file: &File) -> Result<(), LoadError> {
    let Some(child) = node.children().find(Node::is_element) else {
        return Ok(());
    };
    let cause = Cause::UnknownElement {
        found: child.tag_name().name().to_owned(),
        parent: node.tag_name().name().to_owned(),
        known: Vec::new(),
    };
    Err(LoadError::at(&start_tag(child, &file.source), cause))
}
