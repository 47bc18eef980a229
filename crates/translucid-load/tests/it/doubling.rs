//! Time grows with a file's length, whatever list in it is long.
//!
//! Each list of each format is doubled until it takes a while or the file is large, and then may not take much more than
//! twice as long as half of it.

#![allow(clippy::needless_pass_by_value, reason = "texts that are made where they are passed")]

use std::fmt::Write;
use std::path::Path;

use tempfile::TempDir;
use translucid_load::{LoadOptions, load_scene};
use translucid_testing::thread_cpu_seconds;

/// Time at which a list is long enough \[s\].
const A_WHILE: f64 = 0.05;

/// Time from which on it is compared \[s\].
const LEAST: f64 = 0.005;

/// Lists that `earcut` takes the square of their length for, which a megabyte bounds.
const SQUARE: [&str; 2] = ["obj polygon of a comb", "obj polygon of a spiral"];

/// Factor of time for the double list; of n log n it is little more than 2, of n² it is 4.
const MOST_GROWTH: f64 = 2.6;

/// Bytes up to which lists are doubled.
const LARGEST: usize = 1 << 20;

/// Times that a comparison is tried: a busy machine only ever makes a load slower.
const TRIES: usize = 6;

/// Seconds that loading a megabyte may take, on a machine with others at work.
const MOST_SECONDS: f64 = 8.0;

