//! Checks that the graph of objects has no cycle and a limited depth.

use super::object::Object;
use super::property::Value;
use crate::mitsuba::error::{Cause, LoadError, Located};

/// Maximum depth of nested elements, of references and of includes.
pub const MAX_DEPTH: usize = 64;

/// Checks that no object contains itself and that none is nested too deeply.
pub fn check_nesting(objects: &[Object]) -> Result<(), LoadError> {
    let mut heights = vec![None; objects.len()];
    for i in 0..objects.len() {
        height(objects, i, &mut heights, &mut Vec::new())?;
    }
    Ok(())
}

/// Number of levels of the graph below the object `index`, including its own. `path` leads from a
/// root to it.
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
            if path.len() <= MAX_DEPTH {
                below = below.max(height(objects, child, heights, path)?);
            } else {
                below = MAX_DEPTH;
            }
        }
    }
    path.pop();
    if below >= MAX_DEPTH {
        return Err(objects[index].error(Cause::NestedTooDeep(MAX_DEPTH)));
    }
    heights[index] = Some(below + 1);
    Ok(below + 1)
}
