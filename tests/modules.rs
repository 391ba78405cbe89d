//! The order of the modules under `src`: a module uses only modules that stand below it in [`ORDER`],
//! and no two files or directories of one module import each other, directly or through others.
//!
//! The checker reads tokens, so comments and strings do not count, and follows `mod` declarations from
//! `lib.rs` and `main.rs`, so that test modules do not count either. Paths are those that begin with
//! `crate`, `super` or `self`, and those of `use` that begin with a child module. A name that a `mod.rs`
//! re-exports counts as an import of the file that it comes from; glob re-exports are not followed.
//! A `mod.rs` and its own files count as one: it declares them and may hold what they share.

#[path = "modules/graph.rs"]
mod graph;
#[path = "modules/imports.rs"]
mod imports;

use std::fs;
use std::path::Path;

use graph::{Crate, Sources};

/// All top-level modules, from top to bottom. Those in one row do not use each other.
const ORDER: [&[&str]; 18] = [
    &["commands"],
    &["convergence", "diagnosis"],
    &["render"],
    &["analysis"],
    &["integrators"],
    &["technique"],
    &["path"],
    &["markov"],
    &["mitsuba"],
    &["scene"],
    &["bvh"],
    &["sampling"],
    &["metrics"],
    &["film"],
    &["plot"],
    &["statistics"],
    &["math"],
    // Planted faults, for the use of all.
    &["fault"],
];

#[test]
fn modules_use_only_modules_below_them() {
    let found = Crate::of(&sources()).violations_of(&ORDER);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn files_of_a_module_do_not_import_each_other_in_a_circle() {
    let found = Crate::of(&sources()).circles();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

fn sources() -> Sources {
    fn read(directory: &Path, prefix: &str, sources: &mut Sources) {
        for entry in fs::read_dir(directory).expect("a directory") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy();
            let name = format!("{prefix}{name}");
            if path.is_dir() {
                read(&path, &format!("{name}/"), sources);
            } else if path.extension().is_some_and(|e| e == "rs") {
                sources.insert(name, fs::read_to_string(&path).expect("a source"));
            }
        }
    }
    let mut sources = Sources::new();
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    read(&src, "", &mut sources);
    sources
}

fn crate_of(files: &[(&str, &str)]) -> Crate {
    let own = |(path, text): &(&str, &str)| ((*path).to_owned(), (*text).to_owned());
    Crate::of(&files.iter().map(own).collect())
}

#[test]
fn an_arrow_that_goes_up_is_found() {
    let order: [&[&str]; 2] = [&["top", "side"], &["bottom"]];
    let of = |top: &str, side: &str, bottom: &str| {
        let files = [
            ("lib.rs", "mod top; mod side; mod bottom;"),
            ("top.rs", top),
            ("side.rs", side),
            ("bottom.rs", bottom),
        ];
        crate_of(&files).violations_of(&order)
    };
    let down = "use crate::bottom::{self, X};\nfn f() -> super::bottom::Y {}";
    assert!(of(down, "", "use std::fmt;").is_empty());
    let up = "src/bottom.rs:2: bottom uses top, which is not below it";
    for text in [
        "\nuse crate::top::X;",
        "\nuse crate::{top};",
        "\nuse super::top;",
        "\nfn f() { let x = [crate::top::X]; }",
        "\nmod inline { use super::super::top; }",
    ] {
        let found = of(down, "", text);
        assert_eq!(found.len(), 1, "{text}: {found:?}");
        let found = found[0].replace("bottom::inline", "bottom");
        assert_eq!(found, up, "{text}");
    }
    let across = of("use crate::side::X;", "", "");
    assert_eq!(
        across,
        ["src/top.rs:1: top uses side, which is not below it"]
    );
    let unknown = crate_of(&[("lib.rs", "mod other;"), ("other.rs", "")]).violations_of(&order);
    assert_eq!(unknown, ["src/other.rs: other has no place in the order"]);
}

#[test]
fn comments_strings_and_tests_do_not_count() {
    let bottom = r#"
        //! As [`crate::top::X`].
        // use crate::top::X;
        const TEXT: &str = "use crate::top::X;";
        pub(crate) fn f() {}
        #[cfg(test)] use crate::top::X;
        #[cfg(test)] mod outside;
        #[cfg(test)] mod tests { use crate::top::X; }
        #[cfg(all(test, unix))] fn g() { crate::top::f() }
    "#;
    let files = [
        ("lib.rs", "mod top; mod bottom;"),
        ("top.rs", "use crate::bottom;"),
        ("bottom.rs", bottom),
        ("bottom/outside.rs", "use crate::top::X;"),
    ];
    let found = crate_of(&files).violations_of(&[&["top"], &["bottom"]]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn a_circle_is_found() {
    let of = |shared: &str, a: &str, b: &str, c: &str| {
        let files = [
            ("lib.rs", "mod m;"),
            ("m/mod.rs", shared),
            ("m/a.rs", a),
            ("m/b/mod.rs", "mod inner;"),
            ("m/b/inner.rs", b),
            ("m/c.rs", c),
        ];
        crate_of(&files).circles()
    };
    let plain = "mod a; mod b; mod c; use a::A; struct Shared;";
    // The parent and its children use each other; the children do not.
    let apart = of(
        plain,
        "use super::Shared; use super::b::B;",
        "use crate::m::c::C;",
        "",
    );
    assert!(apart.is_empty(), "{apart:?}");
    // Two that import each other; one of them is a directory.
    let two = of(plain, "use super::b::B;", "use crate::m::a::A;", "");
    assert_eq!(
        two,
        [
            "src/m/a.rs:1: m::a uses m::b: m::b also leads to m::a",
            "src/m/b/inner.rs:1: m::b::inner uses m::a: m::a also leads to m::b"
        ]
    );
    // Three, and one arrow passes through a re-export under another name.
    let renamed = "mod a; mod b; mod c; pub use c::Real as C;";
    let three = of(
        renamed,
        "use super::b::B;",
        "use crate::m::{C};",
        "\nfn f(a: super::a::A) {}",
    );
    assert_eq!(three.len(), 3, "{three:?}");
    assert_eq!(
        three[1],
        "src/m/b/inner.rs:1: m::b::inner uses m::c: m::c also leads to m::b"
    );
    let broken = of(renamed, "use super::b::B;", "use crate::m::{C};", "");
    assert!(broken.is_empty(), "{broken:?}");
}