/// A file with a list of a length, by its name and bytes.
type List = fn(usize) -> (&'static str, Vec<u8>);

/// CPU seconds of loading a file, or of refusing it.
fn seconds(folder: &Path, list: &dyn Fn(usize) -> (&'static str, Vec<u8>), length: usize) -> f64 {
    let (name, bytes) = list(length);
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    let start = thread_cpu_seconds();
    drop(load_scene(&path, &LoadOptions::default(), &mut Vec::new()));
    thread_cpu_seconds() - start
}

/// The fault of a list whose loading takes these seconds by its length and whose files have these bytes, if it has one.
fn fault(name: &str, seconds: &dyn Fn(usize) -> f64, size: &dyn Fn(usize) -> usize) -> Option<String> {
    let (mut length, mut before, mut faults) = (512, f64::INFINITY, Vec::new());
    loop {
        let mut time = seconds(length);
        // What memory takes grows in steps, so that one doubling or two prove nothing
        for _ in 0..TRIES {
            if before.max(LEAST) * MOST_GROWTH >= time {
                break;
            }
            before = before.min(seconds(length / 2));
            time = time.min(seconds(length));
        }
        if before.max(LEAST) * MOST_GROWTH < time {
            faults.push(format!("{name}: {time:.3} s for {length}, {before:.3} s for half of it"));
        } else {
            faults.clear();
        }
        let bytes = size(length);
        let of_megabyte = time * LARGEST as f64 / bytes as f64;
        let is_known = SQUARE.contains(&name);
        if faults.len() >= 3 && !is_known {
            return faults.pop();
        }
        if (time > A_WHILE && (faults.is_empty() || is_known)) || 2 * bytes > LARGEST {
            let is_long = of_megabyte > MOST_SECONDS;
            return is_long
                .then(|| format!("{name}: {of_megabyte:.1} s a megabyte, {time:.3} s for {length}"));
        }
        (before, length) = (time, 2 * length);
    }
}

/// Bytes of a list's file and of those beside it.
fn size(folder: &Path, list: &dyn Fn(usize) -> (&'static str, Vec<u8>), length: usize) -> usize {
    let bytes = list(length).1.len();
    let beside = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let beside = beside.filter(|entry| entry.file_name().to_string_lossy().starts_with("list."));
    bytes + beside.map(|entry| entry.metadata().unwrap().len() as usize).sum::<usize>()
}

/// A text with a line for each number below a length.
fn lines(length: usize, line: impl Fn(usize) -> String) -> String {
    (0..length).fold(String::new(), |mut text, number| {
        writeln!(text, "{}", line(number)).unwrap();
        text
    })
}

/// A list of JSON.
fn list(length: usize, entry: impl Fn(usize) -> String) -> String {
    (0..length).map(entry).collect::<Vec<_>>().join(",")
}

/// Pseudo-random numbers below a million.
fn noise(number: usize) -> u64 {
    (number as u64 ^ 0x55)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .rotate_left(29)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9)
        >> 40
        & 0xfffff
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn obj(text: String) -> (&'static str, Vec<u8>) {
    ("a.obj", text.into_bytes())
}

/// An OBJ with a polygon of these corners.
fn polygon(vertices: String, corners: impl Iterator<Item = usize>) -> (&'static str, Vec<u8>) {
    let mut text = vertices + "f";
    corners.for_each(|corner| write!(text, " {corner}").unwrap());
    obj(text + "\n")
}

/// Corners of a circle.
fn circle(length: usize) -> String {
    lines(length, |i| {
        let (sin, cos) = (i as f64 * std::f64::consts::TAU / length as f64).sin_cos();
        format!("v {cos:.5} {sin:.5} 0")
    })
}

const OBJ: &[(&str, List)] = &[
    ("obj triangles", |n| {
        obj(format!(
            "{}{}",
            lines(n, |i| format!("v {i} {} 0", i % 7)),
            lines(n - 2, |i| format!("f {} {} {}", i + 1, i + 2, i + 3))
        ))
    }),
    ("obj unknown words", |n| obj(format!("{TRIANGLE}{}f 1 2 3\n", lines(n, |i| format!("word{i} 1 2"))))),
    ("obj continued lines", |n| obj(format!("{TRIANGLE}f{} 1 2 3\n", lines(n, |_| " 1 2 3 \\".into())))),
    ("obj unknown materials", |n| {
        obj(format!("{TRIANGLE}f 1 2 3\n{}", lines(n, |i| format!("usemtl m{i}"))))
    }),
    ("obj unknown materials of faces", |n| {
        obj(format!("{TRIANGLE}{}", lines(n, |i| format!("usemtl m{i}\nf 1 2 3"))))
    }),
    ("obj libraries", |n| obj(format!("{TRIANGLE}{}f 1 2 3\n", lines(n, |i| format!("mtllib no{i}.mtl"))))),
    ("obj libraries of a line", |n| {
        obj(format!("{TRIANGLE}mtllib {}\nf 1 2 3\n", lines(n, |i| format!("no{i}.mtl")).replace('\n', " ")))
    }),
    ("obj objects", |n| obj(format!("{TRIANGLE}{}", lines(n, |i| format!("o {i}\nf 1 2 3"))))),
    ("obj groups", |n| obj(format!("{TRIANGLE}{}", lines(n, |i| format!("g {i}\nf 1 2 3"))))),
    ("obj objects that are left out", |n| {
        obj(format!("{TRIANGLE}f 1 2 3\n{}", lines(n, |i| format!("o {i}\nf 1 1 1"))))
    }),
    ("obj groups in turn", |n| obj(format!("{TRIANGLE}{}", lines(n, |i| format!("g {}\nf 1 2 3", i % 2))))),
    ("obj smoothing groups", |n| obj(format!("{TRIANGLE}{}", lines(n, |i| format!("s {i}\nf 1 2 3"))))),
    ("obj short faces", |n| obj(format!("{TRIANGLE}f 1 2 3\n{}", lines(n, |_| "f 1 2".into())))),
    ("obj coordinates of a corner", |n| {
        obj(format!(
            "{TRIANGLE}{}{}",
            lines(n, |_| "vt 0 0".into()),
            lines(n, |i| format!("f 1/{} 2 3", i + 1))
        ))
    }),
    ("obj fan", |n| {
        obj(format!("v 0 0 1\n{}{}", circle(n), lines(n - 1, |i| format!("f 1 {} {}", i + 2, i + 3))))
    }),
    ("obj fan of creases", |n| {
        obj(format!("v 0 0 1\n{}s off\n{}", circle(n), lines(n - 1, |i| format!("f 1 {} {}", i + 2, i + 3))))
    }),
    ("obj faces of an edge", |n| {
        obj(format!("v 0 0 0\nv 0 0 1\n{}{}", circle(n), lines(n, |i| format!("f 1 2 {}", i + 3))))
    }),
    ("obj closed bodies", |n| {
        obj(lines(n, |i| {
            format!(
                "v {i} 0 0\nv {i}.5 0 0\nv {i} 1 0\nv {i} 0 1\nf -4 -3 -2\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1"
            )
        }))
    }),
    ("obj polygon of three", |n| polygon(TRIANGLE.into(), (0..n).map(|i| i % 3 + 1))),
    ("obj polygon of three and one", |n| {
        polygon(format!("{TRIANGLE}v .2 .2 0\n"), (0..n).map(|i| i % 3 + 1).chain([4]))
    }),
    ("obj polygon of a circle", |n| polygon(circle(n), 1..=n)),
    ("obj polygon of a circle twice", |n| polygon(circle(n), (1..=n).chain(1..=n))),
    ("obj polygon to and fro", |n| polygon(circle(n), (1..=n).chain((1..n).rev()))),
    ("obj polygon of noise", |n| polygon(lines(n, |i| format!("v {} {} 0", noise(i), noise(i + n))), 1..=n)),
    ("obj polygon of noise in space", |n| {
        polygon(lines(n, |i| format!("v {} {} {}", noise(i), noise(i + n), noise(i + 2 * n))), 1..=n)
    }),
    ("obj polygon of a star", |n| polygon(circle(n | 1), (0..n | 1).map(|i| i * (n / 2) % (n | 1) + 1))),
    ("obj polygon of a comb", |n| {
        polygon(
            lines(n, |i| format!("v {} {} 0", i, if i % 2 == 0 { 0 } else { 100 }))
                + &format!("v {n} -1 0\nv 0 -1 0\n"),
            1..=n + 2,
        )
    }),
    ("obj polygon of a spiral", |n| {
        polygon(
            lines(n, |i| {
                let (turn, radius) = (
                    (i.min(n - 1 - i)) as f64 * 0.3,
                    (i.min(n - 1 - i) as f64) + if 2 * i < n { 0.0 } else { 5.0 },
                );
                format!("v {:.2} {:.2} 0", radius * turn.cos(), radius * turn.sin())
            }),
            1..=n,
        )
    }),
    ("obj polygon of stairs", |n| {
        polygon(lines(n, |i| format!("v {} {} 0", i / 2, i.div_ceil(2))) + "v 0 9999999 0\n", 1..=n + 1)
    }),
    ("obj polygons of noise", |n| {
        obj(format!(
            "{}{}",
            lines(99, |i| format!("v {} {} 0", noise(i), noise(i + 99))),
            lines(n / 64, |i| {
                format!(
                    "f {}",
                    lines(64, |j| format!("{}", (i * 7 + j * (i % 13 + 1)) % 99 + 1)).replace('\n', " ")
                )
            })
        ))
    }),
];

/// An MTL with these lines, and a face of its first material: both files are in one folder.
fn mtl(folder: &Path, text: String) -> (&'static str, Vec<u8>) {
    std::fs::write(folder.join("list.mtl"), text).unwrap();
    obj(format!("mtllib list.mtl\n{TRIANGLE}usemtl m0\nf 1 2 3\n"))
}

fn ply(vertices: usize, elements: String, data: String) -> (&'static str, Vec<u8>) {
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n{elements}end_header\n{data}"
    );
    ("a.ply", text.into_bytes())
}

const FACE: &str = "property list uchar int vertex_indices\n";

/// A PLY of a triangle with further lines in its header.
fn ply_with(length: usize, line: impl Fn(usize) -> String) -> (&'static str, Vec<u8>) {
    let header = format!("element face 1\n{FACE}{}", lines(length, line));
    ply(3, header, format!("{CORNERS}3 0 1 2\n"))
}

/// The vertices of a triangle.
const CORNERS: &str = "0 0 0\n1 0 0\n0 1 0\n";

/// A PLY with one list of vertices.
fn ply_list(element: &str, length: usize) -> (&'static str, Vec<u8>) {
    let vertices = " 0 1 2".repeat(length / 3) + &" 0".repeat(length % 3);
    let header = format!("element {element} 1\nproperty list int int vertex_indices\n");
    ply(3, header, format!("{CORNERS}{length}{vertices}\n"))
}

const PLY: &[(&str, List)] = &[
    ("ply elements", |n| ply_with(n, |i| format!("element e{i} 0"))),
    ("ply elements of no properties", |n| ply_with(n, |i| format!("element e{i} 9"))),
    ("ply comments", |n| ply_with(n, |i| format!("comment {i}"))),
    ("ply properties", |n| {
        ply(
            3,
            format!("{}element face 1\n{FACE}", lines(n, |i| format!("property uchar p{i}"))),
            format!("{}3 0 1 2\n", format!("0 1 0{}\n", " 1".repeat(n)).repeat(3)),
        )
    }),
    ("ply fan", |n| {
        ply(
            n + 1,
            format!("element face {}\n{FACE}", n - 1),
            format!(
                "0 0 1\n{}{}",
                circle(n).replace("v ", ""),
                lines(n - 1, |i| format!("3 0 {} {}", i + 1, i + 2))
            ),
        )
    }),
    ("ply polygon", |n| ply_list("face", n)),
    ("ply strip", |n| ply_list("tristrips", n)),
    ("ply coordinates of corners", |n| {
        ply(
            3,
            format!("element face {n}\n{FACE}property list uchar float texcoord\n"),
            format!("{CORNERS}{}", lines(n, |i| format!("3 0 1 2 6 {i} 0 0 0 0 0"))),
        )
    }),
    ("ply colors of faces", |n| {
        ply(
            3,
            format!(
                "element face {n}\n{FACE}property float red\nproperty float green\nproperty float blue\n"
            ),
            format!("{CORNERS}{}", lines(n, |i| format!("3 0 1 2 {i} 0 0"))),
        )
    }),
];

const STL: &[(&str, List)] = &[
    ("stl fan", |n| {
        (
            "a.stl",
            ("solid\n".to_owned()
                + &lines(n, |i| {
                    let corner = |i: usize| {
                        let (sin, cos) = (i as f64 / n as f64 * 6.0).sin_cos();
                        format!("vertex {cos:.5} {sin:.5} {}", i % 2)
                    };
                    format!("facet\nouter loop\nvertex 0 0 1\n{}\n{}\nendloop", corner(i), corner(i + 1))
                }))
                .into_bytes(),
        )
    }),
    ("stl colors", |n| {
        ("a.stl", {
            let mut bytes = vec![b' '; 80];
            bytes.extend((n as u32).to_le_bytes());
            for i in 0..n as u16 {
                bytes.extend([0; 12]);
                bytes.extend(
                    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0_f32, f32::from(i)]
                        .into_iter()
                        .flat_map(f32::to_le_bytes),
                );
                bytes.extend((i | 0x8000).to_le_bytes());
            }
            bytes
        })
    }),
    ("stl solids", |n| {
        ("a.stl", lines(n, |i| format!("solid {i}\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendsolid")).into_bytes())
    }),
];

/// A glTF of a triangle, with other lists.
fn gltf(rest: String) -> (&'static str, Vec<u8>) {
    gltf_of([1; 3], rest)
}

/// A glTF of so many buffers, views and accessors of a triangle, each of one before it, with other lists.
fn gltf_of([buffers, views, accessors]: [usize; 3], rest: String) -> (&'static str, Vec<u8>) {
    // Positions (0 0 0) (1 0 0) (0 1 0)
    const DATA: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let uri = format!("data:application/octet-stream;base64,{DATA}");
    let all_buffers = list(buffers, |_| format!("{{\"byteLength\":36,\"uri\":\"{uri}\"}}"));
    let all_views = list(views, |i| format!("{{\"buffer\":{},\"byteLength\":36}}", i.min(buffers - 1)));
    let all_accessors = list(accessors, |i| {
        let view = i.min(views - 1);
        format!("{{\"bufferView\":{view},\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}}")
    });
    let text = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{all_buffers}],\"bufferViews\":[{all_views}],\
         \"accessors\":[{all_accessors}],{rest}}}"
    );
    ("a.gltf", text.into_bytes())
}

