//! Suggestions for a misspelled name, and quotes of at most a line.

use std::borrow::Cow;
use std::fmt::Display;

/// A name is suggested if at most one in this many characters was misspelled: wrong, missing, too many,
/// or swapped with the next.
const CHARACTERS_PER_ERROR: usize = 3;

/// Maximum number of known names that a message lists.
const MAX_LISTED: usize = 40;

/// Maximum number of characters of a name or a value that a message quotes.
const MAX_SHOWN: usize = 100;

/// Maximum number of characters of a path or a sentence.
const MAX_LONG: usize = 400;

/// `text` or, if it is long, its beginning.
pub(in crate::mitsuba) fn shown(text: &str) -> Cow<'_, str> {
    beginning(text, MAX_SHOWN)
}

/// A path or a sentence that quotes the contents of a file, or its beginning.
pub(super) fn shown_long(text: impl Display) -> String {
    beginning(&text.to_string(), MAX_LONG).into_owned()
}

fn beginning(text: &str, max: usize) -> Cow<'_, str> {
    match text.char_indices().nth(max) {
        Some((end, _)) => format!("{}...", &text[..end]).into(),
        None => text.into(),
    }
}

/// "; did you mean `x`? (known: ...)": the known name most similar to `found`, if any is similar
/// enough, and the known names.
pub(super) fn suggestion(found: &str, known: &[String]) -> String {
    let nearest = nearest(found, known);
    let suggestion = nearest.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    suggestion + &listed(known)
}

/// " (known: ...)", or nothing if no names are known.
pub(super) fn listed(known: &[String]) -> String {
    if known.is_empty() {
        return String::new();
    }
    let shown = known.iter().take(MAX_LISTED);
    let shown: Vec<_> = shown.map(|name| self::shown(name)).collect();
    let rest = known.len() - shown.len();
    let more = match rest {
        0 => String::new(),
        _ => format!(" and {rest} more"),
    };
    format!(" (known: {}{more})", shown.join(", "))
}

fn nearest<'a>(found: &str, known: &'a [String]) -> Option<&'a str> {
    // The similarity of long texts takes long to compute.
    if found.len() > MAX_SHOWN {
        return None;
    }
    let found = found.to_lowercase();
    let most_errors = (found.chars().count() / CHARACTERS_PER_ERROR).max(1);
    let known = known.iter().filter(|name| name.len() <= MAX_SHOWN);
    known
        .map(|name| (strsim::osa_distance(&found, &name.to_lowercase()), name))
        .filter(|(errors, _)| *errors <= most_errors)
        .min_by_key(|(errors, _)| *errors)
        .map(|(_, name)| name.as_str())
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_name_is_suggested_only_for_a_misspelling_of_it() {
        let known = ["height", "width", "rfilter", "max_depth", "Au"].map(str::to_owned);
        for (found, expected) in [
            ("hieght", Some("height")),
            ("maxdepth", Some("max_depth")),
            ("Aux", Some("Au")),
            ("high_quality_edges", None),
            ("filename", None),
            ("alpha", None),
        ] {
            assert_eq!(nearest(found, &known), expected, "{found}");
        }
    }
}
