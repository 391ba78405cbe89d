//! Film and images: reconstruction filters, accumulation in f64, EXR and PNG files.
//!
//! ```
//! use metrolight::film::{Film, Filter, Splat};
//! use metrolight::math::Rgb;
//!
//! let mut film = Film::new(2, 1, Filter::Box);
//! // A sample of the left pixel, and a splat in the right one; one sample of the film in all.
//! film.add_samples(0, [0.5; 3], 1);
//! film.splat(&Splat { position: [0.75, 0.5], value: Rgb::ONE });
//! let image = film.resolve(1.0);
//! assert_eq!(image.pixels, [[0.5; 3], [2.0; 3]]);
//! ```

pub mod accumulate;
pub mod exr;
pub mod file;
pub mod filter;
pub mod image;
pub mod png;
pub mod read;
pub mod sampler;
pub mod splats;

pub use self::image::{AnnotatedImage, AttributeValue, Crop, Image};
pub use accumulate::Film;
pub use exr::{ExrLayer, stage_exr, write_exr};
pub use file::{StagedFile, WriteError, check_writable, replace_file};
pub use filter::{Filter, FilterSampler};
pub use png::{png_text, srgb_bytes, stage_png, write_png};
pub use read::{Decode, ReadImageError, read_annotated, read_image};
pub use sampler::FilmSampler;
pub use splats::{Splat, SplatFilm, SplatLog};
