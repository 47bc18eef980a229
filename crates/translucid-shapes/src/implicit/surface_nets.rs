//! Triangle meshes of solids given by distance functions.
//!
//! Dual surface nets: a vertex for each piece of surface in a cell of a grid, a quadrilateral for each
//! grid edge that crosses the surface (S. F. F. Gibson, "Constrained elastic surface nets", 1998), with the
//! pieces told apart as in G. M. Nielson, "Dual marching cubes", 2004, so that thin walls stay manifold.
//!
//! ```text
//! for each block of cells that the surface can reach: evaluate its grid nodes, or note their side beside it
//! while a face has inside corners only on one diagonal: fill one of its other corners
//! for each cell with a change of sign: a vertex per piece, moved onto the surface by Newton steps
//! for each grid edge with a change of sign: two triangles between the four cells around it
//! ```

use std::sync::LazyLock;

use glam::{IVec3, Vec3};
use rayon::prelude::*;
use translucid_scene::Mesh;

/// Greatest slope of a distance function that the search for blocks allows for.
const SLOPE: f32 = 1.3;
/// Cells along the edge of a block that is evaluated as a whole.
const BLOCK: i32 = 2;
/// Cells along the edge of the blocks that the search starts with.
const COARSE: i32 = 8;
/// Cosine between the normals of a vertex and of a triangle below which they disagree.
const AGREEMENT: f32 = 0.1;
/// The mark of a node or cell that has no entry.
const NONE: u32 = u32::MAX;

/// The mesh of a solid within a box of two opposite corners, with `cells` grid cells along the box's longest side.
///
/// `distance` is a signed distance, or a function like it: negative inside, its slope at most [`SLOPE`].
pub(crate) fn mesh_solid(bounds: [Vec3; 2], distance: &(impl Fn(Vec3) -> f32 + Sync), cells: usize) -> Mesh {
    let mut nets = Nets::new(bounds, distance, cells);
    nets.evaluate_nodes();
    while nets.fill_ambiguous_faces() {}
    nets.place_vertices();
    nets.settle_vertices();
    nets.connect();
    if nets.mend_creases() {
        nets.separate_folds();
    }
    nets.mesh
}

/// A block of cells.
#[derive(Clone, Copy)]
struct Block {
    corner: IVec3,
    /// Infinite with the sign of the distances in all of the block where the surface cannot be in it, else NaN.
    side: f32,
}

/// The pieces of surface in a cell: the first vertex, and which piece each of the 12 edges belongs to.
#[derive(Clone, Copy)]
struct Pieces {
    first: u32,
    of_edge: [u8; 12],
}

/// Where a vertex begins: its cell, the mean of the crossings within it, and whether it is the only one there.
struct Start {
    cell: IVec3,
    offset: Vec3,
    alone: bool,
}

/// Surroundings of a vertex: sums over its triangles, and the least cosine between their normals and its own.
#[derive(Clone, Copy)]
struct Ring {
    corners: Vec3,
    normals: Vec3,
    count: f32,
    agreement: f32,
}

struct Nets<'a, D> {
    distance: &'a D,
    origin: Vec3,
    cell: f32,
    /// Cells along each axis.
    size: IVec3,
    /// Distances at the nodes; infinite where only the sign is needed, NaN where nothing is.
    nodes: Vec<f32>,
    /// Cells that have been looked at, in blocks.
    blocks: Vec<Block>,
    /// Index into `pieces` of each cell, or `NONE`.
    pieces_of_cell: Vec<u32>,
    pieces: Vec<Pieces>,
    starts: Vec<Start>,
    mesh: Mesh,
}

