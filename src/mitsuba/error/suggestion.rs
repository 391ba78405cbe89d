//! Suggestions for a misspelled name.

/// Minimum Jaro-Winkler similarity (1 for equal names) of a suggestion.
const MIN_SIMILARITY: f64 = 0.7;

/// Maximum number of known names that a message lists.
const MAX_LISTED: usize = 40;

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
    let shown = known.iter().take(MAX_LISTED).cloned().collect::<Vec<_>>();
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
        .filter(|(similarity, _)| *similarity >= MIN_SIMILARITY)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name.as_str())
}
