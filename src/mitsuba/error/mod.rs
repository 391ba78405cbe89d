//! Errors and warnings of the loader, with their places in the scene files.

mod cause;
mod suggestion;

use std::fmt;

use miette::{Diagnostic, LabeledSpan, SourceCode};

pub use cause::Cause;
pub(super) use suggestion::shown;

use super::source::Place;

/// Most faults that one error lists.
const MAX_LISTED: usize = 64;

/// A fault in a scene file or in a file that it names, and the faults found after it. The message is
/// that of the first and begins with its place, `scene.xml:12:3`; a report shows the others as well.
#[derive(Debug)]
pub struct LoadError(Box<Fault>);

#[derive(Debug)]
struct Fault {
    place: Option<Place>,
    cause: Cause,
    /// The faults found after this one, each without others.
    others: Vec<LoadError>,
}

impl LoadError {
    fn new(place: Option<Place>, cause: Cause) -> Self {
        let others = Vec::new();
        Self(Box::new(Fault {
            place,
            cause,
            others,
        }))
    }

    /// This error and `next`, which was found after it. A fault that is listed already is left out: an
    /// object that cannot be built is an error of each object that refers to it.
    pub(super) fn and(mut self, mut next: Self) -> Self {
        let more = std::mem::take(&mut next.0.others);
        for fault in std::iter::once(next).chain(more) {
            let text = fault.to_string();
            let is_new = self.faults().all(|known| known.to_string() != text);
            if is_new && self.0.others.len() + 1 < MAX_LISTED {
                self.0.others.push(fault);
            }
        }
        self
    }

    /// This fault, and those found after it.
    pub fn faults(&self) -> impl Iterator<Item = &LoadError> {
        std::iter::once(self).chain(&self.0.others)
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
        let is_text = !matches!(self.0.cause, Cause::NotXml | Cause::Encoding(_));
        (is_text && place.fits_in_a_report()).then(|| place.file() as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.0.place.as_ref()?;
        let label = LabeledSpan::new_with_span(Some("here".into()), place.span());
        Some(Box::new(std::iter::once(label)))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let others = self.0.others.iter();
        (others.len() > 0).then(|| {
            let all: Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a> =
                Box::new(others.map(|other| other as &dyn Diagnostic));
            all
        })
    }
}

/// The faults found so far.
#[derive(Debug, Default)]
pub(super) struct Faults(Option<LoadError>);

impl Faults {
    /// Adds a fault, and all that were found after it.
    pub fn add(&mut self, error: LoadError) {
        self.0 = Some(match self.0.take() {
            Some(first) => first.and(error),
            None => error,
        });
    }

    /// The value of `result`; `None` if it is a fault, which is added.
    pub fn check<T>(&mut self, result: Result<T, LoadError>) -> Option<T> {
        result.map_err(|error| self.add(error)).ok()
    }

    /// `value`, unless there are faults.
    pub fn or<T>(self, value: T) -> Result<T, LoadError> {
        self.0.map_or(Ok(value), Err)
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
