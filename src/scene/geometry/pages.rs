//! Memory for what rays read at random: in huge pages where the system has them, since looking up which
//! page an address is in would cost a large scene up to a quarter of its rays.

use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

/// A slice in pages of its own.
pub struct Pages<T> {
    /// Page-aligned.
    bytes: MmapMut,
    count: usize,
    items: PhantomData<T>,
}

impl<T: Pod> Pages<T> {
    /// `count` items of zeros.
    pub fn zeroed(count: usize) -> Self {
        // A map of no bytes is an error.
        let size = (count * size_of::<T>()).max(1);
        let bytes = MmapMut::map_anon(size).expect("memory for the geometry");
        // Advice, which may be ignored and may be unknown: nothing is lost but speed.
        #[cfg(all(target_os = "linux", not(miri)))]
        let _ = bytes.advise(memmap2::Advice::HugePage);
        Self {
            bytes,
            count,
            items: PhantomData,
        }
    }

    /// A copy.
    pub fn copy_of(items: &[T]) -> Self {
        let mut pages = Self::zeroed(items.len());
        pages.copy_from_slice(items);
        pages
    }
}

impl<T: Pod> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        bytemuck::cast_slice(&self.bytes[..self.count * size_of::<T>()])
    }
}

impl<T: Pod> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        bytemuck::cast_slice_mut(&mut self.bytes[..self.count * size_of::<T>()])
    }
}
