//! Reads the elements of scene files, with includes and substitution, into a list of objects.

use std::path::{Path, PathBuf};

use roxmltree::Node;

use super::animation::animation;
use super::attributes::Attributes;
use super::document::{self, File};
use super::element::{Directive, Element};
use super::ids::Ids;
use super::nesting::MAX_DEPTH;
use super::object::{Object, Tag};
use super::parameter::Parse;
use super::property::Value;
use super::search_path::{SearchPath, folder_of};
use super::substitution::Substitution;
use super::transform::transform;
use super::within::Within;
use super::{lenient, spectrum, upgrade, value};
use crate::mitsuba::error::{Cause, Faults, LoadError, Located, Warning, shown};
use crate::mitsuba::source::Place;

/// Maximum number of included files. Without a limit, files that each include the next one twice
/// would take exponential time.
const MAX_INCLUDES: usize = 4096;

/// The state of reading.
pub struct Reader {
    /// The values of `$variables`.
    pub variables: Substitution,
    /// The objects read so far; the first is the scene.
    pub objects: Vec<Object>,
    /// Their ids.
    pub ids: Ids,
    /// Where files are looked for.
    pub search_path: SearchPath,
    /// Suspicious parts of the files.
    pub warnings: Vec<Warning>,
    /// Faults in elements, which do not end the reading of the others.
    faults: Faults,
    /// All files read.
    pub files: Vec<PathBuf>,
    /// The files being read, each included by the one before it.
    including: Vec<PathBuf>,
    /// Number of files included so far.
    includes: usize,
}

/// Where elements are being read.
#[derive(Clone, Copy)]
struct Context<'a> {
    file: &'a File,
    /// Index of the object that encloses the elements.
    parent: usize,
    /// Depth of nesting in this file.
    depth: usize,
}

/// Where the root of an included file goes.
struct Inclusion {
    parent: usize,
    /// Name of the parameter that the root becomes, if it is not a scene.
    name: String,
    /// The attribute with the name of the file.
    place: Place,
}

impl Reader {
    /// A reader for the scene file at `path`, with the variables of the command line.
    pub fn new(path: &Path, defines: &[(String, String)]) -> Self {
        Self {
            variables: Substitution::new(defines),
            objects: Vec::new(),
            ids: Ids::default(),
            search_path: SearchPath::new(path),
            warnings: Vec::new(),
            faults: Faults::default(),
            files: Vec::new(),
            including: Vec::new(),
            includes: 0,
        }
    }

    /// Reads the scene file at `path` and the files it includes.
    pub fn scene(&mut self, path: &Path) -> Result<(), LoadError> {
        self.file(path, None)?;
        std::mem::take(&mut self.faults).or(())
    }

    /// Reads a file: the scene file if `into` is `None`, otherwise an included one.
    fn file(&mut self, path: &Path, into: Option<Inclusion>) -> Result<(), LoadError> {
        let fail = |cause| match &into {
            Some(to) => to.place.error(cause),
            None => LoadError::nowhere(cause),
        };
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if self.including.contains(&canonical) {
            return Err(fail(Cause::IncludeCycle(path.to_owned())));
        }
        let source = document::read(path, fail, &mut self.warnings)?;
        self.files.push(path.to_owned());
        let xml = lenient::as_xml(source.text());
        let document = document::parse(&source, &xml)?;
        let root = document.root_element();
        let file = File::new(root, &source)?;
        self.including.push(canonical);
        let in_object = |parent| Context {
            file: &file,
            parent,
            depth: 0,
        };
        match (into, Tag::named(root.tag_name().name())) {
            (None, Some(Tag::Scene)) => {
                let place = file.start_tag(root);
                let scene = Object::new(Tag::Scene, "scene".into(), None, place);
                self.objects.push(scene);
                self.contents(root, in_object(0))?;
            }
            (None, _) => {
                let cause = Cause::NotAScene(root.tag_name().name().to_owned());
                return Err(file.start_tag(root).error(cause));
            }
            (Some(to), Some(Tag::Scene)) => self.contents(root, in_object(to.parent))?,
            (Some(to), Some(tag)) => self.object(root, tag, to.name, in_object(to.parent))?,
            (Some(_), None) => return Err(file.unknown_element(root, "include", Element::names())),
        }
        self.including.pop();
        Ok(())
    }

