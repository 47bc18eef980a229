//! The body that lies below a surface: surfaces of one subsurface group, as a path through the inside meets them.

use glam::Vec3;

use translucid_scene::Scene;

use super::clearance::Clearance;
use super::geometry::{Geometry, Hit, SurfacePoint};
use super::triangle::Ray;

/// Surfaces between a point in the body and where it ends: meshes of a group that overlap, or that are doubled.
const MOST_SURFACES: u32 = 64;

/// Cosine to the normal below which a path begins below its ray rather than on it: the way to there would be long.
const GRAZING: f32 = 0.1;

/// A point inside a body, as a path keeps track of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside {
    pub(crate) position: Vec3,
    /// Closed meshes that the point is in.
    nesting: u32,
}

/// The body.
#[derive(Clone, Copy)]
pub(crate) struct Body<'a> {
    geometry: &'a Geometry,
    clearance: Option<&'a Clearance>,
    group: u32,
    /// 1, or −1 where the surface is seen from its back: the body is then in front of its surfaces.
    side: f32,
    /// Distance from surfaces at which a point is safely on one side \[L\].
    offset: f32,
}

/// Diagonals of the scene beyond which a walk has left an open mesh for good: hardly any would find the way back.
const FARTHEST: f32 = 2.0;

/// The end of a flight.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FlightEnd {
    /// It ends inside.
    Inside(Inside),
    /// It meets the body's end after a distance.
    Boundary { distance: f32, hit: Hit },
}

impl Inside {
    /// Just below the surface.
    fn below(position: Vec3) -> Self {
        Self { position, nesting: 1 }
    }
}

impl<'a> Body<'a> {
    /// The body below a surface that is seen from its outside (`side` 1) or, in an open mesh, from its inside (−1).
    pub(crate) fn below(scene: &'a Scene, geometry: &'a Geometry, point: &SurfacePoint, side: f32) -> Self {
        let clearance = geometry.clearance(&scene.objects, point.group);
        Self { geometry, clearance, group: point.group, side, offset: point.offset }
    }

    /// Where a direction into the body begins below a surface point, and the way from the point to there \[L\]; `None` if
    /// the direction leads outside.
    pub(crate) fn enter(&self, point: &SurfacePoint, direction: Vec3) -> Option<(Inside, f32)> {
        let normal = point.geometric_normal * self.side;
        let cosine = -direction.dot(normal);
        // On the ray where it is deep enough, unless it hardly gets deeper
        let skipped = self.offset / cosine.max(GRAZING);
        let start = point.position + direction * skipped - normal * (self.offset - skipped * cosine);
        (cosine > 0.0).then(|| (Inside::below(start), skipped))
    }

    /// Follows a flight from a point inside.
    ///
    /// A collision nearer to the body's end than rounding allows counts as a little before it: on the other side the walk
    /// would never leave again.
    pub(crate) fn fly(&self, from: Inside, direction: Vec3, length: f32) -> FlightEnd {
        if self.clearance.is_some_and(|clearance| length + self.offset <= clearance.at(from.position)) {
            return FlightEnd::Inside(Inside { position: from.position + direction * length, ..from });
        }
        let mut nesting = from.nesting;
        let mut done = 0.0;
        for _ in 0..MOST_SURFACES {
            let start = from.position + direction * done;
            let ray = Ray::segment(start, direction, length - done + self.offset);
            let Some(hit) = self.geometry.closest_in_group(&ray, self.group) else { break };
            let distance = done + hit.t;
            let leaves = direction.dot(self.geometry.normal(&hit)) * self.side > 0.0;
            if leaves && nesting <= 1 {
                if distance <= length {
                    return FlightEnd::Boundary { distance, hit };
                }
                let position = from.position + direction * (distance - self.offset).max(0.0);
                return FlightEnd::Inside(Inside { position, nesting });
            }
            if distance > length {
                break;
            }
            nesting = if leaves { nesting - 1 } else { nesting + 1 };
            done = distance + self.offset;
        }
        FlightEnd::Inside(Inside { position: from.position + direction * length, nesting })
    }

    /// The end of a flight that has left the body after a distance, if there the body goes on behind a gap; calls `leave`
    /// wherever it leaves the body again.
    pub(crate) fn behind(
        &self,
        from: Inside,
        direction: Vec3,
        distance: f32,
        length: f32,
        mut leave: impl FnMut(f32, Hit),
    ) -> Option<Inside> {
        let position = from.position + direction * length;
        let mut nesting = 0_u32;
        let mut done = distance + self.offset;
        for _ in 0..MOST_SURFACES {
            let ray = Ray::segment(from.position + direction * done, direction, length - done);
            let hit = if done < length { self.geometry.closest_in_group(&ray, self.group) } else { None };
            let Some(hit) = hit else {
                return (nesting > 0 && position.is_finite()).then_some(Inside { position, nesting });
            };
            let leaves = direction.dot(self.geometry.normal(&hit)) * self.side > 0.0;
            if leaves && nesting == 1 {
                leave(done + hit.t, hit);
            }
            nesting = if leaves { nesting.saturating_sub(1) } else { nesting + 1 };
            done += hit.t + self.offset;
        }
        None
    }

    /// Whether the way from a point to another leads through the body alone.
    pub(crate) fn connects(&self, from: Inside, to: Vec3) -> bool {
        let (direction, length) = (to - from.position).normalize_and_length();
        let is_clear = |clearance: &Clearance| length <= clearance.at(from.position) + clearance.at(to);
        // Collisions lie that much before the body's end
        self.clearance.is_some_and(is_clear)
            || matches!(self.fly(from, direction, length - self.offset), FlightEnd::Inside(_))
    }

    /// Whether a point is so far off that there is nothing to come back to, or nowhere at all.
    pub(crate) fn is_lost(&self, at: &Inside) -> bool {
        let (low, high) = self.geometry.bounds();
        let farthest = (high - low) * FARTHEST;
        let off = (at.position - 0.5 * (low + high)).length_squared();
        off.is_nan() || off > farthest.length_squared()
    }

    /// Outward normal of a surface that a direction inside meets.
    pub(crate) fn normal(&self, hit: &Hit) -> Vec3 {
        self.geometry.normal(hit) * self.side
    }

    /// The point just inside a surface at which a walk is reflected.
    pub(crate) fn reflected(&self, hit: &Hit) -> Inside {
        Inside::below(self.geometry.position(hit) - self.normal(hit) * self.offset)
    }
}
