//! Names of the channels of an OpenEXR file, whatever its parts.

use std::collections::HashSet;

use exr::meta::attribute::Text;
use exr::meta::header::Header;

/// Layers that hold the finished picture, in any case: Blender's, that of most other renderers, Nuke's, and RenderMan's.
const PICTURES: [&str; 5] = ["combined", "beauty", "rgba", "rgb", "ci"];

/// The place in [`PICTURES`] of a layer or part that is called so; views may follow ("ViewLayer.Combined.left").
pub(super) fn picture_rank(name: &str) -> Option<usize> {
    let rank = |word: &str| PICTURES.iter().position(|picture| word.eq_ignore_ascii_case(picture));
    name.split('.').filter_map(rank).min()
}

/// Whether a layer or part is called as the finished picture is.
pub(super) fn is_picture(name: &str) -> bool {
    picture_rank(name).is_some()
}

/// A layer's name up to the word that calls it a picture: what follows is a view.
pub(super) fn before_view(name: &str) -> Option<Vec<&str>> {
    let words: Vec<&str> = name.split('.').collect();
    let end = words.iter().position(|word| is_picture(word))?;
    Some(words[..=end].to_vec())
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
