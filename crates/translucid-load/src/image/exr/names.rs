//! Names of the channels of an OpenEXR file, whatever its parts.

use std::collections::HashSet;

use exr::meta::attribute::Text;
use exr::meta::header::Header;

/// Layers that hold the finished picture, in any case: Blender's, that of most other renderers, and Nuke's.
const PICTURES: [&str; 3] = ["combined", "beauty", "rgba"];

/// Whether a layer or part is called as the finished picture is; views may follow ("ViewLayer.Combined.left").
pub(super) fn is_picture(name: &str) -> bool {
    name.split('.').any(|word| PICTURES.iter().any(|picture| word.eq_ignore_ascii_case(picture)))
}

/// The layer that a channel belongs to, with its dot: "albedo." of "albedo.R", nothing of "R".
pub(super) fn layer(name: &str) -> &str {
    name.rfind('.').map_or("", |dot| &name[..=dot])
}

/// The names of each part's channels as a file of one part has them.
///
/// In a file of several views the view comes before the component ("Combined.left.R"), as Blender writes it.
/// Where parts have the same names, the picture keeps them, or else the first part.
/// The layers of the others get the part's name in front ("albedo.R"), or its number if the name does not tell it apart.
pub(super) fn channel_names(headers: &[Header]) -> Vec<Vec<String>> {
    let views: HashSet<_> = headers.iter().filter_map(view_name).collect();
    let mut names: Vec<Vec<String>> = headers
        .iter()
        .map(|header| {
            let view = view_name(header).filter(|_| views.len() > 1);
            let channels = header.channels.list.iter().map(|channel| text(&channel.name));
            channels.map(|name| view.as_deref().map_or(name.clone(), |view| in_view(&name, view))).collect()
        })
        .collect();

    let part_names: Vec<String> = headers.iter().map(part_name).collect();
    let mut order: Vec<usize> = (0..headers.len()).collect();
    order.sort_by_key(|&part| !is_picture(&part_names[part]));
    let mut taken: HashSet<String> = HashSet::new();
    for part in order {
        let numbered = format!("part {}", part + 1);
        for label in [part_names[part].as_str(), numbered.as_str()] {
            let own = &mut names[part];
            let layers: HashSet<String> =
                own.iter().filter(|name| taken.contains(*name)).map(|name| layer(name).to_owned()).collect();
            if !label.is_empty() {
                let clashing = own.iter_mut().filter(|name| layers.contains(layer(name)));
                clashing.for_each(|name| *name = format!("{label}.{name}"));
            }
        }
        taken.extend(names[part].iter().cloned());
    }
    names
}

/// The name of a part, empty if it has none.
pub(super) fn part_name(header: &Header) -> String {
    header.own_attributes.layer_name.as_ref().map(text).unwrap_or_default()
}

fn view_name(header: &Header) -> Option<String> {
    header.own_attributes.view_name.as_ref().map(text)
}

fn in_view(name: &str, view: &str) -> String {
    let (layer, component) = name.split_at(layer(name).len());
    format!("{layer}{view}.{component}")
}

/// A text as UTF-8, or else each byte as a character.
pub(super) fn text(text: &Text) -> String {
    std::str::from_utf8(text.as_slice()).map_or_else(|_| text.to_string(), str::to_owned)
}
