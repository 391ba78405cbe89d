//! Substitution of `$name` in attributes, with values from `-D name=value` and `<default>`.

use std::collections::BTreeMap;
use std::ops::Bound::{Included, Unbounded};

use crate::mitsuba::error::Cause;

/// Maximum length of an attribute after substitution, in bytes. Without a limit, defaults that
/// each double the previous one would exhaust memory.
const MAX_LENGTH: usize = 1 << 20;

/// Maximum total length of all attributes with substituted variables, in bytes.
const MAX_TOTAL: usize = 1 << 26;

struct Variable {
    value: String,
    /// Given on the command line. It takes precedence over defaults, and a warning says if no file
    /// uses it.
    defined: bool,
    used: bool,
}

/// The values of `$variables`.
pub struct Substitution {
    /// By name.
    variables: BTreeMap<String, Variable>,
    /// Total length so far of attributes with substituted variables, in bytes.
    total: usize,
}

impl Substitution {
    /// The variables of the command line. The last value given for a name counts.
    pub fn new(defines: &[(String, String)]) -> Self {
        let variable = |(name, value): &(String, String)| {
            let variable = Variable {
                value: value.clone(),
                defined: true,
                used: false,
            };
            (name.clone(), variable)
        };
        Self {
            variables: defines.iter().map(variable).collect(),
            total: 0,
        }
    }

    /// Sets the value of a `<default>`, unless the variable already has one.
    pub fn set_default(&mut self, name: &str, value: &str) {
        let default = || Variable {
            value: value.to_owned(),
            defined: false,
            used: false,
        };
        self.variables
            .entry(name.to_owned())
            .or_insert_with(default);
    }

    /// Replaces each `$name` in `text`. As in Mitsuba 3 the longest name that matches is taken, so
    /// `$size2` may be `$size` followed by a 2, and `\$` is a dollar sign.
    pub fn apply(&mut self, text: &str) -> Result<String, Cause> {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let (before, after) = (&rest[..dollar], &rest[dollar + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                result.push_str(before);
                result.push('$');
                rest = after;
                continue;
            }
            result.push_str(before);
            let length = self.longest_match(after).map(str::len);
            let variable = length.and_then(|length| self.variables.get_mut(&after[..length]));
            let (Some(length), Some(variable)) = (length, variable) else {
                return Err(self.undefined(after));
            };
            variable.used = true;
            result.push_str(&variable.value);
            rest = &after[length..];
            if result.len() > MAX_LENGTH {
                return Err(Cause::SubstitutionTooLong(MAX_LENGTH));
            }
        }
        result.push_str(rest);
        if rest.len() < text.len() {
            self.total += result.len();
        }
        if self.total > MAX_TOTAL {
            return Err(Cause::SubstitutionTooMuch(MAX_TOTAL));
        }
        Ok(result)
    }

    /// The names and the values of the variables that [`Self::apply`] replaces in `text`.
    pub fn values_in(&self, text: &str) -> Vec<(String, String)> {
        let mut values = Vec::new();
        let mut parts = text.split('$');
        let mut is_escaped = parts.next().is_some_and(|before| before.ends_with('\\'));
        for part in parts {
            let name = self.longest_match(part).filter(|_| !is_escaped);
            if let Some((name, variable)) = name.and_then(|name| self.variables.get_key_value(name))
            {
                values.push((name.clone(), variable.value.clone()));
            }
            is_escaped = part.ends_with('\\');
        }
        values
    }

    /// The names given on the command line that no file has used.
    pub fn unused(&self) -> impl Iterator<Item = &str> {
        let is_unused = |(_, v): &(&String, &Variable)| v.defined && !v.used;
        let unused = self.variables.iter().filter(is_unused);
        unused.map(|(name, _)| name.as_str())
    }

