//! The lights of a scene as words. Whole numbers among floating-point ones are stated as such, which hold them exactly.
//!
//! ```text
//! tables   0 number of placed lights, 1 of emissive triangles, 2 how one is selected: by power, weighed one by one, by a tree,
//!          3 number of lights at infinity that rays meet, 4 where their numbers begin,
//!          5 number of lights with a surface, 6 where their numbers begin,
//!          7 number of the environment plus 1 (0: none), 8 whether the camera sees it, 9 where triangles begin,
//!          10 where the numbers of lights beside the tree begin, 11 how many these are, 12 where the tree's lanes begin,
//!          13 where each light's lane begins (−1 − place of those beside the tree), 14 where each node's lane begins
//!          then the placed lights, those numbers, the tables of the environment's image, the triangles, and the tree
//! images   where lights are selected by power, a choice among all of them by power;
//!          of the environment's image a choice of a row of cells, one of a cell for each row, and the texels (red, green, blue)
//!
//! light    0 kind, 1 whether the camera sees it, 2 shape:
//!          rectangle, ellipse   2 radiance, 5 corner, 8 and 11 unit vectors along the edges, 14 normal, 17 size
//!          sky                  2 radiance
//!          image                5 where its tables begin
//!          others               2 the fields of `SphereLight`, `SpotLight`, `BeamLight` or `DistantLight`
//! image    0 width, 1 height, 2 columns and 3 rows of cells, 4 width and 5 height of a cell in pixels,
//!          6 environment from world, row by row, 15 irradiances of +x, −x, +y, −y, +z, −z,
//!          21 where texels begin, 22 where the choice of a row begins, 23 where those of cells begin,
//!          then sin² and cos² of half the polar angle for each edge of a row, then for each row its solid angle
//! triangle corners, mean radiance, and where its emission varies its number among the scene's triangles, else −1
//! choice   for each entry and behind the last 2³¹ × the probability of those before it
//! ```
//!
//! Places count from the first word of the lights.

use std::f64::consts::TAU;
use std::ops::Range;

use glam::{Mat3, Vec3};
use translucid_law::Words;
use translucid_scene::SceneError;

use crate::light::{
    EnvironmentMap, LANE_WORDS, LightSet, LightTree, MOST_WEIGHED, PlacedLight, Rectangle, Sky,
};
use crate::render::PreparedScene;

/// Words of the head, of a placed light, of a triangle and of an image.
const HEADER: usize = 15;
const LIGHT_WORDS: usize = 19;
const TRIANGLE_WORDS: usize = 13;
const MAP_HEADER: usize = 24;
/// Word of the head that states where triangles begin.
const TRIANGLES_AT: usize = 9;

/// Kinds of placed lights.
const RECTANGLE: usize = 0;
const ELLIPSE: usize = 1;
const SPHERE: usize = 2;
const SPOT: usize = 3;
const BEAM: usize = 4;
const DISTANT: usize = 5;
const DISC: usize = 6;
const SKY: usize = 7;
const MAP: usize = 8;

/// These constants by their names in the shaders.
pub(super) const LIGHT_CONSTANTS: [(&str, usize); 16] = [
    ("LIGHT_HEADER", HEADER),
    ("LIGHT_WORDS", LIGHT_WORDS),
    ("LIGHT_TRIANGLE_WORDS", TRIANGLE_WORDS),
    ("MAP_HEADER", MAP_HEADER),
    ("MOST_WEIGHED", MOST_WEIGHED),
    ("BY_POWER", BY_POWER),
    ("BY_TREE", BY_TREE),
    ("TREE_LANE", LANE_WORDS),
    ("LIGHT_RECTANGLE", RECTANGLE),
    ("LIGHT_ELLIPSE", ELLIPSE),
    ("LIGHT_SPHERE", SPHERE),
    ("LIGHT_SPOT", SPOT),
    ("LIGHT_BEAM", BEAM),
    ("LIGHT_DISC", DISC),
    ("LIGHT_SKY", SKY),
    ("LIGHT_MAP", MAP),
];

/// Ways to select a light.
const BY_POWER: usize = 0;
const WEIGHED: usize = 1;
const BY_TREE: usize = 2;

/// Largest light tree: its words have places that single precision tells apart.
const MOST_TREE_WORDS: usize = 1 << 22;

/// Lights with a surface, and lights at infinity, are tried one by one.
const MOST_TRIED: usize = 4096;

/// The lights of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightWords {
    /// Words that stand somewhere among the device's tables.
    pub tables: Vec<f32>,
    /// Words that stand first among its images.
    pub images: Vec<u32>,
    /// Scene-wide numbers of the emissive triangles in rising order.
    primitives: Vec<u64>,
}

impl LightWords {
    /// The number of a triangle among the emissive ones, given its scene-wide number; `None` if it emits nothing.
    pub fn triangle(&self, primitive: u64) -> Option<u32> {
        self.primitives.binary_search(&primitive).ok().map(|number| number as u32)
    }

