//! The XML layer: from scene files to objects with typed parameters. It knows the elements of the
//! format, includes, `$variables`, ids and references, and the names of version 0.x, but no plugin.

mod animation;
mod attributes;
mod document;
mod element;
mod ids;
mod lenient;
mod nesting;
mod object;
mod parameter;
mod property;
mod reader;
mod search_path;
mod spectrum;
mod substitution;
mod transform;
mod tree;
mod upgrade;
pub mod value;
mod within;

pub use object::{Object, Tag};
pub use property::{Property, Spectrum, Value};
pub use tree::Tree;
