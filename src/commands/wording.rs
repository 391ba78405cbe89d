//! Text of the library's warnings and of its choice of an integrator, with the options that help.

use metrolight::analysis::lost_light::PROBES;
use metrolight::analysis::trapped_light::BOUNCES;
use metrolight::analysis::{Loss, LostLight, NearSurfaces, OddView, TrappedLight};
use metrolight::render::{Choice, ChoiceReason, Method, SpecularChoice, Warning};
use metrolight::scene::ChainSearch;
use metrolight::scene::coincident::Coincident;
use metrolight::technique::TechniqueSet;

/// What limits an image.
pub fn warning(warning: &Warning) -> String {
    match *warning {
        Warning::NonFinite { count } => {
            format!("{count} contributions were NaN, infinite or negative and have been left out")
        }
        Warning::Unsampled { done, pixels } => format!(
            "only {done} of {pixels} pixels have been sampled: the others are black. Render for longer"
        ),
        Warning::ErrorUnknown => {
            "the error of the image is not known: at least two samples per pixel, or two chains, \
             are needed"
                .into()
        }
        Warning::TargetNotReached { estimate, target } => format!(
            "the estimated relMSE is {estimate:.2e}, above the target {target:.2e}: render for longer"
        ),
        Warning::RareContributions { share } => format!(
            "errors are probably larger than estimated: in {:.0}% of the pixels nearly all variance \
             comes from one part of the samples, so some rare light has probably not been found. \
             Render for longer",
            100.0 * share
        ),
        Warning::NoMutations => "no mutation was made: the image is black".into(),
        Warning::StuckChains { stuck, chains } => format!(
            "{stuck} of {chains} chains have been in one state for more than half of their \
             mutations: they show single paths, perhaps as bright spots"
        ),
        Warning::NoLightInBootstrap { samples } => format!(
            "none of {samples} bootstrap samples found light: the image is black. Unless the scene \
             is meant to be black, take more samples with --bootstrap"
        ),
        Warning::NormalisationUnknown => {
            "the standard error of b, and with it of the brightness of the image, cannot be estimated: \
             take more samples with --bootstrap"
                .into()
        }
        Warning::NormalisationUncertain { relative_error } => format!(
            "the normalisation b, and with it the brightness of the image, has a standard error of \
             {:.1}%: render for longer, or take more samples with --bootstrap",
            100.0 * relative_error
        ),
        Warning::Black => "the image is black: no path has found light".into(),
    }
}

/// What pilots chose for specular next event estimation.
pub fn specular_choice(choice: &SpecularChoice) -> String {
    let (place, verb) = match choice.search {
        ChainSearch::Everywhere => ("from every vertex, which", "samples"),
        ChainSearch::Unconnected | ChainSearch::Off => (
            "where no other technique connects; from every vertex it",
            "would sample",
        ),
    };
    format!(
        "specular next event estimation {place} {verb} {:.0}% more of the light at {:.1} times the cost",
        100.0 * choice.share,
        choice.cost
    )
}

/// What is probably a mistake in a scene.
pub fn odd_view(odd: &OddView) -> String {
    match odd {
        OddView::BackFaces { surfaces, share } => format!(
            "{:.0}% of the image shows the backs of surfaces, which are black: {}. Turn them around with \
             `flip_normals`, or put their materials into `twosided`",
            100.0 * share,
            some_of(surfaces)
        ),
        OddView::BeyondFarClip => {
            "the camera sees nothing: all surfaces in view lie beyond its `far_clip`".into()
        }
        OddView::LampFacesAway { surface } => format!(
            "{surface} lights nothing and is not seen: the side that shines faces away. Turn it around \
             with `flip_normals`"
        ),
    }
}

/// Surfaces that lie too close to be told apart.
pub fn near_surfaces(near: &NearSurfaces) -> String {
    let pairs = near.pairs.iter().map(|pair| pair.join(" and "));
    format!(
        "surfaces that lie too close to be told apart: {}. Rays pass over one of them; move them more than {:.1e} \
         apart",
        some_of(&pairs.collect::<Vec<_>>()),
        near.distance
    )
}

