//! Random scenes: any materials and emitters, anywhere.

use metrolight::mitsuba;
use metrolight::scene::Scene;
use tempfile::TempDir;

/// Two plates, three balls, and one or two emitters, chosen by `u` in [0, 1).
pub fn random_scene(u: &[f32]) -> Scene {
    let mut u = u.iter().copied().cycle();
    let mut between = |low: f32, high: f32| low + (high - low) * u.next().unwrap();
    let mut shapes = String::new();
    for (scale, place) in [("2", "0 0 -2"), ("3", "0 0 -3")] {
        let turn = between(-60.0, 60.0);
        let albedo = between(0.1, 0.9);
        shapes += &format!(
            r#"<shape type="rectangle"><transform name="to_world"><scale value="{scale}"/>
            <rotate x="1" y="0.5" angle="{turn}"/><translate value="{place}"/></transform>
            <bsdf type="twosided"><bsdf type="diffuse"><float name="reflectance" value="{albedo}"/>
            </bsdf></bsdf></shape>"#
        );
    }
    for _ in 0..3 {
        let ior = between(1.2, 1.9);
        let alpha = between(0.15, 0.6);
        let bsdf = match between(0.0, 6.0) as u32 {
            0 => format!(r#"<bsdf type="dielectric"><float name="int_ior" value="{ior}"/></bsdf>"#),
            1 => format!(
                r#"<bsdf type="roughdielectric"><float name="int_ior" value="{ior}"/>
                <float name="alpha" value="{alpha}"/></bsdf>"#
            ),
            2 => format!(r#"<bsdf type="plastic"><float name="int_ior" value="{ior}"/></bsdf>"#),
            3 => format!(
                r#"<bsdf type="roughconductor"><string name="distribution" value="ggx"/>
                <float name="alpha" value="{alpha}"/></bsdf>"#
            ),
            4 => r#"<bsdf type="conductor"/>"#.to_owned(),
            _ => r#"<bsdf type="diffuse"/>"#.to_owned(),
        };
        let (x, y, z) = (between(-1.5, 1.5), between(-1.5, 1.5), between(-1.0, 1.0));
        let radius = between(0.2, 0.8);
        shapes += &format!(
            r#"<shape type="sphere"><point name="center" value="{x} {y} {z}"/>
            <float name="radius" value="{radius}"/>{bsdf}</shape>"#
        );
    }
    let (x, y, z) = (between(-2.0, 2.0), between(0.5, 2.0), between(0.0, 2.0));
    let (size, turn) = (between(0.2, 0.8), between(0.0, 360.0));
    let kind = between(0.0, 5.0) as u32;
    if kind != 3 {
        shapes += &format!(
            r#"<shape type="{}"><transform name="to_world"><scale value="{size}"/>
            <rotate x="0.8" z="0.6" angle="{turn}"/><translate value="{x} {y} {z}"/></transform>
            <emitter type="area"/></shape>"#,
            ["rectangle", "cube", "sphere"][(kind % 3) as usize]
        );
    }
    if kind >= 2 {
        shapes += [
            r#"<emitter type="constant"><float name="radiance" value="0.2"/></emitter>"#,
            r#"<emitter type="point"><point name="position" value="1 2 1"/></emitter>"#,
            r#"<emitter type="directional"><vector name="direction" value="1 -2 -3"/></emitter>"#,
        ][(kind - 2) as usize];
    }
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.xml");
    let text = format!(
        r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="5"/>
        </integrator><sensor type="perspective"><float name="fov" value="50"/>
        <transform name="to_world"><lookat origin="0 0.5 6" target="0 0 0"/></transform></sensor>
        {shapes}</scene>"#
    );
    std::fs::write(&path, text).unwrap();
    let loaded = mitsuba::load(&path, &[]).unwrap();
    loaded.description.build().unwrap()
}
