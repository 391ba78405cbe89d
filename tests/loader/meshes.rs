//! Compares meshes with those that Mitsuba reads from the same files:
//! `traverse(shape)["...vertex_positions"]`, ...

use std::fs;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use metrolight::scene::{ShapeGeometry, TriangleMesh};
use tempfile::TempDir;

use super::{description, load_body};

fn mesh(kind: &str, file: &str, parameters: &str) -> TriangleMesh {
    let mut scene = description(&format!(
        r#"<shape type="{kind}"><string name="filename" value="{file}"/>{parameters}</shape>"#
    ));
    match scene.shapes.remove(0).geometry {
        ShapeGeometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// The error message for a mesh file with these contents.
fn failure(kind: &str, contents: &[u8], parameters: &str) -> String {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("mesh");
    fs::write(&path, contents).expect("a writable file");
    let name = path.display();
    let result = load_body(&format!(
        r#"<shape type="{kind}"><string name="filename" value="{name}"/>{parameters}</shape>"#
    ));
    match result {
        Ok(_) => panic!("loaded: {}", String::from_utf8_lossy(contents)),
        Err(error) => error.to_string(),
    }
}

fn assert_near<const N: usize>(found: &[[f32; N]], expected: &[[f32; N]]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < 1e-5, "{found:?} {expected:?}");
    }
}

const QUAD: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
];
const QUAD_UVS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.25]];
const QUAD_TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
/// The vertex normals that Mitsuba computes for the two triangles.
const SMOOTH: [[f32; 3]; 4] = [
    [0.370_483, -0.370_483, 0.851_754],
    [0.0, 0.0, 1.0],
    [0.370_483, -0.370_483, 0.851_754],
    [0.577_35, -0.577_35, 0.577_35],
];

/// Normals of unit length: those of the loader may have any length.
fn unit(normals: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let unit = |n: &[f32; 3]| glam::Vec3::from(*n).normalize().to_array();
    normals.iter().map(unit).collect()
}

#[test]
fn obj_matches_mitsuba() {
    let quad = mesh("obj", "quad.obj", "");
    // The quadrilateral is split at its first corner. The triangle has vertices of its own, because
    // they have no texture coordinates, so the two faces do not share vertex normals.
    assert_eq!(quad.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6]]);
    assert_eq!(
        quad.positions[4..],
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 2.0, 1.0]]
    );
    let uvs = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    assert_near(&quad.uvs[..4], &uvs);
    let tilted = [0.0, -0.447_213_6, 0.894_427_2];
    let up = [0.0, 0.0, 1.0];
    assert_near(
        &unit(&quad.normals),
        &[up, up, up, up, tilted, tilted, tilted],
    );

    let flat = r#"<boolean name="face_normals" value="true"/>
                  <boolean name="flip_tex_coords" value="false"/>"#;
    let quad = mesh("obj", "quad.obj", flat);
    assert!(quad.normals.is_empty());
    assert_near(
        &quad.uvs[..4],
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
    );

    let with_normals = mesh("obj", "normals.obj", "");
    assert_eq!(with_normals.normals, [[0.0, 0.0, 2.0]; 3]);
    assert!(mesh("obj", "normals.obj", flat).normals.is_empty());
}

/// Corners with the same indices are one vertex across groups, which affects its normal. Numbers
/// after those that a statement needs are ignored.
#[test]
fn groups_of_an_obj_file_are_one_mesh() {
    let mesh = mesh("obj", "groups.obj", "");
    assert_eq!(
        mesh.positions,
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 2.0, 1.0],
            [-1.0, 1.0, 0.0],
            [-1.0, 0.5, 0.0],
        ]
    );
    assert_eq!(
        mesh.triangles,
        [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [3, 2, 1]]
    );
    let (a, b) = ([0.5, 1.0], [0.25, 0.25]);
    assert_eq!(mesh.uvs, [a, a, b, b, a, b]);
    assert_near(
        &unit(&mesh.normals),
        &[
            [0.0, -0.272_538, 0.962_145],
            [-0.357_866, 0.0, 0.933_773],
            [-0.738_123, -0.523_226, 0.425_922],
            [-0.224_973, -0.523_409, 0.821_846],
            [-0.283_993, -0.283_993, 0.915_804],
            [0.0, 0.0, 1.0],
        ],
    );
}

