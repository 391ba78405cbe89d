//! Which module uses which, and where that breaks the order or closes a circle.

use std::collections::{BTreeMap, BTreeSet};

use crate::imports::{Import, ModulePath, contents};

/// Path below `src`, with slashes, and text of each source file.
pub type Sources = BTreeMap<String, String>;

/// The modules that are not only for tests.
#[derive(Default)]
pub struct Crate {
    modules: BTreeMap<ModulePath, Module>,
}

#[derive(Default)]
struct Module {
    /// The file, as in [`Sources`]; inline modules have that of the module around them.
    file: String,
    imports: Vec<Import>,
}

/// One module uses another.
struct Arrow {
    file: String,
    line: usize,
    from: ModulePath,
    to: ModulePath,
}

impl Arrow {
    /// Number of leading names that both ends share.
    fn common(&self) -> usize {
        let pairs = self.from.iter().zip(&self.to);
        pairs.take_while(|(a, b)| a == b).count()
    }

    fn text(&self) -> String {
        let [from, to] = [&self.from, &self.to].map(|path| path.join("::"));
        format!("src/{}:{}: {from} uses {to}", self.file, self.line)
    }
}

impl Crate {
    /// All that is declared in `lib.rs` and `main.rs`, directly or through others.
    pub fn of(sources: &Sources) -> Self {
        let mut all = Self::default();
        for root in ["lib.rs", "main.rs"] {
            if sources.contains_key(root) {
                all.read(sources, root, &[]);
            }
        }
        all
    }

    /// Reads a file and the files of the modules that it declares.
    fn read(&mut self, sources: &Sources, file: &str, module: &[String]) {
        let text = sources.get(file).unwrap_or_else(|| panic!("no {file}"));
        let contents = contents(text, module).unwrap_or_else(|e| panic!("{file}: {e}"));
        for (path, imports) in contents.imports {
            let module = self.modules.entry(path).or_default();
            module.file = file.to_owned();
            module.imports.extend(imports);
        }
        for child in contents.declared {
            let path = child.join("/");
            let candidates = [format!("{path}.rs"), format!("{path}/mod.rs")];
            let found = candidates.iter().find(|file| sources.contains_key(*file));
            let file = found.unwrap_or_else(|| panic!("{file}: no file of {}", child.join("::")));
            self.read(sources, file, &child);
        }
    }

    /// All uses of one module by another: to the module that the path names, or, with
    /// `follow_re_exports`, to the one that defines the item.
    fn arrows(&self, follow_re_exports: bool) -> Vec<Arrow> {
        let mut arrows = Vec::new();
        for (from, module) in &self.modules {
            for import in &module.imports {
                if let Some(to) = self.resolve(from, &import.segments, follow_re_exports, 0) {
                    arrows.push(Arrow {
                        file: module.file.clone(),
                        line: import.line,
                        from: from.clone(),
                        to,
                    });
                }
            }
        }
        arrows
    }

    /// The module of what `segments` names in `module`; `None` if it is of another crate.
    fn resolve(
        &self,
        module: &[String],
        segments: &[String],
        follow: bool,
        depth: u32,
    ) -> Option<ModulePath> {
        let mut at = module.to_vec();
        let mut segments = segments.iter().peekable();
        let mut is_ours = false;
        while let Some(root) =
            segments.next_if(|s| ["crate", "super", "self"].contains(&s.as_str()))
        {
            match root.as_str() {
                "crate" => at.clear(),
                "super" => drop(at.pop()),
                _ => {}
            }
            is_ours = true;
        }
        while let Some(segment) = segments.next() {
            let child = [at.as_slice(), std::slice::from_ref(segment)].concat();
            if self.modules.contains_key(&child) {
                (at, is_ours) = (child, true);
                continue;
            }
            let imports = self
                .modules
                .get(&at)
                .map_or(&[][..], |module| &module.imports);
            let re_export = imports
                .iter()
                .find(|import| import.name.as_ref() == Some(segment));
            if let Some(re_export) = re_export.filter(|_| is_ours && follow && depth < 8) {
                let rest: Vec<String> = segments.cloned().collect();
                let whole = [re_export.segments.clone(), rest].concat();
                return self.resolve(&at, &whole, follow, depth + 1);
            }
            break;
        }
        is_ours.then_some(at)
    }

    /// Uses of modules that do not stand below the user in `order`, and modules that it leaves out.
    pub fn violations_of(&self, order: &[&[&str]]) -> Vec<String> {
        let row = |name: &String| order.iter().position(|row| row.contains(&name.as_str()));
        let top_level = self.modules.iter().filter(|(path, _)| path.len() == 1);
        let left_out =
            top_level
                .filter(|(path, _)| row(&path[0]).is_none())
                .map(|(path, module)| {
                    format!("src/{}: {} has no place in the order", module.file, path[0])
                });
        let wrong = self.arrows(false).into_iter().filter(|arrow| {
            let ends = [arrow.from.first(), arrow.to.first()];
            let [Some(from), Some(to)] = ends else {
                return false;
            };
            from != to && row(from).zip(row(to)).is_some_and(|(from, to)| from >= to)
        });
        let wrong = wrong.map(|arrow| format!("{}, which is not below it", arrow.text()));
        left_out.chain(wrong).collect()
    }

    /// All imports that are part of a circle between the children of one module: its files, and its
    /// directories, each as a whole.
    pub fn circles(&self) -> Vec<String> {
        let mut arrows = self.arrows(true);
        // Imports between parent and child do not count; the order covers the top level.
        arrows.retain(|arrow| {
            let common = arrow.common();
            common > 0 && common < arrow.from.len().min(arrow.to.len())
        });
        let children = |arrow: &Arrow| {
            let end = arrow.common() + 1;
            [arrow.from[..end].to_vec(), arrow.to[..end].to_vec()]
        };
        let edges: BTreeSet<[ModulePath; 2]> = arrows.iter().map(children).collect();
        let is_in_circle = |arrow: &Arrow| {
            let [from, to] = children(arrow);
            reaches(&edges, &to, &from)
        };
        let found = arrows.iter().filter(|arrow| is_in_circle(arrow));
        let mut found: Vec<String> = found
            .map(|arrow| {
                let [from, to] = children(arrow).map(|path| path.join("::"));
                format!("{}: {to} also leads to {from}", arrow.text())
            })
            .collect();
        found.dedup();
        found
    }
}

/// True if a path along `edges` leads from one module to another.
fn reaches(edges: &BTreeSet<[ModulePath; 2]>, from: &ModulePath, to: &ModulePath) -> bool {
    let mut seen = BTreeSet::from([from]);
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for [_, next] in edges.iter().filter(|[start, _]| start == module) {
            if seen.insert(next) {
                open.push(next);
            }
        }
    }
    seen.contains(to)
}
