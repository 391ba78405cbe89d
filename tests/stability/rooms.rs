//! A room in a few words of XML, with something difficult in it.

use metrolight::scene::Scene;

/// A diffuse room of 4 x 3 x 4 around (0, 1.5, 0), open toward the camera, with `contents`. The film
/// has 24 x 18 pixels, paths at most 6 edges.
pub fn room(contents: &str) -> Scene {
    room_to_depth(6, contents)
}

/// Camera and lamp each in a ball of glass: direct light comes over paths of four edges that only
/// camera subpaths find, and of them only those that run into the lamp. Longer paths, which joins on
/// the walls could make, are left out.
pub fn behind_two_panes(lamp_radius: f64) -> Scene {
    let eye = ball("eye", 0.35, [0.0, 1.5, 5.8], GLASS);
    room_to_depth(4, &(shaded_lamp(lamp_radius) + &eye))
}

/// The same seen with the naked eye, which joins can find; and how much brighter radiance is in the ball
/// of glass around the eye: n^2 T, with Fresnel's T = 4n/(n + 1)^2 for the rays through its centre.
pub fn behind_one_pane(lamp_radius: f64) -> (Scene, f64) {
    // The defaults of scene files: glass of BK7 in air.
    let n: f64 = 1.5046 / 1.000_277;
    let brighter = n * n * 4.0 * n / (n + 1.0).powi(2);
    (room_to_depth(3, &shaded_lamp(lamp_radius)), brighter)
}

fn shaded_lamp(radius: f64) -> String {
    lamp(radius, OUT_OF_SIGHT) + &ball("shade", 0.35, OUT_OF_SIGHT, GLASS)
}

fn room_to_depth(max_depth: i32, contents: &str) -> Scene {
    let walls = [
        ("floor", "<rotate x='1' angle='-90'/>"),
        ("ceiling", "<rotate x='1' angle='90'/><translate y='3'/>"),
        ("back", "<translate z='-2' y='1.5'/>"),
        (
            "left",
            "<rotate y='1' angle='90'/><translate x='-2' y='1.5'/>",
        ),
        (
            "right",
            "<rotate y='1' angle='-90'/><translate x='2' y='1.5'/>",
        ),
    ]
    .map(|(name, place)| {
        format!(
            "<shape type='rectangle' id='{name}'>
               <transform name='to_world'><scale value='2'/>{place}</transform>
               <bsdf type='twosided'><bsdf type='diffuse'>
                 <rgb name='reflectance' value='0.6, 0.55, 0.5'/></bsdf></bsdf>
             </shape>"
        )
    })
    .concat();
    scene(
        "<float name='fov' value='40'/>
         <transform name='to_world'>
           <lookat origin='0, 1.5, 5.8' target='0, 1.4, 0' up='0, 1, 0'/></transform>",
        [24, 18],
        max_depth,
        &(walls + contents),
    )
}

/// A scene from XML: what a perspective camera and the scene hold, the film's size, the longest path.
pub fn scene(camera: &str, [width, height]: [u32; 2], max_depth: i32, contents: &str) -> Scene {
    let text = format!(
        "<scene version='3.0.0'>
           <integrator type='path'><integer name='max_depth' value='{max_depth}'/></integrator>
           <sensor type='perspective'>{camera}
             <film type='hdrfilm'>
               <integer name='width' value='{width}'/><integer name='height' value='{height}'/>
               <rfilter type='box'/></film></sensor>
           {contents}
         </scene>"
    );
    let directory = tempfile::tempdir().expect("a temporary directory");
    let path = directory.path().join("scene.xml");
    std::fs::write(&path, text).expect("room for a scene");
    let loaded = metrolight::mitsuba::load(&path, &[]).expect("a scene without faults");
    loaded.description.build().expect("a scene without faults")
}

/// A spherical lamp that shines with 40 W in every channel whatever its radius.
pub fn lamp(radius: f64, [x, y, z]: [f64; 3]) -> String {
    let radiance = 40.0 / (4.0 * std::f64::consts::PI.powi(2) * radius * radius);
    format!(
        "<shape type='sphere' id='lamp'>
           <point name='center' x='{x}' y='{y}' z='{z}'/><float name='radius' value='{radius:e}'/>
           <emitter type='area'><rgb name='radiance' value='{radiance:e}'/></emitter></shape>"
    )
}

/// A ball; `glass` is its material.
pub fn ball(name: &str, radius: f64, [x, y, z]: [f64; 3], glass: &str) -> String {
    format!(
        "<shape type='sphere' id='{name}'>
           <point name='center' x='{x}' y='{y}' z='{z}'/><float name='radius' value='{radius}'/>
           {glass}</shape>"
    )
}

/// Above the opening of a room, where the camera does not see it.
pub const OUT_OF_SIGHT: [f64; 3] = [0.0, 2.75, 2.6];

/// Smooth glass.
pub const GLASS: &str = "<bsdf type='dielectric'/>";
