//! From XML files to objects with parameters: includes and substitution.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roxmltree::Node;

use super::attributes::{Attributes, start_tag};
use super::document::{self, parent};
use super::error::{Cause, LoadError, Warning};
use super::ids::Ids;
use super::nesting::{DEEPEST, check_nesting};
use super::object::{Object, Tag};
use super::parameter::{self, no_elements_in};
use super::property::Value;
use super::source::{Place, SourceFile};
use super::substitution::Substitution;
use super::{upgrade, value};

/// Greatest number of included files: includes that double one another must come to an end.
const MOST_INCLUDES: usize = 4096;

/// Elements that stand for a parameter or do something else than make an object.
const OTHER_ELEMENTS: [&str; 14] = [
    "alias",
    "boolean",
    "default",
    "float",
    "include",
    "integer",
    "path",
    "point",
    "ref",
    "rgb",
    "spectrum",
    "string",
    "transform",
    "vector",
];

/// The objects of a scene; the first is the scene itself.
#[derive(Debug)]
pub struct Tree {
    /// Objects, with references resolved and free of cycles.
    pub objects: Vec<Object>,
    /// Where files are looked for, in this order.
    search: Vec<PathBuf>,
    /// Strange but harmless things.
    pub warnings: Vec<Warning>,
}

impl Tree {
    /// Reads the scene file at `path` and what it includes.
    pub fn read(path: &Path, defines: &[(String, String)]) -> Result<Self, LoadError> {
        let mut reader = Reader {
            variables: Substitution::new(defines),
            objects: Vec::new(),
            ids: Ids::default(),
            search: vec![parent(path)],
            including: Vec::new(),
            includes: 0,
            warnings: Vec::new(),
        };
        reader.file(path, None)?;
        let unused = reader.variables.unused().map(|name| Warning {
            place: None,
            text: format!("-D {name}: no file of the scene uses ${name}"),
        });
        let mut warnings: Vec<Warning> = unused.collect();
        warnings.append(&mut reader.warnings);
        reader.ids.resolve_references(&mut reader.objects)?;
        check_nesting(&reader.objects)?;
        Ok(Self {
            objects: reader.objects,
            search: reader.search,
            warnings,
        })
    }

    /// The path of a file that `place` names: relative to `<path>`s, to the scene file, or to the
    /// file that names it.
    pub fn locate(&self, name: &str, place: &Place) -> PathBuf {
        let own = parent(place.file().path());
        let first = self.search.first().unwrap_or(&own);
        let mut candidates = self.search.iter().chain([&own]).map(|dir| dir.join(name));
        candidates
            .find(|path| path.exists())
            .unwrap_or_else(|| first.join(name))
    }
}

/// One file while it is read.
pub struct File {
    /// Its text.
    pub source: Arc<SourceFile>,
    /// Of version 0.x or 1.
    pub legacy: bool,
}

struct Reader {
    variables: Substitution,
    objects: Vec<Object>,
    ids: Ids,
    search: Vec<PathBuf>,
    /// Files that are being read, each included by the one before it.
    including: Vec<PathBuf>,
    includes: usize,
    warnings: Vec<Warning>,
}

/// Where the root of an included file goes.
struct Inclusion {
    parent: usize,
    /// Name of the parameter that the root becomes, if it is not a scene.
    name: String,
    /// Of the file's name.
    place: Place,
}

