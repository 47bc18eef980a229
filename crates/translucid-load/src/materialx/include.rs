//! Documents that a document includes (XInclude): a look has its materials in others.

use std::path::{Path, PathBuf};

use roxmltree::{Document, Node, ParsingOptions};
use translucid_scene::{Place, SceneError};

use super::document::{MOST_NODES, shown};
use super::model::materials;
use crate::file::read_file;
use crate::result::Result;

/// Most documents that are looked into.
const MOST: usize = 64;

/// The included documents with their materials.
#[derive(Default)]
struct Included {
    files: Vec<(PathBuf, Vec<String>)>,
}

/// The included document that has the material, if the document at hand has none, or none of the name.
///
/// # Errors
/// An included document cannot be read, none has the material, or several have one and there is no name.
pub(super) fn home(bytes: &[u8], path: &Path, name: Option<&str>) -> Result<Option<PathBuf>> {
    // Most documents include none, and are not read twice for it
    if !std::str::from_utf8(bytes).is_ok_and(|text| text.contains("include")) {
        return Ok(None);
    }
    let mut included = Included::default();
    let Some((own, links)) = contents(bytes) else { return Ok(None) };
    if links.is_empty() || name.map_or(!own.is_empty(), |name| own.iter().any(|own| own == name)) {
        return Ok(None);
    }
    included.add(links, path)?;
    let all: Vec<(&PathBuf, &String)> = included
        .files
        .iter()
        .flat_map(|(file, names)| names.iter().map(move |name| (file, name)))
        .filter(|(_, found)| name.is_none_or(|name| *found == name))
        .collect();
    let names = || {
        let names = included.files.iter().flat_map(|(_, names)| names);
        format!("they are {}", names.take(16).map(|name| shown(name)).collect::<Vec<_>>().join(", "))
    };
    let error = |message: String| Err(SceneError::at(Place::file(path), message).with_help(names()));
    match (&all[..], name) {
        ([(file, _)], _) | ([(file, _), ..], Some(_)) => Ok(Some((*file).clone())),
        ([], Some(name)) => {
            error(format!("neither the document nor one that it includes has a material \"{}\"", shown(name)))
        }
        ([], None) => Ok(None),
        (_, None) => error(format!(
            "the documents that are included have {} materials, so file_material must name one",
            all.len()
        )),
    }
}

impl Included {
    /// Adds documents that one includes, and those that they include.
    fn add(&mut self, links: Vec<String>, path: &Path) -> Result<()> {
        let folder = path.parent().unwrap_or(Path::new(""));
        for link in links {
            let file = folder.join(link.replace('\\', "/"));
            if self.files.len() >= MOST || self.files.iter().any(|(known, _)| *known == file) {
                continue;
            }
            let Some((names, links)) = contents(&read_file(&file)?) else { continue };
            self.files.push((file.clone(), names));
            self.add(links, &file)?;
        }
        Ok(())
    }
}

/// The names of the materials of a document, and the files that it includes; none if it is no document.
fn contents(bytes: &[u8]) -> Option<(Vec<String>, Vec<String>)> {
    let text = std::str::from_utf8(bytes).ok()?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).ok()?;
    let root = document.root_element();
    let text = |node: Node<'_, '_>, key: &str| node.attribute(key).map(str::to_owned);
    let names = materials(root).into_iter().filter_map(|material| text(material, "name")).collect();
    let includes = root.children().filter(|child| child.tag_name().name() == "include");
    Some((names, includes.filter_map(|include| text(include, "href")).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_found_in_included_documents() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, format!("<materialx xmlns:xi=\"x\">{text}</materialx>")).unwrap();
            path
        };
        let include = |name: &str| format!("<xi:include href=\"{name}\"/>");
        let material = |name: &str| format!("<surfacematerial name=\"{name}\"/>");
        let wood = write("wood.mtlx", &(material("Wood") + &include("look.mtlx")));
        write("both.mtlx", &(include("wood.mtlx") + &material("Brass")));
        let look = write("look.mtlx", &(include("both.mtlx") + "<look name=\"L\"/>"));
        let find = |path: &Path, name: Option<&str>| home(&read_file(path).unwrap(), path, name);
        assert_eq!(find(&look, Some("Wood")).unwrap(), Some(wood.clone()));
        let error = find(&look, None).unwrap_err().to_string();
        assert!(error.contains("have 2 materials") && error.contains("they are Brass, Wood"), "{error}");
        let error = find(&look, Some("Gold")).unwrap_err().to_string();
        assert!(error.contains("one that it includes has a material \"Gold\""), "{error}");
        assert_eq!(find(&wood, None).unwrap(), None);
        let broken = write("broken.mtlx", &include("missing.mtlx"));
        assert!(find(&broken, None).unwrap_err().to_string().contains("missing.mtlx: cannot be read"));
    }
}
