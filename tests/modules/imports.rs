//! The paths that a source imports, read from its tokens.

use std::collections::BTreeMap;

use proc_macro2::{Delimiter, Ident, LexError, TokenStream, TokenTree};

/// Names from the root of the crate down, such as ["film", "exr"].
pub type ModulePath = Vec<String>;

/// A path in a source.
pub struct Import {
    /// From 1 on.
    pub line: usize,
    /// Its names, as written.
    pub segments: Vec<String>,
    /// The name that a `use` binds it to.
    pub name: Option<String>,
}

/// What a file says of modules.
#[derive(Default)]
pub struct Contents {
    /// The imports of its module, and of each inline module.
    pub imports: BTreeMap<ModulePath, Vec<Import>>,
    /// Modules that have files of their own.
    pub declared: Vec<ModulePath>,
}

/// Reads the text of the file of `module`.
pub fn contents(text: &str, module: &[String]) -> Result<Contents, LexError> {
    let mut found = Contents::default();
    found.scan(text.parse()?, module);
    Ok(found)
}

impl Contents {
    fn scan(&mut self, tokens: TokenStream, module: &[String]) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut imports = Vec::new();
        let mut i = 0;
        while i < tokens.len() {
            let rest = &tokens[i..];
            i += 1;
            match (&rest[0], rest.get(1), rest.get(2)) {
                // An item that only tests have.
                (TokenTree::Punct(p), Some(TokenTree::Group(attribute)), _)
                    if p.as_char() == '#' && is_for_tests(&attribute.stream()) =>
                {
                    i += 1 + item_length(&rest[2..]);
                }
                // mod name; or mod name { ... }
                (TokenTree::Ident(word), Some(TokenTree::Ident(name)), Some(next))
                    if word == "mod" =>
                {
                    let child = [module, &[name.to_string()]].concat();
                    match next {
                        TokenTree::Group(body) => self.scan(body.stream(), &child),
                        _ => self.declared.push(child),
                    }
                    i += 2;
                }
                // use ...;
                (TokenTree::Ident(word), Some(next), _) if word == "use" && !is(next, '<') => {
                    let end = rest.iter().position(|t| is(t, ';')).unwrap_or(rest.len());
                    imports.extend(use_tree(&rest[1..end], &[]));
                    i += end - 1;
                }
                // crate::a::b
                (TokenTree::Ident(word), Some(next), _) if is_root(word) && is(next, ':') => {
                    let (segments, length) = plain_path(rest);
                    let line = word.span().start().line;
                    imports.push(Import {
                        line,
                        segments,
                        name: None,
                    });
                    i += length - 1;
                }
                (TokenTree::Group(group), ..) => self.scan(group.stream(), module),
                _ => {}
            }
        }
        self.imports
            .entry(module.to_vec())
            .or_default()
            .extend(imports);
    }
}

fn is(token: &TokenTree, character: char) -> bool {
    matches!(token, TokenTree::Punct(p) if p.as_char() == character)
}

fn is_root(word: &Ident) -> bool {
    word == "crate" || word == "super" || word == "self"
}

/// True of `cfg(test)` and `cfg(all(test, ...))`.
fn is_for_tests(attribute: &TokenStream) -> bool {
    let text = attribute.to_string().replace(' ', "");
    text == "cfg(test)" || text.starts_with("cfg(all(test,")
}

/// Number of tokens of the item, or of the variant or field, that `tokens` begin with.
fn item_length(tokens: &[TokenTree]) -> usize {
    let is_end = |token: &TokenTree| match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        token => is(token, ';') || is(token, ','),
    };
    tokens
        .iter()
        .position(is_end)
        .map_or(tokens.len(), |end| end + 1)
}

/// The names of a path that `tokens` begin with, and how many tokens it takes.
fn plain_path(tokens: &[TokenTree]) -> (Vec<String>, usize) {
    let mut segments = Vec::new();
    let mut length = 0;
    while let Some(TokenTree::Ident(name)) = tokens.get(length) {
        segments.push(name.to_string());
        length += 1;
        let is_joined = matches!(&tokens[length..], [a, b, TokenTree::Ident(_), ..] if is(a, ':') && is(b, ':'));
        if !is_joined {
            break;
        }
        length += 2;
    }
    (segments, length)
}

/// All that a `use` between `use` and `;` imports, below `prefix`.
fn use_tree(tokens: &[TokenTree], prefix: &[String]) -> Vec<Import> {
    let (names, length) = plain_path(tokens);
    let mut segments = [prefix, &names].concat();
    let rest = &tokens[length..];
    // `a::{b, c}`: each branch is a path below `a`.
    let group = rest.iter().find_map(|token| match token {
        TokenTree::Group(group) => Some(group.stream()),
        _ => None,
    });
    if let Some(branches) = group {
        let branches: Vec<TokenTree> = branches.into_iter().collect();
        return branches
            .split(|token| is(token, ','))
            .filter(|branch| !branch.is_empty())
            .flat_map(|branch| use_tree(branch, &segments))
            .collect();
    }
    // `a::{self}` imports `a`.
    if segments.len() > 1 && segments.last().is_some_and(|last| last == "self") {
        segments.pop();
    }
    let line = tokens.first().map_or(0, |token| token.span().start().line);
    let alias = match rest {
        [TokenTree::Ident(word), TokenTree::Ident(name)] if word == "as" => Some(name.to_string()),
        _ => None,
    };
    let is_glob = rest.iter().any(|token| is(token, '*'));
    let name = alias
        .or_else(|| segments.last().cloned())
        .filter(|_| !is_glob);
    vec![Import {
        line,
        segments,
        name,
    }]
}