/// Meshes of one accessor each, and nodes of them.
fn meshes_of_accessors(length: usize) -> String {
    format!(
        "\"meshes\":[{}],\"nodes\":[{}]",
        list(length, |i| format!("{{\"primitives\":[{{\"attributes\":{{\"POSITION\":{i}}}}}]}}")),
        list(length, |i| format!("{{\"mesh\":{i}}}"))
    )
}

const PRIMITIVE: &str = "{\"attributes\":{\"POSITION\":0}}";

/// A glTF of a node with a mesh of these primitives, with other lists.
fn gltf_mesh(primitives: &str, rest: &str) -> (&'static str, Vec<u8>) {
    gltf(format!("{rest}\"meshes\":[{{\"primitives\":[{primitives}]}}],\"nodes\":[{{\"mesh\":0}}]"))
}

/// A glTF of nodes, with a mesh to have.
fn gltf_nodes(nodes: String) -> (&'static str, Vec<u8>) {
    gltf(format!("\"meshes\":[{{\"primitives\":[{PRIMITIVE}]}}],\"nodes\":[{nodes}]"))
}

/// A glTF of these materials, each of a primitive, with other lists.
fn gltf_materials(length: usize, material: impl Fn(usize) -> String, rest: &str) -> (&'static str, Vec<u8>) {
    let materials = list(length, material);
    let primitives = list(length, |i| format!("{{\"attributes\":{{\"POSITION\":0}},\"material\":{i}}}"));
    gltf_mesh(&primitives, &format!("{rest}\"materials\":[{materials}],"))
}

