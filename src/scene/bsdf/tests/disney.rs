//! Disney's model as a sum of lobes against the equations of lajolla's handout, and against other models.

use std::f64::consts::PI;

use glam::DVec3;

use super::super::{DisneyLobes, DisneySum, Material, MicrofacetDistribution, Principled};
use super::materials::{
    BLACK, COLOR, GREY, HALF, LIGHT_GREY, WHITE, disney_sum, opaque_principled, textures,
    transparent_disney_sum,
};
use super::{context, unit};
use crate::math::Rgb;
use crate::scene::Texture;

/// Directions to the camera and to the light, both in front.
const PAIRS: [[(f32, f32, f32); 2]; 3] = [
    [(0.3, 0.2, 0.9), (-0.5, 0.1, 0.6)],
    [(0.9, -0.1, 0.15), (-0.7, 0.3, 0.2)],
    [(0.4, 0.3, 0.4), (0.5, 0.1, 0.3)],
];

/// Values of the textures, in the order of [`DisneySum`].
const COLOR_VALUE: [f64; 3] = [0.2, 0.5, 0.8];
const ROUGHNESS: f64 = 0.7;
const GREY_VALUE: f64 = 0.3;
const LIGHT_GREY_VALUE: f64 = 0.7;

fn sum(disney: DisneySum) -> Material {
    Material::DisneySum(disney)
}

fn evaluate(material: &Material, camera: (f32, f32, f32), light: (f32, f32, f32)) -> Rgb {
    let [camera, light] = [camera, light].map(|(x, y, z)| unit(x, y, z));
    material.evaluate(&context(&textures()), light, camera).f
}

fn assert_close(found: Rgb, expected: Rgb, case: &str) {
    let error = (found - expected).abs().max_element();
    let bound = 2e-5 * expected.max_element() + 1e-7;
    assert!(error < bound, "{case}: {found} {expected}");
}

/// (1 - cos)^5.
fn schlick(cos: f64) -> f64 {
    (1.0 - cos).powi(5)
}

/// Color over its luminance.
fn tint() -> [f64; 3] {
    let [r, g, b] = COLOR_VALUE;
    let luminance = 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
    COLOR_VALUE.map(|c| c / luminance)
}

/// The handout's lobes without their cosine |n . w_out|, for one channel, of the parameters of [`disney_sum`].
struct Handout {
    /// w_in.
    camera: DVec3,
    /// w_out.
    light: DVec3,
    channel: usize,
}

/// A lobe or a sum of lobes.
type Lobe = dyn Fn(&Handout) -> f64;

impl Handout {
    fn cos_h(&self) -> f64 {
        (self.camera + self.light).normalize().dot(self.light)
    }

    fn diffuse(&self) -> f64 {
        let cos2 = self.cos_h().powi(2);
        let product = |f90: f64| {
            (1.0 + (f90 - 1.0) * schlick(self.camera.z))
                * (1.0 + (f90 - 1.0) * schlick(self.light.z))
        };
        let base = product(0.5 + 2.0 * ROUGHNESS * cos2);
        let fss = product(ROUGHNESS * cos2);
        let ss = 1.25 * (fss * (1.0 / (self.camera.z + self.light.z) - 0.5) + 0.5);
        COLOR_VALUE[self.channel] / PI * ((1.0 - GREY_VALUE) * base + GREY_VALUE * ss)
    }

    fn sheen(&self) -> f64 {
        let color = 1.0 - GREY_VALUE + GREY_VALUE * tint()[self.channel];
        color * schlick(self.cos_h())
    }

    /// 1 / (1 + Lambda).
    fn masking(v: DVec3, [x, y]: [f64; 2]) -> f64 {
        let slope2 = ((v.x * x).powi(2) + (v.y * y).powi(2)) / v.z.powi(2);
        1.0 / (1.0 + 0.5 * ((1.0 + slope2).sqrt() - 1.0))
    }

    fn clearcoat(&self) -> f64 {
        let alpha = (1.0 - GREY_VALUE) * 0.1 + GREY_VALUE * 0.001;
        let (a2, h) = (alpha * alpha, (self.camera + self.light).normalize());
        let fresnel = 0.04 + 0.96 * schlick(self.cos_h());
        let d = (a2 - 1.0) / (PI * a2.ln() * (1.0 + (a2 - 1.0) * h.z * h.z));
        let g = Self::masking(self.camera, [0.25; 2]) * Self::masking(self.light, [0.25; 2]);
        fresnel * d * g / (4.0 * self.camera.z * self.light.z)
    }

    /// The modified metal, with C_0.
    fn metal(&self) -> f64 {
        let aspect = (1.0 - 0.9 * GREY_VALUE).sqrt();
        let alphas = [ROUGHNESS.powi(2) / aspect, ROUGHNESS.powi(2) * aspect];
        let h = (self.camera + self.light).normalize();
        let root = (h.x / alphas[0]).powi(2) + (h.y / alphas[1]).powi(2) + h.z * h.z;
        let d = 1.0 / (PI * alphas[0] * alphas[1] * root * root);
        let g = Self::masking(self.camera, alphas) * Self::masking(self.light, alphas);
        let k = 1.0 - GREY_VALUE + GREY_VALUE * tint()[self.channel];
        let c0 = 0.5 * 0.04 * (1.0 - GREY_VALUE) * k + GREY_VALUE * COLOR_VALUE[self.channel];
        let fresnel = c0 + (1.0 - c0) * schlick(self.cos_h());
        fresnel * d * g / (4.0 * self.camera.z * self.light.z)
    }
}

