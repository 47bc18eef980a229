//! A light tree: it selects one of many lights at a point, at a cost that grows with the logarithm of their number
//! [A. Conty Estevez & C. Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! Proc. ACM Comput. Graph. Interact. Tech. 1(2)].
//!
//! ```text
//! cut ← the root's children
//! three times: replace the heaviest node of the cut with its children
//! choose from the cut by the random number, and keep its remainder
//! while the choice is a node: choose one of its children in the same way
//! ```
//!
//! The weight of a cluster is an estimate of its lights' contribution at the point, 0 only if bounds prove that they
//! contribute nothing; a single light computes its own weight.
//! The probability of a light is the product along its way, which is found by going up from its leaf to the cut.
//! Where bounds are too wide, all children of a node may turn out to contribute nothing: then no light is chosen.
//!
//! Departures from the paper:
//! 1. Nodes have eight children, which are weighed together: one look at eight small clusters is nearer to the truth
//!    than three looks at pairs of larger ones.
//! 2. The cut is a splitting that still draws a single light: where it matters, clusters are evaluated before the choice
//!    between them, not after. One, two and eight opened nodes measured the same as four, within the noise.
//! 3. Bounds decide what is left out, but a bound is a bad estimate of a cluster of lights that shine in all directions,
//!    or of a box cut by the horizon: there the intensity is that of the lights' mean and first moments, and the
//!    cosine the mean over the box's heights.
//! 4. Intensities take the place of powers: a spot and a sphere of equal intensity light a point in the spot's cone
//!    alike.

mod builder;

use glam::{BVec4A, Vec4};
use translucid_law::Receiver;

use super::bounds::LightBounds;
use super::emitters::Emitters;
use super::weights::{LightWeights, importance};
use builder::build;

/// Children of a node.
pub(crate) const WIDTH: usize = 8;

/// Nodes that a point chooses from at once; see the head of the file.
const OPENED: usize = 4;

/// Words of a lane for devices.
pub(crate) const LANE_WORDS: usize = 20;

/// Marks a child that is a light.
const LEAF: u32 = 1 << 31;

/// The number of no place: that of the root, and of lights that are not in the tree.
const NOWHERE: u32 = u32::MAX;

/// Share of a node's samples that goes evenly to all children that can contribute, in case the important ones are
/// hidden.
const EVEN_SHARE: f32 = 0.02;

/// Room for rounding in the cosines of cones: the sine next to 0 has an error of 3e-4.
const COSINE_ROOM: f32 = 1e-3;

/// Room for rounding in the height above the horizon, relative to the distance.
const HORIZON_ROOM: f32 = 1e-6;

/// Room for rounding of boxes, relative to their coordinates.
const BOX_ROOM: f32 = 4.0 * f32::EPSILON;

/// Least share of the mean intensity that a cluster is taken to shed in any direction where it may shed light at all.
const LEAST_LEAN: f32 = 0.1;

/// Distances to a cluster count as at least this share of its radius.
const NEAREST: f32 = 0.5;

/// A light that can contribute at all weighs at least this and at most its reciprocal.
const LEAST_WEIGHT: f32 = 1e-30;

/// A number for each lane.
type LightLanes = [Vec4; WIDTH / 4];

/// Clusters of lights, one in each lane. Empty lanes have no strength.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct LightNode {
    center: [LightLanes; 3],
    half_size: [LightLanes; 3],
    radius: LightLanes,
    axis: [LightLanes; 3],
    cos_o: LightLanes,
    sin_o: LightLanes,
    cos_e: LightLanes,
    strength: LightLanes,
    mean: LightLanes,
    lean: [LightLanes; 3],
    /// Weight of the bound of the intensity as an estimate, in [0, 1]: 1 if all normals are the same.
    alike: LightLanes,
    /// Index of a node, or `LEAF` and the number of a light.
    children: [u32; WIDTH],
}