/// A material with a texture.
fn textured(texture: usize) -> String {
    format!("{{\"pbrMetallicRoughness\":{{\"baseColorTexture\":{{\"index\":{texture}}}}}}}")
}

const GLTF: &[(&str, List)] = &[
    ("gltf nodes", |n| gltf_nodes(list(n, |_| "{\"mesh\":0}".into()))),
    ("gltf chain of nodes", |n| {
        gltf_nodes(list(n, |i| format!("{{\"children\":[{}]}}", i + 1)) + ",{\"mesh\":0}")
    }),
    ("gltf children", |n| {
        let children = list(n, |i| format!("{}", i + 1));
        gltf_nodes(format!("{{\"children\":[{children}]}},{}", list(n, |_| "{\"mesh\":0}".into())))
    }),
    ("gltf meshes", |n| {
        gltf(format!(
            "\"meshes\":[{}],\"nodes\":[{}]",
            list(n, |_| format!("{{\"primitives\":[{PRIMITIVE}]}}")),
            list(n, |i| format!("{{\"mesh\":{i}}}"))
        ))
    }),
    ("gltf primitives", |n| gltf_mesh(&list(n, |_| PRIMITIVE.into()), "")),
    ("gltf materials", |n| gltf_materials(n, |i| format!("{{\"name\":\"{i}\"}}"), "")),
    ("gltf extensions of materials", |n| {
        gltf_materials(n, |i| format!("{{\"extensions\":{{\"KHR_materials_e{i}\":{{}}}}}}"), "")
    }),
    ("gltf extensions required", |n| {
        gltf_mesh(PRIMITIVE, &format!("\"extensionsRequired\":[{}],", list(n, |i| format!("\"E{i}\""))))
    }),
    ("gltf missing pictures", |n| {
        let images = list(n, |i| format!("{{\"uri\":\"no{i}.png\"}}"));
        let textures = list(n, |i| format!("{{\"source\":{i}}}"));
        gltf_materials(n, textured, &format!("\"images\":[{images}],\"textures\":[{textures}],"))
    }),
    ("gltf cameras and lights", |n| {
        gltf(format!(
            "\"extensions\":{{\"KHR_lights_punctual\":{{\"lights\":[{}]}}}},\"cameras\":[{}],\"meshes\":[{{\"primitives\":[{PRIMITIVE}]}}],\"nodes\":[{{\"mesh\":0}},{}]",
            list(n, |_| "{\"type\":\"point\"}".into()),
            list(n, |_| "{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":1}}".into()),
            list(n, |i| format!(
                "{{\"camera\":{i},\"extensions\":{{\"KHR_lights_punctual\":{{\"light\":{i}}}}}}}"
            ))
        ))
    }),
    ("gltf accessors", |n| gltf_of([1, 1, n], meshes_of_accessors(n))),
    ("gltf views", |n| gltf_of([1, n, n], meshes_of_accessors(n))),
    ("gltf buffers", |n| gltf_of([n, n, n], meshes_of_accessors(n))),
    ("gltf samplers", |n| {
        let samplers = list(n, |_| "{\"wrapS\":33071}".into());
        let textures = list(n, |i| format!("{{\"source\":0,\"sampler\":{i}}}"));
        let images = "\"images\":[{\"uri\":\"no.png\"}]";
        let rest = format!("\"samplers\":[{samplers}],\"textures\":[{textures}],{images},");
        gltf_materials(n, textured, &rest)
    }),
    ("gltf attributes", |n| {
        let attributes = list(n, |i| format!("\"_A{i}\":0"));
        gltf_mesh(&format!("{{\"attributes\":{{\"POSITION\":0,{attributes}}}}}"), "")
    }),
];

