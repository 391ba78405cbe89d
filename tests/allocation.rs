//! The inner loop does not allocate, neither per path nor per mutation.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use metrolight::integrators::{Sampler, Splats, Workspace};
use metrolight::markov::{Chain, SmallStep};
use metrolight::render::LightTarget;
use metrolight::sampling::FreshCoordinates;
use metrolight::sampling::seeds::{self, Purpose};

/// The system allocator with a counter.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is forwarded unchanged to the system allocator, which keeps the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocations during `work`. This binary has one test, so no other thread allocates meanwhile.
fn allocations(work: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    work();
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

#[test]
fn mutations_and_samples_allocate_nothing() {
    assert!(
        allocations(|| drop(std::hint::black_box(vec![1u8; 100]))) > 0,
        "the counter counts"
    );
    for name in ["spheres", "pool"] {
        let scene = common::load(&format!("scenes/{name}/scene.xml"), &[]);
        let mut target = LightTarget::new(&scene, Sampler::Bidirectional);
        let start = seeds::generator(0, Purpose::Bootstrap, 0);
        let rng = seeds::chain_generators(0, 1).remove(0);
        let mut chain = Chain::start(&mut target, start, rng, 0.3, SmallStep::default());
        // Let the buffers grow to the length of the longest path.
        (0..10_000).for_each(|_| _ = chain.step(&mut target).density);
        let during = allocations(|| {
            (0..10_000).for_each(|_| _ = chain.step(&mut target).density);
        });
        assert_eq!(during, 0, "{name}: allocations in 10000 mutations");

        let mut point = FreshCoordinates::new(seeds::generator(0, Purpose::Pixels, 0));
        let (mut workspace, mut splats) = (Workspace::default(), Splats::default());
        for sampler in [Sampler::Path, Sampler::Light, Sampler::Bidirectional] {
            let mut sample = || sampler.sample(&scene, &mut point, &mut workspace, &mut splats);
            (0..10_000).for_each(|_| sample());
            let during = allocations(|| (0..10_000).for_each(|_| sample()));
            assert_eq!(
                during, 0,
                "{name}, {sampler:?}: allocations in 10000 samples"
            );
        }
    }
}
