//! Rays per CPU second on the dragon, single-threaded.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench rays [-- dragon_198k dragon_870k --rays 400000 --write FOLDER]
//! cargo bench -p translucid-workbench --bench rays -- dragon_198k --serve
//! ```
//!
//! The kinds are those of a path tracer with subsurface scattering:
//!
//! | kind | rays | question |
//! |---|---|---|
//! | camera | through the pixels of a square picture, tile by tile | nearest hit |
//! | bounce | cosine-distributed, from what the camera sees, tile by tile | nearest hit |
//! | scattered | the same from points all over the surface in random order | nearest hit |
//! | shadow | from what the camera sees to points of a rectangle of light | any hit |
//! | probe | segments through the neighborhood of what the camera sees | nearest hit |
//! | probe-all | the same | every hit |
//! | walk | steps of random walks below what the camera sees | nearest hit |
//!
//! Radii of probes are drawn from normalized diffusion with a mean free path of 1 % of the mesh's height, cut at 99.9 %
//! of its energy; walks have the same mean free path.
//! Times are CPU time of the one thread that traces; each is the least of five, since whatever else runs on the machine
//! only adds to it.
//! `--write` writes meshes and rays as plain numbers, and `--serve` answers kind after kind from standard input, for
//! `benches/peers/embree.py`.
//! The meshes are scans, which are not part of the project (`docs/inside/scans.md`). A mesh that is not there is skipped.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use glam::Vec3;
use translucid_load::load_ply;
use translucid_profile::NormalizedDiffusion;
use translucid_render::internals::Frame;
use translucid_render::{Geometry, Hit, Ray, TILE_SIZE};
use translucid_scene::{Mesh, Object};
use translucid_testing::{SplitMix, asset, thread_cpu_seconds};

const MESHES: [&str; 2] = ["dragon_198k", "dragon_870k"];

/// Side of the picture, in pixels.
const SIZE: u32 = 512;

/// Mean free path as a part of the mesh's height.
const MEAN_FREE_PATH: f32 = 0.01;

/// Flights of a walk, at most.
const MOST_FLIGHTS: u32 = 32;

/// Distance by which origins leave the surface, as a part of the mesh's height.
const OFFSET: f32 = 1e-5;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
    let count = value("--rays").and_then(|n| n.parse().ok()).unwrap_or(400_000);
    let is_named = |name: &str| arguments.iter().any(|a| a == name);
    let all = !MESHES.iter().any(|&name| is_named(name));
    for name in MESHES.into_iter().filter(|&name| all || is_named(name)) {
        let Some(bench) = Bench::load(name, count) else {
            println!("{name}: skipped, dragon/{name}.ply is not in TRANSLUCID_ASSETS");
            continue;
        };
        if let Some(folder) = value("--write") {
            bench.write(&Path::new(folder).join(name)).unwrap_or_else(|error| panic!("{folder}: {error}"));
        }
        if is_named("--serve") { bench.serve() } else { bench.print(name) }
    }
}

/// The query of a ray.
#[derive(Clone, Copy, PartialEq)]
enum Question {
    Nearest,
    NearestInGroup,
    Any,
    Every,
}

/// A segment as a file has it: origin, unit direction, length.
#[derive(Clone, Copy)]
struct Segment {
    origin: Vec3,
    direction: Vec3,
    length: f32,
}

struct Kind {
    name: &'static str,
    question: Question,
    segments: Vec<Segment>,
}

struct Bench {
    mesh: Object,
    geometry: Geometry,
    build_seconds: f64,
    kinds: Vec<Kind>,
}

