//! The channels of an OpenEXR file that are the picture.

use super::names::{is_picture, layer};

/// Layers that a warning names.
const MOST_NAMED: usize = 4;

/// Numbers of the channels of a picture.
#[derive(Debug, PartialEq)]
pub(super) struct Picture {
    pub(super) color: [Option<usize>; 3],
    pub(super) alpha: Option<usize>,
    /// A warning where other layers may be meant, too.
    pub(super) doubt: Option<String>,
}

impl Picture {
    /// Chooses among the channels of all parts: R, G, B (and A), or Y as grey, or else the first three of a layer.
    ///
    /// Channels without a layer come first, then those of a layer that is called as a picture is, then any other.
    ///
    /// # Errors
    /// There are no channels, or nothing but depths.
    pub(super) fn choose(names: &[&str]) -> Result<Self, String> {
        let find = |name: String| names.iter().position(|other| *other == name);
        let (prefix, doubt) = match prefixes(names) {
            prefixes if prefixes.is_empty() => return Err(no_picture(names)),
            prefixes => choose_prefix(&prefixes),
        };
        let member = |component: &str| find(format!("{prefix}{component}"));
        let color = match (member("R"), member("Y"), member("X")) {
            (Some(red), ..) => [Some(red), member("G"), member("B")],
            (None, Some(grey), None) => [Some(grey); 3],
            _ => {
                let mut members = (0..names.len()).filter(|&i| layer(names[i]) == prefix);
                match [members.next(), members.next(), members.next()] {
                    [Some(only), None, None] => [Some(only); 3],
                    members => members,
                }
            }
        };
        Ok(Self { color, alpha: member("A"), doubt })
    }

    /// Numbers of all its channels.
    pub(super) fn channels(&self) -> Vec<usize> {
        let mut channels: Vec<usize> = self.color.into_iter().chain([self.alpha]).flatten().collect();
        channels.sort_unstable();
        channels.dedup();
        channels
    }
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
    let component = |name: &str| name[layer(name).len()..].to_owned();
    let is_vector = |name: &str| names.contains(&format!("{}X", layer(name)).as_str());
    let kinds: [&dyn Fn(&str) -> bool; 3] =
        [&|name| component(name) == "R", &|name| component(name) == "Y" && !is_vector(name), &|name| {
            !is_depth(name)
        }];
    kinds.into_iter().map(of).find(|found| !found.is_empty()).unwrap_or_default()
}

/// The layer that is taken of several, and a warning unless it is plain which.
fn choose_prefix<'a>(prefixes: &[&'a str]) -> (&'a str, Option<String>) {
    if let Some(plain) = prefixes.iter().find(|prefix| prefix.is_empty()) {
        return (plain, None);
    }
    let called: Vec<&str> = prefixes.iter().copied().filter(|prefix| is_picture(prefix)).collect();
    let meant = if called.is_empty() { prefixes } else { &called };
    let quoted = |prefix: &&str| format!("\"{}\"", prefix.trim_end_matches('.'));
    let others: Vec<String> = meant[1..].iter().take(MOST_NAMED).map(quoted).collect();
    let more = meant.len().saturating_sub(1 + MOST_NAMED);
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    let doubt = (!others.is_empty()).then(|| {
        let (taken, others) = (quoted(&meant[0]), others.join(", "));
        format!("the layer {taken} is taken as the picture, which may be {others}{more}, too")
    });
    (meant[0], doubt)
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
        (channels.map(|&i| names[i].to_owned()).collect(), picture.doubt)
    }

    #[test]
    fn picture_is_plain_or_called_so_or_the_first() {
        let layers = ["AO.R", "V.Combined.A", "V.Combined.B", "V.Combined.G", "V.Combined.R", "V.Emission.R"];
        let combined = ["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A"].map(String::from);
        assert_eq!(chosen(&layers), (combined.to_vec(), None));
        assert_eq!(chosen(&["a.R", "R", "Beauty.R"]), (vec![String::from("R")], None));
        let (channels, doubt) = chosen(&["x.R", "y.R", "z.Y"]);
        assert_eq!(channels, ["x.R"]);
        assert_eq!(doubt.unwrap(), "the layer \"x\" is taken as the picture, which may be \"y\", too");
        let views = ["V.Combined.left.R", "V.Combined.right.R", "V.Glossy.left.R"];
        let doubt = chosen(&views).1.unwrap();
        assert!(
            doubt.contains("\"V.Combined.left\" is taken") && doubt.contains("\"V.Combined.right\", too"),
            "{doubt}"
        );
        assert!(!doubt.contains("Glossy"), "{doubt}");
    }

    #[test]
    fn picture_of_a_vector_has_its_components() {
        let vector = ["V.Depth.Z", "V.Normal.X", "V.Normal.Y", "V.Normal.Z"];
        let normal = ["V.Normal.X", "V.Normal.Y", "V.Normal.Z"].map(String::from);
        assert_eq!(chosen(&vector), (normal.to_vec(), None));
        assert_eq!(chosen(&["V.Mist.Z", "mask"]).0, ["mask"; 3]);
        let many: Vec<String> = (0..9).map(|i| format!("{i}.R")).collect();
        let doubt = chosen(&many.iter().map(String::as_str).collect::<Vec<_>>()).1.unwrap();
        assert!(doubt.ends_with("which may be \"1\", \"2\", \"3\", \"4\" and 4 more, too"), "{doubt}");
    }
}