fn toml(text: String) -> (&'static str, Vec<u8>) {
    ("a.toml", format!("unit = \"mm\"\n{text}").into_bytes())
}

const BALL: &str = "[[object]]\nshape = \"box\"\n";

const TOML: &[(&str, List)] = &[
    ("toml objects", |n| toml(BALL.repeat(n))),
    ("toml objects of names", |n| {
        toml(lines(n, |i| format!("[[object]]\nshape = \"box\"\nname = \"{i}\"\nsubsurface_group = \"{i}\"")))
    }),
    ("toml materials", |n| toml(BALL.to_owned() + &lines(n, |i| format!("[[material]]\nname = \"{i}\"")))),
    ("toml materials of objects", |n| {
        toml(lines(n, |i| {
            format!("[[material]]\nname = \"{i}\"\n[[object]]\nshape = \"box\"\nmaterial = \"{i}\"")
        }))
    }),
    ("toml lights", |n| {
        toml(
            BALL.to_owned()
                + &lines(n, |_| {
                    "[[light]]\ntype = \"distant\"\ndirection = [0, -1, 0]\nirradiance = 1".into()
                }),
        )
    }),
    ("toml cameras", |n| {
        toml(
            BALL.to_owned()
                + &lines(n, |i| {
                    format!("[[camera]]\nname = \"{i}\"\nposition = [0, 0, 9]\ntarget = [0, 0, 0]")
                }),
        )
    }),
    ("toml transforms", |n| {
        toml(format!("{BALL}transforms = [{}]\n", list(n, |i| format!("{{ translate = [{i}, 0, 0] }}"))))
    }),
    ("toml unknown keys", |n| toml(BALL.to_owned() + &lines(n, |i| format!("key{i} = 1")))),
    ("toml missing pictures", |n| {
        toml(
            BALL.to_owned()
                + &lines(n, |i| {
                    format!("[[material]]\nname = \"{i}\"\nbase_color = {{ file = \"no{i}.png\" }}")
                }),
        )
    }),
    ("toml nested arrays", |n| toml(format!("{BALL}scale = {}1{}\n", "[".repeat(n), "]".repeat(n)))),
];

