//! The node hierarchy, flattened: which node is where in the world.

use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::buffers::Arrays;
use super::document::{self, Document, Node};
use super::extensions::Members;
use super::notes::Notes;
use crate::result::Result;

const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// A node with its place in the world.
#[derive(Clone, Copy)]
pub(super) struct PlacedNode {
    pub(super) index: usize,
    pub(super) world_from_local: DAffine3,
    /// Whether it is of the scene; others can be joints of a skin.
    pub(super) is_in_scene: bool,
    /// Whether its mesh and light show: it and its parents are visible by KHR_node_visibility.
    pub(super) is_visible: bool,
}

/// All nodes, those of the default scene first, parents before children, under a `world_from_root` transform.
///
/// Without a default scene it is the first one, without scenes every root node.
///
/// # Errors
/// A reference to a node that does not exist, a node with two parents, a cycle, a scene that lists a
/// child, or a transform that is not affine or overflows.
pub(super) fn flatten(
    document: &Document,
    notes: &Notes<'_>,
    world_from_root: DAffine3,
) -> Result<Vec<PlacedNode>> {
    let parents = find_parents(document, notes)?;
    refuse_cycles(&parents, document, notes)?;
    let place = |index, is_in_scene| PlacedNode {
        index,
        world_from_local: world_from_root,
        is_in_scene,
        is_visible: is_in_scene,
    };
    let in_scene = roots(document, &parents, notes)?;
    let mut is_elsewhere: Vec<bool> = parents.iter().map(Option::is_none).collect();
    in_scene.iter().for_each(|&root| is_elsewhere[root] = false);
    let elsewhere = (0..parents.len()).filter(|&root| is_elsewhere[root] && !document.skins.is_empty());
    let mut stack: Vec<PlacedNode> = elsewhere.map(|root| place(root, false)).collect();
    stack.extend(in_scene.into_iter().rev().map(|root| place(root, true)));
    let mut placed = Vec::new();
    // An explicit stack: a chain of a million nodes is legal, and no reason to overflow the machine's.
    while let Some(mut at) = stack.pop() {
        let part = document.nodes.label(at.index);
        let node = document.nodes.get(at.index, &part)?;
        at.world_from_local *= local_transform(node, &part, notes)?;
        if !at.world_from_local.is_finite() {
            return Err(notes.error(&part, "its transform in the world is too large for a number"));
        }
        if let Some(data) = Members::of(&node.extensions, "KHR_node_visibility", &part, notes.path)? {
            at.is_visible &= data.get("visible")?.unwrap_or(true);
        }
        stack.extend(node.children.iter().rev().map(|&index| PlacedNode { index, ..at }));
        placed.push(at);
    }
    Ok(placed)
}

fn find_parents(document: &Document, notes: &Notes<'_>) -> Result<Vec<Option<usize>>> {
    let nodes = document.nodes.as_slice();
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        let part = document.nodes.label(index);
        for &child in &node.children {
            document.nodes.get(child, &part)?;
            if let Some(other) = parents[child].replace(index) {
                let (child, other) = (document.nodes.label(child), document.nodes.label(other));
                return Err(notes.error(&child, format!("it is a child of both {other} and {part}")));
            }
        }
    }
    Ok(parents)
}

/// Follows every node's parents up; nodes known to lead to a root are not followed again.
fn refuse_cycles(parents: &[Option<usize>], document: &Document, notes: &Notes<'_>) -> Result<()> {
    /// Walk that visited a node first; 0 is none yet.
    type Walk = usize;
    let mut visited: Vec<Walk> = vec![0; parents.len()];
    for start in 0..parents.len() {
        let walk = start + 1;
        let mut at = Some(start);
        while let Some(node) = at {
            if visited[node] == walk {
                return Err(
                    notes.error(&document.nodes.label(node), "it is its own ancestor: nodes form a cycle")
                );
            }
            if visited[node] != 0 {
                break;
            }
            visited[node] = walk;
            at = parents[node];
        }
    }
    Ok(())
}

