//! Programs that name themselves in a file's first comments, and what their numbers mean.
//!
//! | program | named by | meaning in MTL | seen in |
//! |---|---|---|---|
//! | Blender from 3.1 on | `# Blender 5.3.0 MTL File: …`; without a number that of the OBJ file counts | `Ns` = 1000 (1 − roughness)², `Ka` = metallic (1 is also 0), `Ks` = Specular IOR Level, `d` = alpha in every model, `Tf` = transmission, `Pc` = 4 coat; `map_Ks`, `map_Ns` and `map_refl` are pictures of Level, roughness and metallic | export of 3.4.1 and 5.3.0, all read back by the importer of 5.3.0 |
//! | Blender 2.80 to 3.0 | as above | the same, but `Ns` = 900 (1 − roughness)² | source of its add-on `io_scene_obj`, `write_mtl` |
//! | VTK, also in PyVista and ParaView | `# wavefront mtl file written by the visualization toolkit` | `Tr` = opacity | source of `vtkOBJExporter`; PyVista 0.49.1 |
//!
//! Blender before 2.80 had another renderer, whose numbers are those of other programs.
//! No program is known whose colors of OBJ or PLY need a rule of their own: all are sRGB, floats too (three.js 0.187, and
//! Blender 5.3.0 as it reads them), and most of those programs do not name themselves.

/// A program's own meaning of its numbers, where others mean something else; by default none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Writer {
    /// Materials are Blender's Principled BSDF, and this is `Ns` of a roughness of 0.
    pub(crate) principled: Option<f32>,
    /// `Tr` is the opacity.
    pub(crate) tr_is_opacity: bool,
}

/// Words that name a program, the first version of it, and what it means; the first that fits counts.
const WRITERS: [(&str, [u32; 2], Writer); 3] = [
    ("blender", [3, 1], Writer { principled: Some(1000.0), tr_is_opacity: false }),
    ("blender", [2, 80], Writer { principled: Some(900.0), tr_is_opacity: false }),
    ("visualization toolkit", [0, 0], Writer { principled: None, tr_is_opacity: true }),
];

/// Most lines at the head of a file, and most bytes of one, in which programs name themselves.
const HEAD: [usize; 2] = [8, 200];

impl Writer {
    /// The program that wrote a material library for an OBJ file, whose comments may have the version.
    pub(crate) fn of_library(library: &[u8], obj: &[u8]) -> Self {
        let [library, obj] = [library, obj].map(comments);
        let fits = |(name, since, _): &&(&str, [u32; 2], Self)| {
            let versions = || [&library, &obj].into_iter().find_map(|text| version(text, name));
            library.contains(&format!(" {name}"))
                && (*since == [0, 0] || versions().is_some_and(|v| v >= *since))
        };
        WRITERS.iter().find(fits).map_or_else(Self::default, |(.., writer)| *writer)
    }
}

/// The comments at the head of a file, in small letters.
fn comments(bytes: &[u8]) -> String {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let comments = lines.take_while(|line| line.is_empty() || line.starts_with(b"#"));
    let text = |line: &[u8]| String::from_utf8_lossy(&line[..line.len().min(HEAD[1])]).to_lowercase();
    comments.take(HEAD[0]).map(text).collect::<Vec<_>>().join("\n")
}

/// The major and minor number behind a name, as in "blender 5.3.0" or "blender v2.79 (sub 0)".
fn version(text: &str, name: &str) -> Option<[u32; 2]> {
    let numbers = |rest: &str| {
        let mut numbers = rest.trim_start().trim_start_matches('v').split(|c: char| !c.is_ascii_digit());
        Some([numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?])
    };
    text.split(&format!(" {name}")).skip(1).find_map(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writers_are_known_by_name_and_version() {
        let of = |library: &str, obj: &str| Writer::of_library(library.as_bytes(), obj.as_bytes());
        let blender = |exponent: f32| Writer { principled: Some(exponent), tr_is_opacity: false };
        let nameless = "# Blender MTL File: 'a.blend'\n# Material Count: 1\n\nnewmtl a\n";
        for (library, obj, expected) in [
            ("# Blender 5.3.0 MTL File: 'None'\n# www.blender.org\n", "", blender(1000.0)),
            (nameless, "# Blender v3.4.1 OBJ File: ''\n", blender(1000.0)),
            (nameless, "# Blender v2.93.4 OBJ File: 'a.blend'\r\n# www.blender.org\r\n", blender(900.0)),
            (nameless, "# Blender v2.79 (sub 0) OBJ File: ''\n", Writer::default()),
            (nameless, "", Writer::default()),
            ("\u{feff}# Blender 5.3.0 MTL File: 'None'\n", "", blender(1000.0)),
            ("newmtl a\n# Blender 5.3.0 MTL File\n", "# Blender 5.3.0\n", Writer::default()),
            ("# made with www.blender.org 5.3\n", "# Blender 5.3.0\n", Writer::default()),
            ("# Blender 99999999999.1\n", "# Blender .\n", Writer::default()),
            (
                "# wavefront mtl file written by the visualization toolkit\n\nnewmtl mtl1\n",
                "",
                Writer { principled: None, tr_is_opacity: true },
            ),
            ("", "", Writer::default()),
        ] {
            assert_eq!(of(library, obj), expected, "{library} {obj}");
        }
    }
}
