//! Memory for data that rays read at random addresses: in huge pages where the system has them, since
//! misses of the address translation would cost a large scene up to a quarter of its rays per second.

use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

/// A slice in pages of its own.
pub struct HugePages<T> {
    /// Page-aligned.
    bytes: MmapMut,
    count: usize,
    items: PhantomData<T>,
}

impl<T: Pod> HugePages<T> {
    /// `count` items whose bytes are all zero.
    pub fn zeroed(count: usize) -> Self {
        // A map of no bytes is an error.
        let size = (count * size_of::<T>()).max(1);
        let bytes = MmapMut::map_anon(size).expect("memory for the geometry");
        // The system may ignore or reject this advice, which costs only speed.
        #[cfg(all(target_os = "linux", not(miri)))]
        let _ = bytes.advise(memmap2::Advice::HugePage);
        Self {
            bytes,
            count,
            items: PhantomData,
        }
    }

    /// A copy of `items`.
    pub fn copy_of(items: &[T]) -> Self {
        let mut pages = Self::zeroed(items.len());
        pages.copy_from_slice(items);
        pages
    }
}

impl<T: Pod> Deref for HugePages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        bytemuck::cast_slice(&self.bytes[..self.count * size_of::<T>()])
    }
}

impl<T: Pod> DerefMut for HugePages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        bytemuck::cast_slice_mut(&mut self.bytes[..self.count * size_of::<T>()])
    }
}