/// A list in a file beside the one that is loaded, in this folder.
type ListBeside = fn(&Path, usize) -> (&'static str, Vec<u8>);

const BESIDE: &[(&str, ListBeside)] = &[
    ("mtl materials", |folder, n| mtl(folder, lines(n, |i| format!("newmtl m{i}")))),
    ("mtl materials of one name", |folder, n| mtl(folder, lines(n, |_| "newmtl m0".into()))),
    ("mtl values out of range", |folder, n| {
        mtl(folder, format!("newmtl m0\n{}", lines(n, |i| format!("Kd {} 0 0", i + 2))))
    }),
    ("mtl unknown maps", |folder, n| {
        mtl(folder, format!("newmtl m0\n{}", lines(n, |i| format!("map_x{i} a.png"))))
    }),
    ("mtl missing pictures", |folder, n| {
        mtl(folder, format!("newmtl m0\n{}", lines(n, |i| format!("map_Kd no{i}.png"))))
    }),
    ("mtl options of a map", |folder, n| {
        mtl(folder, format!("newmtl m0\nmap_Kd{} no.png\n", " -o 1 2 3".repeat(n)))
    }),
    ("mtl transparent materials", |folder, n| mtl(folder, lines(n, |i| format!("newmtl m{i}\nTr 1")))),
    ("csv rows", |folder, n| {
        csv(folder, format!("r,reflectance\n{}", lines(n, |i| format!("{i},{}", 1.0 / (i + 1) as f64))))
    }),
    ("csv columns", |folder, n| {
        let (names, ones) = ((0..n).map(|i| format!(",c{i}")).collect::<String>(), ",1".repeat(n));
        csv(folder, format!("r,reflectance{names}\n0,1{ones}\n1,.5{ones}\n"))
    }),
    ("mtlx nodes", |folder, n| {
        let value = "<input name=\"value\" type=\"color3\" value=\"1,1,1\"/>";
        let node = |i| format!("<constant name=\"n{i}\" type=\"color3\">{value}</constant>");
        mtlx(folder, lines(n, node), "")
    }),
    ("mtlx chain of nodes", |folder, n| products(folder, n, |_| "value=\"1,1,1\"".into())),
    ("mtlx tree of nodes", |folder, n| products(folder, n, |i| format!("nodename=\"n{i}\""))),
    ("mtlx inputs", |folder, n| {
        let inputs = lines(n, |i| format!("<input name=\"i{i}\" type=\"float\" value=\"1\"/>"));
        mtlx(folder, String::new(), &inputs)
    }),
    ("mtlx materials", |folder, n| {
        let shader = "<input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"S\"/>";
        let material =
            |i| format!("<surfacematerial name=\"m{i}\" type=\"material\">{shader}</surfacematerial>");
        mtlx(folder, lines(n, material), "")
    }),
    ("mtlx shaders", |folder, n| {
        mtlx(folder, lines(n, |i| format!("<open_pbr_surface name=\"s{i}\" type=\"surfaceshader\"/>")), "")
    }),
    ("mtlx graphs", |folder, n| {
        let output = "<output name=\"o\" type=\"color3\" nodename=\"n\"/>";
        let graphs = lines(n, |i| format!("<nodegraph name=\"g{i}\">{output}</nodegraph>"));
        mtlx(folder, graphs, "<input name=\"base_color\" type=\"color3\" nodegraph=\"g0\" output=\"o\"/>")
    }),
    ("png chunks", |folder, n| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        for i in 0..n {
            encoder.add_text_chunk(format!("k{i}"), "v".into()).unwrap();
        }
        encoder.write_header().and_then(|mut writer| writer.write_image_data(&[9])).unwrap();
        std::fs::write(folder.join("list.png"), bytes).unwrap();
        picture("list.png")
    }),
    ("exr channels", |folder, n| {
        let other = (0..n).map(|i| format!("c{i:07}"));
        let names: Vec<String> = ["B", "G", "R"].map(String::from).into_iter().chain(other).collect();
        exr(folder, &[&names])
    }),
    ("exr parts", |folder, n| {
        let names = ["B", "G", "R"].map(String::from);
        exr(folder, &vec![&names[..]; n])
    }),
    ("tiff pages", |folder, n| {
        // A page of one pixel, which all have
        let mut bytes = b"II*\0\x0a\0\0\0\x99\0".to_vec();
        for page in 1..=n {
            bytes.extend(9_u16.to_le_bytes());
            for (tag, value) in
                [(256, 1), (257, 1), (258, 8), (259, 1), (262, 1), (273, 8), (277, 1), (278, 1), (279, 1_u32)]
            {
                bytes.extend([tag, 4_u16].into_iter().flat_map(u16::to_le_bytes));
                bytes.extend([1, value].into_iter().flat_map(u32::to_le_bytes));
            }
            let next = if page == n { 0 } else { bytes.len() as u32 + 4 };
            bytes.extend(next.to_le_bytes());
        }
        std::fs::write(folder.join("list.tif"), bytes).unwrap();
        picture("list.tif")
    }),
    ("hdr lines", |folder, n| {
        std::fs::write(
            folder.join("list.hdr"),
            format!(
                "#?RADIANCE\n{}FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\u{1}\u{1}\u{1}\u{1}",
                lines(n, |i| format!("K{i}=1"))
            ),
        )
        .unwrap();
        picture("list.hdr")
    }),
];

