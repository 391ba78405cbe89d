//! Errors and warnings of the loader, with their places in the scene files.

mod cause;
mod suggestion;

use std::fmt;

use miette::{Diagnostic, LabeledSpan, SourceCode};

pub use cause::Cause;

use super::source::Place;

/// A fault in a scene file or in a file that it names. The message begins with the place,
/// `scene.xml:12:3`.
#[derive(Debug)]
pub struct LoadError(Box<Fault>);

#[derive(Debug)]
struct Fault {
    place: Option<Place>,
    cause: Cause,
}

impl LoadError {
    fn new(place: Option<Place>, cause: Cause) -> Self {
        Self(Box::new(Fault { place, cause }))
    }

    /// A fault outside the text of all scene files.
    pub(super) fn nowhere(cause: Cause) -> Self {
        Self::new(None, cause)
    }

    /// The place of the fault; `None` if the scene file itself could not be read.
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// The cause.
    pub fn cause(&self) -> &Cause {
        &self.0.cause
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_at(f, self.0.place.as_ref(), &self.0.cause)
    }
}

impl std::error::Error for LoadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        std::error::Error::source(&self.0.cause)
    }
}

impl Diagnostic for LoadError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        let place = self.0.place.as_ref()?;
        place
            .fits_in_a_report()
            .then(|| place.file() as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.0.place.as_ref()?;
        let label = LabeledSpan::new_with_span(Some("here".into()), place.span());
        Some(Box::new(std::iter::once(label)))
    }
}

/// A suspicious part of a scene that does not prevent rendering.
#[derive(Clone, Debug)]
pub struct Warning {
    /// The place in a scene file; `None` if the warning concerns none.
    pub place: Option<Place>,
    /// The message.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_at(f, self.place.as_ref(), &self.text)
    }
}

fn write_at(
    f: &mut fmt::Formatter<'_>,
    place: Option<&Place>,
    message: &dyn fmt::Display,
) -> fmt::Result {
    match place {
        Some(place) => write!(f, "{place}: {message}"),
        None => write!(f, "{message}"),
    }
}

/// Something with a place in a scene file, which errors and warnings refer to.
pub(super) trait Located {
    /// The place.
    fn place(&self) -> &Place;

    /// An error at the place.
    fn error(&self, cause: Cause) -> LoadError {
        LoadError::new(Some(self.place().clone()), cause)
    }

    /// Parameters or objects contradict each other.
    fn conflict(&self, problem: impl Into<String>) -> LoadError {
        self.error(Cause::Conflict(problem.into()))
    }

    /// A feature of Mitsuba that is not supported.
    fn not_modelled(&self, feature: impl Into<String>) -> LoadError {
        self.error(Cause::NotSupported(feature.into()))
    }

    /// A warning at the place.
    fn warning(&self, text: impl Into<String>) -> Warning {
        Warning {
            place: Some(self.place().clone()),
            text: text.into(),
        }
    }
}

impl Located for Place {
    fn place(&self) -> &Place {
        self
    }
}
