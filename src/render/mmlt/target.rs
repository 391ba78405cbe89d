//! The target of the chains of multiplexed Metropolis.

use crate::fault::{Fault, planted};
use crate::film::Splat;
use crate::integrators::{PathSampler, SingleTechnique, SplatList, Workspace};
use crate::markov::Target;
use crate::math::color;
use crate::path::dimensions;
use crate::render::plan::Clamp;
use crate::sampling::{Dimension, Sampler};
use crate::scene::{RayCounts, Scene};
use crate::technique::{Technique, Techniques};

/// Paths of one length; the technique is a coordinate of the state (Hachisuka et al. 2014, section 4).
/// The density is the luminance of the residual, in units of the importance map, times the number of
/// techniques of that length. So its mean b_k equals the mean of the sum over all techniques.
pub struct MultiplexedTarget<'a> {
    scene: &'a Scene,
    clamp: &'a Clamp,
    /// k: number of edges of the paths.
    edges: usize,
    techniques: Techniques,
    workspace: Workspace,
}

impl<'a> MultiplexedTarget<'a> {
    /// The residual of the paths of `edges` edges.
    pub fn new(scene: &'a Scene, clamp: &'a Clamp, edges: usize) -> Self {
        Self {
            scene,
            clamp,
            edges,
            techniques: Techniques::of(scene),
            workspace: Workspace::default(),
        }
    }

    /// Rays traced so far.
    pub fn rays(&self) -> RayCounts {
        self.workspace.rays
    }

    /// The technique that the point chooses.
    #[inline]
    pub fn technique<S: Sampler>(&self, sampler: &mut S) -> Technique {
        let count = self.techniques.count(self.edges);
        let [mut choice] = sampler.get::<1>(dimensions::TECHNIQUE);
        if planted(Fault::TechniquesSkewed) {
            choice *= choice;
        }
        let i = ((choice * count as f32) as usize).min(count - 1);
        self.techniques.nth(self.edges, i)
    }
}

impl Target for MultiplexedTarget<'_> {
    type Contribution = SplatList;

    #[inline]
    fn evaluate<S: Sampler>(&mut self, sampler: &mut S, out: &mut SplatList) -> f64 {
        out.clear();
        let technique = self.technique(sampler);
        let mut count = self.techniques.count(self.edges) as f32;
        if planted(Fault::TechniqueCountLeftOut) {
            count = 1.0;
        }
        let mut density = 0.0;
        let path_sampler = SingleTechnique(technique);
        path_sampler.sample_paths(self.scene, sampler, &mut self.workspace, |path| {
            if !color::is_light(path.splat().value) {
                density = f64::NAN;
                return;
            }
            let [_, mut residual] = self.clamp.split(self.edges, path.splat());
            if planted(Fault::OtherThreshold) {
                let mut half = path.splat();
                half.value *= 0.5;
                [_, residual] = self.clamp.split(self.edges, half);
                residual.value *= 2.0;
            }
            let splat = Splat {
                value: color::saturated(residual.value * count),
                ..residual
            };
            out.add(technique, splat);
            // Technique 1* may find several paths at one point.
            density += f64::from(self.clamp.luminance(splat));
        });
        density
    }
}

/// The start of a chain: a sample with a technique coordinate.
#[derive(Clone, Copy, Debug)]
pub struct WithTechnique<S> {
    sample: S,
    choice: f32,
}

impl<S> WithTechnique<S> {
    /// `sample` with a technique coordinate that chooses `technique`. `u` in [0, 1) is the position within
    /// the interval of the technique.
    pub fn new(sample: S, techniques: Techniques, technique: Technique, u: f32) -> Self {
        let count = techniques.count(technique.edges()) as f32;
        let choice = (techniques.index(technique) as f32 + u) / count;
        Self {
            sample,
            choice: choice.min(1.0 - f32::EPSILON / 2.0),
        }
    }
}

impl<S: Sampler> Sampler for WithTechnique<S> {
    #[inline]
    fn get<const N: usize>(&mut self, first: Dimension) -> [f32; N] {
        let mut values = self.sample.get(first);
        let technique = dimensions::TECHNIQUE;
        let dimensions = first.index..first.index + N;
        if first.stream == technique.stream && dimensions.contains(&technique.index) {
            values[technique.index - first.index] = self.choice;
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::IndependentSampler;
    use crate::sampling::seeds::Purpose;

    #[test]
    fn a_start_chooses_its_technique() {
        for edges in 1..9 {
            let techniques = Techniques::without_chains();
            for i in 0..techniques.count(edges) {
                let technique = techniques.nth(edges, i);
                for u in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0] {
                    let sample = IndependentSampler::new(0, Purpose::Tests, 0);
                    let mut start = WithTechnique::new(sample, techniques, technique, u);
                    let [choice] = start.get::<1>(dimensions::TECHNIQUE);
                    let count = techniques.count(edges) as f32;
                    // Rounding may put the upper end of an interval into the next one.
                    let chosen = (choice * count) as usize;
                    assert!(
                        chosen == i || (u > 0.9 && chosen == i + 1),
                        "{technique} {u}"
                    );
                }
            }
        }
    }
}