impl Reader {
    /// Reads a file: the scene if `into` is `None`, else into an object that exists.
    fn file(&mut self, path: &Path, into: Option<Inclusion>) -> Result<(), LoadError> {
        let fail = |cause| match &into {
            Some(to) => LoadError::at(&to.place, cause),
            None => LoadError::nowhere(cause),
        };
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if self.including.contains(&canonical) {
            return Err(fail(Cause::IncludeCycle(path.to_owned())));
        }
        let source = document::read(path, fail)?;
        let document = document::parse(&source)?;
        let root = document.root_element();
        let legacy = document::is_legacy(root, &source)?;
        let file = File {
            source: Arc::clone(&source),
            legacy,
        };
        self.including.push(canonical);
        match into {
            None if root.tag_name().name() == "scene" => {
                let place = start_tag(root, &file.source);
                let scene = Object::new(Tag::Scene, "scene".into(), None, place);
                self.objects.push(scene);
                self.contents(root, 0, &file, 0)?;
            }
            None => {
                let cause = Cause::NotAScene(root.tag_name().name().to_owned());
                return Err(LoadError::at(&start_tag(root, &file.source), cause));
            }
            Some(to) if root.tag_name().name() == "scene" => {
                self.contents(root, to.parent, &file, 0)?;
            }
            Some(to) => match tag_of(root) {
                Some(tag) => self.object(root, tag, to.parent, Some(to.name), &file, 0)?,
                None => return Err(self.unknown_element(root, "include", &file)),
            },
        }
        self.including.pop();
        Ok(())
    }

