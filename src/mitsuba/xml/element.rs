//! The elements of the format.

use super::object::Tag;
use super::parameter::{PARAMETERS, Parse};

const DIRECTIVES: [(&str, Directive); 7] = [
    ("alias", Directive::Alias),
    ("animation", Directive::Animation),
    ("default", Directive::Default),
    ("include", Directive::Include),
    ("path", Directive::SearchPath),
    ("ref", Directive::Reference),
    ("transform", Directive::Transform),
];

/// An element that is neither an object nor a simple parameter.
#[derive(Clone, Copy)]
pub enum Directive {
    /// A second id of an object.
    Alias,
    /// A transform, given for several times.
    Animation,
    /// The default value of a variable.
    Default,
    /// Another scene file.
    Include,
    /// A folder in which files are looked for.
    SearchPath,
    /// A nested object, given by its id.
    Reference,
    /// A transform, given by nested elements.
    Transform,
}

/// What an element stands for.
pub enum Element {
    /// A nested object.
    Object(Tag),
    /// A parameter, and how its value is read.
    Parameter(Parse),
    /// Anything else.
    Directive(Directive),
}

impl Element {
    /// The element `name`; `None` if it is unknown or `scene`, which cannot be nested.
    pub fn named(name: &str) -> Option<Self> {
        let object = Tag::named(name).filter(|&tag| tag != Tag::Scene);
        let parameter = || PARAMETERS.iter().find(|(known, _)| *known == name);
        let directive = || DIRECTIVES.iter().find(|(known, _)| *known == name);
        object
            .map(Element::Object)
            .or_else(|| parameter().map(|&(_, parse)| Element::Parameter(parse)))
            .or_else(|| directive().map(|&(_, directive)| Element::Directive(directive)))
    }

    /// The names of all elements except `scene`.
    pub fn names() -> impl Iterator<Item = &'static str> {
        let objects = Tag::ALL.iter().map(|(name, _)| *name);
        let parameters = PARAMETERS.iter().map(|(name, _)| *name);
        let directives = DIRECTIVES.iter().map(|(name, _)| *name);
        let names = objects.chain(parameters).chain(directives);
        names.filter(|name| *name != Tag::Scene.name())
    }
}
