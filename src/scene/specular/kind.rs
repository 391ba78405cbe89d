//! Kinds of vertices of chains on a mesh: reflection and refraction, seen from either side.

use arrayvec::ArrayVec;

use crate::scene::bsdf::DeltaLobe;

/// A kind of vertex: its lobe, and the side of the mesh on which D is.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub lobe: DeltaLobe,
    /// 1 if D is on the front side, -1 if it is behind.
    pub side: f32,
    /// eta_D and eta_y; equal for reflection.
    pub indices: [f32; 2],
}

impl Kind {
    /// The side of y, as that of D.
    pub fn end_side(&self) -> f32 {
        match self.lobe {
            DeltaLobe::Reflection => self.side,
            DeltaLobe::Transmission => -self.side,
        }
    }
}

/// Number of kinds.
pub const COUNT: usize = 4;

/// The kinds of vertices on a mesh. A mask has a bit for each.
#[derive(Clone, Debug)]
pub struct Kinds {
    kinds: ArrayVec<Kind, COUNT>,
}

impl Kinds {
    /// Those of a mesh whose side behind the normals has the index of refraction `eta` relative to the other side;
    /// `None` if it only reflects.
    pub fn new(eta: Option<f64>) -> Self {
        let eta = eta.map(|eta| eta as f32);
        let mut kinds = ArrayVec::new();
        if eta != Some(1.0) {
            kinds.extend([1.0, -1.0].map(|side| Kind {
                lobe: DeltaLobe::Reflection,
                side,
                indices: [1.0, 1.0],
            }));
        }
        if let Some(eta) = eta {
            kinds.extend(
                [(1.0, [1.0, eta]), (-1.0, [eta, 1.0])].map(|(side, indices)| Kind {
                    lobe: DeltaLobe::Transmission,
                    side,
                    indices,
                }),
            );
        }
        Self { kinds }
    }

    /// A mask of all kinds.
    pub fn all(&self) -> u8 {
        (1 << self.kinds.len()) - 1
    }

    /// A mask of the kinds with this lobe.
    pub fn mask_of(&self, lobe: DeltaLobe) -> u8 {
        let with_lobe = |(i, kind): (usize, &Kind)| u8::from(kind.lobe == lobe) << i;
        self.kinds.iter().enumerate().map(with_lobe).sum()
    }

    /// The kinds in `mask` with their places in it.
    pub fn iter(&self, mask: u8) -> impl Iterator<Item = (usize, &Kind)> {
        let in_mask = move |&(i, _): &(usize, &Kind)| mask & 1 << i != 0;
        self.kinds.iter().enumerate().filter(in_mask)
    }
}
