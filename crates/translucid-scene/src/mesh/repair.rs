//! Makes a mesh from a file valid, and says what it took.

use std::collections::HashSet;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::check::{LARGEST_COORDINATE, has_area, is_color};
use super::{Mesh, Triangle};
use crate::{Place, SceneError, Warning};

/// Makes a mesh valid: see [`Mesh`].
///
/// - An attribute array of the wrong length is left out.
/// - A triangle is left out if an index is out of range, a vertex is not finite or beyond ±10⁹, or its
///   area is zero (or its height below 10⁻⁶ of its longest edge).
/// - A vertex that no triangle uses is left out without a word.
/// - Where triangles are eight times as many as vertices, one that is there already is left out.
/// - A texture coordinate that is not finite becomes 0, and so does a channel of a color that is not in [0, 10⁶].
/// - A normal that is zero or not finite is replaced by the smooth one
///   ([`Mesh::smooth_normals`]), the others are made unit; if tangents are broken, all are left out.
///
/// Each kind of repair adds one warning with its count, but a few triangles of zero area: they are no surface, and meshes
/// of revolution have them at their poles.
///
/// # Errors
/// No triangle is left.
pub fn repair_mesh(mesh: &mut Mesh, place: &Place, warnings: &mut Vec<Warning>) -> Result<(), SceneError> {
    if mesh.triangles.is_empty() {
        return Err(SceneError::at(place.clone(), "the mesh has no triangles"));
    }
    let mut report = Report { place, warnings };
    drop_misfit_attributes(mesh, &mut report);
    let found = mesh.triangles.len();
    drop_bad_triangles(mesh, &mut report);
    if mesh.triangles.is_empty() {
        let message = format!("none of the mesh's {found} triangles can be used: {}", report.last());
        return Err(SceneError::at(place.clone(), message));
    }
    drop_unused_vertices(mesh);
    drop_repeated_triangles(mesh, &mut report);
    mend_uvs_and_colors(mesh, &mut report);
    mend_normals(mesh, &mut report);
    drop_bad_tangents(mesh, &mut report);
    Ok(())
}

/// Where repairs are written down.
struct Report<'a> {
    place: &'a Place,
    warnings: &'a mut Vec<Warning>,
}

impl Report<'_> {
    fn add(&mut self, message: String) {
        self.warnings.push(Warning { message, place: Some(self.place.clone()) });
    }

    /// One warning for `count` things of a kind, none for zero; the kind goes on after "thing" or "things".
    fn count(&mut self, count: usize, thing: &str, kind: &str, what_was_done: &str) {
        match count {
            0 => (),
            1 => self.add(format!("1 {thing} {kind}: {what_was_done}")),
            _ => self.add(format!("{count} {thing}s {kind}: {what_was_done}")),
        }
    }

    fn last(&self) -> &str {
        self.warnings.last().map_or("", |warning| &warning.message)
    }
}

fn drop_misfit_attributes(mesh: &mut Mesh, report: &mut Report<'_>) {
    fn fit<T>(values: &mut Vec<T>, vertices: usize, what: &str, report: &mut Report<'_>) {
        let length = values.len();
        if length != 0 && length != vertices {
            report.add(format!("{length} {what} for {vertices} vertices: {what} left out"));
            *values = Vec::new();
        }
    }
    let vertices = mesh.positions.len();
    fit(&mut mesh.normals, vertices, "normals", report);
    fit(&mut mesh.uvs, vertices, "texture coordinates", report);
    fit(&mut mesh.tangents, vertices, "tangents", report);
    fit(&mut mesh.colors, vertices, "vertex colors", report);
}

/// Faults of triangles.
const FAULTS: [&str; 3] = [ZERO_AREA, BAD_VERTEX, OUT_OF_RANGE];
const ZERO_AREA: &str = "of zero area";

/// Share of triangles of zero area that means nothing.
const USUAL_ZERO_AREA: f64 = 0.05;

const BAD_VERTEX: &str = "with a vertex that is NaN, infinite or beyond ±1e9";
const OUT_OF_RANGE: &str = "with an index out of range";

/// Why a triangle cannot be used, one of [`FAULTS`].
fn fault(mesh: &Mesh, triangle: &Triangle) -> Option<&'static str> {
    let Some(corners) = mesh.corners(triangle) else { return Some(OUT_OF_RANGE) };
    let usable = |p: DVec3| p.is_finite() && p.abs().max_element() <= f64::from(LARGEST_COORDINATE);
    match corners {
        _ if !corners.into_iter().all(usable) => Some(BAD_VERTEX),
        _ if !has_area(corners) => Some(ZERO_AREA),
        _ => None,
    }
}

fn drop_bad_triangles(mesh: &mut Mesh, report: &mut Report<'_>) {
    let mut faults = Vec::new();
    let mut triangles = std::mem::take(&mut mesh.triangles);
    triangles.retain(|triangle| {
        let fault = fault(mesh, triangle);
        faults.extend(fault);
        fault.is_none()
    });
    mesh.triangles = triangles;
    let found = mesh.triangles.len() + faults.len();
    for kind in FAULTS {
        let count = faults.iter().filter(|&&fault| fault == kind).count();
        if kind != ZERO_AREA || count as f64 > USUAL_ZERO_AREA * found as f64 {
            report.count(count, "triangle", kind, "left out");
        }
    }
}

