use super::compare_with_brute_force;
use crate::bvh::Bvh;
use crate::bvh::binary::Quality;
use crate::bvh::build::{Hierarchy, build, build_with, depth};
use crate::bvh::node::MAX_DEPTH;
use crate::bvh::test_primitives::{blob, mesh, scaled_to_radius, triangle};

/// Many triangles in one place, and ever smaller ones around one point: neither makes a tree too deep to
/// traverse, and none is lost.
#[test]
fn coincident_and_nested_triangles_can_be_built() {
    let mut primitives = Vec::new();
    for i in 0..20_000 {
        let size = 0.999_f32.powi(i);
        for (s, z) in [(1.0, 0.0), (size, 0.001 * size)] {
            let corners = [[-s, -s, z], [s, -s, z], [0.0, s, z]];
            primitives.push(triangle(corners));
        }
    }
    let primitives = scaled_to_radius(primitives);
    let check = |name: &str, hierarchy: Hierarchy, primitives| {
        let depth = depth(&hierarchy.nodes);
        assert!(depth > 3 && depth <= MAX_DEPTH, "{name}: {depth}");
        let bvh = Bvh::from_hierarchy(hierarchy, primitives);
        compare_with_brute_force(&bvh, 300, 5);
    };
    let mut sorted = primitives.clone();
    check("default", build(&mut sorted), sorted);
    // The tree that is built if the best one is too deep.
    let mut sorted = primitives;
    let shallow = build_with(&mut sorted, Quality::Shallow);
    check("shallow", shallow, sorted);
}

/// After construction the memory is some 2 times the 36 bytes of a plain triangle. (The peak during the
/// construction of a mesh of a million triangles was 3.3 times in all, its loaded form included.)
#[test]
fn memory_is_bounded() {
    let bvh = Bvh::new(scaled_to_radius(mesh(&blob(160), |p| p)));
    let plain = 36 * bvh.triangle_count();
    let bytes = bvh.bytes();
    assert!(bytes > plain && bytes < 3 * plain, "{bytes} {plain}");
}
