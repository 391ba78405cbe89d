//! Text of scene files that is not XML, but that Mitsuba's parser (pugixml) and the editors of scene
//! files accept: `--` within comments, and white space before the XML declaration.

use std::borrow::Cow;

/// `text` as XML of the same length, so that places in one are places in the other. Only comments and
/// the declaration, which are not read, may differ.
pub fn as_xml(text: &str) -> Cow<'_, str> {
    let mut blanks: Vec<(usize, usize)> = Vec::new();
    blanks.extend(declaration(text));
    let mut at = 0;
    while let Some(found) = text[at..].find("<!") {
        let start = at + found;
        let (open, close) = match &text[start..] {
            rest if rest.starts_with("<!--") => ("<!--", "-->"),
            rest if rest.starts_with("<![CDATA[") => ("<![CDATA[", "]]>"),
            _ => ("<!", ">"),
        };
        let body = start + open.len();
        let Some(length) = text[body..].find(close) else {
            break;
        };
        let content = &text[body..body + length];
        if close == "-->" && (content.contains("--") || content.ends_with('-')) {
            blanks.push((body, body + length));
        }
        at = body + length + close.len();
    }
    if blanks.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut result = String::with_capacity(text.len());
    let mut at = 0;
    for (start, end) in blanks {
        result.push_str(&text[at..start]);
        // Line breaks stay: the parser counts them.
        let blank = text[start..end].bytes();
        result.extend(blank.map(|b| if b == b'\n' { '\n' } else { ' ' }));
        at = end;
    }
    result.push_str(&text[at..]);
    Cow::Owned(result)
}

/// The XML declaration, if white space comes before it. A byte order mark may come first.
fn declaration(text: &str) -> Option<(usize, usize)> {
    let after_mark = text.trim_start_matches('\u{feff}');
    let trimmed = after_mark.trim_start();
    let is_indented = trimmed.len() < after_mark.len();
    if !(is_indented && trimmed.starts_with("<?xml")) {
        return None;
    }
    let start = text.len() - trimmed.len();
    let length = trimmed.find("?>")? + 2;
    Some((start, start + length))
}

#[cfg(test)]
mod tests {
    use super::as_xml;

    #[test]
    fn comments_with_dashes_and_a_late_declaration_become_blank() {
        for (text, expected) in [
            ("<a><!-- b -- c --></a>", "<a><!--        --></a>"),
            ("<a><!-- é--\n- ---></a>", "<a><!--     \n   --></a>"),
            ("<a><!-- b - c --></a>", "<a><!-- b - c --></a>"),
            (
                "\n<?xml version=\"1.0\"?><a/>",
                "\n                     <a/>",
            ),
            ("<a><![CDATA[<!-- -- ]]></a>", "<a><![CDATA[<!-- -- ]]></a>"),
            ("<a><!-- -- ", "<a><!-- -- "),
        ] {
            let xml = as_xml(text);
            assert_eq!(xml, expected);
            assert_eq!(xml.len(), text.len());
        }
    }
}