/// The content of a node's lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightChild {
    LightNode(u32),
    Light(u32),
}

impl LightNode {
    /// Puts a cluster in a lane.
    pub(crate) fn set(&mut self, lane: usize, bounds: &LightBounds, child: LightChild) {
        let center = bounds.low.midpoint(bounds.high);
        let room = bounds.low.abs().max(bounds.high.abs()) * BOX_ROOM;
        let half_size = (bounds.high - center).max(center - bounds.low) + room;
        let strength = bounds.strength.max(f32::MIN_POSITIVE);
        let alike = bounds.facing.length() / strength;
        let put = |lanes: &mut LightLanes, value: f32| lanes[lane / 4][lane % 4] = value;
        for axis in 0..3 {
            put(&mut self.center[axis], center[axis]);
            put(&mut self.half_size[axis], half_size[axis]);
            put(&mut self.axis[axis], bounds.axis[axis]);
            put(&mut self.lean[axis], bounds.lean[axis]);
        }
        put(&mut self.radius, half_size.length());
        put(&mut self.cos_o, libm::cosf(bounds.theta_o));
        put(&mut self.sin_o, libm::sinf(bounds.theta_o));
        put(&mut self.cos_e, libm::cosf(bounds.theta_e) - COSINE_ROOM);
        put(&mut self.strength, strength);
        put(&mut self.mean, bounds.mean);
        put(&mut self.alike, if alike.is_finite() { (alike * alike).min(1.0) } else { 0.0 });
        self.children[lane] = match child {
            LightChild::LightNode(index) => index,
            LightChild::Light(light) => LEAF | light,
        };
    }

    /// The content of a lane, if there is any.
    fn child(&self, lane: usize) -> Option<LightChild> {
        let child = self.children[lane];
        let found =
            if child & LEAF == 0 { LightChild::LightNode(child) } else { LightChild::Light(child & !LEAF) };
        (self.strength[lane / 4][lane % 4] > 0.0).then_some(found)
    }

    /// Moves the nodes it refers to.
    pub(crate) fn shift(&mut self, by: u32) {
        for lane in 0..WIDTH {
            if let Some(LightChild::LightNode(index)) = self.child(lane) {
                self.children[lane] = index + by;
            }
        }
    }

    /// Estimates of the irradiance that each lane's lights bring (luminance), between [`LEAST_WEIGHT`] and its
    /// reciprocal; 0 only where none of them can contribute.
    fn importances(&self, receiver: &Receiver) -> [f32; WIDTH] {
        let [first, second] = [0, 1].map(|half| self.importances_of_half(half, receiver));
        let ([a, b, c, d], [e, f, g, h]) = (first.to_array(), second.to_array());
        [a, b, c, d, e, f, g, h]
    }