/// An OpenEXR picture of one pixel, in parts of these channels.
fn exr(folder: &Path, parts: &[&[String]]) -> (&'static str, Vec<u8>) {
    let is_multipart = parts.len() > 1;
    let word = |value: u32| value.to_le_bytes();
    let mut bytes = [word(20_000_630), word(if is_multipart { 0x1002 } else { 2 })].concat();
    for (number, channels) in parts.iter().enumerate() {
        let mut list: Vec<u8> = Vec::new();
        for name in *channels {
            list.extend(name.bytes().chain([0]));
            list.extend([word(2), word(0), word(1), word(1)].concat());
        }
        list.push(0);
        let mut attributes = vec![
            ("channels", "chlist", list),
            ("compression", "compression", vec![0]),
            ("dataWindow", "box2i", vec![0; 16]),
            ("displayWindow", "box2i", vec![0; 16]),
            ("lineOrder", "lineOrder", vec![0]),
            ("pixelAspectRatio", "float", 1_f32.to_le_bytes().to_vec()),
            ("screenWindowCenter", "v2f", vec![0; 8]),
            ("screenWindowWidth", "float", 1_f32.to_le_bytes().to_vec()),
        ];
        if is_multipart {
            attributes.extend([
                ("name", "string", format!("p{number}").into_bytes()),
                ("type", "string", b"scanlineimage".to_vec()),
                ("chunkCount", "int", word(1).to_vec()),
            ]);
        }
        for (name, kind, value) in attributes {
            bytes.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
            bytes.extend(word(value.len() as u32));
            bytes.extend(value);
        }
        bytes.push(0);
    }
    bytes.extend(is_multipart.then_some(0));
    let size = |channels: &[String]| 8 + 4 * channels.len() + if is_multipart { 4 } else { 0 };
    let mut offset = bytes.len() + 8 * parts.len();
    for channels in parts {
        bytes.extend((offset as u64).to_le_bytes());
        offset += size(channels);
    }
    for (number, channels) in parts.iter().enumerate() {
        bytes.extend(word(number as u32).into_iter().filter(|_| is_multipart));
        bytes.extend([word(0), word(4 * channels.len() as u32)].concat());
        bytes.extend(0.5_f32.to_le_bytes().repeat(channels.len()));
    }
    std::fs::write(folder.join("list.exr"), bytes).unwrap();
    picture("list.exr")
}

