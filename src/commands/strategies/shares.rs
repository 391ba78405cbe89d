//! The two images of each technique, and their light.

use metrolight::film::Image;
use metrolight::math::{Rgb, luminance};
use metrolight::render::{Strategies, TechniqueImages};
use metrolight::technique::Technique;

/// The two images of a technique.
#[derive(Clone, Copy)]
pub enum Kind {
    Unweighted,
    Weighted,
}

impl Kind {
    pub const ALL: [Self; 2] = [Self::Unweighted, Self::Weighted];

    /// `unweighted` or `weighted`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unweighted => "unweighted",
            Self::Weighted => "weighted",
        }
    }

    /// That image of the two.
    pub fn of(self, images: &TechniqueImages) -> &Image {
        match self {
            Self::Unweighted => &images.unweighted,
            Self::Weighted => &images.weighted,
        }
    }

    /// File name of the image of a technique.
    pub fn exr(self, technique: Technique) -> String {
        let kind = self.name();
        match technique {
            Technique::Specular { t, n } => format!("{kind}_specular{n}_t{t}.exr"),
            _ => format!("{kind}_s{}_t{}.exr", technique.s(), technique.t()),
        }
    }

    /// File name of the contact sheet.
    pub fn sheet(self) -> String {
        format!("{}.png", self.name())
    }
}

/// Mean luminances of all images, in the order of the techniques.
pub struct Shares {
    /// Unweighted and weighted.
    pub means: Vec<[f64; 2]>,
    /// Sum of the weighted means: the mean luminance of the image.
    pub total: f64,
}

impl Shares {
    /// Measures all images.
    pub fn of(rendering: &Strategies) -> Self {
        let images = rendering.images.iter();
        let means: Vec<[f64; 2]> = images
            .map(|images| Kind::ALL.map(|kind| mean_luminance(kind.of(images))))
            .collect();
        Self {
            total: means.iter().map(|mean| mean[1]).sum(),
            means,
        }
    }

    /// Share of technique `i` in the light of the image; `None` if the image is black.
    pub fn share(&self, i: usize) -> Option<f64> {
        (self.total > 0.0).then(|| self.means[i][1] / self.total)
    }
}

fn mean_luminance(image: &Image) -> f64 {
    let luminances = image.pixels.iter().map(|&p| luminance(Rgb::from(p)));
    luminances.map(f64::from).sum::<f64>() / image.pixels.len() as f64
}

/// A number of edges in words.
pub fn edges_text(k: usize) -> String {
    if k == 1 {
        "1 edge".into()
    } else {
        format!("{k} edges")
    }
}

/// A share as a percentage.
pub fn percent(share: f64) -> String {
    format!("{:.1}%", 100.0 * share)
}
