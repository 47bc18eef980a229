//! The part of a photograph that shows the edge and nothing else, where a white card lies in it.

use std::collections::VecDeque;

use crate::linear_photo::Photo;

/// Cells along the longer side of a photograph, in which a card is looked for.
const CELLS: usize = 256;

/// A cell belongs to the card where no channel differs more from the card's.
const ALIKE: f64 = 0.08;

/// A card that is found has at most this many times the area of the part that was named: else the piece is as white.
const GREATEST_CARD: usize = 30;

/// Distance from the card, over the photograph's longer side: the card keeps light from the piece below it, and dims what is
/// near.
const AWAY: f64 = 0.1;

/// The greatest part of a region beside a white card that shows what is wanted; the region itself where it does not hold the
/// card, or no part does.
pub(crate) fn beside_white(
    photo: &Photo,
    region: [usize; 4],
    white: [usize; 4],
    is_wanted: impl Fn(&Photo) -> bool,
) -> [usize; 4] {
    let [x0, y0, x1, y1] = region;
    let [left, top, right, bottom] = card_around(photo, white);
    if left >= x1 || right <= x0 || top >= y1 || bottom <= y0 {
        return region;
    }
    let away = (AWAY * photo.width.max(photo.height) as f64) as usize;
    let mut parts = [
        [x0, y0, x1.min(left.saturating_sub(away)), y1],
        [x0.max(right + away), y0, x1, y1],
        [x0, y0, x1, y1.min(top.saturating_sub(away))],
        [x0, y0.max(bottom + away), x1, y1],
    ];
    let area = |[x0, y0, x1, y1]: &[usize; 4]| x1.saturating_sub(*x0) * y1.saturating_sub(*y0);
    parts.sort_by_key(|part| std::cmp::Reverse(area(part)));
    let is_fit = |part: &&[usize; 4]| area(part) > 0 && is_wanted(&photo.part(**part));
    parts.iter().find(is_fit).copied().unwrap_or(region)
}

/// The rectangle around a white card of which a part is named: what is connected to that part and looks like it. Where it
/// cannot be told from the piece, the named part and half its size around it.
fn card_around(photo: &Photo, named: [usize; 4]) -> [usize; 4] {
    let [x0, y0, x1, y1] = named;
    let step = photo.width.max(photo.height).div_ceil(CELLS);
    let [columns, rows] = [photo.width, photo.height].map(|n| n.div_ceil(step));
    let white = photo.part(named).mean();
    let is_alike = |x: usize, y: usize| {
        let corner = [x, y].map(|i| (step * i).saturating_sub(1));
        let cell = photo.part([corner[0], corner[1], step * (x + 1) + 1, step * (y + 1) + 1]).mean();
        cell.iter().zip(white).all(|(v, white)| (v - white).abs() <= ALIKE * white)
    };
    let mut is_card = vec![false; columns * rows];
    let named_cells =
        || (y0 / step..y1.div_ceil(step)).flat_map(|y| (x0 / step..x1.div_ceil(step)).map(move |x| (x, y)));
    let mut queue: VecDeque<(usize, usize)> =
        named_cells().filter(|(x, y)| *x < columns && *y < rows).collect();
    queue.iter().for_each(|(x, y)| is_card[y * columns + x] = true);
    let most = GREATEST_CARD * queue.len();
    let (mut count, mut found) = (0, named);
    while let Some((x, y)) = queue.pop_front() {
        count += 1;
        found = [
            found[0].min(step * x),
            found[1].min(step * y),
            found[2].max(step * (x + 1)),
            found[3].max(step * (y + 1)),
        ];
        let neighbors = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
        for (x, y) in neighbors.into_iter().filter(|(x, y)| *x < columns && *y < rows) {
            if !is_card[y * columns + x] && is_alike(x, y) {
                is_card[y * columns + x] = true;
                queue.push_back((x, y));
            }
        }
    }
    if count <= most {
        return found;
    }
    let [half_width, half_height] = [(x1 - x0).div_ceil(2), (y1 - y0).div_ceil(2)];
    [x0.saturating_sub(half_width), y0.saturating_sub(half_height), x1 + half_width, y1 + half_height]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piece of reflectance 0.6, whose left quarter is dark, with a card of 0.9 from (70, 10) to before (90, 30).
    fn photo(piece: f32) -> Photo {
        Photo::from_fn(120, 80, |x, y| {
            let grain = 1e-3 * ((x * 7 + y * 13) % 11) as f32;
            let is_card = (70..90).contains(&x) && (10..30).contains(&y);
            [grain
                + if is_card {
                    0.9
                } else if x < 30 {
                    0.02
                } else {
                    piece
                }; 3]
        })
    }

    #[test]
    fn region_leaves_the_card_out() {
        let all = [0, 0, 120, 80];
        let region = |piece, region| beside_white(&photo(piece), region, [75, 15, 85, 25], |_| true);
        // The card is found but for its rim, and 12 pixels around it are left out
        assert_eq!(region(0.6, all), [0, 0, 59, 80]);
        assert_eq!(region(0.6, [0, 40, 120, 80]), [0, 40, 120, 80]);
        assert_eq!(region(0.6, [0, 50, 120, 80]), [0, 50, 120, 80]);
        // A piece as bright as the card hides how far it goes
        assert_eq!(region(0.89, all), [0, 0, 58, 80]);
        // Where the wanted thing is elsewhere
        let needs_width = |part: &Photo| part.width > 100;
        assert_eq!(beside_white(&photo(0.6), all, [75, 15, 85, 25], needs_width), [0, 41, 120, 80]);
        assert_eq!(beside_white(&photo(0.6), all, [75, 15, 85, 25], |_| false), all);
    }
}
