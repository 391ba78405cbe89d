//! The inner loop does not allocate, neither per path nor per mutation.
// An allocator that counts is unsafe to implement.
#![allow(unsafe_code)]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use metrolight::integrators::{
    BidirectionalPathTracer, LightTracer, PathSampler, PathTracer, SplatList, Workspace,
};
use metrolight::markov::{Chain, Mutations, Perturbation, bootstrap};
use metrolight::render::SplatTarget;
use metrolight::sampling::seeds;
use metrolight::scene::Scene;

/// The system allocator with a counter.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is forwarded unchanged to the system allocator, which keeps the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as the caller guarantees.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller guarantees.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as the caller guarantees.
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
    for name in [
        "scenes/spheres/scene.xml",
        "scenes/pool/scene.xml",
        "tests/scenes/composites.xml",
    ] {
        let scene = common::load(name, &[]);
        let mut target = SplatTarget::new(&scene, BidirectionalPathTracer);
        let start = bootstrap::sample(0, 0);
        let rng = seeds::chain_generators(0, 1).remove(0);
        let mutations = Mutations::kelemen(0.3, Perturbation::default());
        let mut chain = Chain::start(&mut target, start, rng, mutations);
        // Let the buffers grow to the length of the longest path.
        (0..50_000).for_each(|_| _ = chain.step(&mut target).kind);
        let during = allocations(|| {
            (0..10_000).for_each(|_| _ = chain.step(&mut target).kind);
        });
        assert_eq!(during, 0, "{name}: allocations in 10000 mutations");
        assert_no_allocation(name, &scene, PathTracer);
        assert_no_allocation(name, &scene, LightTracer);
        assert_no_allocation(name, &scene, BidirectionalPathTracer);
    }
}

/// Asserts that samples allocate nothing once buffers have grown.
fn assert_no_allocation(name: &str, scene: &Scene, path_sampler: impl PathSampler) {
    let (mut workspace, mut splats) = (Workspace::default(), SplatList::default());
    let mut sample = |i| {
        path_sampler.sample_splats(scene, &mut common::sample(i), &mut workspace, &mut splats);
    };
    // The same samples twice, so that no path of the second run is longer than those of the first.
    (0..10_000).for_each(&mut sample);
    let during = allocations(|| (0..10_000).for_each(&mut sample));
    assert_eq!(during, 0, "{name}: allocations in 10000 samples");
}