    fn contents(
        &mut self,
        node: Node,
        parent: usize,
        file: &File,
        depth: usize,
    ) -> Result<(), LoadError> {
        if depth > DEEPEST {
            let place = start_tag(node, &file.source);
            return Err(LoadError::at(&place, Cause::NestedTooDeep(DEEPEST)));
        }
        for child in node.children() {
            if child.is_element() {
                self.element(child, parent, file, depth)?;
            } else if child.is_text() && !child.text().unwrap_or("").trim().is_empty() {
                self.warnings.push(Warning {
                    place: Some(Place::new(&file.source, child.range())),
                    text: "text between elements means nothing".into(),
                });
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        node: Node,
        parent: usize,
        file: &File,
        depth: usize,
    ) -> Result<(), LoadError> {
        let name = node.tag_name().name();
        let is_scene = name == "scene";
        if let Some(tag) = tag_of(node).filter(|_| !is_scene) {
            return self.object(node, tag, parent, None, file, depth);
        }
        if !OTHER_ELEMENTS.contains(&name) {
            let around = self.objects[parent].tag.name();
            return Err(self.unknown_element(node, around, file));
        }
        let mut attributes = Attributes::new(node, &file.source, &mut self.variables)?;
        match name {
            "default" => self.default(&mut attributes)?,
            "alias" => self.alias(&mut attributes)?,
            "path" => self.search_path(&mut attributes, parent)?,
            "include" => {
                let (filename, place) = attributes.text("filename")?;
                let name = attributes.text_optional("name");
                let name = name.map_or(String::new(), |(name, _)| name);
                attributes.finish()?;
                no_elements_in(node, file)?;
                return self.include(
                    &filename,
                    Inclusion {
                        parent,
                        name,
                        place,
                    },
                );
            }
            _ => {
                let parameter = if name == "ref" {
                    let id = attributes.text("id")?.0;
                    let name = attributes.text_optional("name");
                    (name.map_or(String::new(), |n| n.0), Value::Reference(id))
                } else {
                    let parameter = attributes.text("name")?.0;
                    let value = {
                        let Self {
                            variables,
                            warnings,
                            ..
                        } = self;
                        parameter::value(node, &mut attributes, file, variables, warnings)?
                    };
                    (parameter, value)
                };
                let name = if file.legacy {
                    upgrade::underscore_case(&parameter.0)
                } else {
                    parameter.0
                };
                let place = attributes.place().clone();
                self.objects[parent].add(name, parameter.1, place)?;
            }
        }
        if name != "transform" {
            no_elements_in(node, file)?;
        }
        attributes.finish()
    }

    fn object(
        &mut self,
        node: Node,
        tag: Tag,
        parent: usize,
        name: Option<String>,
        file: &File,
        depth: usize,
    ) -> Result<(), LoadError> {
        let mut attributes = Attributes::new(node, &file.source, &mut self.variables)?;
        let plugin = attributes.text("type")?.0;
        let id = attributes.text_optional("id");
        let own_name = attributes.text_optional("name");
        let name = name.filter(|name| !name.is_empty());
        let name = name.unwrap_or(own_name.map_or(String::new(), |(name, _)| name));
        if node.parent().is_some_and(|parent| parent.is_root()) {
            attributes.text("version")?;
        }
        let place = attributes.place().clone();
        attributes.finish()?;

        let index = self.objects.len();
        let name = if file.legacy {
            upgrade::underscore_case(&name)
        } else {
            name
        };
        self.objects[parent].add(name, Value::Object(index), place.clone())?;
        let id = id.filter(|(id, _)| !id.is_empty());
        if let Some((id, at)) = &id {
            self.ids.claim(id, index, &self.objects, at)?;
        }
        let id = id.map(|(id, _)| id);
        self.objects.push(Object::new(tag, plugin, id, place));
        self.contents(node, index, file, depth + 1)?;
        if file.legacy {
            upgrade::object(&mut self.objects[index])?;
        }
        Ok(())
    }

    fn default(&mut self, attributes: &mut Attributes) -> Result<(), LoadError> {
        let (name, place) = attributes.text("name")?;
        let (value, _) = attributes.text("value")?;
        if name.is_empty() {
            let cause = value::malformed("", "the name of a variable");
            return Err(LoadError::at(&place, cause));
        }
        self.variables.set_default(&name, &value);
        Ok(())
    }

    fn alias(&mut self, attributes: &mut Attributes) -> Result<(), LoadError> {
        let (id, place) = attributes.text("id")?;
        let (alias, alias_place) = attributes.text("as")?;
        let index = self.ids.object(&id);
        let index = index.map_err(|cause| LoadError::at(&place, cause))?;
        self.ids.claim(&alias, index, &self.objects, &alias_place)
    }

    fn search_path(
        &mut self,
        attributes: &mut Attributes,
        parent_object: usize,
    ) -> Result<(), LoadError> {
        let (value, place) = attributes.text("value")?;
        if parent_object != 0 {
            let cause = Cause::Conflict("<path> may stand directly in <scene> only".into());
            return Err(attributes.error(cause));
        }
        let path = parent(place.file().path()).join(value);
        if !path.is_dir() {
            let error = io::Error::new(io::ErrorKind::NotFound, "no such folder");
            return Err(LoadError::at(&place, Cause::Unreadable { path, error }));
        }
        self.search.insert(0, path);
        Ok(())
    }

    fn include(&mut self, filename: &str, to: Inclusion) -> Result<(), LoadError> {
        self.includes += 1;
        if self.includes > MOST_INCLUDES {
            let cause = Cause::TooManyIncludes(MOST_INCLUDES);
            return Err(LoadError::at(&to.place, cause));
        }
        if self.including.len() > DEEPEST {
            return Err(LoadError::at(&to.place, Cause::NestedTooDeep(DEEPEST)));
        }
        let own = parent(to.place.file().path());
        let has_file = |dir: &&PathBuf| dir.join(filename).exists();
        let found = [&own].into_iter().chain(&self.search).find(has_file);
        let path = found.unwrap_or(&own).join(filename);
        self.file(&path, Some(to))
    }

    fn unknown_element(&self, node: Node, parent: &str, file: &File) -> LoadError {
        let objects = Tag::ALL.iter().map(|(name, _)| *name);
        let known = objects.chain(OTHER_ELEMENTS);
        let known = known.filter(|name| *name != "scene");
        let cause = Cause::UnknownElement {
            found: node.tag_name().name().to_owned(),
            parent: parent.to_owned(),
            known: known.map(str::to_owned).collect(),
        };
        LoadError::at(&start_tag(node, &file.source), cause)
    }
}

fn tag_of(node: Node) -> Option<Tag> {
    let name = node.tag_name().name();
    let found = Tag::ALL.iter().find(|(known, _)| *known == name);
    found.map(|(_, tag)| *tag)
}