/// Opaque, with every other parameter; each channel in f64.
#[test]
fn lobes_are_those_of_the_handout() {
    for [camera, light] in PAIRS {
        let expected = |lobe: &Lobe| {
            let [camera, light] = [camera, light].map(|(x, y, z)| unit(x, y, z).as_dvec3());
            Rgb::from_array([0, 1, 2].map(|channel| {
                lobe(&Handout {
                    camera,
                    light,
                    channel,
                }) as f32
            }))
        };
        let whole = |h: &Handout| {
            let dielectric = 1.0 - GREY_VALUE;
            dielectric * (h.diffuse() + LIGHT_GREY_VALUE * h.sheen())
                + h.metal()
                + 0.25 * LIGHT_GREY_VALUE * h.clearcoat()
        };
        let cases: [(DisneyLobes, &Lobe); 4] = [
            (DisneyLobes::Diffuse, &Handout::diffuse),
            (DisneyLobes::Sheen, &Handout::sheen),
            (DisneyLobes::Clearcoat, &Handout::clearcoat),
            (DisneyLobes::All, &whole),
        ];
        for (lobes, lobe) in cases {
            let found = evaluate(&sum(disney_sum(lobes)), camera, light);
            assert_close(found, expected(lobe), &format!("{lobes:?} {camera:?}"));
        }
    }
}

/// A dielectric that transmits all light is a rough dielectric whose factors are the colour and its square root.
#[test]
fn glass_is_a_coloured_rough_dielectric() {
    let glass = sum(DisneySum {
        anisotropic: BLACK,
        roughness: HALF,
        metallic: BLACK,
        sheen: BLACK,
        clearcoat: BLACK,
        ..transparent_disney_sum(WHITE)
    });
    let mut textures = textures().to_vec();
    textures.push(Texture::Constant(Rgb::new(0.2, 0.5, 0.8).map(f32::sqrt)));
    let rough = Material::RoughDielectric {
        distribution: MicrofacetDistribution::Ggx,
        roughness: super::super::Roughness::Constant(0.25),
        eta: 1.5,
        specular_reflectance: COLOR,
        specular_transmittance: textures.len() as u32 - 1,
    };
    let behind = |(x, y, z): (f32, f32, f32)| (x, y, -z);
    for [a, b] in PAIRS {
        for (camera, light) in [
            (a, b),
            (a, behind(a)),
            (behind(b), a),
            (behind(a), behind(b)),
        ] {
            let [to_camera, to_light] = [camera, light].map(|(x, y, z)| unit(x, y, z));
            let context = context(&textures);
            let found = glass.evaluate(&context, to_light, to_camera);
            let expected = rough.evaluate(&context, to_light, to_camera);
            let case = format!("{camera:?} {light:?}");
            assert_close(found.f, expected.f, &case);
            for (p, q) in [
                (found.pdf_to_light, expected.pdf_to_light),
                (found.pdf_to_camera, expected.pdf_to_camera),
            ] {
                assert!((p - q).abs() <= 2e-5 * q, "{case}: {p} {q}");
            }
        }
    }
}

/// Without a base, sheen and clearcoat both models are metals with Schlick's reflectance.
#[test]
fn metals_are_those_of_principled() {
    let ours = sum(DisneySum {
        metallic: WHITE,
        clearcoat: BLACK,
        ..disney_sum(DisneyLobes::All)
    });
    let theirs = Material::Principled(Principled {
        metallic: WHITE,
        clearcoat: BLACK,
        ..opaque_principled()
    });
    for [camera, light] in PAIRS {
        let [found, expected] = [&ours, &theirs].map(|m| evaluate(m, camera, light));
        assert_close(found, expected, &format!("{camera:?}"));
    }
}

/// With glass the other lobes keep their weights, and behind the surface there is only glass.
#[test]
fn transmission_takes_the_place_of_the_base() {
    let [camera, light] = PAIRS[0];
    let at = |specular_transmission, metallic| {
        let disney = DisneySum {
            metallic,
            sheen: BLACK,
            clearcoat: BLACK,
            ..transparent_disney_sum(specular_transmission)
        };
        evaluate(&sum(disney), camera, light)
    };
    // Linear in t, and no glass in a metal.
    let expected = at(BLACK, BLACK) * (1.0 - 0.3) + at(WHITE, BLACK) * 0.3;
    assert_close(at(GREY, BLACK), expected, "between");
    assert_close(at(LIGHT_GREY, WHITE), at(BLACK, WHITE), "metal");
    let behind = |v: (f32, f32, f32)| (v.0, v.1, -v.2);
    let opaque = sum(disney_sum(DisneyLobes::All));
    assert_eq!(evaluate(&opaque, behind(camera), behind(light)), Rgb::ZERO);
}