impl<'a, D: Fn(Vec3) -> f32 + Sync> Nets<'a, D> {
    fn new([low, high]: [Vec3; 2], distance: &'a D, cells: usize) -> Self {
        let cell = (high - low).max_element() / cells as f32;
        // A margin of a cell on either side, rounded up to whole blocks.
        let size = ((high - low) / cell).ceil().as_ivec3() + 2;
        let size = (size + COARSE - 1) / COARSE * COARSE;
        let origin = 0.5 * (low + high) - 0.5 * cell * size.as_vec3();
        let count = |size: IVec3| (size.x * size.y * size.z) as usize;
        Self {
            distance,
            origin,
            cell,
            size,
            nodes: vec![f32::NAN; count(size + 1)],
            blocks: Vec::new(),
            pieces_of_cell: vec![NONE; count(size)],
            pieces: Vec::new(),
            starts: Vec::new(),
            mesh: Mesh::default(),
        }
    }

    fn position(&self, node: IVec3) -> Vec3 {
        self.origin + self.cell * node.as_vec3()
    }

    fn node_index(&self, node: IVec3) -> usize {
        let size = self.size + 1;
        ((node.z * size.y + node.y) * size.x + node.x) as usize
    }

    fn cell_index(&self, cell: IVec3) -> usize {
        ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize
    }

    fn cell_at(&self, index: usize) -> IVec3 {
        let (index, size) = (index as i32, self.size);
        IVec3::new(index % size.x, index / size.x % size.y, index / size.x / size.y)
    }

    /// Evaluates the nodes of all blocks that the surface can reach.
    fn evaluate_nodes(&mut self) {
        for corner in grid(self.size / COARSE) {
            self.visit_block(corner * COARSE, COARSE);
        }
        let mut wanted = Vec::new();
        for block in 0..self.blocks.len() {
            let Block { corner, side } = self.blocks[block];
            for offset in grid(IVec3::splat(BLOCK + 1)) {
                let node = corner + offset;
                let index = self.node_index(node);
                if side.is_nan() && !self.nodes[index].is_finite() {
                    self.nodes[index] = 0.0;
                    wanted.push((index, node));
                } else if self.nodes[index].is_nan() {
                    self.nodes[index] = side;
                }
            }
        }
        let values: Vec<f32> =
            wanted.par_iter().map(|&(_, node)| (self.distance)(self.position(node))).collect();
        for ((index, _), value) in wanted.into_iter().zip(values) {
            self.nodes[index] = value;
        }
    }

    /// Keeps a block of `edge` cells, down to the least size, if the surface can reach it.
    fn visit_block(&mut self, corner: IVec3, edge: i32) {
        let center = self.position(corner) + 0.5 * edge as f32 * self.cell;
        let distance = (self.distance)(center);
        let half_diagonal = 0.5 * edge as f32 * 3.0_f32.sqrt();
        // One cell more than the block, because a node may be filled.
        if distance.abs() > SLOPE * (half_diagonal + 1.0) * self.cell {
            return;
        }
        if edge == BLOCK {
            let is_beside = distance.abs() > SLOPE * half_diagonal * self.cell;
            let side = if is_beside { f32::INFINITY.copysign(distance) } else { f32::NAN };
            self.blocks.push(Block { corner, side });
            return;
        }
        for offset in grid(IVec3::splat(2)) {
            self.visit_block(corner + offset * (edge / 2), edge / 2);
        }
    }