/// The first names of a list, and how many more there are.
fn some_of(names: &[String]) -> String {
    const SHOWN: usize = 3;
    let shown = names.iter().take(SHOWN).cloned().collect::<Vec<_>>();
    match names.len().saturating_sub(SHOWN) {
        0 => shown.join(", "),
        rest => format!("{} and {rest} more", shown.join(", ")),
    }
}

/// Where an image is too dark, or may be. The image is rendered by `method`, if that is known.
pub fn lost_light(lost: &LostLight, method: Option<Method>) -> String {
    let emitter = &lost.emitter;
    let surfaces = match &lost.surfaces[..] {
        [] => "nothing is".into(),
        [one] => format!("{one} is"),
        [one, two] => format!("{one} and {two} are"),
        [one, more @ ..] => format!("{one} and {} more shapes are", more.len()),
    };
    // Chains of the kinds that technique 1* seeks are not reported.
    let lit = format!("{surfaces} lit by {emitter} through smooth glass or mirrors");
    let chains = "in chains that specular next event estimation does not seek";
    match (lost.techniques, lost.loss) {
        (TechniqueSet::Bidirectional, Loss::Always) => format!(
            "lost light: {lit} {chains}, and seen through smooth glass or mirrors. No integrator here \
             finds that light, so the image is too dark there. Use a small area light, or make the \
             glass or mirrors a little rough"
        ),
        (TechniqueSet::Path, Loss::Always) => format!(
            "lost light: {lit} {chains}, which path tracing cannot find. Use bdpt, pssmlt or mmlt, \
             which find it where it is seen directly"
        ),
        (TechniqueSet::Light, _) => format!(
            "lost light: {surfaces} seen through smooth glass or mirrors, where light tracing finds \
             nothing. Use another integrator"
        ),
        (TechniqueSet::Bidirectional, Loss::Nearly) if method == Some(Method::Mmlt) => format!(
            "rare light: {lit} {chains}, and seen through smooth glass or mirrors. Only paths that hit \
             the emitter by chance find that light, and none of {PROBES} did. The chains of mmlt stay \
             near the paths that are found, so expect darkness or blotches there at first: render for \
             longer, use a larger emitter, or make the glass or mirrors a little rough"
        ),
        (TechniqueSet::Bidirectional, Loss::Nearly) => format!(
            "rare light: {lit} {chains}, and seen through smooth glass or mirrors. Only paths that hit \
             the emitter by chance find that light, and none of {PROBES} did. Expect fireflies, or \
             darkness in their place. Use a larger emitter, or make the glass or mirrors a little rough"
        ),
        (TechniqueSet::Path, Loss::Nearly) => format!(
            "rare light: {lit} {chains}. Path tracing finds that light only by hitting the emitter, and \
             none of {PROBES} paths did. Use bdpt, pssmlt or mmlt, which find it where it is seen directly"
        ),
    }
}

/// Why a scene has no finite brightness, or nearly none.
pub fn trapped_light(trapped: &TrappedLight) -> String {
    format!(
        "trapped light: {:.0}% of the light is left after {BOUNCES} bounces, because the scene is \
         closed and absorbs almost nothing. Without a limit on path length its brightness is \
         infinite or too large to be computed. Set a limit with --max-depth, or give surfaces an \
         albedo below 1",
        100.0 * trapped.share
    )
}

/// Shapes that are left out.
pub fn coincident(coincident: &Coincident) -> String {
    format!(
        "{} coincides with {}: of coincident shapes only the first is kept ({} left out)",
        coincident.name, coincident.with, coincident.count
    )
}

/// Which integrator was chosen, and why.
pub fn choice(choice: &Choice) -> String {
    let reason = match choice.reason() {
        ChoiceReason::Gain(gain) => {
            format!("it is expected to have 1/{gain:.3} of the error of bdpt at equal time")
        }
        ChoiceReason::RareLight => {
            "only rare and bright paths find some of the light, which bdpt shows as fireflies"
                .into()
        }
        ChoiceReason::NoBrightPaths => "no path is bright enough for chains to help".into(),
    };
    format!(
        "{} is chosen: {reason} (a pilot of {} samples, {:.1} s; --integrator overrides it)",
        choice.integrator.method().name(),
        choice.samples,
        choice.seconds
    )
}