impl Bench {
    fn load(name: &str, count: usize) -> Option<Self> {
        let path = asset(&format!("dragon/{name}.ply"))?;
        let mesh = load_ply(&path, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"));
        let object = Object {
            name: name.into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        };
        let start = Instant::now();
        let geometry = Geometry::new(std::slice::from_ref(&object));
        let build_seconds = start.elapsed().as_secs_f64();
        let kinds = Rays::new(&geometry, &object.mesh).kinds(count);
        Some(Self { mesh: object, geometry, build_seconds, kinds })
    }

    fn print(&self, name: &str) {
        let triangles = self.mesh.mesh.triangles.len();
        let bytes = self.geometry.memory() as f64 / triangles as f64;
        println!(
            "{name}: {triangles} triangles, tree of {bytes:.0} bytes a triangle built in {:.2} s",
            self.build_seconds
        );
        println!("| kind | rays | hits per ray | M rays per CPU s |");
        println!("|---|---|---|---|");
        for kind in &self.kinds {
            let runs: Vec<_> = (0..5).map(|_| self.trace(kind)).collect();
            let seconds = runs.iter().map(|run| run.0).fold(f64::INFINITY, f64::min);
            let rays = kind.segments.len() as f64;
            let hits = runs[0].1 as f64 / rays;
            println!("| {} | {rays} | {hits:.4} | {:.2} |", kind.name, rays / seconds * 1e-6);
        }
    }

    /// CPU seconds for all rays of a kind, and the hits they have.
    fn trace(&self, kind: &Kind) -> (f64, u64) {
        let geometry = &self.geometry;
        let start = thread_cpu_seconds();
        let mut hits = 0_u64;
        for &Segment { origin, direction, length } in &kind.segments {
            let ray = Ray::segment(origin, direction, length);
            match kind.question {
                Question::Nearest => hits += u64::from(geometry.closest(&ray).is_some()),
                Question::NearestInGroup => hits += u64::from(geometry.closest_in_group(&ray, 0).is_some()),
                Question::Any => hits += u64::from(geometry.occluded(&ray)),
                Question::Every => geometry.all_in_group(&ray, 0, |_| hits += 1),
            }
        }
        (thread_cpu_seconds() - start, hits)
    }

    /// Reads a kind a line, traces it, and prints CPU seconds and hits.
    fn serve(&self) {
        println!("ready");
        for line in std::io::stdin().lines() {
            let Ok(name) = line else { return };
            let Some(kind) = self.kinds.iter().find(|kind| kind.name == name.trim()) else { return };
            let (seconds, hits) = self.trace(kind);
            println!("{seconds} {hits}");
        }
    }

    /// Mesh and rays as little-endian numbers.
    fn write(&self, folder: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let Mesh { positions, triangles, .. } = &*self.mesh.mesh;
        std::fs::write(folder.join("vertices.f32"), bytemuck::cast_slice(positions))?;
        std::fs::write(folder.join("triangles.u32"), bytemuck::cast_slice(triangles))?;
        for kind in &self.kinds {
            let mut file = std::io::BufWriter::new(std::fs::File::create(
                folder.join(kind.name).with_extension("rays"),
            )?);
            for Segment { origin: o, direction: d, length } in &kind.segments {
                file.write_all(bytemuck::cast_slice(&[o.x, o.y, o.z, d.x, d.y, d.z, *length]))?;
            }
            file.flush()?;
        }
        Ok(())
    }
}

/// Where a ray starts.
#[derive(Clone, Copy)]
struct Start {
    position: Vec3,
    normal: Vec3,
}

/// Makes the rays.
struct Rays<'a> {
    geometry: &'a Geometry,
    mesh: &'a Mesh,
    center: Vec3,
    height: f32,
    random: SplitMix,
}

impl<'a> Rays<'a> {
    fn new(geometry: &'a Geometry, mesh: &'a Mesh) -> Self {
        let (low, high) = mesh.bounds();
        let (center, height) = (0.5 * (low + high), high.y - low.y);
        Self { geometry, mesh, center, height, random: SplitMix(1) }
    }

    fn kinds(mut self, count: usize) -> Vec<Kind> {
        let camera = self.camera(count);
        let mut seen: Vec<Start> = camera.iter().filter_map(|ray| self.meet(ray)).collect();
        assert!(!seen.is_empty(), "the camera looks at the mesh");
        // As many starts as rays: points are met again in the same order.
        let once = seen.len();
        seen = (0..count).map(|i| seen[i * once / count]).collect();
        let anywhere: Vec<Start> = (0..count).map(|_| self.surface_point()).collect();
        let probes: Vec<Segment> = self.probes(&seen);
        let kind = |name, question, segments| Kind { name, question, segments };
        vec![
            kind("null", Question::Nearest, camera.iter().map(|c| Segment { length: 1e-9, ..*c }).collect()),
            kind("camera", Question::Nearest, camera),
            kind("bounce", Question::Nearest, seen.iter().map(|start| self.bounce(start)).collect()),
            kind("scattered", Question::Nearest, anywhere.iter().map(|start| self.bounce(start)).collect()),
            kind("shadow", Question::Any, seen.iter().map(|start| self.shadow(start)).collect()),
            kind("probe", Question::NearestInGroup, probes.clone()),
            kind("probe-all", Question::Every, probes),
            kind("walk", Question::NearestInGroup, self.walks(&seen)),
        ]
    }

    /// Rays through the pixels of a square picture, tile by tile and sample after sample.
    fn camera(&mut self, count: usize) -> Vec<Segment> {
        let toward = Vec3::new(0.25, -0.18, -1.0).normalize();
        let origin = self.center - toward * (2.6 * self.height);
        let frame = Frame::from_normal(toward);
        let tiles = SIZE / TILE_SIZE;
        let per_pixel = count.div_ceil((SIZE * SIZE) as usize) as u32;
        let mut rays = Vec::with_capacity(count);
        for number in 0..tiles * tiles * TILE_SIZE * TILE_SIZE * per_pixel {
            let (pixel, tile) = (number / per_pixel, number / per_pixel / (TILE_SIZE * TILE_SIZE));
            let inside = pixel % (TILE_SIZE * TILE_SIZE);
            let x = (tile % tiles) * TILE_SIZE + inside % TILE_SIZE;
            let y = (tile / tiles) * TILE_SIZE + inside / TILE_SIZE;
            let at = |pixel: u32, u: f32| ((pixel as f32 + u) / SIZE as f32 - 0.5) * 0.6;
            let (u, v) = (at(x, self.random.uniform_f32()), at(y, self.random.uniform_f32()));
            let direction = frame.to_world(Vec3::new(u, v, 1.0)).normalize();
            rays.push(Segment { origin, direction, length: f32::INFINITY });
        }
        rays.truncate(count);
        rays
    }

