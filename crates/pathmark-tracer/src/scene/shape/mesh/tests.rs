//! Tests of scenes with meshes from files.

use crate::error::Result;
use crate::math::{Vec3, dot};
use crate::scene::{Scene, load};
use std::fs;

const HEAD: &str = "about = 'a mesh'\nbackground = [1.0, 1.0, 1.0]\n\n[camera.pinhole]\nposition = [0.0, 0.0, 10.0]\nlook-at = [0.0, 0.0, 0.0]\n\
    field-of-view = 40.0\n\n[[objects]]\nname = 'thing'\nmaterial = { diffuse = { albedo = [0.5, 0.5, 0.5] } }\n";

/// Loads a scene with one shape, beside a file of that name.
fn scene(shape: &str, file: (&str, &str)) -> Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(folder.path().join(file.0), file.1).unwrap();
    fs::write(&path, format!("{HEAD}shape = {{ {shape} }}\n")).unwrap();
    load(path.to_str().unwrap())
}

fn mesh(obj: &str, placement: &str) -> Scene {
    scene(&format!("mesh = {{ file = 'a.obj'{placement} }}"), ("a.obj", obj)).unwrap()
}

/// The sum of the areas of triangles in a plane of constant z, whichever way each faces.
fn area(scene: &Scene) -> f64 {
    let areas = scene.primitives.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.corners;
        0.5 * dot((b - a).cross(c - a), Vec3::new(0.0, 0.0, 1.0)).abs()
    });
    areas.sum()
}

/// The remarks without the folder of the file.
fn remarks(scene: &Scene) -> Vec<String> {
    let own = |remark: &String| remark.rsplit_once('/').map_or(remark.clone(), |(_, own)| own.to_string());
    scene.remarks.iter().map(own).collect()
}

const DART: [&str; 4] = ["-2 -1 0", "0 0 0", "2 -1 0", "0 2 0"];

/// The area of the dart is 4 (shoelace formula). A fan from its first corner has an area of 6, and turns a triangle
/// over.
#[test]
fn a_concave_face_keeps_its_outline() {
    let obj = DART.map(|vertex| format!("v {vertex}\n")).concat() + "f 1 2 3 4\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let ply = format!("{ply}{}\n4 0 1 2 3\n", DART.join("\n"));
    let quad = DART.map(|vertex| format!("[{}]", vertex.replace(' ', ".0, ") + ".0")).join(", ");
    let scenes = [
        mesh(&obj, ""),
        scene("mesh = { file = 'a.ply' }", ("a.ply", &ply)).unwrap(),
        scene(&format!("quad = {{ corners = [{quad}] }}"), ("none", "")).unwrap(),
    ];
    for scene in scenes {
        assert_eq!((area(&scene), scene.primitives.triangles.len()), (4.0, 2));
        assert_eq!(remarks(&scene), [""; 0]);
    }
}

/// Without the mark and with it, before a vertex and before a name.
#[test]
fn a_byte_order_mark_hides_nothing() {
    let obj = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 3 0\nf 1 2 3\n";
    assert_eq!(area(&mesh(obj, "")), 1.0);
    assert_eq!(area(&mesh(&format!("\u{feff}{obj}"), "")), 1.0);
    assert_eq!(area(&mesh(&format!("\u{feff}o a\n{obj}o b\nf 1 2 3\n"), ", object = 'a'")), 1.0);
}

/// A mesh that is scaled by 2, turned by quarters about x and z and moved is the mesh of the vertices that were
/// computed by hand: (x, y, z) becomes (2 z + 1, 2 x + 2, 2 y + 3).
#[test]
fn a_placed_mesh_is_the_mesh_of_placed_vertices() {
    let faces = "f 1 2 3\nf 1 3 4\n";
    let plain = format!("v 0 0 0\nv 1 0 0\nv 1 4 0.5\nv 0 4 -3\n{faces}");
    let placed = format!("v 1 2 3\nv 1 4 3\nv 2 4 11\nv -5 2 11\n{faces}");
    let placement = ", scale = 2.0, rotate = [90.0, 0.0, 90.0], translate = [1.0, 2.0, 3.0]";
    assert_eq!(mesh(&plain, placement).primitives, mesh(&placed, "").primitives);
    // The placement is part of the scene's identity.
    assert_ne!(mesh(&plain, placement).hash, mesh(&plain, &placement.replace("2.0,", "2.5,")).hash);
    // A placement that changes nothing changes no bit, not even the sign of a zero.
    let still = ", scale = 1.0, rotate = [0.0, -0.0, 0.0], translate = [0.0, 0.0, 0.0]";
    let signed = plain.replacen("v 0 0 0", "v -0 0 -0", 1);
    let bits = |scene: &Scene| format!("{:?}", scene.primitives.triangles);
    assert_eq!(bits(&mesh(&signed, still)), bits(&mesh(&signed, "")));
}

#[test]
fn doubtful_faces_are_remarked() {
    let bent = "v -1 -1 0\nv 1 -1 0\nv 1 1 0.2\nv -1 1 0\nf 1 2 3 4\n";
    let expected = "a.obj: faces that are not flat: 1; the cut into triangles decides their shape";
    assert_eq!(remarks(&mesh(bent, "")), [expected]);
    let bow = "v -1 -1 0\nv 1 1 0\nv 1 -1 0\nv -1 1 0\nf 1 2 3 4\nf 2 3 4 1\n";
    assert_eq!(remarks(&mesh(bow, "")), ["a.obj: faces whose edges cross: 2; their area is uncertain"]);
    let quad = "quad = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.2], [0.0, 1.0, 0.0]] }";
    let expected = "thing: faces that are not flat: 1; the cut into triangles decides their shape";
    assert_eq!(remarks(&scene(quad, ("none", "")).unwrap()), [expected]);
    let more = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
        property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n";
    let scene = scene("mesh = { file = 'a.ply' }", ("a.ply", more)).unwrap();
    assert_eq!(remarks(&scene), ["a.ply: data behind the last element of the header are not used"]);
}

/// The view of 40 degrees is 7.28 high at the mesh, and twice as wide in a picture of two squares.
#[test]
fn a_mesh_outside_the_view_is_remarked_with_its_bounds() {
    let obj = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n";
    let unseen = |placement: &str, width| {
        let scene = mesh(obj, placement);
        scene.unseen_meshes(&scene.camera.view(width, 10)).collect::<Vec<_>>()
    };
    for seen in ["", ", translate = [4.5, 0.0, 0.0]", ", translate = [0.0, -4.5, 0.0]", ", scale = 100.0"] {
        assert_eq!(unseen(seen, 10), [""; 0], "{seen}");
    }
    assert_eq!(unseen(", translate = [6.0, 0.0, 0.0]", 20), [""; 0]);
    let expected = "thing: the camera does not see this mesh, which extends from (5.0, -1.0, 0.0) to (7.0, 1.0, 0.0); `scale`, \
        `rotate` and `translate` place a mesh";
    assert_eq!(unseen(", translate = [6.0, 0.0, 0.0]", 10), [expected]);
    for away in ["[0.0, 6.0, 0.0]", "[0.0, 0.0, 20.0]", "[0.0, -6.0, 0.0]", "[1e5, 0.0, 0.0]"] {
        assert_eq!(unseen(&format!(", translate = {away}"), 10).len(), 1, "{away}");
    }
}
