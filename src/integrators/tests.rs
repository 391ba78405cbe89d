//! Faults planted in technique 1*, and the tests that find them.

use glam::{DMat4, DVec3};

use super::{BidirectionalPathTracer, PathSampler, Workspace};
use crate::fault::{self, Fault};
use crate::math::{Rgb, luminance};
use crate::sampling::IndependentSampler;
use crate::sampling::seeds::Purpose;
use crate::scene::test_scenes::{self, emitting};
use crate::scene::{ChainSearch, Material, Scene, Texture, TriangleMesh};
use crate::statistics::Moments;
use crate::technique::Technique;

const SAMPLES: u64 = 1_500_000;

/// A lamp over a curved sheet of glass over a floor and a wall, seen from above: the camera is at the origin and looks along +z.
fn scene() -> Scene {
    let at = |z: f64, half: f64| {
        DMat4::from_translation(DVec3::new(0.0, 0.0, z)) * DMat4::from_scale(DVec3::splat(half))
    };
    let mut water = test_scenes::grid(24);
    water.normals = water
        .positions
        .iter()
        .map(|p| {
            let slope = DVec3::new(0.2 * f64::from(p[0]), 0.3 * f64::from(p[1]), 1.0);
            slope.normalize().as_vec3().to_array()
        })
        .collect();
    for p in &mut water.positions {
        p[2] = -0.1 * p[0] * p[0] - 0.15 * p[1] * p[1];
    }
    let mut surface = test_scenes::mesh(water, at(3.0, 2.0));
    surface.material = 1;
    let floor = test_scenes::mesh(TriangleMesh::rectangle(), at(4.5, 2.0));
    // A wall in the water, so that light subpaths that went through it can be connected.
    let upright = DMat4::from_rotation_y(-std::f64::consts::FRAC_PI_2);
    let to_wall = DMat4::from_translation(DVec3::new(1.2, 0.0, 4.0)) * upright;
    let wall = test_scenes::mesh(TriangleMesh::rectangle(), to_wall);
    let lamp = test_scenes::sphere(DVec3::new(0.8, 0.0, 1.0), 0.3);
    let lamp = emitting(lamp, Rgb::splat(5.0));
    let mut description = test_scenes::description(vec![surface, floor, wall, lamp], vec![]);
    let side = Box::new(Material::Diffuse { reflectance: 0 });
    description.textures.push(Texture::Constant(Rgb::ONE));
    description.materials = vec![
        Material::TwoSided {
            front: side.clone(),
            back: side,
        },
        Material::Dielectric {
            // A tenth to a fifth of the light is reflected.
            eta: 2.4,
            specular_reflectance: 1,
            specular_transmittance: 1,
        },
    ];
    description.depth.max_depth = Some(6);
    description.build().expect("a scene")
}

/// What samples of bidirectional path tracing say of technique 1*.
#[derive(Default)]
struct Sums {
    /// Weighted light of a sample.
    light: Moments,
    /// That of its paths of 5 edges: two vertices with a density between chains, which join or are joined to the lamp.
    joined: Moments,
    /// Number of paths of 1*, and sum of p_* / p_0 over paths of s = 0 that both sample. Their means are equal: both
    /// integrate p_* over the paths.
    paths: Moments,
    ratios: Moments,
}

fn sums(scene: &Scene, first: u64) -> Sums {
    let (mut sums, mut workspace) = (Sums::default(), Workspace::default());
    for i in first..first + SAMPLES {
        let mut sampler = IndependentSampler::new(0, Purpose::Tests, i);
        let (mut light, mut joined, mut paths, mut ratios) = (0.0, 0.0, 0.0, 0.0);
        BidirectionalPathTracer.sample_paths(scene, &mut sampler, &mut workspace, |path| {
            let weighted = f64::from(luminance(path.splat().value));
            light += weighted;
            if path.technique.edges() == 5 {
                joined += weighted;
            }
            match path.technique {
                Technique::Specular { t: 3, n: 1 } => paths += 1.0,
                Technique::Hit { t: 5 } => ratios += (1.0 / f64::from(path.weight) - 1.0).sqrt(),
                _ => {}
            }
        });
        sums.light.add(light);
        sums.joined.add(joined);
        sums.paths.add(paths);
        sums.ratios.add(ratios);
    }
    sums
}

/// Difference of two means in standard errors.
fn z(a: &Moments, b: &Moments) -> f64 {
    (a.mean - b.mean) / a.standard_error().hypot(b.standard_error())
}

/// z of the light, and of that of joined paths, with technique 1* against those without it, and of the two estimates
/// of the density.
fn deviations(fault: Option<Fault>, everywhere: bool) -> [f64; 3] {
    let mut without = scene();
    without.casters.set_search(ChainSearch::Off);
    let mut with = scene();
    if everywhere {
        with.casters.set_search(ChainSearch::Everywhere);
    }
    let (expected, found) = fault::with(fault, || (sums(&without, 0), sums(&with, SAMPLES)));
    [
        z(&found.light, &expected.light),
        z(&found.joined, &expected.joined),
        z(&found.paths, &found.ratios),
    ]
}

#[test]
fn without_a_fault_means_and_densities_agree() {
    for everywhere in [false, true] {
        let [light, joined, density] = deviations(None, everywhere);
        assert!(light.abs() < 3.5, "{everywhere}: {light}");
        assert!(joined.abs() < 3.5, "{everywhere}: {joined}");
        assert!(everywhere || density.abs() < 3.5, "{density}");
    }
}

#[test]
fn planted_faults_are_found() {
    for (fault, everywhere) in [
        (Fault::ChainJacobianOff, false),
        (Fault::ChainProbabilityLeftOut, false),
        (Fault::ChainRadianceUnscaled, false),
        (Fault::MembershipSkipped, false),
        (Fault::ChainTermLeftOut, true),
    ] {
        let found = deviations(Some(fault), everywhere);
        println!("{fault:?}: {found:.1?}");
        assert!(found.iter().any(|z| z.abs() > 5.0), "{fault:?}: {found:?}");
    }
}