#[test]
fn ply_is_read_in_all_three_encodings() {
    for file in ["quad_le.ply", "quad_be.ply", "quad_ascii.ply"] {
        let quad = mesh("ply", file, "");
        assert_eq!(quad.positions, QUAD, "{file}");
        assert_eq!(quad.uvs, QUAD_UVS, "{file}");
        assert_eq!(quad.triangles, QUAD_TRIANGLES, "{file}");
        match file {
            "quad_ascii.ply" => assert_eq!(quad.normals, [[0.0, 0.0, 2.0]; 4]),
            _ => assert_near(&unit(&quad.normals), &SMOOTH),
        }
        let other = r#"<boolean name="face_normals" value="true"/>
                       <boolean name="flip_tex_coords" value="true"/>"#;
        let quad = mesh("ply", file, other);
        assert!(quad.normals.is_empty());
        assert_near(
            &quad.uvs,
            &[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.75]],
        );
    }
}

#[test]
fn serialized_is_read_in_both_versions() {
    let index = |i: usize| format!(r#"<integer name="shape_index" value="{i}"/>"#);
    // Plain; with normals, texture coordinates and colours; in double precision.
    for (file, i, has_normals, has_uvs) in [
        ("v4.serialized", 0, false, false),
        ("v4.serialized", 1, true, true),
        ("v4.serialized", 2, false, true),
        ("v3.serialized", 0, false, false),
        ("v3.serialized", 1, true, true),
    ] {
        let quad = mesh("serialized", file, &index(i));
        assert_eq!(quad.positions, QUAD, "{file} {i}");
        assert_eq!(quad.triangles, QUAD_TRIANGLES, "{file} {i}");
        assert_eq!(quad.uvs.len(), if has_uvs { 4 } else { 0 });
        if has_uvs {
            assert_eq!(quad.uvs, QUAD_UVS, "{file} {i}");
        }
        let expected = if has_normals {
            [[0.0, 0.0, 1.0]; 4]
        } else {
            SMOOTH
        };
        assert_near(&unit(&quad.normals), &expected);
    }
    for (file, i) in [("v4.serialized", 3), ("v3.serialized", 2)] {
        let body = format!(
            r#"<shape type="serialized"><string name="filename" value="{file}"/>{}</shape>"#,
            index(i)
        );
        let message = load_body(&body).expect_err("out of range").to_string();
        assert!(message.contains("`shape_index`"), "{message}");
    }
}

#[test]
fn errors_in_obj_files_have_a_line() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (rest, phrases) in [
        ("f 1 2 4\n", [":4: ", "none of the 3 positions"]),
        ("f 1 2 0\n", [":4: ", "none of the 3 positions"]),
        ("f 1 2 -4\n", [":4: ", "none of the 3 positions"]),
        (
            "f 1 2 3\nf 1/1 2/1 3/1\n",
            [":5: ", "none of the 0 texture"],
        ),
        // Multiplied by 2 or 3, these overflow 64 bits and become small.
        (
            "vt 0 0\nf 1/9223372036854775807 2/1 3/1\n",
            [":5: ", "none of the 1 texture"],
        ),
        (
            "vn 0 0 1\nf 1//6148914691236517206 2//1 3//1\n",
            [":5: ", "none of the 1 normals"],
        ),
        (
            "f 1 2 -9223372036854775808\n",
            [":4: ", "none of the 3 positions"],
        ),
        ("f 1 2 //\n", [":4: ", "is not a corner"]),
        ("f 1 2 3///1\n", [":4: ", "is not a corner"]),
        ("f 1 2\n", [":4: ", "three corners"]),
        ("v 1 nan 2\n", [":4: ", "`nan` is not a finite number"]),
        ("vt 1e39 0\n", [":4: ", "`1e39` is not a finite number"]),
        ("v 1 2\n", [":4: ", "3 numbers expected"]),
        ("v 1 2 # 3\n", [":4: ", "3 numbers expected"]),
        ("vn 0 0 x\n", [":4: ", "`x`"]),
        ("", ["mesh: ", "no triangles"]),
    ] {
        let message = failure("obj", format!("{triangle}{rest}").as_bytes(), "");
        for phrase in phrases {
            assert!(message.contains(phrase), "{rest}: {message}");
        }
    }
}

