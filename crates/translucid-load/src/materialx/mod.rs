//! MaterialX documents (.mtlx): a material of an OpenPBR Surface, or of a shader that [`model`] translates into one.
//!
//! [`shader`] reads inputs and [`graph`] the nodes in front of them; everything else gets a warning, once.
//! Lengths have the unit that their input states, or that of the scene.
//! Colors have the color space that is stated around them, and become linear Rec. 709.

mod color_space;
mod document;
mod graph;
mod include;
mod model;
mod shader;
mod unit;

use std::path::{Path, PathBuf};

use roxmltree::{Document, Node, ParsingOptions};
use translucid_profile::nearest;
use translucid_scene::description::FileRequest;
use translucid_scene::{ImageKind, Material, Place, SceneError, Unit, Warning};

use self::document::{Kind, MOST_NODES, Source, clipped, shown, title};
use self::graph::Graph;
use self::model::{ShadingModel, materials};
use self::shader::{LengthUnits, read_shader};
use crate::file::read_file;
use crate::result::Result;

/// Most bytes of a document.
const LARGEST_FILE: u64 = 16 << 20;

/// The material that is read from a document.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaterialChoice<'a> {
    /// Name of the material, needed where there are several.
    pub(super) name: Option<&'a str>,
    /// Unit of lengths that state none; the scene's by default, with a warning.
    pub(super) length_unit: Option<Unit>,
    /// Unit of the scene.
    pub(super) unit: Unit,
}

/// Loads a material; its textures count the images that it asks for.
pub(super) fn load_materialx(
    path: &Path,
    choice: MaterialChoice<'_>,
    warnings: &mut Vec<Warning>,
) -> Result<(Material, Vec<FileRequest<ImageKind>>)> {
    let length = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    if length > LARGEST_FILE {
        let message = format!("the document has {length} bytes, but at most {LARGEST_FILE} are allowed");
        return Err(SceneError::at(Place::file(path), message));
    }
    read(&read_file(path)?, path, choice, warnings)
}

/// Reads a material of a MaterialX document from memory, and the paths of the images that its textures count.
///
/// Documents that it includes are read where the material is in one of them.
/// `name` chooses among several materials; `unit` is that of the scene, and of lengths that state none.
///
/// # Errors
/// The bytes are no XML, have a document type, more than 2²⁰ nodes, no material or none of the name, or one whose
/// shader is of no model that is read; a value is not of its input's type, a unit unknown, a reference to nothing or
/// in a circle. The message names the line.
///
/// ```
/// use std::path::Path;
/// use translucid_load::parse_materialx;
/// use translucid_scene::Unit;
///
/// let text = br#"<materialx version="1.39">
///   <open_pbr_surface name="soap" type="surfaceshader">
///     <input name="subsurface_weight" type="float" value="1"/>
///     <input name="subsurface_radius" type="float" value="0.4" unittype="distance" unit="centimeter"/>
///   </open_pbr_surface>
/// </materialx>"#;
/// let (soap, _) = parse_materialx(text, Path::new("soap.mtlx"), None, Unit::Millimeter, &mut Vec::new())?;
/// assert_eq!(soap.subsurface_radius.factor, 4.0);
/// # Ok::<(), translucid_scene::SceneError>(())
/// ```
pub fn parse_materialx(
    bytes: &[u8],
    path: &Path,
    name: Option<&str>,
    unit: Unit,
    warnings: &mut Vec<Warning>,
) -> Result<(Material, Vec<PathBuf>)> {
    let choice = MaterialChoice { name, length_unit: None, unit };
    let (material, images) = read(bytes, path, choice, warnings)?;
    Ok((material, images.into_iter().map(|image| image.path).collect()))
}

fn read(
    bytes: &[u8],
    path: &Path,
    choice: MaterialChoice<'_>,
    warnings: &mut Vec<Warning>,
) -> Result<(Material, Vec<FileRequest<ImageKind>>)> {
    if let Some(other) = include::home(bytes, path, choice.name)? {
        return read_document(&read_file(&other)?, &other, choice, warnings);
    }
    read_document(bytes, path, choice, warnings)
}

fn read_document(
    bytes: &[u8],
    path: &Path,
    choice: MaterialChoice<'_>,
    warnings: &mut Vec<Warning>,
) -> Result<(Material, Vec<FileRequest<ImageKind>>)> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let place = Place::part(path, format!("byte {}", error.valid_up_to()));
        SceneError::at(place, "a MaterialX document must be UTF-8 text, but this is not")
    })?;
    // No document type: entities could grow without bound
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| syntax_error(&error, path))?;
    let source = Source::new(&document, path);
    let found = read_material(&source, path, choice);
    warnings.extend(source.into_warnings());
    found
}