    /// Returns `true` if one of these scene-wide numbers is that of an emissive triangle.
    pub(super) fn are_in(&self, primitives: Range<u64>) -> bool {
        let at = self.primitives.partition_point(|&primitive| primitive < primitives.start);
        self.primitives.get(at).is_some_and(|&primitive| primitive < primitives.end)
    }

    /// Has the emission of a triangle of a number looked up on its surface, which is that of another among the scene's.
    pub(super) fn look_up(&mut self, number: u32, place: usize) {
        let last = self.tables[TRIANGLES_AT] as usize + (number as usize + 1) * TRIANGLE_WORDS - 1;
        self.tables[last] = place as f32;
    }
}

/// The lights of a prepared scene as words.
///
/// # Errors
/// There are too many lights with a surface, or too many at infinity.
pub fn lights(prepared: &PreparedScene) -> Result<LightWords, SceneError> {
    of_set(light_set(prepared))
}

/// The lights of a prepared scene, as the processor samples them.
pub fn light_set(prepared: &PreparedScene) -> &LightSet {
    prepared.lights()
}

fn of_set(set: &LightSet) -> Result<LightWords, SceneError> {
    let (sources, triangles) = (&set.emitters.sources, &set.emitters.triangles);
    let surfaces: Vec<usize> = (0..sources.len()).filter(|&light| sources[light].is_surface()).collect();
    for (count, what) in [(surfaces.len(), "with a surface"), (set.infinite.len(), "at infinity")] {
        if count > MOST_TRIED {
            let message = format!("the scene has {count} lights {what}, but devices take up to {MOST_TRIED}");
            return Err(SceneError::new(message));
        }
    }
    let tree = set.selection.tree().filter(|(tree, apart)| {
        apart.len() <= MOST_WEIGHED && tree.lane_count() * LANE_WORDS <= MOST_TREE_WORDS
    });
    let way = if set.emitters.len() <= MOST_WEIGHED { WEIGHED } else { tree.map_or(BY_POWER, |_| BY_TREE) };
    let mut images = Vec::new();
    if way == BY_POWER {
        let power = |light| f64::from(set.emitters.power(light, set.cross_section));
        images.extend(choice(&(0..set.emitters.len()).map(power).collect::<Vec<_>>()));
    }

    let mut tables = vec![0.0; HEADER];
    for source in sources {
        let start = tables.len();
        tables.extend(placed(source));
        tables.resize(start + LIGHT_WORDS, 0.0);
    }
    let infinite_at = tables.len();
    tables.extend(set.infinite.iter().map(|&light| number(light)));
    let surfaces_at = tables.len();
    tables.extend(surfaces.iter().map(|&light| number(light)));
    for (light, source) in sources.iter().enumerate() {
        if let Some(map) = map_of(source) {
            tables[HEADER + light * LIGHT_WORDS + 5] = number(tables.len());
            push_map(map, &mut tables, &mut images);
        }
    }
    let triangles_at = tables.len();
    for triangle in triangles {
        let words = triangle.vertices.into_iter().chain([triangle.radiance]);
        tables.extend(words.flat_map(|vector| vector.to_array()));
        tables.push(-1.0);
    }
    let mut tree_places = [0.0; 5];
    if let (BY_TREE, Some((tree, apart))) = (way, tree) {
        tree_places = push_tree(tree, apart, &mut tables);
    }
    let header = [
        number(sources.len()),
        number(triangles.len()),
        number(way),
        number(set.infinite.len()),
        number(infinite_at),
        number(surfaces.len()),
        number(surfaces_at),
        number(set.environment.map_or(0, |light| light + 1)),
        flag(set.environment_visible()),
        number(triangles_at),
    ];
    tables[..HEADER].copy_from_slice(&words(&[&header, &tree_places]));
    let primitives = triangles.iter().map(|triangle| triangle.primitive).collect();
    Ok(LightWords { tables, images, primitives })
}

/// Puts the tree behind the tables: the last words of the head.
fn push_tree(tree: &LightTree, apart: &[usize], tables: &mut Vec<f32>) -> [f32; 5] {
    let mut append = |words: &mut dyn Iterator<Item = f32>| {
        let at = number(tables.len());
        tables.extend(words);
        at
    };
    let (parents, leaves) = tree.places();
    let place_beside = |light| apart.binary_search(&light).map_or(0.0, |place| -1.0 - number(place));
    let leaf = |(light, &leaf): (usize, &u32)| {
        if tree.holds(light) { leaf as f32 } else { place_beside(light) }
    };
    let parent = |&parent: &u32| if parent == u32::MAX { 0.0 } else { parent as f32 };
    let apart_at = append(&mut apart.iter().map(|&light| number(light)));
    let lanes_at = append(&mut tree.lanes().into_iter().flatten());
    let leaves_at = append(&mut leaves.iter().enumerate().map(leaf));
    let parents_at = append(&mut parents.iter().map(parent));
    [apart_at, number(apart.len()), lanes_at, leaves_at, parents_at]
}

