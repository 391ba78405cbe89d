//! The scene that a command reads.

use std::path::{Path, PathBuf};
use std::time::Instant;

use metrolight::analysis::{LostLight, lost_light_observed, trapped_light};
use metrolight::mitsuba::{self, Overrides};
use metrolight::render::{Method, Observer, SpecularChoice, choose_specular};
use metrolight::scene::{ChainSearch, Scene};
use metrolight::technique::TechniqueSet;
use miette::IntoDiagnostic;

use super::names::SpecularName;
use super::numbers::duration;
use super::progress::Progress;
use super::{memory, values, wording};

/// A scene file, and overrides of its settings.
#[derive(clap::Args)]
pub struct SceneArgs {
    /// Scene file in Mitsuba's XML format (versions 0.5 to 3)
    #[arg(value_name = "SCENE")]
    pub path: PathBuf,

    /// Set a variable of the scene ($NAME); may be repeated
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = values::define)]
    pub defines: Vec<(String, String)>,

    /// Size of the image in pixels [default: that of the scene file]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<[u32; 2]>,

    /// Maximum number of edges of a path: 1 shows emitters only, 2 adds direct light, -1 is unlimited
    /// [default: that of the scene file]
    #[arg(
        long,
        value_name = "N",
        value_parser = values::max_depth,
        allow_negative_numbers = true
    )]
    pub max_depth: Option<values::MaxDepth>,

    /// Specular next event estimation: where vertices are connected to lights through smooth glass and mirrors
    #[arg(long, value_name = "MODE", default_value = "auto")]
    pub specular: SpecularName,
}

/// A scene that is ready to be rendered.
pub struct Opened {
    pub scene: Scene,
    /// The files that were read.
    pub files: Vec<PathBuf>,
    /// Warnings about its files, and about the scene for any integrator.
    pub warnings: Vec<String>,
    /// Time to read and decode all files.
    pub load_seconds: f64,
    /// Time to build the acceleration structure and the emitters' distributions, and of pilots.
    pub build_seconds: f64,
    /// What the pilots of `--specular auto` chose; `None` if there was nothing to choose.
    pub specular: Option<SpecularChoice>,
}

impl Opened {
    /// Number of pixels of its image.
    pub fn pixels(&self) -> u64 {
        u64::from(self.scene.film.width) * u64::from(self.scene.film.height)
    }

    /// How long opening the scene took.
    pub fn times(&self) -> String {
        format!(
            "loaded in {}, acceleration structure built in {}",
            duration(self.load_seconds),
            duration(self.build_seconds),
        )
    }

    /// Where technique 1* is used.
    pub fn specular_in_use(&self) -> SpecularName {
        match self.scene.casters.search() {
            ChainSearch::Off => SpecularName::Off,
            ChainSearch::Unconnected => SpecularName::On,
            ChainSearch::Everywhere => SpecularName::Everywhere,
        }
    }

    /// Warnings of light that `techniques` cannot find, or only rarely, in an image by `method`.
    pub fn lost_light(
        &self,
        techniques: TechniqueSet,
        method: Option<Method>,
        progress: &Progress,
    ) -> Vec<String> {
        let lost = find_lost_light(&self.scene, techniques, progress);
        let lost = lost.iter().map(|lost| wording::lost_light(lost, method));
        lost.collect()
    }
}

/// Light of `scene` that `techniques` cannot find, or only rarely.
pub fn find_lost_light(
    scene: &Scene,
    techniques: TechniqueSet,
    progress: &Progress,
) -> Vec<LostLight> {
    progress.phase("checking");
    let start = Instant::now();
    let lost = lost_light_observed(scene, techniques, &|done| progress.steady(start, done));
    progress.finish();
    lost
}

impl SceneArgs {
    /// Loads and builds the scene. `threads` are for the pilots of `--specular auto`; `None` for one per core.
    pub fn open(&self, threads: Option<usize>) -> miette::Result<Opened> {
        let start = Instant::now();
        let overrides = Overrides { size: self.size };
        let loaded = mitsuba::load_with(&self.path, &self.defines, overrides)?;
        let mut warnings: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
        let mut description = loaded.description;
        let coincident = description.remove_coincident();
        warnings.extend(coincident.as_ref().map(wording::coincident));
        if let Some(limit) = self.max_depth {
            description.depth.max_depth = limit.0;
        }
        memory::check_scene(&description)?;
        let load_seconds = start.elapsed().as_secs_f64();

        let start = Instant::now();
        let mut scene = description
            .build()
            .map_err(|error| miette::miette!("{}: {error}", self.path.display()))?;
        let specular = match self.specular.search() {
            Some(search) => {
                scene.casters.set_search(search);
                None
            }
            None => choose_specular(&mut scene, threads).into_diagnostic()?,
        };
        let build_seconds = start.elapsed().as_secs_f64();
        warnings.extend(trapped_light(&scene).as_ref().map(wording::trapped_light));
        Ok(Opened {
            scene,
            files: loaded.files,
            warnings,
            load_seconds,
            build_seconds,
            specular,
        })
    }

    /// The arguments for this scene, for a command line that is printed.
    pub fn words(&self) -> String {
        let mut words = vec![quoted(&self.path.to_string_lossy())];
        for (name, value) in &self.defines {
            words.push(format!("-D {}", quoted(&format!("{name}={value}"))));
        }
        if let Some([width, height]) = self.size {
            words.push(format!("--size {width}x{height}"));
        }
        if let Some(limit) = self.max_depth {
            words.push(match limit.0 {
                Some(depth) => format!("--max-depth {depth}"),
                None => "--max-depth -1".into(),
            });
        }
        if self.specular != SpecularName::Auto {
            words.push(format!("--specular {}", self.specular));
        }
        words.join(" ")
    }

    /// The name of the scene: its file's stem or, if that is `scene`, the name of its directory.
    pub fn name(&self) -> miette::Result<String> {
        let absolute = std::path::absolute(&self.path).into_diagnostic()?;
        let stem = absolute.file_stem().unwrap_or_default();
        let folder = absolute.parent().and_then(Path::file_name);
        let name = match folder {
            Some(folder) if stem == "scene" => folder,
            _ => stem,
        };
        Ok(name.to_string_lossy().into_owned())
    }
}

/// A word for a shell, in quotes if needed.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_with_special_characters_are_quoted() {
        assert_eq!(quoted("a/b.xml"), "a/b.xml");
        assert_eq!(quoted("x=1, 2"), "'x=1, 2'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }
}