fn syntax_error(error: &roxmltree::Error, path: &Path) -> SceneError {
    let message = match error {
        roxmltree::Error::DtdDetected => {
            return SceneError::at(Place::file(path), "the document has a document type, which is not read")
                .with_help("take <!DOCTYPE …> and its entities out");
        }
        roxmltree::Error::NodesLimitReached => {
            format!("the document has more than {MOST_NODES} elements and texts")
        }
        _ => format!("this is not valid XML: {}", clipped(&error.to_string(), 200)),
    };
    let is_bare = message.contains("not '<'");
    let error = SceneError::at(Place::line(path, error.pos().row as usize), message);
    if is_bare { error.with_help("a < in a value, as in <UDIM>, is written &lt;") } else { error }
}

fn read_material<'d>(
    source: &Source<'d>,
    path: &Path,
    choice: MaterialChoice<'_>,
) -> Result<(Material, Vec<FileRequest<ImageKind>>)> {
    let root = source.document.root_element();
    if !root.has_tag_name("materialx") {
        let message = format!("the document is a {}, but must be a materialx", shown(root.tag_name().name()));
        return Err(source.error(root, message));
    }
    for include in root.children().filter(|child| child.is_element() && child.tag_name().name() == "include")
    {
        let file = include.attribute("href").unwrap_or_default();
        source.warn(include, format!("the document \"{}\" that is included is left out", shown(file)));
    }
    let chosen = choose(source, root, choice.name)?;
    let mut graph = Graph::new(source, path);
    let shader = shader_of(source, &graph, chosen)?;
    let Some(model) = ShadingModel::of(shader) else {
        let allowed = ShadingModel::CATEGORIES.join(", ");
        let message = format!("the shader is {}, but must be one of {allowed}", title(shader));
        return Err(source.error(shader, message));
    };
    let units = LengthUnits { of_scene: choice.unit, stated: choice.length_unit };
    let mut material = read_shader(&mut graph, shader, model, units)?;
    material.name = chosen.attribute("name").unwrap_or_default().to_owned();
    let images = images_in_use(&mut material, graph.files.images);
    Ok((material, images))
}

/// The images that a material refers to, which then counts these: others were behind inputs that keep their defaults.
fn images_in_use(
    material: &mut Material,
    images: Vec<FileRequest<ImageKind>>,
) -> Vec<FileRequest<ImageKind>> {
    let mut numbers = vec![None; images.len()];
    let mut count = 0;
    material.for_each_image(|image| {
        *image = *numbers[*image].get_or_insert_with(|| {
            count += 1;
            count - 1
        });
    });
    let mut used: Vec<_> = images.into_iter().zip(numbers).filter(|(_, number)| number.is_some()).collect();
    used.sort_by_key(|(_, number)| *number);
    used.into_iter().map(|(image, _)| image).collect()
}

/// The material of a name, or the only one; where there are no materials, a shader.
fn choose<'d>(source: &Source<'d>, root: Node<'d, 'd>, name: Option<&str>) -> Result<Node<'d, 'd>> {
    let all = materials(root);
    let names = || all.iter().filter_map(|material| material.attribute("name"));
    let list = || names().take(16).map(shown).collect::<Vec<_>>().join(", ");
    let Some(name) = name else {
        return match all[..] {
            [only] => Ok(only),
            [] => {
                let allowed = ShadingModel::CATEGORIES.join(", ");
                Err(source.error(root, format!("the document has no surfacematerial, and no {allowed}")))
            }
            _ => {
                let message =
                    format!("the document has {} materials, so file_material must name one", all.len());
                Err(source.error(root, message).with_help(format!("they are {}", list())))
            }
        };
    };
    let of_name: Vec<_> = all.iter().filter(|material| material.attribute("name") == Some(name)).collect();
    match of_name[..] {
        [only] => Ok(*only),
        [] => {
            let error = source.error(root, format!("the document has no material \"{}\"", shown(name)));
            Err(match nearest(name, names()) {
                Some(near) => error.with_help(format!("did you mean \"{}\"?", shown(near))),
                None => error.with_help(format!("they are {}", list())),
            })
        }
        _ => Err(source.error(root, format!("the document has several materials \"{}\"", shown(name)))),
    }
}

/// The shader of a material, which may be one itself.
fn shader_of<'d>(source: &Source<'d>, graph: &Graph<'_, 'd>, material: Node<'d, 'd>) -> Result<Node<'d, 'd>> {
    if !material.has_tag_name("surfacematerial") {
        return Ok(material);
    }
    let inputs = material.children().filter(|child| child.has_tag_name("input"));
    for input in inputs.filter(|input| input.attribute("name") != Some("surfaceshader")) {
        source.warn(input, format!("{} of {} is left out", title(input), title(material)));
    }
    let shader = match source.child(material, Kind::Input, "surfaceshader")? {
        Some(input) => graph.node_behind(input)?,
        None => None,
    };
    shader.ok_or_else(|| {
        source.error(material, format!("{} has no surfaceshader that is connected", title(material)))
    })
}

#[cfg(test)]
mod tests;