#[test]
fn errors_in_ply_files_have_a_line_or_an_offset() {
    let ply = |vertices: u64, faces: u64, data: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\n\
             property float y\nproperty float z\nelement face {faces}\n\
             property list uchar int vertex_indices\nend_header\n{data}"
        )
    };
    let three = "0 0 0\n1 0 0\n0 1 0\n";
    for (text, phrases) in [
        (
            ply(3, 1, &format!("{three}3 0 1 3\n")),
            ["mesh: ", "refers to vertex 3"],
        ),
        (
            ply(3, 1, &format!("{three}3 0 1 -1\n")),
            [":13: ", "-1 is not the index"],
        ),
        (
            ply(3, 1, &format!("{three}3 0 1 0.5\n")),
            [":13: ", "0.5 is not the index"],
        ),
        (
            ply(3, 1, &format!("{three}2 0 1\n")),
            [":13: ", "three corners"],
        ),
        (
            ply(3, 1, &format!("{three}-3 0 1\n")),
            [":13: ", "-3 entries"],
        ),
        (
            ply(3, 1, "0 0 0\n1 x 0\n"),
            [":11: ", "`x` is not a number"],
        ),
        (
            ply(3, 1, "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2"),
            ["mesh: ", "position of vertex 1"],
        ),
        (
            ply(4_000_000_000, 1, three),
            [":13: ", "ends before its data"],
        ),
        (
            ply(3, 4_000_000_000, three),
            [":13: ", "ends before its data"],
        ),
        (ply(5_000_000_000, 1, three), [":3: ", "number of vertex"]),
        (ply(3, 0, three), ["mesh: ", "no triangles"]),
        ("ply\nformat ascii 1.0\n".into(), ["mesh: ", "no end"]),
        ("ply\nformat text 1.0\n".into(), [":2: ", "`text`"]),
        (
            "ply\nproperty float x\n".into(),
            [":2: ", "before any element"],
        ),
        (
            "ply\nelement vertex 1\nproperty quad x\n".into(),
            [":3: ", "`quad`"],
        ),
    ] {
        let message = failure("ply", text.as_bytes(), "");
        for phrase in phrases {
            assert!(message.contains(phrase), "{text}: {message}");
        }
    }
    let binary = ply(4_000_000_000, 1, "abc").replace("ascii", "binary_little_endian");
    let message = failure("ply", binary.as_bytes(), "");
    assert!(
        message.contains("(byte ") && message.contains("ends before"),
        "{message}"
    );
    // Skipping four thousand million elements without properties takes no time.
    let nothing = ply(3, 1, &format!("{three}3 0 1 2\n")).replace(
        "element vertex",
        "element nothing 4000000000\nelement vertex",
    );
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("mesh.ply");
    fs::write(&path, nothing).expect("a writable file");
    assert_eq!(
        mesh("ply", &path.display().to_string(), "").triangles.len(),
        1
    );
}

#[test]
fn faulty_serialized_files_are_rejected() {
    let stream = |vertices: u64, triangles: u64, data: &[f32]| {
        let mut encoder = ZlibEncoder::new(vec![0x1C, 0x04, 3, 0], Compression::default());
        let mut content = 0x1000_u32.to_le_bytes().to_vec();
        content.extend(vertices.to_le_bytes());
        content.extend(triangles.to_le_bytes());
        content.extend(data.iter().flat_map(|x| x.to_le_bytes()));
        encoder.write_all(&content).expect("memory");
        encoder.finish().expect("memory")
    };
    let one = r#"<integer name="shape_index" value="1"/>"#;
    let minus = r#"<integer name="shape_index" value="-1"/>"#;
    for (bytes, parameters, phrase) in [
        (
            stream(u64::MAX, 1, &[]),
            "",
            "it claims 18446744073709551615 vertices",
        ),
        (
            stream(4_000_000_000, 1, &[0.0; 9]),
            "",
            "it claims 4000000000 vertices and 1 triangles, in all 48000000012 bytes",
        ),
        (
            stream(3, 4_000_000_000, &[0.0; 9]),
            "",
            "it claims 3 vertices and 4000000000 triangles",
        ),
        (stream(100_000, 1, &[0.0; 9]), "", "the data ends early"),
        (stream(3, 1, &[0.0; 12]), minus, "at least 0"),
        (stream(3, 1, &[f32::NAN; 12]), "", "position of vertex 0"),
        (stream(3, 1, &[1.0; 12]), "", "refers to vertex 1065353216"),
        (stream(0, 0, &[]), "", "no triangles"),
        (vec![0x1C, 0x04, 3, 0, 1, 2, 3], "", "the data is corrupt"),
        (vec![0x1C, 0x04, 5, 0], "", "version 5"),
        (
            vec![0x1C, 0x04, 3, 0, 255, 255, 255, 255],
            one,
            "table at the end",
        ),
        (vec![0x1C], "", "no serialized mesh"),
    ] {
        let message = failure("serialized", &bytes, parameters);
        assert!(message.contains(phrase), "{phrase}: {message}");
    }
}
