//! Classes of paths, and the techniques that find them (Veach 1997, section 8.3).
//!
//! A class names for every vertex from the emitter to the lens whether it scatters by a delta function (S)
//! or not (D): L S D E. In the full notation emitter and lens have two letters each, one for the vertex and
//! one for the direction. Technique (s, t) connects two neighbours by an edge that it has not sampled, so
//! letters s and s + 1 of the full notation must both be D.

use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    D,
    S,
}

use Event::{D, S};

/// Surfaces x_1 ... x_{k-1} of a path, from the emitter on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Class {
    surfaces: u32,
    /// Bit i is set if x_{i+1} is S.
    specular: u32,
}

impl Class {
    pub fn new(events: impl IntoIterator<Item = Event>) -> Self {
        let mut class = Self {
            surfaces: 0,
            specular: 0,
        };
        for event in events {
            class.specular |= u32::from(event == S) << class.surfaces;
            class.surfaces += 1;
        }
        class
    }

    /// From letters: "SSD".
    pub fn parse(letters: &str) -> Self {
        Self::new(letters.chars().map(|c| if c == 'S' { S } else { D }))
    }

    /// Number of edges, k.
    pub fn edges(self) -> usize {
        self.surfaces as usize + 1
    }

    pub fn events(self) -> impl Iterator<Item = Event> {
        (0..self.surfaces).map(move |i| if self.specular >> i & 1 == 1 { S } else { D })
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters: String = self.events().map(|event| format!("{event:?}")).collect();
        write!(f, "L{letters}E")
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emitter {
    Area,
    Point,
    /// It emits in a single direction, from a distribution of positions: the letters of a point light.
    /// (Veach's SD and DS are those of a light with a position.)
    Directional,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    Pinhole,
    Thin,
}

/// The techniques that sample paths of `edges` edges, without t = 0, light subpaths that hit the lens.
pub fn techniques(edges: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=edges).map(move |s| (s, edges + 1 - s))
}

/// True if technique (s, t), t >= 1, finds paths of `class`.
pub fn finds(emitter: Emitter, lens: Lens, class: Class, (s, _): (usize, usize)) -> bool {
    let mut letters = match emitter {
        Emitter::Area => vec![D, D],
        Emitter::Point | Emitter::Directional => vec![S, D],
    };
    letters.extend(class.events());
    // Direction, then position.
    letters.extend(match lens {
        Lens::Pinhole => [D, S],
        Lens::Thin => [D, D],
    });
    letters[s] == D && letters[s + 1] == D
}
