//! Points in blue noise over surfaces, each with the area that it stands for.
//!
//! Darts are thrown in a random order at places all over the surface, and stick where no other dart is nearer
//! than r [Cook 1986, "Stochastic sampling in computer graphics": Poisson discs].
//! Then the surface is cut into patches much smaller than a disc, and the area of each goes to the nearest point:
//! the areas are those of the points' Voronoi cells, and add up to the mesh's.
//! Points on surfaces that face away from each other (the two sides of a sheet) neither keep each other away nor take
//! each other's area.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

use glam::Vec3;
use rayon::prelude::*;
use translucid_profile::split_mix::split_mix;
use translucid_scene::Scene;

use super::hash_grid::HashGrid;
use super::patches::Patch;
use super::plan::GroupPlan;
use crate::ray::Geometry;

/// Disc radius over spacing: saturated darts then stand for the square of the spacing on average.
const DISC: f64 = 0.79;
/// Area of the places that darts are thrown at, over the area that a point stands for.
const PLACE_AREA: f64 = 1.0 / 4.0;
/// Area of the patches that are shared out, over the same.
const PATCH_AREA: f64 = 1.0 / 16.0;

/// A point of a surface that stands for the area around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surfel {
    pub(crate) position: [f32; 3],
    /// Area that it stands for \[L²\].
    pub(crate) area: f32,
    /// Unit geometric normal on the outside.
    pub(crate) normal: [f32; 3],
    /// Number of its triangle in the scene.
    pub(crate) primitive: u32,
}

impl Surfel {
    pub(crate) fn position(&self) -> Vec3 {
        self.position.into()
    }

    pub(crate) fn normal(&self) -> Vec3 {
        self.normal.into()
    }
}

/// Why there are no points.
pub(super) enum Unfinished {
    Stopped,
    TooMany,
}

/// Covers a group with points, at most so many. `progress` hears the part that is done.
pub(super) fn cover(
    scene: &Scene,
    geometry: &Geometry,
    plan: &GroupPlan,
    most: usize,
    progress: &(dyn Fn(f64) + Sync),
    stop: &AtomicBool,
) -> Result<Vec<Surfel>, Unfinished> {
    let mut cover = DartThrowing::new(scene, geometry, plan, most, stop);
    cover.throw_darts(&|part| progress(0.5 * part))?;
    let areas = cover.share_area(&|part| progress(0.5 + 0.5 * part))?;
    for (surfel, area) in cover.surfels.iter_mut().zip(areas) {
        surfel.area = area as f32;
    }
    cover.surfels.retain(|surfel| surfel.area > 0.0);
    Ok(cover.surfels)
}

/// A place that a dart is thrown at.
#[derive(Clone, Copy)]
struct DartPlace {
    order: u64,
    position: Vec3,
    primitive: u32,
}

struct DartThrowing<'a> {
    scene: &'a Scene,
    geometry: &'a Geometry,
    plan: &'a GroupPlan,
    most: usize,
    stop: &'a AtomicBool,
    /// Least distance of two points \[L\].
    disc: f64,
    surfels: Vec<Surfel>,
    grid: HashGrid,
}

impl<'a> DartThrowing<'a> {
    fn new(
        scene: &'a Scene,
        geometry: &'a Geometry,
        plan: &'a GroupPlan,
        most: usize,
        stop: &'a AtomicBool,
    ) -> Self {
        let disc = DISC * plan.spacing;
        let grid = HashGrid::new(2.0 * disc);
        Self { scene, geometry, plan, most, stop, disc, surfels: Vec::new(), grid }
    }

    /// Every triangle of the group: number of its object, its number there.
    fn triangles(&self) -> Vec<(usize, usize)> {
        let of =
            |&object: &usize| (0..self.scene.objects[object].mesh.triangles.len()).map(move |t| (object, t));
        self.plan.objects.iter().flat_map(of).collect()
    }

    /// Scene-wide number of a triangle: scenes of which it does not fit get no points.
    fn primitive(&self, object: usize, triangle: usize) -> u32 {
        self.geometry.primitive(object as u32, triangle as u32) as u32
    }

