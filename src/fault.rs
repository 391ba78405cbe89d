//! Faults that unit tests plant in the rendering code, to show that other tests detect them. Outside of
//! unit tests [`planted`] is false at compile time and has no cost.

/// The faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// Small steps are clamped to the unit interval instead of wrapped around it.
    Clamped,
    /// Small steps go up more often than down.
    Asymmetric,
    /// A rejected proposal is not undone.
    NotRestored,
    /// An unread coordinate is brought up to date with one small step too few.
    LazyStepTooFew,
    /// Acceptance by I(u)/I(v).
    InvertedRatio,
    /// The acceptance probability in the weights may exceed 1.
    UnclippedWeights,
    /// After 8 rejections in a row, any proposal of positive density is accepted.
    ForcedAcceptance,
    /// The weights use 0.8 times the probability of a large step.
    OtherLargeStepProbability,
    /// The number of techniques is left out of a multiplexed density.
    TechniqueCountLeftOut,
    /// The technique coordinate chooses techniques with few light vertices too often.
    TechniquesSkewed,
    /// Chains clamp at twice the threshold of the independent samples.
    OtherThreshold,
    /// The residual of a clamped path is the whole path.
    ResidualUnclamped,
    /// Chains start at residuals chosen uniformly, not in proportion to their density.
    ResampledUniformly,
    /// Long paths get more mutations than their share b_k, short ones fewer.
    LengthShares,
    /// The weight of the chains that redistribute residuals is too large by a factor of 2.
    ChainWeightOff,
    /// Two neighbouring chains share their random numbers.
    SharedNumbers,
    /// b of the bootstrap is 1% too large.
    NormalisationOff,
    /// The factor of shading normals (Veach 1997, section 5.3.2) is left out of light subpaths.
    AdjointLeftOut,
    /// The MIS weight of connected subpaths is 20% too large.
    WeightOff,
    /// T of a specular chain is 20% too small.
    ChainJacobianOff,
    /// The probabilities of the lobes of a specular chain are left out of its density.
    ChainProbabilityLeftOut,
    /// Radiance is not scaled where a specular chain is refracted.
    ChainRadianceUnscaled,
    /// Technique s = 0 keeps its whole weight where technique 1* samples the path too.
    MembershipSkipped,
    /// Light subpaths do not know technique 1*.
    ChainTermLeftOut,
    /// The probability that a mask is hit is left out of the density of what it covers.
    OpacityLeftOut,
    /// The density of a blend is that of the model that was chosen.
    BlendOfOneModel,
    /// The probability of the normal that a light subpath uses is left out of its density.
    NormalProbabilityLeftOut,
    /// The cosine with the perturbed normal is replaced by that with the shading normal.
    PerturbedCosineLeftOut,
    /// Phong's lobe is normalised without the cosine, as its density is.
    PhongNormalisedAsDensity,
    /// The squared index of refraction is left out of the density of refraction by a facet.
    FacetJacobianOff,
}

#[cfg(test)]
thread_local! {
    static PLANTED: std::cell::Cell<Option<Fault>> = const { std::cell::Cell::new(None) };
}

/// True if `fault` has been planted in this thread.
#[cfg(test)]
#[inline]
pub(crate) fn planted(fault: Fault) -> bool {
    PLANTED.get() == Some(fault)
}

/// False: nothing can be planted outside of unit tests.
#[cfg(not(test))]
#[inline(always)]
pub(crate) const fn planted(_fault: Fault) -> bool {
    false
}

/// Runs `work` in a new thread in which `fault` is planted.
#[cfg(test)]
pub(crate) fn with<T: Send>(fault: Option<Fault>, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .start_handler(move |_| PLANTED.set(fault))
        .build()
        .expect("a thread");
    pool.install(work)
}
