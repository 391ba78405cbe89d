//! The state of a scene under construction, which the plugins read and extend.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::PathBuf;

use super::error::{Faults, LoadError, Warning};
use super::ignored::{Ignored, is_of_a_fork};
use super::xml::{Object, Property, Tag, Tree, Value};
use crate::scene::{EmitterDescription, Material, ShapeDescription, Texture};

/// What the user specifies in place of the scene file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Width and height of the image in pixels. The field of view changes as if the film had this
    /// size.
    pub size: Option<[u32; 2]>,
}

/// A scene under construction.
pub struct Builder<'a> {
    tree: &'a Tree,
    /// What the user specifies in place of the scene file.
    pub overrides: Overrides,
    /// Textures, which materials refer to by index.
    pub textures: Vec<Texture>,
    /// Materials, which shapes refer to by index.
    pub materials: Vec<Material>,
    /// The textures of objects: index of the object to index of the texture.
    pub texture_of: HashMap<usize, u32>,
    /// Why a texture is no reflectance: an image with values outside [0, 1]. By index of the texture.
    pub out_of_range: HashMap<u32, LoadError>,
    /// Why a texture is no radiance: an image with negative values. By index of the texture.
    pub negative: HashMap<u32, LoadError>,
    /// The materials of objects: index of the object to index of the material.
    pub material_of: HashMap<usize, u32>,
    /// Surfaces.
    pub shapes: Vec<ShapeDescription>,
    /// Emitters that are not surfaces.
    pub emitters: Vec<EmitterDescription>,
    /// Suspicious parts of the scene files.
    pub warnings: &'a mut Vec<Warning>,
    /// Why objects cannot be built. The others are built nevertheless, to find all faults.
    pub faults: Faults,
    /// Parameters that are left out of account.
    ignored: RefCell<Ignored>,
}

impl<'a> Builder<'a> {
    /// An empty scene, to be filled from the objects of `tree`.
    pub fn new(tree: &'a Tree, overrides: Overrides, warnings: &'a mut Vec<Warning>) -> Self {
        Self {
            tree,
            overrides,
            textures: Vec::new(),
            materials: Vec::new(),
            texture_of: HashMap::new(),
            out_of_range: HashMap::new(),
            negative: HashMap::new(),
            material_of: HashMap::new(),
            shapes: Vec::new(),
            emitters: Vec::new(),
            warnings,
            faults: Faults::default(),
            ignored: RefCell::default(),
        }
    }

    /// The object at `index`.
    pub fn object(&self, index: usize) -> &'a Object {
        &self.tree.objects[index]
    }

    /// The only nested object of the kind `tag`, if there is one.
    pub fn child(&self, object: &Object, tag: Tag) -> Result<Option<usize>, LoadError> {
        object.child(&self.tree.objects, tag)
    }

    /// The indices of all nested objects of the kind `tag`.
    pub fn children(&self, object: &Object, tag: Tag) -> Vec<usize> {
        let children = object.children(&self.tree.objects, tag);
        children.map(|(index, _)| index).collect()
    }

    /// The indices of the BSDFs nested in `object`. The object may still reject them.
    pub fn nested_bsdfs(&self, object: &'a Object) -> impl Iterator<Item = usize> + use<'a> {
        let nested = object.nested(&self.tree.objects, Tag::Bsdf);
        nested.map(|(index, _)| index)
    }

    /// The materials of the BSDFs nested in `object`, which are built before it, and the properties
    /// that hold them.
    pub fn nested_materials(&self, object: &'a Object) -> Vec<(&Material, &'a Property)> {
        let nested = object.children(&self.tree.objects, Tag::Bsdf);
        nested
            .filter_map(|(index, property)| {
                let material = *self.material_of.get(&index)?;
                Some((&self.materials[material as usize], property))
            })
            .collect()
    }

    /// True if an object other than the scene refers to the object at `index`.
    pub fn is_referenced(&self, index: usize) -> bool {
        let is_it = |property: &Property| matches!(property.value, Value::Object(i) if i == index);
        let mut others = self.tree.objects.iter().skip(1);
        others.any(|object| object.properties.iter().any(is_it))
    }

    /// Checks that all parameters and nested objects of `object` have been read, except those of research
    /// forks, which are ignored.
    pub fn finish(&self, object: &Object) -> Result<(), LoadError> {
        for property in object.unused().filter(|p| is_of_a_fork(&p.name)) {
            self.ignore(object, property);
        }
        object.finish(&self.tree.objects)
    }

    /// Ignores all parameters of `object` that have not been read, whatever they are.
    pub fn ignore_rest(&self, object: &Object) {
        for property in object.unused() {
            self.ignore(object, property);
        }
    }

    /// Ignores a parameter of `object`, which a warning mentions.
    pub fn ignore(&self, object: &Object, property: &Property) {
        property.used.set(true);
        self.ignored.borrow_mut().add(object, property);
    }

    /// A warning of all parameters that were ignored, if there are any.
    pub fn ignored(&self) -> Option<Warning> {
        self.ignored.borrow().warning()
    }

    /// The path of the file that the required parameter `filename` names, and that parameter.
    pub fn file(&self, object: &'a Object) -> Result<(PathBuf, &'a Property), LoadError> {
        match object.text("filename")? {
            Some((name, property)) => Ok((self.tree.locate(name, &property.place), property)),
            None => Err(object.missing("the string `filename`")),
        }
    }

    /// Adds a texture and returns its index.
    pub fn add_texture(&mut self, texture: Texture) -> u32 {
        self.textures.push(texture);
        (self.textures.len() - 1) as u32
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        (self.materials.len() - 1) as u32
    }
}