    fn throw_darts(&mut self, progress: &dyn Fn(f64)) -> Result<(), Unfinished> {
        let mut places = self.places();
        places.par_sort_unstable_by_key(|place| (place.order, place.primitive));
        for (number, place) in places.iter().enumerate() {
            if number.is_multiple_of(4096) {
                if self.stop.load(Ordering::Relaxed) {
                    return Err(Unfinished::Stopped);
                }
                progress(number as f64 / places.len() as f64);
            }
            let (object, triangle) = self.geometry.object_and_triangle(place.primitive.into());
            let normal = Patch::of_triangle(&self.scene.objects[object as usize], triangle as usize).normal();
            self.throw(place.position, normal, place.primitive)?;
        }
        Ok(())
    }

    /// A random place in each of many patches.
    fn places(&self) -> Vec<DartPlace> {
        let most_area = PLACE_AREA * self.plan.spacing.powi(2);
        let seed = self.scene.integrator.seed;
        let of = |(object, triangle): (usize, usize)| {
            let patch = Patch::of_triangle(&self.scene.objects[object], triangle);
            let primitive = self.primitive(object, triangle);
            let mut places = Vec::new();
            patch.for_each_part(most_area, |part| {
                let order = split_mix(split_mix(seed ^ u64::from(primitive) << 32) ^ places.len() as u64);
                let bits = split_mix(order);
                let [u, v] = [bits >> 32, bits & 0xffff_ffff].map(|bits| bits as f64 / 4_294_967_296.0);
                places.push(DartPlace { order, position: part.point(u, v).as_vec3(), primitive });
            });
            places
        };
        self.triangles().into_par_iter().flat_map_iter(of).collect()
    }

    /// Adds a point where no other is near.
    fn throw(&mut self, position: Vec3, normal: Vec3, primitive: u32) -> Result<(), Unfinished> {
        let squared = (self.disc * self.disc) as f32;
        let surfels = &self.surfels;
        let is_near = |other: u32| {
            let other = &surfels[other as usize];
            other.position().distance_squared(position) < squared && other.normal().dot(normal) >= 0.0
        };
        if self.grid.any_near(position, self.disc, is_near) {
            return Ok(());
        }
        if self.surfels.len() >= self.most {
            return Err(Unfinished::TooMany);
        }
        self.surfels.push(Surfel { position: position.into(), area: 0.0, normal: normal.into(), primitive });
        self.grid.push(position);
        Ok(())
    }

    /// Area of the patches that are nearest to each point.
    fn share_area(&mut self, progress: &(dyn Fn(f64) + Sync)) -> Result<Vec<f64>, Unfinished> {
        let triangles = self.triangles();
        // Whole numbers, because their sum does not depend on the order: parts of the area in 2⁶².
        let quantum = self.plan.area / (1_u64 << 62) as f64;
        let done = AtomicUsize::new(0);
        let (areas, orphans) = self.share(&triangles, quantum, &|| {
            let done = done.fetch_add(1, Ordering::Relaxed);
            if done.is_multiple_of(4096) {
                progress(done as f64 / triangles.len() as f64);
            }
        });
        if self.stop.load(Ordering::Relaxed) {
            return Err(Unfinished::Stopped);
        }
        if orphans.is_empty() {
            return Ok(areas.iter().map(|area| *area as f64 * quantum).collect());
        }
        // Patches that no dart has come near get points of their own
        for orphan in orphans {
            self.throw(orphan.position, orphan.normal, orphan.primitive)?;
        }
        let (areas, _) = self.share(&triangles, quantum, &|| {});
        Ok(areas.iter().map(|area| *area as f64 * quantum).collect())
    }

    /// Shares the patches of triangles out; those that have no point within two discs are left over.
    fn share(
        &self,
        triangles: &[(usize, usize)],
        quantum: f64,
        done: &(dyn Fn() + Sync),
    ) -> (Vec<u64>, Vec<UncoveredPatch>) {
        let areas: Vec<AtomicU64> = self.surfels.iter().map(|_| AtomicU64::new(0)).collect();
        let most_area = PATCH_AREA * self.plan.spacing.powi(2);
        let of = |&(object, triangle): &(usize, usize)| {
            let mut orphans = Vec::new();
            done();
            if self.stop.load(Ordering::Relaxed) {
                return orphans;
            }
            let patch = Patch::of_triangle(&self.scene.objects[object], triangle);
            let normal = patch.normal();
            patch.for_each_part(most_area, |part| {
                let position = part.center().as_vec3();
                match self.nearest(position, normal) {
                    Some(surfel) => {
                        areas[surfel as usize].fetch_add((part.area() / quantum) as u64, Ordering::Relaxed);
                    }
                    None => {
                        let primitive = self.primitive(object, triangle);
                        orphans.push(UncoveredPatch { position, normal, primitive });
                    }
                }
            });
            orphans
        };
        let orphans = triangles.par_iter().flat_map_iter(of).collect();
        (areas.into_iter().map(AtomicU64::into_inner).collect(), orphans)
    }

