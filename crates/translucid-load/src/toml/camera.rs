//! `[camera]` and `[[camera]]`.

use std::collections::HashSet;

use translucid_scene::Camera;
use translucid_scene::description::{FileList, Item};

use super::claim_name;
use crate::NamedCamera;
use crate::result::Result;

/// Most cameras of a scene file.
const MOST_CAMERAS: usize = 65_536;

/// The camera of `[camera]`, or those of each `[[camera]]`.
pub(super) fn read_cameras(item: &Item<'_>) -> Result<Vec<NamedCamera>> {
    let tables = item.one_or_more_tables(MOST_CAMERAS)?;
    let is_one = tables.len() == 1;
    let keys = [vec!["name"], Camera::DESCRIPTION.keys()].concat();
    let mut names = HashSet::new();
    let mut cameras = Vec::new();
    for table in tables {
        let table = table.allow(&keys)?;
        let name = match table.get("name") {
            None if is_one => String::new(),
            _ => table.require("name")?.name()?,
        };
        claim_name(&table, &name, &mut names)?;
        let camera = Camera::DESCRIPTION.read(&table, &mut FileList::default())?;
        cameras.push(NamedCamera { name, camera, of_square: None });
    }
    Ok(cameras)
}
