//! Groups of faces that are one body.

use glam::Vec3;

use crate::weld::Corner;
use crate::winding::places;

/// Makes the numbers of bodies one where groups have a border in common: the lowest counts.
///
/// A group is the number of a body, below that of `bodies`, with triangles whose positions are in range; a body may have
/// several. A border is an edge of one triangle of the body; vertices at the same place are one.
pub(super) fn join(bodies: &mut [u32], positions: &[Vec3], mut groups: Vec<(u32, &[[Corner; 3]])>) {
    groups.sort_by_key(|(body, _)| *body);
    if groups.first().map(|group| group.0) == groups.last().map(|group| group.0) {
        return;
    }
    let mut firsts: Vec<u32> = (0..bodies.len() as u32).collect();
    for [one, other] in alike(positions, &groups) {
        let [one, other] = [one, other].map(|body| first_of(&mut firsts, body));
        firsts[one.max(other) as usize] = one.min(other);
    }
    bodies.iter_mut().for_each(|body| *body = first_of(&mut firsts, *body));
}

/// Pairs of bodies with a border in common.
fn alike(positions: &[Vec3], groups: &[(u32, &[[Corner; 3]])]) -> Vec<[u32; 2]> {
    let places = places(positions);
    let mut borders = Vec::new();
    for groups in groups.chunk_by(|a, b| a.0 == b.0) {
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for corners in groups.iter().flat_map(|(_, triangles)| *triangles) {
            let [a, b, c] = corners.map(|corner| places[corner.position as usize]);
            edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
        }
        edges.sort_unstable();
        let single = edges.chunk_by(|a, b| a == b).filter(|uses| uses.len() == 1);
        borders.extend(single.map(|uses| (uses[0], groups[0].0)));
    }
    borders.sort_unstable();
    let meeting = borders.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let mut pairs: Vec<[u32; 2]> = meeting.map(|pair| [pair[0].1, pair[1].1]).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// The lowest number of those that are one with a number; each knows a lower one, and is given one still lower.
fn first_of(firsts: &mut [u32], mut number: u32) -> u32 {
    while firsts[number as usize] != number {
        firsts[number as usize] = firsts[firsts[number as usize] as usize];
        number = firsts[number as usize];
    }
    number
}