/// Triangles per vertex beyond which some must be there again and again: a closed surface has two.
const MOST_PER_VERTEX: usize = 8;

/// Leaves out triangles that are there already. Thousands at one place would take a ray as much longer.
fn drop_repeated_triangles(mesh: &mut Mesh, report: &mut Report<'_>) {
    let found = mesh.triangles.len();
    if found <= MOST_PER_VERTEX * mesh.positions.len() {
        return;
    }
    let mut known = HashSet::new();
    mesh.triangles.retain(|&[a, b, c]| {
        // The same corners in the same order, from the least on
        known.insert(if a < b.min(c) {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        })
    });
    let repeated = found - mesh.triangles.len();
    report.count(repeated, "triangle", "as before, at the same corners", "left out");
}

fn drop_unused_vertices(mesh: &mut Mesh) {
    let mut used = vec![false; mesh.positions.len()];
    for &vertex in mesh.triangles.iter().flatten() {
        used[vertex as usize] = true;
    }
    if used.iter().all(|&used| used) {
        return;
    }
    let mut new_index = Vec::with_capacity(used.len());
    let mut next = 0;
    for &used in &used {
        new_index.push(next);
        next += u32::from(used);
    }
    for vertex in mesh.triangles.iter_mut().flatten() {
        *vertex = new_index[*vertex as usize];
    }
    keep(&mut mesh.positions, &used);
    keep(&mut mesh.normals, &used);
    keep(&mut mesh.uvs, &used);
    keep(&mut mesh.tangents, &used);
    keep(&mut mesh.colors, &used);
}

/// Keeps the values whose flag is set.
fn keep<T>(values: &mut Vec<T>, flags: &[bool]) {
    let mut flags = flags.iter();
    values.retain(|_| flags.next().is_some_and(|&flag| flag));
}

fn mend_uvs_and_colors(mesh: &mut Mesh, report: &mut Report<'_>) {
    let bad_uv = |uv: &&mut Vec2| !uv.is_finite();
    let uvs = mesh.uvs.iter_mut().filter(bad_uv).map(|uv| *uv = Vec2::ZERO).count();
    report.count(uvs, "texture coordinate", "with a NaN or infinity", "set to 0");
    let bad_color = |color: &&mut Vec3| !is_color(color);
    let mend = |color: &mut Vec3| *color = color.map(|c| if is_color(&Vec3::splat(c)) { c } else { 0.0 });
    let colors = mesh.colors.iter_mut().filter(bad_color).map(mend).count();
    report.count(colors, "vertex color", "outside [0, 1e6]", "bad channels set to 0");
}

fn mend_normals(mesh: &mut Mesh, report: &mut Report<'_>) {
    let mut broken = Vec::new();
    for (vertex, normal) in mesh.normals.iter_mut().enumerate() {
        match normal.try_normalize() {
            Some(unit) => *normal = unit,
            None => broken.push(vertex),
        }
    }
    if broken.is_empty() {
        return;
    }
    let smooth = mesh.smooth_normals();
    for &vertex in &broken {
        mesh.normals[vertex] = smooth[vertex];
    }
    report.count(broken.len(), "normal", "without a direction", "computed from the triangles around");
}

