//! Why a scene cannot be loaded, named by cause, with what can be done about each.

use std::fmt;
use std::io;
use std::path::PathBuf;

use miette::{Diagnostic, LabeledSpan, SourceCode};

use super::mesh::MeshError;
use super::source::Place;
use crate::film::ReadImageError;

/// Names less alike than this (Jaro-Winkler, 1 for equal) are not suggested for one another.
const ALIKE: f64 = 0.7;

/// Greatest number of known names that a message lists.
const LISTED: usize = 40;

/// A fault in a scene file or in a file that it names. The message begins with the place,
/// `scene.xml:12:3`.
#[derive(Debug)]
pub struct LoadError(Box<Fault>);

#[derive(Debug)]
struct Fault {
    place: Option<Place>,
    cause: Cause,
}

impl LoadError {
    pub(super) fn at(place: &Place, cause: Cause) -> Self {
        let place = Some(place.clone());
        Self(Box::new(Fault { place, cause }))
    }

    pub(super) fn nowhere(cause: Cause) -> Self {
        Self(Box::new(Fault { place: None, cause }))
    }

    /// Where; `None` if the scene file itself could not be read.
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// What is wrong.
    pub fn cause(&self) -> &Cause {
        &self.0.cause
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.place {
            Some(place) => write!(f, "{place}: {}", self.0.cause),
            None => write!(f, "{}", self.0.cause),
        }
    }
}

impl std::error::Error for LoadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        std::error::Error::source(&self.0.cause)
    }
}

impl Diagnostic for LoadError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        let place = self.0.place.as_ref()?;
        place
            .is_worth_showing()
            .then(|| place.file() as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.0.place.as_ref()?;
        let label = LabeledSpan::new_with_span(Some("here".into()), place.span());
        Some(Box::new(std::iter::once(label)))
    }
}

