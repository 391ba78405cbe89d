//! The techniques: each joins what the subpaths give to a path (Veach 1997, chapter 10).

pub mod connect;

pub use connect::{Connection, emitted, escaped, join, to_lens, to_light};