fn drop_bad_tangents(mesh: &mut Mesh, report: &mut Report<'_>) {
    let mend = |tangent: &Vec4| {
        let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
        tangent.is_finite().then(|| tangent.truncate().try_normalize())?.map(|unit| unit.extend(sign))
    };
    let broken = mesh.tangents.iter().filter(|tangent| mend(tangent).is_none()).count();
    if broken > 0 {
        mesh.tangents = Vec::new();
    }
    for tangent in &mut mesh.tangents {
        *tangent = mend(tangent).unwrap_or(Vec4::new(1.0, 0.0, 0.0, 1.0));
    }
    let what_was_done = "all tangents left out, to be derived from texture coordinates";
    report.count(broken, "tangent", "without a direction", what_was_done);
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn place() -> Place {
        Place::file(Path::new("broken.ply"))
    }

    /// Two triangles of a unit square, with every attribute.
    fn square() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4],
            colors: vec![Vec3::ONE; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// The mesh after repair, and the warnings as one text.
    fn repaired(mut mesh: Mesh) -> (Mesh, String) {
        let mut warnings = Vec::new();
        repair_mesh(&mut mesh, &place(), &mut warnings).expect("something is left");
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        (mesh, lines.join("\n"))
    }

    fn refusal(mut mesh: Mesh) -> String {
        repair_mesh(&mut mesh, &place(), &mut Vec::new()).expect_err("nothing is left").to_string()
    }

    #[test]
    fn repair_leaves_a_valid_mesh_alone() {
        assert_eq!(repaired(square()), (square(), String::new()));
    }

    #[test]
    fn repair_drops_and_counts_bad_triangles() {
        let mut mesh = square();
        mesh.positions.extend([Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY), Vec3::splat(1e10)]);
        mesh.positions.extend([Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.5, 0.0, 1e-9)]);
        mesh.normals.resize(9, Vec3::Z);
        mesh.uvs.resize(9, Vec2::ZERO);
        mesh.tangents.resize(9, Vec4::new(1.0, 0.0, 0.0, 1.0));
        mesh.colors.resize(9, Vec3::ONE);
        let bad = [[0, 1, 9], [0, 1, u32::MAX], [0, 1, 4], [1, 2, 5], [2, 3, 6]];
        mesh.triangles.splice(1..1, bad);
        mesh.triangles.extend([[0, 0, 1], [0, 7, 2], [0, 8, 1], [3, 3, 3]]);
        let (mended, warnings) = repaired(mesh);
        assert_eq!(mended, square());
        assert!(warnings.contains("broken.ply: 4 triangles of zero area: left out"), "{warnings}");
        assert!(warnings.contains("3 triangles with a vertex that is NaN"), "{warnings}");
        assert!(warnings.contains("2 triangles with an index out of range"), "{warnings}");
    }

    #[test]
    fn repair_says_nothing_of_a_few_triangles_of_zero_area() {
        for (good, is_said) in [(18, true), (40, false)] {
            let positions = [Vec3::ZERO, Vec3::X, Vec3::Y].repeat(good);
            let triangles = (0..good as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
            let triangles = triangles.chain([[0, 0, 1]]).collect();
            let (mended, warnings) = repaired(Mesh { positions, triangles, ..Mesh::default() });
            assert_eq!(mended.triangles.len(), good);
            assert_eq!(warnings.contains("1 triangle of zero area"), is_said, "{warnings}");
        }
    }

    #[test]
    fn repair_drops_triangles_that_are_there_again_and_again() {
        let mut mesh = square();
        let few = mesh.triangles.clone();
        mesh.triangles = [vec![[2, 0, 1], [1, 0, 2]], few.repeat(20)].concat();
        let (mended, warnings) = repaired(mesh);
        assert_eq!(mended.triangles, [[2, 0, 1], [1, 0, 2], [0, 2, 3]]);
        assert!(warnings.contains("39 triangles as before, at the same corners"), "{warnings}");
    }

    #[test]
    fn repair_refuses_an_empty_mesh_and_says_why() {
        let empty = Mesh { triangles: Vec::new(), ..square() };
        assert_eq!(refusal(empty), "broken.ply: the mesh has no triangles");
        let message = refusal(Mesh { triangles: vec![[0, 1, 7]], ..square() });
        assert!(message.contains("none of the mesh's 1 triangles can be used"), "{message}");
        assert!(message.contains("index out of range"), "{message}");
    }

    #[test]
    fn repair_drops_attributes_of_the_wrong_length() {
        let mut mesh = square();
        mesh.normals.pop();
        mesh.uvs.push(Vec2::ZERO);
        mesh.tangents.pop();
        mesh.colors.pop();
        let (mended, warnings) = repaired(mesh);
        assert!(mended.normals.is_empty() && mended.uvs.is_empty());
        assert!(mended.tangents.is_empty() && mended.colors.is_empty());
        assert!(warnings.contains("5 texture coordinates for 4 vertices"), "{warnings}");
        assert_eq!(warnings.lines().count(), 4);
    }

    #[test]
    fn repair_mends_attributes() {
        let mut mesh = square();
        mesh.normals[0] = Vec3::ZERO;
        mesh.normals[1] = Vec3::NAN;
        mesh.normals[2] = Vec3::new(0.0, 0.0, 2.0);
        mesh.uvs[3].y = f32::INFINITY;
        mesh.tangents[1] = Vec4::ZERO;
        mesh.colors[0] = Vec3::new(f32::NAN, -1.0, 0.5);
        let (mended, warnings) = repaired(mesh);
        assert_eq!(mended.normals, square().normals);
        assert_eq!(mended.uvs[3], Vec2::ZERO);
        assert!(mended.tangents.is_empty());
        assert_eq!(mended.colors[0], Vec3::new(0.0, 0.0, 0.5));
        for part in ["2 normals", "1 texture coordinate", "1 tangent", "1 vertex color"] {
            assert!(warnings.contains(part), "{part} in {warnings}");
        }
    }

    #[test]
    fn repair_keeps_tiny_and_large_meshes_whose_cross_products_f32_can_square() {
        for scale in [1e-8, 1e8] {
            let mut mesh = square();
            mesh.positions.iter_mut().for_each(|p| *p *= scale);
            let (mended, warnings) = repaired(mesh);
            assert_eq!(warnings, "", "{scale}");
            let [a, b, c] = [0, 1, 2].map(|corner| mended.positions[corner]);
            let cross = (b - a).cross(c - a).length_squared();
            assert!(cross.is_normal(), "{cross}");
        }
    }
}
