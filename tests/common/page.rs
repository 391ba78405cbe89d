//! Parses an HTML page, and loads it in a browser.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

/// A page that `report` wrote.
pub struct Page {
    html: String,
    /// The same without the contents of styles and scripts, which is well-formed XML.
    markup: String,
    /// Contents of styles and scripts, each with its opening tag.
    raw: Vec<(String, String)>,
}

impl Page {
    pub fn read(path: &Path) -> Self {
        let html = fs::read_to_string(path).expect("a page");
        let mut page = Self {
            markup: String::new(),
            raw: Vec::new(),
            html: html.clone(),
        };
        // As in browsers, <script> and <style> are raw text up to the first end tag.
        let mut rest = html.as_str();
        while let Some(start) = ["<script", "<style"]
            .iter()
            .filter_map(|tag| rest.find(tag))
            .min()
        {
            let open = start + rest[start..].find('>').expect("a tag ends") + 1;
            let end = if rest[start..].starts_with("<script") {
                "</script"
            } else {
                "</style"
            };
            let close = open + rest[open..].find(end).expect("an end tag");
            page.markup += &rest[..open];
            page.raw
                .push((rest[start..open].into(), rest[open..close].into()));
            rest = &rest[close..];
        }
        page.markup += rest;
        page
    }

    /// The markup as a tree. Being well-formed shows that nothing was inserted unescaped.
    pub fn document(&self) -> roxmltree::Document<'_> {
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        };
        roxmltree::Document::parse_with_options(&self.markup, options).expect("well-formed markup")
    }

    /// All visible text.
    pub fn text(&self) -> String {
        let document = self.document();
        let texts = document.descendants().filter(|node| node.is_text());
        texts.filter_map(|node| node.text()).collect()
    }

    /// The data of the viewer's script.
    pub fn data(&self) -> Value {
        let mut json = self
            .raw
            .iter()
            .filter(|(tag, _)| tag.contains("application/json"));
        let (_, text) = json.next().expect("data");
        serde_json::from_str(text).expect("JSON")
    }

    /// Asserts that no element or style refers to anything outside the page, and that no attribute is a
    /// script.
    pub fn check_stands_alone(&self) {
        for node in self
            .document()
            .descendants()
            .filter(|node| node.is_element())
        {
            let name = node.tag_name().name();
            for tag in [
                "link", "iframe", "object", "embed", "base", "video", "audio", "form",
            ] {
                assert_ne!(name, tag);
            }
            for attribute in node.attributes() {
                let (name, value) = (attribute.name(), attribute.value());
                assert!(!name.starts_with("on"), "{name}");
                match name {
                    "href" => assert!(value.starts_with('#'), "{value}"),
                    "src" => check_picture(value),
                    "srcset" | "action" | "data" | "poster" => panic!("{name}={value}"),
                    _ => (),
                }
            }
        }
        for (tag, text) in &self.raw {
            if !tag.contains("application/json") {
                for outside in [
                    "http:", "https:", "//cdn", "@import", "url(", "fetch(", "import ",
                ] {
                    assert!(!text.contains(outside), "{outside}");
                }
            }
        }
    }
}

/// Asserts that a data URI holds a picture that can be decoded.
fn check_picture(uri: &str) {
    let (kind, data) = uri
        .strip_prefix("data:image/")
        .and_then(|rest| rest.split_once(";base64,"))
        .expect("a picture in base64");
    let bytes = STANDARD.decode(data).expect("base64");
    match kind {
        "png" => assert!(image::load_from_memory(&bytes).expect("a PNG").width() > 0),
        "svg+xml" => {
            let svg = String::from_utf8(bytes).expect("UTF-8");
            roxmltree::Document::parse(&svg).expect("an SVG document");
        }
        kind => panic!("{kind}"),
    }
}

/// Headless Chromium.
pub struct Browser(PathBuf);

/// Collects errors from before the page's own script on.
const WATCH: &str = "<script>
const found = { problems: [] };
addEventListener('error', (event) => found.problems.push(String(event.message)), true);
addEventListener('unhandledrejection', (event) => found.problems.push(String(event.reason)));
addEventListener('securitypolicyviolation', (event) => found.problems.push(event.blockedURI));
console.error = (...what) => found.problems.push(what.join(' '));
window.alert = (what) => found.problems.push('alert ' + what);
</script>";

impl Browser {
    /// The first of the usual names that is installed.
    pub fn find() -> Option<Self> {
        let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
        let path = std::env::var_os("PATH")?;
        let mut files =
            std::env::split_paths(&path).flat_map(|dir| names.map(|name| dir.join(name)));
        files.find(|file| file.is_file()).map(Self)
    }

    /// Runs `script` in the loaded page and returns the object `found` that it filled, with the errors
    /// and policy violations in `problems`.
    pub fn run(&self, page: &Page, script: &str) -> Value {
        let end = "const end = document.createElement('pre'); end.id = 'found'; \
                   end.textContent = btoa(encodeURIComponent(JSON.stringify(found))); \
                   document.body.append(end);";
        let output = self.load(page, &format!("{script}\n{end}"), &["--dump-dom"]);
        let dom = String::from_utf8_lossy(&output.stdout);
        let found = dom.rsplit_once("<pre id=\"found\">").map(|(_, rest)| rest);
        let Some((found, _)) = found.and_then(|rest| rest.split_once("</pre>")) else {
            panic!(
                "the script did not end: {}",
                String::from_utf8_lossy(&output.stderr)
            );
        };
        let found = STANDARD.decode(found).expect("base64");
        serde_json::from_str(&percent_decoded(&found)).expect("JSON")
    }

    /// Runs `script` in the page and writes a screenshot.
    pub fn screenshot(&self, page: &Page, script: &str, to: &Path) {
        let shot = format!("--screenshot={}", to.display());
        self.load(page, script, &[&shot]);
    }

    fn load(&self, page: &Page, script: &str, options: &[&str]) -> Output {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("page.html");
        let html = page.html.replacen("<head>", &format!("<head>{WATCH}"), 1);
        let script = format!(
            "<script>addEventListener('load', () => {{ try {{ {script} }} catch (error) {{ \
             const end = document.createElement('pre'); end.id = 'found'; \
             end.textContent = btoa(encodeURIComponent(JSON.stringify({{ problems: [String(error.stack)] }}))); \
             document.body.append(end); }} }});</script></body>"
        );
        // The last </body> is the page's own.
        let (before, after) = html.rsplit_once("</body>").expect("a body");
        fs::write(&path, format!("{before}{script}{after}")).expect("written");
        let mut command = Command::new(&self.0);
        command
            .args([
                "--headless=new",
                "--no-sandbox",
                "--disable-gpu",
                "--hide-scrollbars",
            ])
            .args(["--window-size=1000,800", "--virtual-time-budget=10000"])
            .arg(format!(
                "--user-data-dir={}",
                directory.path().join("profile").display()
            ))
            .args(options)
            .arg(format!("file://{}", path.display()));
        command.output().expect("the browser runs")
    }
}

/// The inverse of JavaScript's `encodeURIComponent`.
fn percent_decoded(bytes: &[u8]) -> String {
    let mut decoded = Vec::new();
    let mut rest = bytes;
    while let Some((&first, after)) = rest.split_first() {
        if first == b'%' {
            let hex = std::str::from_utf8(&after[..2]).expect("ASCII");
            decoded.push(u8::from_str_radix(hex, 16).expect("two digits"));
            rest = &after[2..];
        } else {
            decoded.push(first);
            rest = after;
        }
    }
    String::from_utf8(decoded).expect("UTF-8")
}