    /// Puts a node inside on every face whose inside corners are two opposite ones, and says whether
    /// there was any: four crossings of one face could join two cells by two edges, which is not manifold.
    fn fill_ambiguous_faces(&mut self) -> bool {
        let mut found = false;
        for block in 0..self.blocks.len() {
            for offset in grid(IVec3::splat(BLOCK)) {
                let cell = self.blocks[block].corner + offset;
                for axis in 0..3 {
                    found |= self.fill_face(cell, IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
                }
            }
        }
        found
    }

    fn fill_face(&mut self, node: IVec3, b: IVec3, c: IVec3) -> bool {
        let around = [node, node + b, node + b + c, node + c].map(|node| self.node_index(node));
        let inside = around.map(|index| self.nodes[index] < 0.0);
        if inside[0] != inside[2] || inside[1] != inside[3] || inside[0] == inside[1] {
            return false;
        }
        let outside = if inside[0] { around[1] } else { around[0] };
        self.nodes[outside] = -0.01 * self.cell;
        true
    }

    /// Distances at the corners of a cell; corner i lies at the bits of i.
    fn corners(&self, cell: IVec3) -> [f32; 8] {
        let row = self.size.x as usize + 1;
        let plane = row * (self.size.y as usize + 1);
        let nodes = &self.nodes[self.node_index(cell)..];
        std::array::from_fn(|i| nodes[(i & 1) + (i >> 1 & 1) * row + (i >> 2) * plane])
    }

    /// Distances at the corners of a cell that the surface crosses, computed where only their side was known.
    fn finite_corners(&self, cell: IVec3, corners: [f32; 8]) -> [f32; 8] {
        std::array::from_fn(|i| {
            let is_known = corners[i].is_finite();
            if is_known { corners[i] } else { (self.distance)(self.position(cell + corner_offset(i))) }
        })
    }

    /// Makes the vertices of every cell that the surface crosses.
    fn place_vertices(&mut self) {
        for block in std::mem::take(&mut self.blocks) {
            for offset in grid(IVec3::splat(BLOCK)) {
                let cell = block.corner + offset;
                let corners = self.corners(cell);
                let inside = (0..8).fold(0u8, |bits, i| bits | (u8::from(corners[i] < 0.0) << i));
                if inside != 0 && inside != 0xff {
                    self.place_cell(cell, &self.finite_corners(cell, corners), inside);
                }
            }
        }
    }

    fn place_cell(&mut self, cell: IVec3, corners: &[f32; 8], inside: u8) {
        let of_edge = PIECES_OF_EDGES[usize::from(inside)];
        let first = self.starts.len() as u32;
        let index = self.cell_index(cell);
        self.pieces_of_cell[index] = self.pieces.len() as u32;
        self.pieces.push(Pieces { first, of_edge });
        for piece in 0.. {
            let crossings =
                (0..12).filter(|&edge| of_edge[edge] == piece).map(|edge| crossing(corners, edge));
            let (sum, count) = crossings.fold((Vec3::ZERO, 0.0), |(sum, count), p| (sum + p, count + 1.0));
            if count == 0.0 {
                break;
            }
            // Two pieces in a cell must not be moved into one place.
            let alone = of_edge.iter().all(|&other| other == piece || other == 12);
            self.starts.push(Start { cell, offset: sum / count, alone });
        }
    }

    /// Moves all vertices onto the surface.
    fn settle_vertices(&mut self) {
        let settled: Vec<(Vec3, Vec3)> = self.starts.par_iter().map(|start| self.settled(start)).collect();
        (self.mesh.positions, self.mesh.normals) = settled.into_iter().unzip();
    }

    fn settled(&self, start: &Start) -> (Vec3, Vec3) {
        let low = self.position(start.cell);
        let guess = low + self.cell * start.offset;
        let (settled, normal) = self.settle(low, guess);
        (if start.alone { settled } else { guess }, normal)
    }

    /// Moves a point onto the surface by two Newton steps without leaving its cell, and gives the normal.
    fn settle(&self, low: Vec3, mut p: Vec3) -> (Vec3, Vec3) {
        let mut normal = Vec3::Y;
        for _ in 0..2 {
            let (distance, gradient) = self.distance_and_gradient(p);
            normal = gradient.normalize_or(Vec3::Y);
            let step = distance / gradient.length().max(0.3);
            p = (p - step * normal).clamp(low + 0.02 * self.cell, low + 0.98 * self.cell);
        }
        (p, normal)
    }

    /// Distance and gradient from the values at the corners of a small tetrahedron.
    fn distance_and_gradient(&self, p: Vec3) -> (f32, Vec3) {
        let step = 0.25 * self.cell;
        let corners =
            [Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::ONE];
        let values = corners.map(|corner| (self.distance)(p + step * corner));
        let gradient =
            corners.iter().zip(values).map(|(&corner, value)| corner * value).sum::<Vec3>() / (4.0 * step);
        (0.25 * values.iter().sum::<f32>(), gradient)
    }

    /// Connects the vertices around each grid edge that crosses the surface.
    fn connect(&mut self) {
        for index in 0..self.pieces_of_cell.len() {
            if self.pieces_of_cell[index] == NONE {
                continue;
            }
            let cell = self.cell_at(index);
            let inside = self.nodes[self.node_index(cell)] < 0.0;
            for axis in 0..3 {
                let end = self.nodes[self.node_index(cell + IVec3::AXES[axis])] < 0.0;
                if inside != end {
                    self.connect_edge(cell, axis, inside);
                }
            }
        }
    }

    fn connect_edge(&mut self, cell: IVec3, axis: usize, inside: bool) {
        let (b, c) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
        // Counter-clockwise about the axis; the edge's place within each cell follows from the offset.
        let around = [(cell - b - c, 3), (cell - c, 2), (cell, 0), (cell - b, 1)];
        let mut quad = around.map(|(cell, place)| self.vertex(cell, 4 * axis + place));
        if !inside {
            quad.reverse();
        }
        let [p, q, r, s] = quad.map(|vertex| self.mesh.positions[vertex as usize]);
        let [a, b, c, d] = quad;
        if p.distance_squared(r) < q.distance_squared(s) {
            self.mesh.triangles.extend([[a, b, c], [a, c, d]]);
        } else {
            self.mesh.triangles.extend([[a, b, d], [b, c, d]]);
        }
    }

    /// Vertex of the piece of surface in `cell` that crosses one of its edges.
    fn vertex(&self, cell: IVec3, edge: usize) -> u32 {
        let pieces = self.pieces_of_cell[self.cell_index(cell)];
        debug_assert!(pieces != NONE, "a distance function is steeper than {SLOPE}");
        let pieces = self.pieces[pieces as usize];
        pieces.first + u32::from(pieces.of_edge[edge])
    }

    /// Where a crease is finer than a cell the gradient can point away from a triangle: move such
    /// vertices to the mean of their neighbors, with the mean of their triangles' normals.
    ///
    /// Returns whether there may be triangles left that disagree with a normal.
    fn mend_creases(&mut self) -> bool {
        for _ in 0..3 {
            if !self.any_disagrees() {
                return false;
            }
            let rings = self.rings();
            let Mesh { positions, normals, .. } = &mut self.mesh;
            for ((position, normal), ring) in positions.iter_mut().zip(normals).zip(rings) {
                if ring.agreement < AGREEMENT {
                    *position = ring.corners / ring.count;
                    *normal = ring.normals.normalize_or(*normal);
                }
            }
        }
        true
    }

    /// Whether any vertex has a normal that a triangle there disagrees with.
    fn any_disagrees(&self) -> bool {
        let Mesh { positions, normals, triangles, .. } = &self.mesh;
        triangles.par_iter().any(|triangle| {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let flat = (b - a).cross(c - a).normalize_or_zero();
            triangle.iter().any(|&vertex| flat.dot(normals[vertex as usize]) < AGREEMENT)
        })
    }

    /// Gives triangles that still disagree with a normal vertices of their own.
    fn separate_folds(&mut self) {
        let Mesh { positions, normals, triangles, .. } = &mut self.mesh;
        for triangle in triangles {
            let corners = triangle.map(|vertex| positions[vertex as usize]);
            let [a, b, c] = corners;
            let flat = (b - a).cross(c - a).normalize_or_zero();
            if triangle.iter().any(|&vertex| flat.dot(normals[vertex as usize]) < 0.01) {
                let first = positions.len() as u32;
                positions.extend(corners);
                normals.extend([flat; 3]);
                *triangle = [first, first + 1, first + 2];
            }
        }
    }

    fn rings(&self) -> Vec<Ring> {
        let Mesh { positions, normals, triangles, .. } = &self.mesh;
        let mut rings = vec![
            Ring { corners: Vec3::ZERO, normals: Vec3::ZERO, count: 0.0, agreement: 1.0 };
            positions.len()
        ];
        for triangle in triangles {
            let corners = triangle.map(|vertex| positions[vertex as usize]);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for (k, vertex) in triangle.iter().enumerate() {
                let ring = &mut rings[*vertex as usize];
                ring.corners += corners[(k + 1) % 3] + corners[(k + 2) % 3];
                ring.count += 2.0;
                ring.normals += normal;
                ring.agreement = ring.agreement.min(normal.dot(normals[*vertex as usize]));
            }
        }
        rings
    }
}

/// All points of a grid, x fastest.
fn grid(size: IVec3) -> impl Iterator<Item = IVec3> {
    (0..size.z)
        .flat_map(move |z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec3::new(x, y, z))))
}

