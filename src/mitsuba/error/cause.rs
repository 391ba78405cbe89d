//! The causes of loading errors.

use std::io;
use std::path::PathBuf;

use super::suggestion::{listed, shown, shown_long, suggestion};
use crate::film::ReadImageError;
use crate::mitsuba::mesh::MeshError;
use crate::mitsuba::source::Place;

/// Why a scene cannot be loaded.
#[derive(Debug, thiserror::Error)]
pub enum Cause {
    /// A file is missing or cannot be read.
    #[error("cannot read {}: {error}", shown_long(path.display()))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// A scene file that exceeds the size limit.
    #[error("{}: the file has {bytes} bytes, more than the {limit} allowed", shown_long(path.display()))]
    FileTooLarge {
        /// The file.
        path: PathBuf,
        /// Its size in bytes.
        bytes: u64,
        /// The largest size allowed, in bytes.
        limit: u64,
    },
    /// The text is not in the encoding that the file declares.
    #[error("the file is not valid {0}, the encoding that it declares; save it as UTF-8")]
    Encoding(&'static str),
    /// The file does not begin like a scene file.
    #[error("the file is not XML: a scene file begins with <scene>")]
    NotXml,
    /// Not well-formed XML.
    #[error("broken XML: {}", shown_long(.0))]
    Xml(String),
    /// An element has too many attributes.
    #[error("an element with more than {0} attributes")]
    TooManyAttributes(usize),
    /// `version` is missing or malformed.
    #[error("the root element needs a version such as version=\"3.0.0\"{}", found(.0))]
    Version(Option<String>),
    /// The root element is not `<scene>`.
    #[error("a scene file begins with <scene>, not <{}>", shown(.0))]
    NotAScene(String),
    /// An element that is not allowed at its place.
    #[error(
        "unexpected element <{}> in <{parent}>{}",
        shown(found),
        suggestion(found, known)
    )]
    UnknownElement {
        /// Its name.
        found: String,
        /// The enclosing element.
        parent: String,
        /// The elements allowed there.
        known: Vec<String>,
    },
    /// An attribute that the element does not have.
    #[error(
        "<{element}> has no attribute `{}`{}",
        shown(found),
        suggestion(found, known)
    )]
    UnknownAttribute {
        /// The element.
        element: String,
        /// The attribute.
        found: String,
        /// The attributes it has.
        known: Vec<String>,
    },
    /// A required attribute is missing.
    #[error("<{element}> needs the attribute `{attribute}`")]
    MissingAttribute {
        /// The element.
        element: String,
        /// The attribute.
        attribute: String,
    },
    /// A type of shape, BSDF, ... that is not supported.
    #[error("unknown {kind} type `{}`{}", shown(found), suggestion(found, known))]
    UnknownPlugin {
        /// The name of its element.
        kind: String,
        /// Its type.
        found: String,
        /// The known types.
        known: Vec<String>,
    },
    /// A parameter that is not supported.
    #[error(
        "{} has no parameter `{}`{}",
        shown(owner),
        shown(found),
        suggestion(found, known)
    )]
    UnknownParameter {
        /// The object.
        owner: String,
        /// The parameter.
        found: String,
        /// The known parameters.
        known: Vec<String>,
    },
    /// A nested object that its owner does not accept.
    #[error("{} does not accept {}{}", shown(owner), shown(child), listed(known))]
    UnexpectedChild {
        /// The enclosing object.
        owner: String,
        /// The nested object.
        child: String,
        /// The known parameters.
        known: Vec<String>,
    },
    /// A required parameter is missing.
    #[error("{} needs {parameter}", shown(owner))]
    MissingParameter {
        /// The object.
        owner: String,
        /// The parameter.
        parameter: String,
    },
    /// A parameter is given twice.
    #[error("`{}` is given twice; first at {first}", shown(name))]
    DuplicateParameter {
        /// The parameter.
        name: String,
        /// Where it is given for the first time.
        first: Place,
    },
    /// A parameter has the wrong type.
    #[error("`{}` must be {expected}, not {}", shown(name), shown(found))]
    WrongType {
        /// The parameter.
        name: String,
        /// The expected type.
        expected: String,
        /// The actual type.
        found: String,
    },
    /// Text that cannot be parsed as a value.
    #[error("`{}` is not {expected}", shown(text))]
    Malformed {
        /// The text.
        text: String,
        /// What was expected.
        expected: String,
    },
    /// A name outside a closed set.
    #[error("unknown {what} `{}`{}", shown(found), suggestion(found, known))]
    UnknownName {
        /// The kind of thing it names.
        what: String,
        /// The name.
        found: String,
        /// The known names.
        known: Vec<String>,
    },
    /// A value outside its range.
    #[error("`{}` is {}; it must be {range}", shown(name), shown(found))]
    OutOfRange {
        /// The parameter.
        name: String,
        /// Its value.
        found: String,
        /// The allowed range.
        range: String,
    },
    /// A feature of Mitsuba that is not supported.
    #[error("not supported: {0}")]
    NotSupported(String),
    /// Parameters or objects that contradict each other.
    #[error("{0}")]
    Conflict(String),
    /// A `$variable` without a value.
    #[error(
        "`${}` has no value: give one with an earlier <default> or with \
         -D {}=VALUE{}",
        shown(found),
        shown(found),
        suggestion(found, known)
    )]
    UndefinedVariable {
        /// Its name.
        found: String,
        /// The known variables.
        known: Vec<String>,
    },
    /// An attribute is too long after substitution.
    #[error("after substitution of its $variables the text is longer than {0} bytes")]
    SubstitutionTooLong(usize),
    /// All attributes together are too long after substitution.
    #[error("after substitution of its $variables the scene is longer than {0} bytes")]
    SubstitutionTooMuch(usize),
    /// A reference to an id that does not exist.
    #[error("no object has the id `{}`{}", shown(found), suggestion(found, known))]
    MissingReference {
        /// The id.
        found: String,
        /// The known ids.
        known: Vec<String>,
    },
    /// A reference to an id that is given twice.
    #[error(
        "two objects have the id `{}`: the one at {first} and the one at {second}",
        shown(id)
    )]
    DuplicateId {
        /// The id.
        id: String,
        /// The first object with this id.
        first: Place,
        /// Where the id is given again.
        second: Place,
    },
    /// Objects that contain each other.
    #[error("circular reference: {0}")]
    ReferenceCycle(String),
    /// Files that include each other.
    #[error("circular include: {} includes itself", shown_long(.0.display()))]
    IncludeCycle(PathBuf),
    /// A file to include is missing, and `$variables` decide its name.
    #[error(
        "cannot read {}: no such {}; {}{}",
        shown_long(path.display()),
        if *has_folder { "file" } else { "folder" },
        values(variables),
        listed(found)
    )]
    MissingInclude {
        /// The file.
        path: PathBuf,
        /// The variables in its name, and their values.
        variables: Vec<(String, String)>,
        /// The folder in which it should be exists.
        has_folder: bool,
        /// The names of the scene files in that folder.
        found: Vec<String>,
    },
    /// Too many files are included.
    #[error("more than {0} files are included")]
    TooManyIncludes(usize),
    /// Elements, references or includes are nested too deeply.
    #[error("nested more than {0} levels deep")]
    NestedTooDeep(usize),
    /// A mesh file cannot be used.
    #[error("{}{}: {}", shown_long(path.display()), error.position(), shown_long(error))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// Why.
        error: MeshError,
    },
    /// An image file cannot be used.
    #[error("{}: {error}", shown_long(path.display()))]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        error: ReadImageError,
    },
    /// A pixel of an image is not a valid reflectance or radiance.
    #[error(
        "{}: pixel ({}, {}) is ({}, {}, {}); values must be {range}",
        shown_long(path.display()), pixel[0], pixel[1], value[0], value[1], value[2]
    )]
    ImageValue {
        /// The file.
        path: PathBuf,
        /// Column and row, from 0 at the top left.
        pixel: [usize; 2],
        /// Its value.
        value: [f32; 3],
        /// The allowed range.
        range: &'static str,
    },
    /// A file with a spectrum cannot be used.
    #[error("{}:{line}: {problem}", path.display())]
    SpectrumFile {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The scene has no sensor.
    #[error("the scene has no sensor: add <sensor type=\"perspective\">")]
    NoSensor,
    /// A transform without an inverse.
    #[error("the transform of {0} is singular: it maps space to a plane, a line or a point")]
    SingularTransform(String),
}

impl Cause {
    /// The vector `name` is zero and has no direction.
    pub(in crate::mitsuba) fn zero_vector(name: &str) -> Self {
        Cause::OutOfRange {
            name: name.to_owned(),
            found: "zero".into(),
            range: "a vector with a direction".into(),
        }
    }
}

fn found(version: &Option<String>) -> String {
    version
        .as_ref()
        .map_or(String::new(), |text| format!(", not \"{}\"", shown(text)))
}

/// What the variables are, and how to change that.
fn values(variables: &[(String, String)]) -> String {
    let value = |(name, value): &(String, String)| {
        let (name, value) = (shown(name), shown(value));
        format!("`${name}` is `{value}`; -D {name}=VALUE gives it another value")
    };
    let values: Vec<String> = variables.iter().map(value).collect();
    values.join("; ")
}