fn number(of: usize) -> f32 {
    of as f32
}

fn flag(is_set: bool) -> f32 {
    f32::from(u8::from(is_set))
}

/// The first words of a light: kind, and whether the camera sees its surface.
fn head(kind: usize, is_visible: bool) -> [f32; 2] {
    [number(kind), flag(is_visible)]
}

/// The parts one behind the other.
fn words(parts: &[&[f32]]) -> Vec<f32> {
    parts.concat()
}

fn placed(source: &PlacedLight) -> Vec<f32> {
    let v = |vector: Vec3| vector.to_array();
    let around = |kind, around: &Rectangle| {
        let head = head(kind, around.visible);
        words(&[
            &head,
            &v(around.radiance),
            &v(around.corner),
            &v(around.x),
            &v(around.y),
            &v(around.normal),
            &around.size,
        ])
    };
    match source {
        PlacedLight::Rectangle(light) => around(RECTANGLE, light),
        PlacedLight::Ellipse(light) => around(ELLIPSE, &light.around),
        PlacedLight::Sphere(light) => words(&[&head(SPHERE, light.visible), &light.words()]),
        PlacedLight::Spot(light) => words(&[&head(SPOT, false), &light.words()]),
        PlacedLight::Beam(light) => words(&[&head(BEAM, false), &light.words()]),
        PlacedLight::Distant(light) => {
            let kind = if light.is_disc() { DISC } else { DISTANT };
            words(&[&head(kind, false), &light.words()])
        }
        PlacedLight::Environment(light) => match &light.sky {
            Sky::Constant(radiance) => words(&[&head(SKY, false), &v(*radiance)]),
            Sky::Map(_) => head(MAP, false).to_vec(),
        },
    }
}

fn map_of(source: &PlacedLight) -> Option<&EnvironmentMap> {
    match source {
        PlacedLight::Environment(light) => match &light.sky {
            Sky::Map(map) => Some(map),
            Sky::Constant(_) => None,
        },
        _ => None,
    }
}

fn push_map(map: &EnvironmentMap, tables: &mut Vec<f32>, images: &mut Vec<u32>) {
    let (pixels, grid) = (&map.pixels, &map.grid);
    let weights = grid.weights(pixels);
    let rows: Vec<&[f64]> = weights.chunks(grid.columns).collect();
    let rows_at = images.len();
    images.extend(choice(&rows.iter().map(|row| row.iter().sum()).collect::<Vec<f64>>()));
    let cells_at = images.len();
    images.extend(rows.iter().flat_map(|row| choice(row)));
    let texels_at = images.len();
    images.extend(pixels.data.iter().flat_map(|texel| texel.to_array().map(f32::to_bits)));

    let start = tables.len();
    let [width, height] = [pixels.width, pixels.height].map(number);
    tables.extend([width, height, number(grid.columns), number(grid.rows)]);
    tables.extend(grid.block.map(number));
    tables.extend(Mat3::transpose(&map.environment_from_world).to_cols_array());
    tables.extend(map.irradiance);
    tables.extend([texels_at, rows_at, cells_at].map(number));
    debug_assert_eq!(tables.len(), start + MAP_HEADER);
    let halves = |row| {
        let cos = grid.cos_theta(row);
        [0.5 * (1.0 - cos), 0.5 * (1.0 + cos)].map(|half| half as f32)
    };
    tables.extend((0..=grid.rows).flat_map(halves));
    let solid_angle = |row| TAU * (grid.cos_theta(row) - grid.cos_theta(row + 1));
    tables.extend((0..grid.rows).map(|row| solid_angle(row) as f32));
}

/// A choice in proportion to weights that are not negative: all that are not 0 have a probability of 2⁻³¹ at least.
fn choice(weights: &[f64]) -> Vec<u32> {
    let sum: f64 = weights.iter().sum();
    let possible = weights.iter().filter(|weight| **weight > 0.0).count();
    let spare = f64::from(1_u32 << 31) - possible as f64;
    let (mut before, mut possible_before) = (0.0, 0);
    let mut words = vec![0];
    for &weight in weights {
        before += weight;
        possible_before += u32::from(weight > 0.0);
        let share = if sum > 0.0 { (before / sum).min(1.0) } else { 0.0 };
        words.push((share * spare).round() as u32 + possible_before);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_have_the_shares_of_their_weights() {
        let weights = [0.0, 3.0, 1e-20, 0.0, 1.0, 1e-20, 0.0];
        let words = choice(&weights);
        let shares: Vec<u32> = words.windows(2).map(|ends| ends[1] - ends[0]).collect();
        assert_eq!((words[0], words[7]), (0, 1 << 31));
        assert_eq!([shares[0], shares[3], shares[6]], [0; 3]);
        assert_eq!([shares[2], shares[5]], [1, 1]);
        assert!(shares[1].abs_diff(3 << 29) <= 4 && shares[4].abs_diff(1 << 29) <= 4, "{shares:?}");
        assert_eq!(choice(&[0.0; 3]), [0; 4]);
    }
}
