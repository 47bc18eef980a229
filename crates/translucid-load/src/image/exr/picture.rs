//! The channels of an OpenEXR file that are the picture.

use super::names::{before_view, layer, picture_rank};

/// Layers that a message names.
const MOST_NAMED: usize = 4;

/// Numbers of the channels of a picture.
#[derive(Debug, PartialEq)]
pub(super) struct Picture {
    pub(super) color: [Option<usize>; 3],
    pub(super) alpha: Option<usize>,
    /// Whether red, green and blue are called X, Y and Z, and belong to no layer: renderers write CIE XYZ so, and vectors as a
    /// layer.
    pub(super) is_xyz: bool,
    /// A warning which layer is taken, where there are others.
    pub(super) said: Option<String>,
}

/// Why there is no picture, and what to do.
type Refusal = (String, Option<String>);

impl Picture {
    /// Chooses among the channels of all parts: R, G, B (and A), or Y as grey, or else the first three of a layer.
    ///
    /// Colors may be written out and in small letters ("red", "g").
    /// Channels without a layer come first, then those of a layer that is called as a picture is, then those of the only layer.
    ///
    /// # Errors
    /// There are no channels, nothing but depths, or several layers and none that is called a picture.
    pub(super) fn choose(names: &[&str]) -> Result<Self, Refusal> {
        let (prefix, said) = match prefixes(names) {
            prefixes if prefixes.is_empty() => return Err((no_picture(names), None)),
            prefixes => choose_prefix(&prefixes)?,
        };
        let member = |component: &str| member(names, prefix, component);
        if member("Y").is_some() && (member("RY").is_some() || member("BY").is_some()) {
            let message = "holds luminance and color differences (Y, RY, BY), which cannot be read";
            return Err((message.into(), Some("save it with channels R, G, B".into())));
        }
        let color = match (member("R"), member("Y"), member("X")) {
            (Some(red), ..) => [Some(red), member("G"), member("B")],
            (None, Some(grey), None) => [Some(grey); 3],
            (None, Some(_), Some(x)) if member("Z").is_some() => [Some(x), member("Y"), member("Z")],
            _ => {
                let mut members = (0..names.len()).filter(|&i| layer(names[i]) == prefix);
                match [members.next(), members.next(), members.next()] {
                    [Some(only), None, None] => [Some(only); 3],
                    members => members,
                }
            }
        };
        Ok(Self {
            color,
            alpha: member("A"),
            is_xyz: prefix.is_empty() && member("R").is_none() && has_xyz(names),
            said,
        })
    }

    /// Numbers of all its channels.
    pub(super) fn channels(&self) -> Vec<usize> {
        let mut channels: Vec<usize> = self.color.into_iter().chain([self.alpha]).flatten().collect();
        channels.sort_unstable();
        channels.dedup();
        channels
    }
}

/// A component in OpenEXR's letters, by that name or written out, in any case.
fn component(name: &str) -> String {
    let own = &name[layer(name).len()..];
    let upper = own.to_ascii_uppercase();
    match upper.as_str() {
        "RED" => "R".into(),
        "GREEN" => "G".into(),
        "BLUE" => "B".into(),
        "ALPHA" => "A".into(),
        "R" | "G" | "B" | "A" | "Y" | "X" | "Z" | "RY" | "BY" => upper,
        _ => own.to_owned(),
    }
}

/// Whether there are X, Y and Z without a layer.
fn has_xyz(names: &[&str]) -> bool {
    ["X", "Y", "Z"].iter().all(|name| names.contains(name))
}

/// The number of a layer's channel, in OpenEXR's own letters if it has that, too.
fn member(names: &[&str], prefix: &str, wanted: &str) -> Option<usize> {
    let exact = names.iter().position(|name| name.strip_prefix(prefix) == Some(wanted));
    exact.or_else(|| names.iter().position(|name| layer(name) == prefix && component(name) == wanted))
}

