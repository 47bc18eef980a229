//! Makes a mesh from a file valid, and says what it took.

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
/// - A texture coordinate that is not finite becomes 0, and so does a channel of a color that is not in [0, 10⁶].
/// - A normal that is zero or not finite is replaced by the smooth one
///   ([`Mesh::smooth_normals`]), the others are made unit; if tangents are broken, all are left out.
///
/// Each kind of repair adds one warning with its count.
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

    /// One warning for `count` things of a kind, none for zero.
    fn count(&mut self, count: usize, [one, many]: [&str; 2], what_was_done: &str) {
        match count {
            0 => (),
            1 => self.add(format!("1 {one}: {what_was_done}")),
            _ => self.add(format!("{count} {many}: {what_was_done}")),
        }
    }

    fn last(&self) -> &str {
        self.warnings.last().map_or("", |warning| &warning.message)
    }
}

fn drop_misfit_attributes(mesh: &mut Mesh, report: &mut Report<'_>) {
    let vertices = mesh.positions.len();
    let mut check = |length: usize, what: &str| {
        let misfit = length != 0 && length != vertices;
        if misfit {
            report.add(format!("{length} {what} for {vertices} vertices: {what} left out"));
        }
        misfit
    };
    if check(mesh.normals.len(), "normals") {
        mesh.normals = Vec::new();
    }
    if check(mesh.uvs.len(), "texture coordinates") {
        mesh.uvs = Vec::new();
    }
    if check(mesh.tangents.len(), "tangents") {
        mesh.tangents = Vec::new();
    }
    if check(mesh.colors.len(), "vertex colors") {
        mesh.colors = Vec::new();
    }
}

/// Why a triangle cannot be used.
enum Fault {
    OutOfRange,
    BadVertex,
    ZeroArea,
}

fn fault(mesh: &Mesh, triangle: &Triangle) -> Option<Fault> {
    let Some(corners) = mesh.corners(triangle) else { return Some(Fault::OutOfRange) };
    let usable = |p: DVec3| p.is_finite() && p.abs().max_element() <= f64::from(LARGEST_COORDINATE);
    if !corners.into_iter().all(usable) {
        Some(Fault::BadVertex)
    } else if !has_area(corners) {
        Some(Fault::ZeroArea)
    } else {
        None
    }
}

fn drop_bad_triangles(mesh: &mut Mesh, report: &mut Report<'_>) {
    let [mut out_of_range, mut bad_vertex, mut zero_area] = [0; 3];
    let mut triangles = std::mem::take(&mut mesh.triangles);
    triangles.retain(|triangle| {
        let fault = fault(mesh, triangle);
        match &fault {
            None => (),
            Some(Fault::OutOfRange) => out_of_range += 1,
            Some(Fault::BadVertex) => bad_vertex += 1,
            Some(Fault::ZeroArea) => zero_area += 1,
        }
        fault.is_none()
    });
    mesh.triangles = triangles;
    let vertices = mesh.positions.len();
    report.count(zero_area, ["triangle of zero area", "triangles of zero area"], "left out");
    report.count(
        bad_vertex,
        [
            "triangle with a vertex that is NaN, infinite or beyond ±1e9",
            "triangles with a vertex that is NaN, infinite or beyond ±1e9",
        ],
        "left out",
    );
    report.count(
        out_of_range,
        ["triangle with an index out of range", "triangles with an index out of range"],
        &format!("left out (the mesh has {vertices} vertices)"),
    );
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
    report.count(uvs, ["texture coordinate is not finite", "texture coordinates are not finite"], "set to 0");
    let bad_color = |color: &&mut Vec3| !is_color(color);
    let mend = |color: &mut Vec3| *color = color.map(|c| if is_color(&Vec3::splat(c)) { c } else { 0.0 });
    let colors = mesh.colors.iter_mut().filter(bad_color).map(mend).count();
    report.count(
        colors,
        ["vertex color is not in [0, 1e6]", "vertex colors are not in [0, 1e6]"],
        "bad channels set to 0",
    );
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
    report.count(
        broken.len(),
        ["normal is zero or not finite", "normals are zero or not finite"],
        "computed from the triangles around",
    );
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
    report.count(
        broken,
        ["tangent is zero or not finite", "tangents are zero or not finite"],
        "all tangents left out, to be derived from texture coordinates",
    );
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
