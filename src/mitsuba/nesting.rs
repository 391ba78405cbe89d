//! References between objects: none may lead back to where it came from.

use super::error::{Cause, LoadError};
use super::object::Object;
use super::property::Value;

/// Deepest nesting of elements, of references and of includes.
pub const DEEPEST: usize = 64;

/// Checks that no object contains itself and that none is nested too deep.
pub fn check_nesting(objects: &[Object]) -> Result<(), LoadError> {
    let mut heights = vec![None; objects.len()];
    for i in 0..objects.len() {
        height(objects, i, &mut heights, &mut Vec::new())?;
    }
    Ok(())
}

/// Levels of objects below `index`, itself included; `path` leads to it.
fn height(
    objects: &[Object],
    index: usize,
    heights: &mut [Option<usize>],
    path: &mut Vec<usize>,
) -> Result<usize, LoadError> {
    if let Some(height) = heights[index] {
        return Ok(height);
    }
    if let Some(start) = path.iter().position(|&i| i == index) {
        let name = |i: &usize| objects[*i].id.clone().unwrap_or(objects[*i].title());
        let mut names: Vec<String> = path[start..].iter().map(name).collect();
        names.push(name(&index));
        let cause = Cause::ReferenceCycle(names.join(" -> "));
        return Err(objects[index].error(cause));
    }
    path.push(index);
    let mut below = 0;
    for property in &objects[index].properties {
        if let Value::Object(child) = property.value {
            if path.len() <= DEEPEST {
                below = below.max(height(objects, child, heights, path)?);
            } else {
                below = DEEPEST;
            }
        }
    }
    path.pop();
    if below >= DEEPEST {
        return Err(objects[index].error(Cause::NestedTooDeep(DEEPEST)));
    }
    heights[index] = Some(below + 1);
    Ok(below + 1)
}