/// A document of products, each of the next one and of a factor.
fn products(folder: &Path, length: usize, factor: impl Fn(usize) -> String) -> (&'static str, Vec<u8>) {
    let product = |i: usize| {
        let [next, other] = [format!("nodename=\"n{}\"", i + 1), factor(i + 1)];
        let input = |name: &str, value: &str| format!("<input name=\"{name}\" type=\"color3\" {value}/>");
        let inputs = input("in1", &next) + &input("in2", &other);
        format!("<multiply name=\"n{i}\" type=\"color3\">{inputs}</multiply>")
    };
    mtlx(folder, lines(length, product), "<input name=\"base_color\" type=\"color3\" nodename=\"n0\"/>")
}

/// A document with a shader of these inputs.
fn mtlx(folder: &Path, nodes: String, inputs: &str) -> (&'static str, Vec<u8>) {
    let text = format!(
        "<materialx version=\"1.39\">\n<open_pbr_surface name=\"S\" type=\"surfaceshader\">{inputs}</open_pbr_surface>\n{nodes}</materialx>\n"
    );
    std::fs::write(folder.join("list.mtlx"), text).unwrap();
    with_material("file = \"list.mtlx\"")
}

fn picture(name: &str) -> (&'static str, Vec<u8>) {
    with_material(&format!("base_color = {{ file = \"{name}\" }}"))
}

/// A table of a profile.
fn csv(folder: &Path, text: String) -> (&'static str, Vec<u8>) {
    std::fs::write(folder.join("list.csv"), text).unwrap();
    with_material("subsurface_table = \"list.csv\"")
}

/// A ball of a material with this line.
fn with_material(line: &str) -> (&'static str, Vec<u8>) {
    toml(format!("{BALL}material = \"m\"\n[[material]]\nname = \"m\"\n{line}\n"))
}

fn check(lists: &[(&str, List)]) {
    check_beside(lists, |list, _, length| list(length));
}

/// Fails if a list of a kind takes long.
fn check_beside<L: Copy>(lists: &[(&str, L)], file: impl Fn(L, &Path, usize) -> (&'static str, Vec<u8>)) {
    let folder = TempDir::new().unwrap();
    let once = |&(name, list): &(&str, L)| {
        let list = |n| file(list, folder.path(), n);
        fault(name, &|n| seconds(folder.path(), &list, n), &|n| size(folder.path(), &list, n))
    };
    // A machine whose memory others use takes several times as long for a page, for a second or so
    let of_list = |entry: &(&str, L)| once(entry).and_then(|_| once(entry));
    let faults: Vec<String> = lists.iter().filter_map(of_list).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn obj_lists() {
    check(OBJ);
}

#[test]
fn ply_and_stl_lists() {
    check(PLY);
    check(STL);
}

#[test]
fn gltf_lists() {
    check(GLTF);
}

#[test]
fn toml_lists() {
    check(TOML);
}

#[test]
fn lists_in_files_beside() {
    check_beside(BESIDE, |list, folder, length| list(folder, length));
}

#[test]
fn square_of_the_length_is_seen() {
    let of = |seconds: &dyn Fn(f64) -> f64| fault("a list", &|n| seconds(n as f64), &|n| 20 * n);
    assert!(of(&|n| 1e-8 * n * n).unwrap().starts_with("a list: 0."));
    assert!(of(&|n| 2e-4 * n).unwrap().contains("s a megabyte"));
    assert_eq!(of(&|n| 1e-7 * n * n.ln()), None);
    // Memory that grows past a step
    assert_eq!(of(&|n| if n < 8192.0 { 1e-6 * n } else { 4e-6 * n }), None);
}