    /// The longest name that `text` begins with. Names that begin like it are neighbours in their order: the
    /// last one that is not after `text` is the longest or, if `text` does not begin with it, has as many
    /// letters in common with `text` as any name.
    fn longest_match(&self, text: &str) -> Option<&str> {
        let mut text = text;
        loop {
            let (name, _) = self
                .variables
                .range::<str, _>((Unbounded, Included(text)))
                .next_back()?;
            if text.starts_with(name.as_str()) {
                return Some(name.as_str()).filter(|name| !name.is_empty());
            }
            let common = text.char_indices().zip(name.chars());
            let mut differing = common.filter(|((_, a), b)| a != b);
            let end = differing.next().map_or(0, |((byte, _), _)| byte);
            text = &text[..end];
        }
    }

    fn undefined(&self, text: &str) -> Cause {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = text.find(|c| !is_name(c)).unwrap_or(text.len());
        Cause::UndefinedVariable {
            found: text[..end].to_owned(),
            known: self.variables.keys().cloned().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(defines: &[(&str, &str)]) -> Substitution {
        let owned = |&(a, b): &(&str, &str)| (a.to_owned(), b.to_owned());
        Substitution::new(&defines.iter().map(owned).collect::<Vec<_>>())
    }

    #[test]
    fn the_longest_name_is_taken_and_a_backslash_escapes() {
        let mut s = with(&[("a", "1"), ("ab", "2")]);
        assert_eq!(s.apply("$a$ab$abc \\$a").unwrap(), "122c $a");

        // Names after and between those that match.
        let mut s = with(&[
            ("a", "1"),
            ("abc", "3"),
            ("abx", "4"),
            ("aé", "5"),
            ("b", "6"),
        ]);
        assert_eq!(
            s.apply("$abd $abb $abcd $aéz $az").unwrap(),
            "1bd 1bb 3d 5z 1z"
        );
        assert!(s.apply("$c").is_err() && s.apply("$").is_err());
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let values = s.values_in("$abd/\\$b $aéz");
        assert_eq!(values, [pair("a", "1"), pair("aé", "5")]);
    }

    #[test]
    fn the_command_line_takes_precedence_and_unused_names_are_listed() {
        let mut s = with(&[("a", "1"), ("b", "2")]);
        s.set_default("a", "3");
        s.set_default("c", "4");
        s.set_default("c", "5");
        assert_eq!(s.apply("$a $c").unwrap(), "1 4");
        assert_eq!(s.unused().collect::<Vec<_>>(), ["b"]);
    }

    #[test]
    fn an_undefined_variable_is_reported_with_a_suggestion() {
        let mut s = with(&[("depth", "1")]);
        let error = s.apply("x$dpeth-1").unwrap_err().to_string();
        assert!(error.contains("`$dpeth`") && error.contains("did you mean `depth`"));
    }

    #[test]
    fn defaults_that_double_in_length_are_rejected() {
        let mut s = with(&[("a0", "xxxxxxxxxxxxxxxx")]);
        let mut last = Ok(String::new());
        for i in 1..64 {
            last = s.apply(&format!("$a{0}$a{0}", i - 1));
            match &last {
                Ok(value) => s.set_default(&format!("a{i}"), &value.clone()),
                Err(_) => break,
            }
        }
        assert!(matches!(last, Err(Cause::SubstitutionTooLong(_))));
    }

    #[test]
    fn long_values_used_often_are_rejected() {
        let long = "x".repeat(MAX_LENGTH - 1);
        let mut s = with(&[("long", &long)]);
        let uses = MAX_TOTAL / MAX_LENGTH;
        for _ in 0..uses {
            assert!(s.apply("$long").is_ok());
        }
        // Text without variables is limited by the size of the file and does not count.
        assert!(s.apply(&long).is_ok());
        assert!(matches!(
            s.apply("-$long-$long"),
            Err(Cause::SubstitutionTooLong(_))
        ));
        let last = (0..2).map(|_| s.apply("$long")).last();
        assert!(matches!(last, Some(Err(Cause::SubstitutionTooMuch(_)))));
    }
}