/// The layers that may be the picture, in their order: those with R, or else with a grey, or else with anything but depths.
fn prefixes<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let of = |is_member: &dyn Fn(&str) -> bool| {
        let mut found: Vec<&'a str> = Vec::new();
        for name in names.iter().filter(|name| is_member(name)) {
            if !found.contains(&layer(name)) {
                found.push(layer(name));
            }
        }
        found
    };
    // A picture that is called so comes before what may be a vector
    let is_xyz = has_xyz(names) && !names.iter().any(|name| picture_rank(layer(name)).is_some());
    let is_vector = |name: &str| member(names, layer(name), "X").is_some();
    let kinds: [&dyn Fn(&str) -> bool; 3] = [
        &|name| component(name) == "R" || is_xyz && name == "X",
        &|name| component(name) == "Y" && !is_vector(name),
        &|name| !is_depth(name),
    ];
    kinds.into_iter().map(of).find(|found| !found.is_empty()).unwrap_or_default()
}

/// The layer that is taken of several, and a warning unless it is plain which.
fn choose_prefix<'a>(prefixes: &[&'a str]) -> Result<(&'a str, Option<String>), Refusal> {
    if let Some(plain) = prefixes.iter().find(|prefix| prefix.is_empty()) {
        return Ok((plain, None));
    }
    if let &[only] = prefixes {
        return Ok((only, None));
    }
    let best = prefixes.iter().filter_map(|prefix| picture_rank(prefix)).min();
    let called: Vec<&str> =
        prefixes.iter().copied().filter(|prefix| best.is_some() && picture_rank(prefix) == best).collect();
    let quoted = |prefix: &str| format!("\"{}\"", prefix.trim_end_matches('.'));
    let list = |prefixes: &[&str]| {
        let named: Vec<String> = prefixes.iter().take(MOST_NAMED).map(|prefix| quoted(prefix)).collect();
        let more = prefixes.len().saturating_sub(MOST_NAMED);
        let more = if more == 0 { String::new() } else { format!(" and {more} more") };
        named.join(", ") + &more
    };
    match called[..] {
        [only] => {
            let others: Vec<&str> = prefixes.iter().copied().filter(|prefix| *prefix != only).collect();
            let (taken, others) = (quoted(only), list(&others));
            Ok((only, Some(format!("the layer {taken} is taken as the picture; {others} left out"))))
        }
        // The same pass in several views
        [first, ref others @ ..] if others.iter().all(|other| before_view(other) == before_view(first)) => {
            let (taken, others) = (quoted(first), list(others));
            Ok((
                first,
                Some(format!("the layer {taken} is taken as the picture, which may be {others}, too")),
            ))
        }
        _ => {
            let candidates = if called.is_empty() { prefixes } else { &called[..] };
            let layer = candidates[0];
            let message = format!("which of the layers {} is the picture is not known", list(candidates));
            let help = format!(
                "save one of them alone, for instance by `oiiotool FILE --ch R={layer}R,G={layer}G,B={layer}B -o \
                 picture.exr`, or call it Combined, beauty or rgba"
            );
            Err((message, Some(help)))
        }
    }
}

/// Why there is no picture among these channels.
fn no_picture(names: &[&str]) -> String {
    if names.is_empty() {
        return String::from("the OpenEXR file has no channels");
    }
    format!("the OpenEXR file is no picture, but a depth: its channels are {}", names.join(", "))
}