    fn contents(&mut self, node: Node, context: Context) -> Result<(), LoadError> {
        let file = context.file;
        if context.depth > MAX_DEPTH {
            return Err(file.start_tag(node).error(Cause::NestedTooDeep(MAX_DEPTH)));
        }
        for child in node.children() {
            if child.is_element() {
                let read = self.element(child, context);
                self.faults.check(read);
            } else if child.is_text() && !child.text().unwrap_or("").trim().is_empty() {
                let place = Place::new(&file.source, child.range());
                let warning = place.warning("text between elements is ignored");
                self.warnings.push(warning);
            }
        }
        Ok(())
    }

    fn element(&mut self, node: Node, context: Context) -> Result<(), LoadError> {
        let Context { file, parent, .. } = context;
        match Element::named(node.tag_name().name()) {
            Some(Element::Object(tag)) => self.object(node, tag, String::new(), context),
            Some(Element::Parameter(_))
                if node.has_tag_name("spectrum") && node.has_attribute("type") =>
            {
                self.typed_spectrum(node, context)
            }
            Some(Element::Parameter(parse)) => self.parameter(node, parse, context),
            Some(Element::Directive(directive)) => self.directive(directive, node, context),
            None => {
                let parent = self.objects[parent].tag.name();
                Err(file.unknown_element(node, parent, Element::names()))
            }
        }
    }

    fn parameter(&mut self, node: Node, parse: Parse, context: Context) -> Result<(), LoadError> {
        let file = context.file;
        let mut attributes = Attributes::new(node, file, &mut self.variables)?;
        let name = attributes.text("name")?.0;
        let within = Within {
            file,
            search_path: &self.search_path,
        };
        let value = parse(&mut attributes, &within)?;
        self.add(&name, value, attributes.place(), context)?;
        file.no_elements_in(node)?;
        attributes.finish()
    }

    /// A `<spectrum>` with a type and parameters of its own, which become a value of the enclosing object.
    fn typed_spectrum(&mut self, node: Node, context: Context) -> Result<(), LoadError> {
        let mut attributes = Attributes::new(node, context.file, &mut self.variables)?;
        let name = attributes.text("name")?.0;
        let plugin = attributes.text("type")?.0;
        let place = attributes.place().clone();
        attributes.finish()?;
        let index = self.objects.len();
        let object = Object::new(Tag::Texture, plugin, None, place.clone());
        self.objects.push(object);
        let within = Context {
            parent: index,
            depth: context.depth + 1,
            ..context
        };
        self.contents(node, within)?;
        let object = &self.objects[index];
        let value = spectrum::of_object(object)?;
        object.finish(&self.objects)?;
        self.add(&name, value, &place, context)
    }

    fn directive(
        &mut self,
        directive: Directive,
        node: Node,
        context: Context,
    ) -> Result<(), LoadError> {
        let Context { file, parent, .. } = context;
        let mut attributes = Attributes::new(node, file, &mut self.variables)?;
        let mut inclusion = None;
        match directive {
            Directive::Alias => self.alias(&mut attributes)?,
            Directive::Animation => {
                let name = attributes.text("name")?.0;
                let matrix = animation(node, file, &mut self.variables, &mut self.warnings)?;
                let value = Value::Transform(matrix);
                self.add(&name, value, attributes.place(), context)?;
            }
            Directive::Default => self.default(&mut attributes)?,
            Directive::Include => {
                let (filename, place) = attributes.text("filename")?;
                let name = attributes.text_or_empty("name");
                let to = Inclusion {
                    parent,
                    name,
                    place,
                };
                inclusion = Some((filename, to));
            }
            Directive::SearchPath => self.search_path(&mut attributes, parent)?,
            Directive::Reference => {
                let value = Value::Reference(attributes.text("id")?.0);
                let name = attributes.text_or_empty("name");
                self.add(&name, value, attributes.place(), context)?;
            }
            Directive::Transform => {
                let name = attributes.text("name")?.0;
                let matrix = transform(node, file, &mut self.variables, &mut self.warnings)?;
                let value = Value::Transform(matrix);
                self.add(&name, value, attributes.place(), context)?;
            }
        }
        if !matches!(directive, Directive::Transform | Directive::Animation) {
            file.no_elements_in(node)?;
        }
        attributes.finish()?;
        match inclusion {
            Some((filename, to)) => self.include(&filename, to),
            None => Ok(()),
        }
    }

