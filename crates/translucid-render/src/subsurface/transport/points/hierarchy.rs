//! Clusters of points: a binary tree whose nodes hold the light of their points and its first two moments.
//!
//! Points are put in the order of the tree once, by halving them along the longest edge of their box; after that the
//! shape of the tree follows from their number alone.
//! Coordinates are in spacings from the group's own origin, so that numbers stay near 1 in any unit.

use glam::{DMat3, DVec3, Mat3, Vec3};

use super::surfels::Surfel;

/// Most points of a leaf.
const LEAF: usize = 8;

/// A point in the tree's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreePoint {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    /// Area that it stands for.
    pub(super) area: f32,
    /// Light that enters there: area times irradiance, per channel.
    pub(super) flux: Vec3,
}

/// A cluster.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointCluster {
    /// Mean position, weighted by area.
    pub(super) center: Vec3,
    /// Greatest distance of a point from the center.
    pub(super) radius: f32,
    /// Σ a.
    pub(super) area: f32,
    /// Σ aE per channel.
    pub(super) flux: Vec3,
    /// Σ aE (p − center) for each channel.
    pub(super) first: [Vec3; 3],
    /// Σ aE |p − center|² per channel.
    pub(super) second: Vec3,
    /// Σ a (p − center)(p − center)ᵀ / Σ a.
    pub(super) spread: Mat3,
    /// Number of the second child; the first is the next node. 0 for a leaf.
    pub(super) right: u32,
    /// Range of its points.
    pub(super) start: u32,
    pub(super) count: u32,
}

/// A tree over points.
#[derive(Debug)]
pub(super) struct PointHierarchy {
    pub(super) nodes: Vec<PointCluster>,
    pub(super) points: Vec<TreePoint>,
    pub(super) origin: DVec3,
    pub(super) inverse_spacing: f64,
}

/// Puts points in the order of the tree.
pub(super) fn order(surfels: &mut [Surfel]) {
    if surfels.len() <= LEAF {
        return;
    }
    let (low, high) = surfels.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), surfel| {
        (low.min(surfel.position()), high.max(surfel.position()))
    });
    let axis = (high - low).max_position();
    let middle = surfels.len() / 2;
    surfels.select_nth_unstable_by(middle, |a, b| {
        let key = |s: &Surfel| (s.position[axis], s.position[(axis + 1) % 3], s.position[(axis + 2) % 3]);
        let ((a0, a1, a2), (b0, b1, b2)) = (key(a), key(b));
        a0.total_cmp(&b0).then(a1.total_cmp(&b1)).then(a2.total_cmp(&b2)).then(a.primitive.cmp(&b.primitive))
    });
    let (left, right) = surfels.split_at_mut(middle);
    rayon::join(|| order(left), || order(right));
}

impl PointHierarchy {
    /// Builds the tree over points that [`order`] has put in order, with their transmitted irradiance.
    pub(super) fn new(surfels: &[Surfel], irradiance: impl Fn(usize) -> Vec3, spacing: f64) -> Self {
        let sum: DVec3 = surfels.iter().map(|surfel| surfel.position().as_dvec3()).sum();
        let mut tree = Self {
            nodes: Vec::with_capacity(surfels.len() * 4 / LEAF),
            points: Vec::with_capacity(surfels.len()),
            origin: sum / surfels.len().max(1) as f64,
            inverse_spacing: spacing.recip(),
        };
        for (number, surfel) in surfels.iter().enumerate() {
            let area = (f64::from(surfel.area) * tree.inverse_spacing.powi(2)) as f32;
            let position = tree.local(surfel.position());
            tree.points.push(TreePoint {
                position,
                normal: surfel.normal(),
                area,
                flux: irradiance(number) * area,
            });
        }
        if !tree.points.is_empty() {
            tree.add(0, surfels.len());
        }
        tree
    }

    /// A place in the tree's units.
    pub(super) fn local(&self, position: Vec3) -> Vec3 {
        ((position.as_dvec3() - self.origin) * self.inverse_spacing).as_vec3()
    }

    /// The points of a node.
    pub(super) fn points_of(&self, node: &PointCluster) -> &[TreePoint] {
        &self.points[node.start as usize..(node.start + node.count) as usize]
    }

    /// Adds the node of a range of points and all below it.
    fn add(&mut self, start: usize, end: usize) {
        let index = self.nodes.len();
        self.nodes.push(PointCluster::new(&self.points[start..end], start));
        if end - start > LEAF {
            let middle = start + (end - start) / 2;
            self.add(start, middle);
            self.nodes[index].right = self.nodes.len() as u32;
            self.add(middle, end);
        }
    }
}

impl PointCluster {
    fn new(points: &[TreePoint], start: usize) -> Self {
        let area: f64 = points.iter().map(|point| f64::from(point.area)).sum();
        let weighted = |point: &TreePoint| point.position.as_dvec3() * f64::from(point.area);
        let center = (points.iter().map(weighted).sum::<DVec3>() / area).as_vec3();
        let mut radius = 0.0_f32;
        let (mut flux, mut second, mut first) = (DVec3::ZERO, DVec3::ZERO, [DVec3::ZERO; 3]);
        let mut spread = DMat3::ZERO;
        for point in points {
            let offset = (point.position - center).as_dvec3();
            let light = point.flux.as_dvec3();
            radius = radius.max(offset.length() as f32);
            flux += light;
            let part = offset * f64::from(point.area);
            spread += DMat3::from_cols(part * offset.x, part * offset.y, part * offset.z);
            second += light * offset.length_squared();
            (0..3).for_each(|channel| first[channel] += offset * light[channel]);
        }
        Self {
            center,
            radius: radius * (1.0 + 1e-6),
            area: area as f32,
            flux: flux.as_vec3(),
            first: first.map(|moment| moment.as_vec3()),
            second: second.as_vec3(),
            spread: (spread * area.recip()).as_mat3(),
            right: 0,
            start: start as u32,
            count: points.len() as u32,
        }
    }
}
