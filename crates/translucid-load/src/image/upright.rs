//! Orientation of pictures, as the tag of that name in TIFF and EXIF has it (TIFF 6.0, Orientation; EXIF 3.0, section 4.6.5).

/// Turns and mirrors a picture as a viewer shows it, and returns its size; a number that is none of 2 to 8 changes nothing.
pub(super) fn upright<T: Copy>(
    pixels: &mut Vec<T>,
    [width, height]: [usize; 2],
    orientation: u16,
) -> [usize; 2] {
    let size = if (5..=8).contains(&orientation) { [height, width] } else { [width, height] };
    let stored = |x: usize, y: usize| {
        let [column, row] = match orientation {
            2 => [width - 1 - x, y],
            3 => [width - 1 - x, height - 1 - y],
            4 => [x, height - 1 - y],
            5 => [y, x],
            6 => [y, height - 1 - x],
            7 => [width - 1 - y, height - 1 - x],
            _ => [width - 1 - y, x],
        };
        row * width + column
    };
    if (2..=8).contains(&orientation) {
        *pixels = (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
            .map(|(x, y)| pixels[stored(x, y)])
            .collect();
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification: row 0 and column 0 of what is stored are named by what a viewer shows there.
    #[test]
    fn orientations_are_those_of_the_specification() {
        // Stored: 3 columns, 2 rows
        let stored = || vec!['a', 'b', 'c', 'd', 'e', 'f'];
        for (orientation, size, shown) in [
            (1, [3, 2], "abcdef"),
            (2, [3, 2], "cbafed"),
            (3, [3, 2], "fedcba"),
            (4, [3, 2], "defabc"),
            (5, [2, 3], "adbecf"),
            (6, [2, 3], "daebfc"),
            (7, [2, 3], "fcebda"),
            (8, [2, 3], "cfbead"),
            (0, [3, 2], "abcdef"),
            (9, [3, 2], "abcdef"),
        ] {
            let mut pixels = stored();
            assert_eq!(upright(&mut pixels, [3, 2], orientation), size, "{orientation}");
            assert_eq!(String::from_iter(pixels), shown, "{orientation}");
        }
    }
}