    fn meet(&self, ray: &Segment) -> Option<Start> {
        let hit: Hit = self.geometry.closest(&Ray::new(ray.origin, ray.direction))?;
        let normal = self.geometry.normal(&hit);
        let outside = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        Some(Start { position: self.geometry.position(&hit), normal: outside })
    }

    /// A corner's neighborhood in a random triangle: near enough to uniform in area on a scanned mesh.
    fn surface_point(&mut self) -> Start {
        let triangle = (self.random.uniform_f32() * self.mesh.triangles.len() as f32) as usize;
        let [a, b, c] = self.mesh.triangles[triangle].map(|corner| self.mesh.positions[corner as usize]);
        let (u, v) = (self.random.uniform_f32().sqrt(), self.random.uniform_f32());
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Z);
        Start { position: a * (1.0 - u) + b * (u * (1.0 - v)) + c * (u * v), normal }
    }

    fn bounce(&mut self, start: &Start) -> Segment {
        let (radius, angle) = (self.random.uniform_f32().sqrt(), self.angle());
        let up = (1.0 - radius * radius).max(0.0).sqrt();
        let local = Vec3::new(radius * angle.cos(), radius * angle.sin(), up);
        let direction = Frame::from_normal(start.normal).to_world(local).normalize();
        Segment { origin: self.above(start), direction, length: f32::INFINITY }
    }

    fn shadow(&mut self, start: &Start) -> Segment {
        let offset =
            Vec3::new(self.random.uniform_f32() - 0.5, 2.0, self.random.uniform_f32() - 0.5) + Vec3::X;
        let origin = self.above(start);
        let way = self.center + offset * self.height - origin;
        Segment { origin, direction: way.normalize(), length: way.length() }
    }

    fn above(&self, start: &Start) -> Vec3 {
        start.position + start.normal * (OFFSET * self.height)
    }

    /// Segments as probes are: along the normal or, more seldom, a tangent, inside the ball of the profile's cut.
    fn probes(&mut self, starts: &[Start]) -> Vec<Segment> {
        let profile = NormalizedDiffusion::from_d(0.8, 1.0).expect("an albedo in [0, 1]");
        let scale = MEAN_FREE_PATH * self.height;
        let longest = profile.quantile(0.999) as f32 * scale;
        let mut segments = Vec::with_capacity(starts.len());
        for start in starts {
            let Frame { x, y, z } = Frame::from_normal(start.normal);
            // Two of three probes go along the normal.
            let (axis, first, second) = match (6.0 * self.random.uniform_f32()) as u32 {
                0 => (x, y, z),
                1 => (y, z, x),
                _ => (z, x, y),
            };
            let radius = profile.quantile(0.999 * f64::from(self.random.uniform_f32())) as f32 * scale;
            let (sin, cos) = self.angle().sin_cos();
            let across = first * cos + second * sin;
            let half = (longest * longest - radius * radius).max(0.0).sqrt();
            let origin = start.position + across * radius + axis * half;
            segments.push(Segment { origin, direction: -axis, length: 2.0 * half });
        }
        segments
    }

    /// Uniform in [0, 2π).
    fn angle(&mut self) -> f32 {
        std::f32::consts::TAU * self.random.uniform_f32()
    }

    /// Flights of isotropic walks that end where they meet the surface.
    fn walks(&mut self, starts: &[Start]) -> Vec<Segment> {
        let count = starts.len();
        let mut segments = Vec::with_capacity(count);
        for start in starts {
            let mut position = start.position - start.normal * (OFFSET * self.height);
            for _ in 0..MOST_FLIGHTS {
                let length = -(1.0 - self.random.uniform_f32()).ln() * MEAN_FREE_PATH * self.height;
                let (z, angle) = (2.0 * self.random.uniform_f32() - 1.0, self.angle());
                let across = (1.0 - z * z).max(0.0).sqrt();
                let direction = Vec3::new(across * angle.cos(), across * angle.sin(), z).normalize();
                segments.push(Segment { origin: position, direction, length });
                if self.geometry.closest(&Ray::segment(position, direction, length)).is_some() {
                    break;
                }
                position += direction * length;
            }
            if segments.len() >= count {
                break;
            }
        }
        segments.truncate(count);
        segments
    }
}