fn corner_offset(corner: usize) -> IVec3 {
    IVec3::new(corner as i32 & 1, corner as i32 >> 1 & 1, corner as i32 >> 2 & 1)
}

/// Corner at the lower end of edge `4 axis + place`, and the bit of its axis.
fn edge_corners(edge: usize) -> [usize; 2] {
    let (axis, place) = (edge / 4, edge % 4);
    let low = (place & 1) << ((axis + 1) % 3) | (place >> 1) << ((axis + 2) % 3);
    [low, low | 1 << axis]
}

/// Where an edge crosses the surface, in cell coordinates; the middle if it does not.
fn crossing(corners: &[f32; 8], edge: usize) -> Vec3 {
    let [a, b] = edge_corners(edge);
    let slope = corners[a] - corners[b];
    let t = if slope == 0.0 { 0.5 } else { (corners[a] / slope).clamp(0.0, 1.0) };
    corner_offset(a).as_vec3().lerp(corner_offset(b).as_vec3(), t)
}

/// [`pieces_of_edges`] by the corners that lie inside.
static PIECES_OF_EDGES: LazyLock<[[u8; 12]; 256]> =
    LazyLock::new(|| std::array::from_fn(|inside| pieces_of_edges(inside as u8)));

/// Number of the surface piece that each edge of a cell belongs to; 12 for edges without crossing.
///
/// No face is ambiguous any more, so a face with crossings has two, and they are of one piece.
fn pieces_of_edges(inside: u8) -> [u8; 12] {
    let is_inside = |corner: usize| inside >> corner & 1 == 1;
    let crosses = |edge: usize| {
        edge_corners(edge).map(is_inside) == [true, false]
            || edge_corners(edge).map(is_inside) == [false, true]
    };
    let mut label: [u8; 12] = std::array::from_fn(|edge| if crosses(edge) { edge as u8 } else { 12 });
    let mut join = |a: usize, b: usize| {
        let (keep, drop) = (label[a].min(label[b]), label[a].max(label[b]));
        label.iter_mut().filter(|entry| **entry == drop).for_each(|entry| *entry = keep);
    };
    for face in 0..6 {
        let edges = face_edges(face);
        let crossing: Vec<usize> = edges.iter().copied().filter(|&edge| crosses(edge)).collect();
        if let [a, b] = crossing[..] {
            join(a, b);
        }
    }
    number_from_zero(label)
}

/// The four edges of a face, in order around it; faces 0, 1 are low and high x, and so on.
fn face_edges(face: usize) -> [usize; 4] {
    let (axis, side) = (face / 2, face % 2);
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    // An edge along b has its place bits from c (first) and axis (second); one along c from axis and b.
    let along_b = |at_c: usize| 4 * b + (at_c | side << 1);
    let along_c = |at_b: usize| 4 * c + (side | at_b << 1);
    [along_b(0), along_c(1), along_b(1), along_c(0)]
}

fn number_from_zero(label: [u8; 12]) -> [u8; 12] {
    let mut seen = Vec::new();
    label.map(|entry| {
        if entry == 12 {
            return 12;
        }
        let known = seen.iter().position(|&other| other == entry);
        known.unwrap_or_else(|| {
            seen.push(entry);
            seen.len() - 1
        }) as u8
    })
}