/// Whether a channel holds distances, by the names that OpenEXR and programs have for it.
fn is_depth(name: &str) -> bool {
    matches!(&name[layer(name).len()..], "Z" | "ZBack" | "depth" | "Depth")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(names: &[&str]) -> (Vec<String>, Option<String>) {
        let picture = Picture::choose(names).unwrap();
        let channels = picture.color.iter().chain([&picture.alpha]).flatten();
        (channels.map(|&i| names[i].to_owned()).collect(), picture.said)
    }

    fn refused(names: &[&str]) -> (String, String) {
        let (message, help) = Picture::choose(names).unwrap_err();
        (message, help.unwrap_or_default())
    }

    #[test]
    fn picture_is_plain_or_called_so_or_the_only_layer() {
        let layers = ["AO.R", "V.Combined.A", "V.Combined.B", "V.Combined.G", "V.Combined.R", "V.Emission.R"];
        let combined = ["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A"].map(String::from);
        let said = "the layer \"V.Combined\" is taken as the picture; \"AO\", \"V.Emission\" left out";
        assert_eq!(chosen(&layers), (combined.to_vec(), Some(said.to_owned())));
        assert_eq!(chosen(&["a.R", "R", "Beauty.R"]), (vec![String::from("R")], None));
        // Blender's name comes before others that a compositor may add
        assert_eq!(chosen(&["a.rgba.R", "b.Combined.R"]).0, ["b.Combined.R"]);
        assert_eq!(
            chosen(&["albedo.R", "albedo.G", "Z"]),
            (vec!["albedo.R".into(), "albedo.G".into()], None)
        );
    }

    #[test]
    fn picture_of_several_layers_is_asked_for() {
        let (message, help) = refused(&["x.R", "y.R", "z.Y"]);
        assert_eq!(
            message,
            "which of the layers \"x.\", \"y.\" is the picture is not known".replace(".\"", "\"")
        );
        assert!(help.contains("oiiotool FILE --ch R=x.R,G=x.G,B=x.B -o picture.exr"), "{help}");
        let (message, _) = refused(&["V1.Combined.R", "V2.Combined.R", "V1.AO.R"]);
        assert!(message.contains("\"V1.Combined\", \"V2.Combined\" is"), "{message}");
        let many: Vec<String> = (0..9).map(|i| format!("{i}.R")).collect();
        let (message, _) = refused(&many.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(message.contains("\"0\", \"1\", \"2\", \"3\" and 5 more is"), "{message}");
        let (message, _) = refused(&["Y", "RY", "BY"]);
        assert!(message.contains("(Y, RY, BY)"), "{message}");
    }

    #[test]
    fn picture_of_several_views_is_the_first() {
        let views = ["V.Combined.left.R", "V.Combined.right.R", "V.Glossy.left.R"];
        let doubt = chosen(&views).1.unwrap();
        assert!(
            doubt.contains("\"V.Combined.left\" is taken") && doubt.contains("\"V.Combined.right\", too"),
            "{doubt}"
        );
        assert!(!doubt.contains("Glossy"), "{doubt}");
    }

    #[test]
    fn colors_may_be_written_out_and_in_small_letters() {
        assert_eq!(chosen(&["b", "g", "r"]).0, ["r", "g", "b"]);
        assert_eq!(chosen(&["C.a", "C.b", "C.g", "C.r"]).0, ["C.r", "C.g", "C.b", "C.a"]);
        let written = ["beauty.alpha", "beauty.blue", "beauty.green", "beauty.red"];
        let expected = ["beauty.red", "beauty.green", "beauty.blue", "beauty.alpha"];
        assert_eq!(chosen(&written).0, expected);
        assert_eq!(chosen(&["BLUE", "GREEN", "RED"]).0, ["RED", "GREEN", "BLUE"]);
        assert_eq!(chosen(&["B", "G", "R", "r"]).0, ["R", "G", "B"]);
        assert_eq!(chosen(&["y"]).0, ["y"; 3]);
    }

    #[test]
    fn picture_of_a_vector_has_its_components() {
        let vector = ["V.Depth.Z", "V.Normal.X", "V.Normal.Y", "V.Normal.Z"];
        let normal = ["V.Normal.X", "V.Normal.Y", "V.Normal.Z"].map(String::from);
        assert_eq!(chosen(&vector), (normal.to_vec(), None));
        assert_eq!(chosen(&["V.Mist.Z", "mask"]).0, ["mask"; 3]);
        assert!(!Picture::choose(&vector).unwrap().is_xyz);
    }

    /// Mitsuba's films, whose layers follow.
    #[test]
    fn picture_of_xyz_comes_before_layers_that_are_not_called_so() {
        let xyz = ["X", "Y", "Z"].map(String::from).to_vec();
        for names in [&["X", "Y", "Z"][..], &["X", "Y", "Z", "albedo.R", "albedo.G", "albedo.B", "nn.X"]] {
            assert_eq!(chosen(names), (xyz.clone(), None));
            assert!(Picture::choose(names).unwrap().is_xyz);
        }
        assert_eq!(chosen(&["A", "X", "Y", "Z"]).0, ["X", "Y", "Z", "A"]);
        let called = ["X", "Y", "Z", "beauty.R", "beauty.G", "beauty.B"];
        assert_eq!(chosen(&called).0, ["beauty.R", "beauty.G", "beauty.B"]);
    }
}
