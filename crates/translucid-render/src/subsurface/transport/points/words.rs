//! Points and smooth profiles as words for a device, which sums up by itself how much of a profile a shape holds.

use std::sync::Arc;

use super::gather::{Gatherer, MaterialProfile};
use super::hierarchy::{PointCluster, TreePoint};

/// Words of a group of points, of a cluster and of a point.
pub(crate) const GROUP_WORDS: usize = 8;
pub(crate) const CLUSTER_WORDS: usize = 15;
pub(crate) const SURFEL_WORDS: usize = 4;

impl Gatherer {
    /// The points for a device: tolerance and number of groups, and for each of them the halves of its number, the lower
    /// first, origin, 1 over the spacing, where its clusters and its points begin; then these, in spacings from the origin.
    pub(crate) fn words(&self) -> Vec<f32> {
        let mut words = vec![self.tolerance as f32, self.groups.len() as f32];
        words.resize(2 + GROUP_WORDS * self.groups.len(), 0.0);
        for (k, group) in self.groups.iter().enumerate() {
            let clusters_at = words.len();
            words.extend(group.tree.nodes.iter().flat_map(cluster_words));
            let points_at = words.len();
            let points = group.tree.points.iter();
            let point_words =
                |point: &TreePoint| -> [f32; SURFEL_WORDS] { point.position.extend(point.area).to_array() };
            words.extend(points.flat_map(point_words));
            let [low, high] = [group.number & 0xffff, group.number >> 16].map(|half| half as f32);
            let [x, y, z] = group.tree.origin.as_vec3().to_array();
            let [clusters_at, points_at] = [clusters_at, points_at].map(|place| place as f32);
            let row = [low, high, x, y, z, group.tree.inverse_spacing as f32, clusters_at, points_at];
            words[2 + GROUP_WORDS * k..][..GROUP_WORDS].copy_from_slice(&row);
        }
        words
    }

    /// The profile of a material.
    pub(crate) fn profile(&self, material: usize) -> Option<&Arc<MaterialProfile>> {
        self.profiles[material].as_ref()
    }
}

impl MaterialProfile {
    /// The profile for a device: the number of its rows, and for each of them the surface albedo, the length of the unit, four words
    /// of each cell, and bounds of the curvature.
    pub(crate) fn words(&self) -> Vec<f32> {
        let mut words = vec![self.rows.len() as f32];
        for (surface_albedo, smooth) in &self.rows {
            words.extend([*surface_albedo, smooth.scale()]);
            words.extend(smooth.cells.as_flattened());
            words.extend(&smooth.curvature);
        }
        words
    }
}

/// Center, radius, area, the upper half of the spread, the second moment for light of 1, second child, first point, points.
fn cluster_words(cluster: &PointCluster) -> [f32; CLUSTER_WORDS] {
    let [x, y, z] = cluster.center.to_array();
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = cluster.spread.to_cols_array_2d();
    let [right, start, count] = [cluster.right, cluster.start, cluster.count].map(|number| number as f32);
    let PointCluster { radius, area, second, .. } = cluster;
    [x, y, z, *radius, *area, xx, xy, xz, yy, yz, zz, second.x, right, start, count]
}
