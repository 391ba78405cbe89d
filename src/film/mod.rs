//! Film and images: reconstruction filters, accumulation in f64, EXR and PNG files.

pub mod accumulate;
pub mod exr;
pub mod file;
pub mod filter;
pub mod image;
pub mod png;
pub mod read;
pub mod sampler;
pub mod splats;

pub use self::image::{AnnotatedImage, AttributeValue, Image};
pub use accumulate::Film;
pub use exr::{ExrLayer, write_exr};
pub use file::{WriteError, check_writable, replace_file};
pub use filter::{Filter, FilterSampler};
pub use png::{srgb_bytes, write_png};
pub use read::{Decode, ReadImageError, read_annotated, read_image};
pub use sampler::FilmSampler;
pub use splats::{Splat, SplatFilm, SplatLog};