    /// Importance of four lanes at once, without branches.
    #[inline(always)]
    fn importances_of_half(&self, i: usize, receiver: &Receiver) -> Vec4 {
        let (point, normal, tilt) = (receiver.point, receiver.normal, receiver.normal.abs());
        let radius = self.radius[i];
        // Distance to the center, not less than the box's radius
        let (x, y, z) =
            (self.center[0][i] - point.x, self.center[1][i] - point.y, self.center[2][i] - point.z);
        let distance2 = x * x + y * y + z * z;
        let distance = distance2.sqrt();
        let per_distance = distance.max(radius).recip();
        // θ, from the axis to the receiver, less θ_o
        let cos = -(self.axis[0][i] * x + self.axis[1][i] * y + self.axis[2][i] * z) * per_distance;
        let sin = (1.0 - cos * cos).max(Vec4::ZERO).sqrt();
        let (sin_o, cos_o) = (self.sin_o[i], self.cos_o[i]);
        let in_cone = cos.cmpge(cos_o);
        let cos_x = Vec4::select(in_cone, Vec4::ONE, cos * cos_o + sin * sin_o);
        let sin_x = Vec4::select(in_cone, Vec4::ZERO, sin * cos_o - cos * sin_o);
        // … less θ_u, half the angle at which the receiver sees the box
        let sin_u = radius * per_distance;
        let cos_u = (1.0 - sin_u * sin_u).max(Vec4::ZERO).sqrt();
        let facing = distance2.cmple(radius * radius) | cos_x.cmpge(cos_u);
        let cos_emitted = Vec4::select(facing, Vec4::ONE, cos_x * cos_u + sin_x * sin_u);
        // The bound as an estimate where all normals are the same, else the mean over directions and how it leans
        let bound = self.strength[i] * cos_emitted.max(Vec4::splat(COSINE_ROOM));
        let lean = self.lean[0][i] * x + self.lean[1][i] * y + self.lean[2][i] * z;
        let moments = (self.mean[i] - lean * per_distance).max(LEAST_LEAN * self.mean[i]);
        let intensity = self.alike[i] * bound + (1.0 - self.alike[i]) * moments.min(bound);
        // Mean cosine over heights from the lowest to the highest corner, above the horizon
        let middle = (normal.x * x + normal.y * y + normal.z * z) * per_distance;
        let reach =
            tilt.x * self.half_size[0][i] + tilt.y * self.half_size[1][i] + tilt.z * self.half_size[2][i];
        let reach = reach * per_distance + HORIZON_ROOM;
        let highest = middle + reach;
        let risen = Vec4::select(middle.cmpge(reach), middle, highest * highest / (4.0 * reach));
        let (cosine, below) = if receiver.has_normal() {
            (risen.min(Vec4::ONE), highest.cmple(Vec4::ZERO))
        } else {
            (Vec4::ONE, BVec4A::splat(false))
        };
        // Where numbers overflow to NaN the comparisons fail: such lights count as in sight
        let hidden = cos_emitted.cmplt(self.cos_e[i]) | below | self.strength[i].cmple(Vec4::ZERO);
        let nearness = distance.max(NEAREST * radius).recip();
        let irradiance = intensity * nearness * nearness * cosine;
        // A NaN becomes the least: the instruction for the greater returns its second operand
        let within_limits = irradiance.max(Vec4::splat(LEAST_WEIGHT)).min(Vec4::splat(1.0 / LEAST_WEIGHT));
        Vec4::select(hidden, Vec4::ZERO, within_limits)
    }

    /// Weights of the lanes at a point; lanes that are lights have the light's own estimate.
    fn weigh(&self, emitters: &Emitters, receiver: &Receiver) -> [f32; WIDTH] {
        let mut weights = self.importances(receiver);
        for (lane, weight) in weights.iter_mut().enumerate() {
            if let Some(LightChild::Light(light)) = self.child(lane).filter(|_| *weight > 0.0) {
                *weight = importance(emitters, light as usize, receiver);
            }
        }
        weights
    }

    /// The heaviest lane that is a node, with its weight.
    fn heaviest(&self, weights: &[f32]) -> (f32, usize) {
        let mut heaviest = (0.0, 0);
        for (lane, &weight) in weights.iter().enumerate() {
            if weight > heaviest.0 && self.children[lane] & LEAF == 0 {
                heaviest = (weight, lane);
            }
        }
        heaviest
    }
}

/// The tree over a scene's lights that have a place.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    nodes: Vec<LightNode>,
    /// For each node the node and lane that it is in, as node × `WIDTH` + lane.
    parents: Vec<u32>,
    /// The lane of each light.
    leaves: Vec<u32>,
}

/// The weights of the root's lanes at a point.
pub(crate) struct Root([f32; WIDTH]);

impl Root {
    /// Estimate of the irradiance that all lights bring; 0 only if none can contribute.
    pub(crate) fn importance(&self) -> f32 {
        self.0.iter().sum()
    }
}

