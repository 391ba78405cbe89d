//! References rendered by Mitsuba 3, and runs of comparisons with them.

use std::path::{Path, PathBuf};

use metrolight::render::Settings;
use metrolight::scene::{ChainSearch, Scene};
use serde::Deserialize;

use super::comparison::{Comparison, Renderings, uniformity};

/// Level of the test that the p-values of all images are uniform, and its number of replicates.
pub const UNIFORMITY: f64 = 1e-3;
pub const REPLICATES: u64 = 4999;

/// One line of the manifest.
#[derive(Deserialize)]
pub struct Entry {
    pub name: String,
    scene: String,
    defines: std::collections::BTreeMap<String, String>,
    pub width: u32,
    height: u32,
    renderings: usize,
    /// Width and height of the stored tiles, in pixels.
    tile: [usize; 2],
    pub methods: Methods,
}

/// Which integrators find the light that the reference shows.
#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
pub enum Methods {
    All,
    Path,
}

impl Entry {
    /// True for a scene of `scenes/`.
    pub fn is_ours(&self) -> bool {
        self.scene.starts_with("scenes/")
    }

    /// True for a published scene, which is not part of the repository.
    pub fn is_published(&self) -> bool {
        self.scene.starts_with("..")
    }

    /// False if METROLIGHT_SCENE is set and not part of the name, and, with a message, if the scene is a
    /// published one that is missing.
    pub fn is_wanted(&self) -> bool {
        if std::env::var("METROLIGHT_SCENE").is_ok_and(|part| !self.name.contains(&part)) {
            return false;
        }
        let here = root().join(&self.scene).exists();
        if !here {
            println!("{}: skipped, the published scene is missing", self.name);
        }
        here
    }

    /// The scene as Mitsuba rendered it.
    pub fn load(&self) -> Scene {
        let size = [("resx", self.width), ("resy", self.height)].map(|(k, v)| (k, v.to_string()));
        let mut defines: Vec<(&str, &str)> = vec![("integrator", "path")];
        defines.extend(size.iter().map(|(k, v)| (*k, v.as_str())));
        defines.extend(self.defines.iter().map(|(k, v)| (k.as_str(), v.as_str())));
        let mut scene = super::load(&self.scene, &defines);
        if self.methods == Methods::Path {
            // Mitsuba's path tracer does not find the light of technique 1*.
            scene.casters.set_search(ChainSearch::Off);
        }
        scene
    }

    /// Mitsuba's renderings, reduced to tiles of `size`.
    pub fn reference(&self, size: [usize; 2]) -> Renderings {
        let file = read_image(&format!("{}.tiles", self.name), ["R", "G", "B"]);
        let columns = self.width as usize / self.tile[0];
        let images = file.chunks_exact(file.len() / self.renderings);
        let tile = [size[0] / self.tile[0], size[1] / self.tile[1]];
        Renderings::new(images, columns, tile)
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// All references.
pub fn manifest() -> Vec<Entry> {
    let path = root().join("tests/references/manifest.json");
    let text = std::fs::read_to_string(path).expect("the manifest");
    serde_json::from_str(&text).expect("a manifest as written by make_references.py")
}

/// Three channels of an image among the references.
pub fn read_image(name: &str, channels: [&str; 3]) -> Vec<[f32; 3]> {
    use exr::prelude::*;
    let path = root().join(format!("tests/references/{name}.exr"));
    let file = read_all_flat_layers_from_file(path).expect("a reference image");
    let channel = |name: &str| -> Vec<f32> {
        file.layer_data
            .iter()
            .flat_map(|layer| &layer.channel_data.list)
            .find(|channel| channel.name.to_string() == name)
            .map(|channel| channel.sample_data.values_as_f32().collect())
            .unwrap_or_else(|| panic!("{name} is missing"))
    };
    let [r, g, b] = channels.map(channel);
    let pairs = r.iter().zip(&g).zip(&b);
    pairs.map(|((&r, &g), &b)| [r, g, b]).collect()
}

/// Level and effort of a comparison.
pub struct Form {
    /// Level of the verdict on one image.
    pub alpha: f64,
    /// Width and height of a tile, in pixels.
    pub tile: [usize; 2],
    /// Number of our independent renderings.
    pub seeds: u64,
}

/// All comparisons of one run, and their failures.
pub struct Run {
    /// Of each comparison.
    pub form: Form,
    /// One per image.
    pub comparisons: Vec<Comparison>,
    failures: Vec<String>,
}

impl Run {
    /// A run without comparisons.
    pub fn new(form: Form) -> Self {
        Self {
            form,
            comparisons: Vec::new(),
            failures: Vec::new(),
        }
    }

    /// Renders the scene of entry number `index` and compares it.
    pub fn compare(
        &mut self,
        (index, entry): (u64, &Entry),
        scene: &Scene,
        settings: &Settings,
        reference: &Renderings,
    ) -> &Comparison {
        let form = &self.form;
        let integrator = settings.method();
        // No two images share a random number.
        let first = 10_000 * (integrator as u64 + 1) + 100 * index;
        let ours = Renderings::render(scene, settings, first..first + form.seeds, form.tile);
        let names = [index * 10 + integrator as u64, index];
        let comparison = Comparison::new(&ours, reference, form.alpha, names);
        let (p, _) = comparison.smallest();
        let [median, worst, image] = comparison.catches().map(|c| 100.0 * c);
        println!(
            "{} {}: smallest adjusted p {p:.2e}; catches {median:.2}% of a tile ({worst:.2}% of the \
             worst), {image:.2}% of the image",
            entry.name,
            integrator.name()
        );
        if p < form.alpha {
            let message = failure(&comparison, &ours, reference);
            let image = format!("{} {}", entry.name, integrator.name());
            self.failures.push(format!("{image}: {message}"));
        }
        self.comparisons.push(comparison);
        self.comparisons.last().expect("the one just added")
    }

    /// Number of p-values in each tenth of [0, 1].
    pub fn tenths(&self) -> [u32; 10] {
        let mut counts = [0; 10];
        let p_values = self.comparisons.iter().flat_map(Comparison::p_values);
        p_values.for_each(|p| counts[((10.0 * p) as usize).min(9)] += 1);
        counts
    }

    /// Asserts that no comparison failed and that all p-values are uniform; returns the p-value of the
    /// latter.
    pub fn judge(mut self) -> f64 {
        if self.comparisons.is_empty() {
            return 1.0;
        }
        let p = uniformity(&self.comparisons, REPLICATES);
        println!("uniformity of all p-values: p = {p:.4}");
        if p < UNIFORMITY {
            let message = format!("the p-values of all images are not uniform: p = {p:.1e}");
            self.failures.push(message);
        }
        let failures = &self.failures;
        assert!(failures.is_empty(), "not equal:\n{}", failures.join("\n"));
        p
    }
}

/// Describes the test with the smallest p-value.
fn failure(comparison: &Comparison, ours: &Renderings, reference: &Renderings) -> String {
    let (p, test) = comparison.smallest();
    let place = if test + 3 < comparison.adjusted.len() {
        format!("tile {}", test / 3)
    } else {
        "the whole image".into()
    };
    let [ours, reference] = [ours, reference].map(|renderings| {
        let moments = renderings.moments()[test];
        format!("{:.6} +- {:.6}", moments.mean, moments.standard_error())
    });
    format!(
        "p = {p:.1e}, {place}, channel {}: reference {reference}, ours {ours}",
        test % 3
    )
}