fn roots(document: &Document, parents: &[Option<usize>], notes: &Notes<'_>) -> Result<Vec<usize>> {
    if document.scene.is_none() && document.scenes.as_slice().is_empty() {
        return Ok((0..parents.len()).filter(|&node| parents[node].is_none()).collect());
    }
    let index = document.scene.unwrap_or(0);
    let scene = document.scenes.get(index, "\"scene\"")?;
    let part = document.scenes.label(index);
    let mut listed = vec![false; parents.len()];
    for &node in &scene.nodes {
        document.nodes.get(node, &part)?;
        let label = || document.nodes.label(node);
        if parents[node].is_some() {
            return Err(notes.error(&part, format!("it lists {}, which is another node's child", label())));
        }
        if std::mem::replace(&mut listed[node], true) {
            return Err(notes.error(&part, format!("it lists {} twice", label())));
        }
    }
    Ok(scene.nodes.clone())
}

/// A node's own transform: its matrix, or translation · rotation · scale.
fn local_transform(node: &Node, part: &str, notes: &Notes<'_>) -> Result<DAffine3> {
    if let Some(columns) = &node.matrix {
        let matrix = DMat4::from_cols_array(columns);
        if !matrix.row(3).abs_diff_eq(glam::DVec4::W, 1e-5) {
            let row = matrix.row(3);
            return Err(
                notes.error(part, format!("its matrix has the last row {row}, but it must be [0, 0, 0, 1]"))
            );
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let scale = DVec3::from_array(node.scale.unwrap_or([1.0; 3]));
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    Ok(DAffine3::from_scale_rotation_translation(
        scale,
        unit_rotation(rotation, part, notes),
        DVec3::from_array(node.translation),
    ))
}

fn unit_rotation(rotation: DQuat, part: &str, notes: &Notes<'_>) -> DQuat {
    let length = rotation.length();
    if length.is_normal() && length.is_finite() {
        rotation / length
    } else {
        notes.warn(part, "a rotation of zero or infinite length is left out");
        DQuat::IDENTITY
    }
}

/// The accessors of EXT_mesh_gpu_instancing by attribute, if a node has it.
fn instancing(node: &Node, part: &str, arrays: &Arrays<'_>) -> Result<Option<document::Attributes>> {
    let data = Members::of(&node.extensions, INSTANCING, part, arrays.notes.path)?;
    data.map(|data| data.require("attributes")).transpose()
}

/// Number of instances of its mesh that a node has, as far as it is known without reading them.
pub(super) fn instance_count(node: &Node, part: &str, arrays: &Arrays<'_>) -> usize {
    let Ok(Some(attributes)) = instancing(node, part, arrays) else { return 1 };
    attributes.values().next().and_then(|&accessor| arrays.count(accessor, part).ok()).unwrap_or(0)
}

/// Transforms of the instances of a node's mesh: one, or those of EXT_mesh_gpu_instancing.
pub(super) fn instances(
    node: &Node,
    placed: &PlacedNode,
    part: &str,
    arrays: &Arrays<'_>,
) -> Result<Vec<DAffine3>> {
    let Some(attributes) = instancing(node, part, arrays)? else { return Ok(vec![placed.world_from_local]) };
    let part = format!("{part}, {INSTANCING}");
    let read3 = |key: &str| {
        let accessor = attributes.get(key);
        accessor.map(|&accessor| arrays.numbers::<3>(accessor, &format!("{key} of {part}"))).transpose()
    };
    let rotation_accessor = attributes.get("ROTATION");
    let rotations =
        rotation_accessor.map(|&a| arrays.numbers::<4>(a, &format!("ROTATION of {part}"))).transpose()?;
    let (translations, scales) = (read3("TRANSLATION")?, read3("SCALE")?);
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let count = counts.into_iter().flatten().next().unwrap_or(0);
    if counts.into_iter().flatten().any(|other| other != count) {
        return Err(arrays.notes.error(&part, "its accessors have different counts"));
    }
    let vector = |values: &Option<Vec<[f32; 3]>>, i: usize, otherwise: DVec3| {
        values.as_ref().map_or(otherwise, |v| DVec3::from_array(v[i].map(f64::from)))
    };
    let transforms = (0..count).map(|i| {
        let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |r| DQuat::from_array(r[i].map(f64::from)));
        placed.world_from_local
            * DAffine3::from_scale_rotation_translation(
                vector(&scales, i, DVec3::ONE),
                unit_rotation(rotation, &part, arrays.notes),
                vector(&translations, i, DVec3::ZERO),
            )
    });
    Ok(transforms.collect())
}