/// A [`TreeCut`] in the making.
struct OpenCut {
    opened: [u32; OPENED],
    len: usize,
    weights: [f32; OPENED * WIDTH],
    /// For each opened node the heaviest lane that can be opened.
    heaviest: [(f32, usize); OPENED],
}

impl OpenCut {
    fn new(weights: [f32; WIDTH], root: &LightNode) -> Self {
        let (opened, len) = ([0; OPENED], 0);
        let mut cut = Self { opened, len, weights: [0.0; OPENED * WIDTH], heaviest: [(0.0, 0); OPENED] };
        cut.open(0, weights, root);
        cut
    }

    fn open(&mut self, index: u32, weights: [f32; WIDTH], node: &LightNode) {
        self.opened[self.len] = index;
        self.weights[self.len * WIDTH..][..WIDTH].copy_from_slice(&weights);
        self.find_heaviest(self.len, node);
        self.len += 1;
    }

    fn find_heaviest(&mut self, slot: usize, node: &LightNode) {
        self.heaviest[slot] = node.heaviest(&self.weights[slot * WIDTH..][..WIDTH]);
    }

    /// Slot and lane of the heaviest cluster that can be opened.
    fn heaviest(&self) -> Option<(usize, usize)> {
        let mut slot = 0;
        for other in 1..self.len {
            if self.heaviest[other].0 > self.heaviest[slot].0 {
                slot = other;
            }
        }
        let (weight, lane) = self.heaviest[slot];
        (weight > 0.0).then_some((slot, lane))
    }
}

/// The clusters that a point chooses from first: the lanes of a few nodes, each but the root in place of the lane
/// that it is below.
pub(crate) struct TreeCut {
    opened: [u32; OPENED],
    len: usize,
    weights: LightWeights<{ OPENED * WIDTH }>,
}

impl TreeCut {
    /// Where a lane of a node is among the clusters, if the node has been opened.
    fn place(&self, node: usize, lane: usize) -> Option<usize> {
        let opened = self.opened[..self.len].iter().position(|&opened| opened as usize == node)?;
        Some(opened * WIDTH + lane)
    }
}

impl LightTree {
    /// A tree over lights given by bounds and number, numbers being below `count`. None if there are none.
    pub(crate) fn new(lights: Vec<(LightBounds, u32)>, count: usize) -> Option<Self> {
        if lights.is_empty() {
            return None;
        }
        let nodes = build(lights);
        let mut parents = vec![NOWHERE; nodes.len()];
        let mut leaves = vec![NOWHERE; count];
        for (index, node) in nodes.iter().enumerate() {
            for lane in 0..WIDTH {
                let place = (index * WIDTH + lane) as u32;
                match node.child(lane) {
                    Some(LightChild::LightNode(child)) => parents[child as usize] = place,
                    Some(LightChild::Light(light)) => leaves[light as usize] = place,
                    None => {}
                }
            }
        }
        Some(Self { nodes, parents, leaves })
    }

    /// All lanes of all nodes as words: center, half size, radius, axis, cos θ_o, sin θ_o, cos θ_e, strength, mean, lean,
    /// alike, child (0 none, a node's number + 1, −(a light's number + 1)).
    pub(crate) fn lanes(&self) -> Vec<[f32; LANE_WORDS]> {
        let lane = |node: &LightNode, lane: usize| {
            let of = |lanes: &LightLanes| lanes[lane / 4][lane % 4];
            let [center, half, axis, lean] = [&node.center, &node.half_size, &node.axis, &node.lean]
                .map(|vector| vector.each_ref().map(of));
            let child = match node.child(lane) {
                None => 0.0,
                Some(LightChild::LightNode(node)) => node as f32 + 1.0,
                Some(LightChild::Light(light)) => -(light as f32 + 1.0),
            };
            let mut words = [0.0; LANE_WORDS];
            words[..3].copy_from_slice(&center);
            words[3..6].copy_from_slice(&half);
            words[6] = of(&node.radius);
            words[7..10].copy_from_slice(&axis);
            words[10..15].copy_from_slice(
                &[&node.cos_o, &node.sin_o, &node.cos_e, &node.strength, &node.mean].map(of),
            );
            words[15..18].copy_from_slice(&lean);
            words[18..].copy_from_slice(&[of(&node.alike), child]);
            words
        };
        self.nodes.iter().flat_map(|node| (0..WIDTH).map(move |index| lane(node, index))).collect()
    }