    /// Reads an object and its contents. `name` is the name of the parameter that it becomes,
    /// unless its own attributes give one.
    fn object(
        &mut self,
        node: Node,
        tag: Tag,
        name: String,
        context: Context,
    ) -> Result<(), LoadError> {
        let mut attributes = Attributes::new(node, context.file, &mut self.variables)?;
        // Old files write types such as `Sphere`, whose plugins are files on systems that ignore case.
        let plugin = attributes.text("type")?.0.to_ascii_lowercase();
        let id = attributes.text_optional("id");
        let id = id.filter(|(id, _)| !id.is_empty());
        let own_name = attributes.text_or_empty("name");
        let name = if name.is_empty() { own_name } else { name };
        if node.parent().is_some_and(|parent| parent.is_root()) {
            attributes.text("version")?;
        }
        let place = attributes.place().clone();
        attributes.finish()?;

        let index = self.objects.len();
        self.add(&name, Value::Object(index), &place, context)?;
        if let Some((id, at)) = &id {
            self.ids.claim(id, index, at);
        }
        let id = id.map(|(id, _)| id);
        self.objects.push(Object::new(tag, plugin, id, place));
        let within = Context {
            parent: index,
            depth: context.depth + 1,
            ..context
        };
        self.contents(node, within)?;
        if context.file.legacy {
            upgrade::object(&mut self.objects[index])?;
        }
        Ok(())
    }

    /// Adds a parameter to the enclosing object. Files of version 0.x may set parameters of the scene, such as those
    /// of an integrator that they include; there they are not an error, and have no effect.
    fn add(
        &mut self,
        name: &str,
        value: Value,
        place: &Place,
        context: Context,
    ) -> Result<(), LoadError> {
        if !context.file.legacy {
            return self.objects[context.parent].add(name.to_owned(), value, place.clone());
        }
        let is_nested = matches!(value, Value::Object(_) | Value::Reference(_));
        if context.parent == 0 && !is_nested {
            let text = format!("`{}` has no effect in <scene>: it is ignored", shown(name));
            self.warnings.push(place.warning(text));
            return Ok(());
        }
        let name = upgrade::underscore_case(name);
        self.objects[context.parent].add(name, value, place.clone())
    }

    fn default(&mut self, attributes: &mut Attributes) -> Result<(), LoadError> {
        let (name, place) = attributes.text("name")?;
        let (value, _) = attributes.text("value")?;
        if name.is_empty() {
            return Err(place.error(value::malformed("", "the name of a variable")));
        }
        self.variables.set_default(&name, &value);
        Ok(())
    }

    fn alias(&mut self, attributes: &mut Attributes) -> Result<(), LoadError> {
        let (id, place) = attributes.text("id")?;
        let (alias, alias_place) = attributes.text("as")?;
        let index = self.ids.object(&id, &self.objects);
        let index = index.map_err(|cause| place.error(cause))?;
        self.ids.claim(&alias, index, &alias_place);
        Ok(())
    }

    fn search_path(&mut self, attributes: &mut Attributes, parent: usize) -> Result<(), LoadError> {
        let (value, place) = attributes.text("value")?;
        if parent != 0 {
            return Err(attributes.conflict("<path> is allowed only directly in <scene>"));
        }
        let path = folder_of(&place).join(value);
        if path.is_dir() {
            self.search_path.add(path);
        } else {
            // Files may be found without it.
            let text = format!("no folder {}: the path is ignored", path.display());
            self.warnings.push(place.warning(text));
        }
        Ok(())
    }

    fn include(&mut self, filename: &str, to: Inclusion) -> Result<(), LoadError> {
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            return Err(to.place.error(Cause::TooManyIncludes(MAX_INCLUDES)));
        }
        if self.including.len() > MAX_DEPTH {
            return Err(to.place.error(Cause::NestedTooDeep(MAX_DEPTH)));
        }
        let path = self.search_path.locate_include(filename, &to.place);
        let variables = self.variables.values_in(to.place.text());
        if !path.exists() && !variables.is_empty() {
            return Err(to.place.error(missing_include(path, variables)));
        }
        self.file(&path, Some(to))
    }
}

/// There is no file at `path`, whose name contains `variables`.
fn missing_include(path: PathBuf, variables: Vec<(String, String)>) -> Cause {
    let folder = path.parent().unwrap_or(Path::new(""));
    let entries = std::fs::read_dir(folder);
    let has_folder = entries.is_ok();
    let names = entries.into_iter().flatten().flatten();
    let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut found: Vec<String> = names.filter(|name| name.ends_with(".xml")).collect();
    found.sort_unstable();
    Cause::MissingInclude {
        path,
        variables,
        has_folder,
        found,
    }
}
