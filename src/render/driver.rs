//! The loop common to the drivers of one image: blocks of samples until the budget is spent or the error is small
//! enough.

use super::clock::Clock;
use super::error::{ErrorEstimate, TargetError};
use super::{Rendering, Settings};
use crate::film::Image;
use crate::scene::RayCounts;

/// The state of a render.
pub(super) trait Driver {
    /// Takes a block of samples, or of mutations, of about the size that `clock` suggests.
    fn advance(&mut self, clock: &Clock);

    /// False if there is nothing to sample.
    fn can_advance(&self) -> bool {
        true
    }

    /// Samples or mutations so far.
    fn samples(&self) -> u64;

    /// Rays so far.
    fn rays(&self) -> RayCounts;

    /// True if the image can be shown: every pixel may have received light.
    fn has_image(&self) -> bool {
        true
    }

    /// True if the error can be estimated now.
    fn has_error(&self) -> bool {
        true
    }

    /// The image so far.
    fn image(&mut self) -> Image;

    /// The error of `image`, if it is requested and can be estimated.
    fn error(&self, image: &Image) -> Option<ErrorEstimate>;

    /// The result, at the end of a render with `settings`.
    fn finish(&mut self, settings: &Settings, clock: &Clock) -> Rendering;

    /// The result that [`Self::finish`] would return now. The render goes on as if it had not been asked for.
    fn result_so_far(&mut self, settings: &Settings, clock: &Clock) -> Rendering {
        self.finish(settings, clock)
    }
}

/// Advances `driver` until the budget of `clock` is spent or the target error of `settings` is reached.
pub(super) fn drive(
    driver: &mut impl Driver,
    settings: &Settings,
    clock: &mut Clock,
    pixels: u64,
) -> Rendering {
    let mut target = TargetError::new(settings, pixels);
    while driver.can_advance() && !clock.is_over(driver.samples()) {
        driver.advance(clock);

        // End the render when its error is small enough.
        let samples = driver.samples();
        if driver.has_error() && target.is_due(samples) {
            let image = driver.image();
            let error = driver.error(&image);
            clock.set_error_fraction(target.check(samples, error.as_ref()));
        }

        // Show the image so far.
        if driver.has_image() {
            let rays = driver.rays().total();
            clock.show(samples, rays, || driver.image());
        }

        // Save the result so far.
        let rays = driver.rays().total();
        clock.save(samples, rays, |clock| driver.result_so_far(settings, clock));
    }
    driver.finish(settings, clock)
}