    /// Number of the lanes of all nodes.
    pub(crate) fn lane_count(&self) -> usize {
        self.nodes.len() * WIDTH
    }

    /// For each node the place of the lane that it is in, and for each light that of its lane, as node × `WIDTH` + lane; the
    /// greatest number where there is none.
    pub(crate) fn places(&self) -> (&[u32], &[u32]) {
        (&self.parents, &self.leaves)
    }

    /// The weights of the root's lanes.
    pub(crate) fn root(&self, emitters: &Emitters, receiver: &Receiver) -> Root {
        Root(self.nodes[0].weigh(emitters, receiver))
    }

    /// Opens the node that weighs most, again and again.
    pub(crate) fn cut(&self, root: &Root, emitters: &Emitters, receiver: &Receiver) -> TreeCut {
        let mut cut = OpenCut::new(root.0, &self.nodes[0]);
        while cut.len < OPENED {
            let Some((slot, lane)) = cut.heaviest() else { break };
            let node = self.nodes[cut.opened[slot] as usize].children[lane];
            cut.weights[slot * WIDTH + lane] = 0.0;
            cut.find_heaviest(slot, &self.nodes[cut.opened[slot] as usize]);
            let opened = &self.nodes[node as usize];
            cut.open(node, opened.weigh(emitters, receiver), opened);
        }
        let OpenCut { opened, len, weights, .. } = cut;
        TreeCut { opened, len, weights: LightWeights::of_first(weights, len * WIDTH, EVEN_SHARE) }
    }

    /// Returns `true` if a light is in the tree.
    pub(crate) fn holds(&self, light: usize) -> bool {
        self.leaves.get(light).is_some_and(|&leaf| leaf != NOWHERE)
    }

    /// Selects a light; returns its number and its probability. None if no light can contribute.
    pub(crate) fn choose(
        &self,
        cut: &TreeCut,
        emitters: &Emitters,
        receiver: &Receiver,
        u: f64,
    ) -> Option<(usize, f32)> {
        let (place, mut probability, mut u) = cut.weights.choose(u)?;
        let mut child = self.nodes[cut.opened[place / WIDTH] as usize].child(place % WIDTH)?;
        loop {
            let node = match child {
                LightChild::Light(light) => return Some((light as usize, probability)),
                LightChild::LightNode(index) => &self.nodes[index as usize],
            };
            let (lane, share, rest) =
                LightWeights::new(node.weigh(emitters, receiver), EVEN_SHARE).choose(u)?;
            child = node.child(lane)?;
            probability *= share;
            u = rest;
        }
    }

    /// Probability with which `choose` selects a light.
    pub(crate) fn probability(
        &self,
        cut: &TreeCut,
        emitters: &Emitters,
        receiver: &Receiver,
        light: usize,
    ) -> f32 {
        let Some(&leaf) = self.leaves.get(light) else { return 0.0 };
        let mut probability = 1.0;
        let mut place = leaf;
        while place != NOWHERE {
            let (index, lane) = (place as usize / WIDTH, place as usize % WIDTH);
            if let Some(place) = cut.place(index, lane) {
                return probability * cut.weights.probability(place);
            }
            let weights = self.nodes[index].weigh(emitters, receiver);
            probability *= LightWeights::new(weights, EVEN_SHARE).probability(lane);
            place = self.parents[index];
        }
        0.0
    }
}