/// What is wrong with a scene.
#[derive(Debug, thiserror::Error)]
pub enum Cause {
    /// A file is missing or cannot be read.
    #[error("cannot read {}: {error}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A file larger than any scene description.
    #[error("{}: the file has {bytes} bytes, more than the {limit} allowed", path.display())]
    FileTooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// The greatest size.
        limit: u64,
    },
    /// The text is not UTF-8.
    #[error("the file is not valid UTF-8")]
    NotUtf8,
    /// Not well-formed XML.
    #[error("broken XML: {0}")]
    Xml(String),
    /// No `version`, or one that is no version.
    #[error("the root element needs a version such as version=\"3.0.0\"{}", found(.0))]
    Version(Option<String>),
    /// The root is something else.
    #[error("a scene file begins with <scene>, not <{0}>")]
    NotAScene(String),
    /// An element that has no meaning where it stands.
    #[error("unexpected element <{found}> in <{parent}>{}", hint(found, known))]
    UnknownElement {
        /// Its name.
        found: String,
        /// The element around it.
        parent: String,
        /// What may stand there.
        known: Vec<String>,
    },
    /// An attribute that the element does not have.
    #[error("<{element}> has no attribute `{found}`{}", hint(found, known))]
    UnknownAttribute {
        /// The element.
        element: String,
        /// The attribute.
        found: String,
        /// What it has.
        known: Vec<String>,
    },
    /// An attribute that must be there.
    #[error("<{element}> needs the attribute `{attribute}`")]
    MissingAttribute {
        /// The element.
        element: String,
        /// The attribute.
        attribute: String,
    },
    /// A type of shape, material, ... that is not modelled.
    #[error("unknown {kind} type `{found}`{}", hint(found, known))]
    UnknownPlugin {
        /// The element's name.
        kind: String,
        /// Its type.
        found: String,
        /// The types there are.
        known: Vec<String>,
    },
    /// A parameter that is not modelled.
    #[error("{owner} has no parameter `{found}`{}", hint(found, known))]
    UnknownParameter {
        /// What has the parameter.
        owner: String,
        /// The parameter.
        found: String,
        /// The parameters there are.
        known: Vec<String>,
    },
    /// A nested object that its owner has no use for.
    #[error("{owner} has no use for {child}{}", listed(known))]
    UnexpectedChild {
        /// The object around it.
        owner: String,
        /// The nested object.
        child: String,
        /// The names of parameters there are.
        known: Vec<String>,
    },
    /// A parameter that must be there.
    #[error("{owner} needs {parameter}")]
    MissingParameter {
        /// What has the parameter.
        owner: String,
        /// The parameter.
        parameter: String,
    },
    /// The same parameter twice.
    #[error("`{name}` is given twice; first at {first}")]
    DuplicateParameter {
        /// The parameter.
        name: String,
        /// Where it is given first.
        first: Place,
    },
    /// A parameter of another type than its owner expects.
    #[error("`{name}` must be {expected}, not {found}")]
    WrongType {
        /// The parameter.
        name: String,
        /// What it should be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// Text that does not read as a value.
    #[error("`{text}` is not {expected}")]
    Malformed {
        /// The text.
        text: String,
        /// What it should be.
        expected: String,
    },
    /// A name that is none of a closed set.
    #[error("unknown {what} `{found}`{}", hint(found, known))]
    UnknownName {
        /// What it names.
        what: String,
        /// The name.
        found: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A value outside its range.
    #[error("`{name}` is {found}; it must be {range}")]
    OutOfRange {
        /// The parameter.
        name: String,
        /// Its value.
        found: String,
        /// Its range.
        range: String,
    },
    /// Something that Mitsuba has and Metrolight does not model.
    #[error("not modelled: {0}")]
    NotModelled(String),
    /// Two parameters that exclude each other, or that must come together.
    #[error("{0}")]
    Conflict(String),
    /// A `$variable` without a value.
    #[error(
        "`${found}` has no value: give one with <default> above this place or with \
         -D {found}=VALUE{}",
        hint(found, known)
    )]
    UndefinedVariable {
        /// Its name.
        found: String,
        /// The variables there are.
        known: Vec<String>,
    },
    /// Substitution makes a text too long.
    #[error("with its $variables replaced this is longer than {0} bytes")]
    SubstitutionTooLong(usize),
    /// Substitution makes a scene too long.
    #[error("with its $variables replaced the scene is longer than {0} bytes")]
    SubstitutionTooMuch(usize),
    /// A reference to nothing.
    #[error("no object has the id `{found}`{}", hint(found, known))]
    MissingReference {
        /// The id.
        found: String,
        /// The ids there are.
        known: Vec<String>,
    },
    /// An id given twice.
    #[error("the id `{id}` is taken by {first}; ids must differ")]
    DuplicateId {
        /// The id.
        id: String,
        /// Who has it.
        first: Place,
    },
    /// Objects that contain each other.
    #[error("circular reference: {0}")]
    ReferenceCycle(String),
    /// Files that include each other.
    #[error("circular include: {} includes itself", .0.display())]
    IncludeCycle(PathBuf),
    /// Too many files.
    #[error("more than {0} files are included")]
    TooManyIncludes(usize),
    /// Elements or references nested beyond reason.
    #[error("nested more than {0} levels deep")]
    NestedTooDeep(usize),
    /// A mesh file that is not usable.
    #[error("{}{}: {}", path.display(), error.position(), error)]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: MeshError,
    },
    /// An image file that is not usable.
    #[error("{}: {error}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: ReadImageError,
    },
    /// An image with a pixel that no reflectance or radiance can have.
    #[error(
        "{}: pixel ({}, {}) is ({}, {}, {}); values must be {range}",
        path.display(), pixel[0], pixel[1], value[0], value[1], value[2]
    )]
    ImageValue {
        /// The file.
        path: PathBuf,
        /// Column and row, from 0 at the top left.
        pixel: [usize; 2],
        /// Its value.
        value: [f32; 3],
        /// What it should be.
        range: &'static str,
    },
    /// Nothing looks at the scene.
    #[error("the scene has no sensor: add <sensor type=\"perspective\">")]
    NoSensor,
    /// Nothing gives light.
    #[error(
        "the scene has no emitter: add an area, point, directional, constant or envmap emitter"
    )]
    NoEmitter,
    /// A transform without an inverse.
    #[error("the transform of {0} is singular: it flattens space to a plane, a line or a point")]
    SingularTransform(String),
}

/// "; did you mean `x`? (known: ...)", or less if there is less to say.
fn hint(found: &str, known: &[String]) -> String {
    let nearest = nearest(found, known);
    let suggestion = nearest.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    suggestion + &listed(known)
}

fn listed(known: &[String]) -> String {
    if known.is_empty() {
        return String::new();
    }
    let shown = known.iter().take(LISTED).cloned().collect::<Vec<_>>();
    let rest = known.len() - shown.len();
    let more = match rest {
        0 => String::new(),
        _ => format!(" and {rest} more"),
    };
    format!(" (known: {}{more})", shown.join(", "))
}

fn nearest<'a>(found: &str, known: &'a [String]) -> Option<&'a str> {
    let found = found.to_lowercase();
    known
        .iter()
        .map(|name| (strsim::jaro_winkler(&found, &name.to_lowercase()), name))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name.as_str())
}

fn found(version: &Option<String>) -> String {
    version
        .as_ref()
        .map_or(String::new(), |text| format!(", not \"{text}\""))
}

/// Something in a scene that is worth knowing and does not keep it from being rendered.
#[derive(Clone, Debug)]
pub struct Warning {
    /// Where; `None` if it is not about a place in a file.
    pub place: Option<Place>,
    /// What.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.text),
            None => write!(f, "{}", self.text),
        }
    }
}
