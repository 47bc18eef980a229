//! The pose in which a file shows its meshes: morph targets by their weights, skins by their joints.
//!
//! Animations are not played: weights and joints are where the file has them.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DMat4, DVec3, Vec3};
use translucid_scene::Mesh;

use super::buffers::Arrays;
use super::document::Primitive;
use super::nodes::PlacedNode;
use crate::result::Result;

/// Where the nodes that may be joints are.
pub(super) type Joints = HashMap<usize, DAffine3>;

/// A vertex whose weights sum to something farther from 1 gets a warning; weights rounded to bytes are nearer.
const FAR_FROM_ONE: f64 = 0.01;

/// The places of all nodes, if there is a skin that could ask for them.
pub(super) fn joints(placed: &[PlacedNode], arrays: &Arrays<'_>) -> Joints {
    let nodes = if arrays.document.skins.is_empty() { &[] } else { placed };
    nodes.iter().map(|node| (node.index, node.world_from_local)).collect()
}

impl Arrays<'_> {
    /// The map of each joint of a skin, from the mesh's space at its binding to the world.
    ///
    /// # Errors
    /// A joint or the matrices are not there, or too few.
    pub(super) fn joint_maps(&self, skin: usize, joints: &Joints, part: &str) -> Result<Vec<DAffine3>> {
        let data = self.document.skins.get(skin, part)?;
        let part = self.document.skins.label(skin);
        let bindings = match data.inverse_bind_matrices {
            Some(accessor) => self.numbers::<16>(accessor, &format!("inverseBindMatrices of {part}"))?,
            None => vec![glam::Mat4::IDENTITY.to_cols_array(); data.joints.len()],
        };
        if bindings.len() < data.joints.len() {
            let (found, needed) = (bindings.len(), data.joints.len());
            return Err(self
                .notes
                .error(&part, format!("it has {found} inverse bind matrices, but {needed} joints")));
        }
        let maps = data.joints.iter().zip(bindings).map(|(&joint, columns)| {
            self.document.nodes.get(joint, &part)?;
            let joint_from_mesh = DAffine3::from_mat4(DMat4::from_cols_array(&columns.map(f64::from)));
            let world_from_joint = joints.get(&joint).copied().unwrap_or_default();
            let map = world_from_joint * joint_from_mesh;
            let too_large = || {
                self.notes.error(
                    &part,
                    format!("the transform of {} is no number", self.document.nodes.label(joint)),
                )
            };
            map.is_finite().then_some(map).ok_or_else(too_large)
        });
        maps.collect()
    }

    /// The map of each vertex from the mesh's space to the world, Σ weight · joint (glTF 2.0, section 3.7.3.3, "Skinned
    /// Mesh Attributes"); none, with a warning, if the primitive has no joints.
    pub(super) fn vertex_maps(
        &self,
        primitive: &Primitive,
        joints: &[DAffine3],
        vertices: usize,
        part: &str,
    ) -> Result<Option<Vec<DAffine3>>> {
        let mut sums = vec![(0.0, DMat3::ZERO, DVec3::ZERO); vertices];
        let mut first = vec![0; vertices];
        let attribute = |key: String| primitive.attributes.get(&key).map(|&accessor| (accessor, key));
        for set in 0.. {
            let of_set = attribute(format!("JOINTS_{set}")).zip(attribute(format!("WEIGHTS_{set}")));
            let Some((numbers, weights)) = of_set else {
                if set == 0 {
                    let message = "a skin is left out: the primitive has no JOINTS_0 and WEIGHTS_0";
                    self.notes.warn(part, message);
                    return Ok(None);
                }
                break;
            };
            let numbers = self.of_vertices(numbers, vertices, part)?;
            let weights = self.of_vertices(weights, vertices, part)?;
            for (vertex, (numbers, weights)) in numbers.into_iter().zip(weights).enumerate() {
                if set == 0 {
                    first[vertex] = numbers[0] as usize;
                }
                for (number, weight) in numbers.into_iter().zip(weights) {
                    if weight.is_nan() || weight < 0.0 {
                        self.notes.warn(part, "weights of joints that are below 0 are taken as 0");
                    }
                    if weight > 0.0 {
                        let (joint, weight) = (self.joint(joints, number as usize, part)?, f64::from(weight));
                        let (sum, linear, translation) = &mut sums[vertex];
                        *sum += weight;
                        *linear += joint.matrix3 * weight;
                        *translation += joint.translation * weight;
                    }
                }
            }
        }
        let blended = sums.into_iter().zip(first).map(|((sum, linear, translation), first)| {
            if sum == 0.0 {
                self.notes.warn(part, "vertices without weights follow their first joint");
                return self.joint(joints, first, part);
            }
            if (sum - 1.0).abs() > FAR_FROM_ONE {
                self.notes.warn(part, "weights of joints that do not add up to 1 are divided by their sum");
            }
            Ok(DAffine3::from_mat3_translation(linear * sum.recip(), translation / sum))
        });
        blended.collect::<Result<_, _>>().map(Some)
    }

    /// Four numbers for each vertex.
    fn of_vertices(
        &self,
        (accessor, key): (usize, String),
        vertices: usize,
        part: &str,
    ) -> Result<Vec<[f32; 4]>> {
        let found = self.numbers::<4>(accessor, &format!("{key} of {part}"))?;
        let shape = &self.document.accessors.as_slice()[accessor].shape;
        if found.len() != vertices || shape != "VEC4" {
            let count = found.len();
            let message =
                format!("its {key} has {count} {shape}, but must have {vertices} VEC4, as many as POSITION");
            return Err(self.notes.error(part, message));
        }
        Ok(found)
    }

    fn joint(&self, joints: &[DAffine3], number: usize, part: &str) -> Result<DAffine3> {
        joints.get(number).copied().ok_or_else(|| {
            self.notes.error(part, format!("it refers to joint {number}, but its skin has {}", joints.len()))
        })
    }

    /// Adds the morph targets, each times its weight (glTF 2.0, section 3.7.2.2, "Morph Targets").
    pub(super) fn add_targets(
        &self,
        primitive: &Primitive,
        weights: &[f64],
        part: &str,
        mesh: &mut Mesh,
    ) -> Result<()> {
        for (number, (target, &weight)) in primitive.targets.iter().zip(weights).enumerate() {
            if weight == 0.0 {
                continue;
            }
            for (key, &accessor) in target {
                let read = || self.numbers::<3>(accessor, &format!("{key} of target {number} of {part}"));
                let add = |sum: Vec3, change: [f32; 3]| {
                    (sum.as_dvec3() + weight * DVec3::from_array(change.map(f64::from))).as_vec3()
                };
                match key.as_str() {
                    "POSITION" => {
                        mesh.positions.iter_mut().zip(read()?).for_each(|(p, change)| *p = add(*p, change));
                    }
                    "NORMAL" => {
                        mesh.normals.iter_mut().zip(read()?).for_each(|(n, change)| *n = add(*n, change));
                    }
                    "TANGENT" => {
                        for (tangent, change) in mesh.tangents.iter_mut().zip(read()?) {
                            *tangent = add(tangent.truncate(), change).extend(tangent.w);
                        }
                    }
                    _ => {
                        let key = super::uri::clip(key);
                        self.notes
                            .warn(part, format!("{key} of morph targets is left out: it keeps its values"));
                    }
                }
            }
        }
        Ok(())
    }
}