    /// The nearest point within two discs on a surface that does not face apart.
    fn nearest(&self, position: Vec3, normal: Vec3) -> Option<u32> {
        for reach in [self.disc, 2.0 * self.disc] {
            let mut best = ((reach * reach) as f32, u32::MAX);
            self.grid.any_near(position, reach, |other| {
                let surfel = &self.surfels[other as usize];
                let squared = surfel.position().distance_squared(position);
                if (squared, other) < best && surfel.normal().dot(normal) >= 0.0 {
                    best = (squared, other);
                }
                false
            });
            if best.1 != u32::MAX {
                return Some(best.1);
            }
        }
        None
    }
}

/// A patch without a point near it.
struct UncoveredPatch {
    position: Vec3,
    normal: Vec3,
    primitive: u32,
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use translucid_scene::{Material, Mesh, Object, ScalarInput, SubsurfaceMethod, SubsurfaceModel};

    use super::*;
    use crate::PreparedScene;
    use crate::subsurface::transport::points::{PixelWidths, PointCloud, PointPlan, PointSettings};

    /// Points on a mesh of a material with a mean free path of 1, ½ and ¼, and their spacing.
    fn covered(mesh: Mesh) -> (Vec<Surfel>, f64) {
        let material = Material {
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_model: SubsurfaceModel::Profile(translucid_profile::Model::NormalizedDiffusion),
            ..Material::default()
        };
        let object = Object {
            name: "o".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        };
        let mut scene = Scene { materials: vec![material], objects: vec![object], ..Scene::default() };
        scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
        let prepared = PreparedScene::new(scene).expect("a valid scene");
        let (world, transports) = prepared.parts();
        let never = AtomicBool::new(false);
        let making = PointSettings { memory: 1 << 30, progress: &|_| {}, stop: &never };
        let plan = PointPlan::new(world, transports.all(), &PixelWidths::default());
        let cloud = PointCloud::laid(world, &plan, &making);
        let cloud = cloud.expect("memory").expect("not stopped");
        (cloud.surfels, cloud.groups[0].spacing)
    }

    /// Two sides of a sheet, a hundredth of the points' spacing apart: one of large and one of tiny triangles.
    fn sheet() -> Mesh {
        let mut mesh = Mesh::default();
        for (cells, height) in [(1_u32, 0.0), (60, -1e-3)] {
            let first = mesh.positions.len() as u32;
            let at = |i: u32| 3.0 * i as f32 / cells as f32;
            let corners = (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j)));
            mesh.positions.extend(corners.map(|(i, j)| Vec3::new(at(i), at(j), height)));
            for cell in 0..cells * cells {
                let a = first + cell / cells * (cells + 1) + cell % cells;
                let (b, c, d) = (a + 1, a + cells + 2, a + cells + 1);
                let up = [[a, b, c], [a, c, d]];
                let down = [[a, c, b], [a, d, c]];
                mesh.triangles.extend(if height == 0.0 { up } else { down });
            }
        }
        mesh
    }

    #[test]
    fn points_share_out_the_area_of_each_side() {
        let (surfels, spacing) = covered(sheet());
        for side in [1.0, -1.0] {
            let own: Vec<&Surfel> = surfels.iter().filter(|s| s.normal[2] * side > 0.5).collect();
            let area: f64 = own.iter().map(|s| f64::from(s.area)).sum();
            assert!((area / 9.0 - 1.0).abs() < 1e-5, "{side}: {area}");
            // On average a point stands for the square of the spacing
            let mean = area / own.len() as f64 / (spacing * spacing);
            assert!((0.85..1.15).contains(&mean), "{side}: {mean} from {} points", own.len());
            for (i, a) in own.iter().enumerate() {
                let cell = f64::from(a.area) / (spacing * spacing);
                assert!((0.2..3.0).contains(&cell), "{side}: {cell}");
                for b in &own[..i] {
                    let distance = f64::from(a.position().distance(b.position()));
                    assert!(distance > 0.999 * DISC * spacing, "{side}: {distance}");
                }
            }
        }
    }
}
