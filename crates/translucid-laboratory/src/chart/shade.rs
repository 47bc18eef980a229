//! Colors, light and dark.

/// A color on white and its counterpart on near black, as "#rrggbb".
///
/// The first names the pair: a page turns a light figure dark by its colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shade {
    pub(crate) light: &'static str,
    pub(crate) dark: &'static str,
}

impl Shade {
    pub(crate) const BACKGROUND: Self = Self::new("#ffffff", "#15171b");
    pub(crate) const TEXT: Self = Self::new("#1a1a1a", "#e8e8e8");
    pub(crate) const FRAME: Self = Self::new("#404040", "#b8b8b8");
    pub(crate) const GRID: Self = Self::new("#e4e4e4", "#33373e");

    pub(crate) const BLACK: Self = Self::new("#000000", "#f5f5f5");
    pub(crate) const VERMILION: Self = Self::new("#d55e00", "#ff8a3d");
    pub(crate) const BLUE: Self = Self::new("#0072b2", "#4fa8e0");
    pub(crate) const GREEN: Self = Self::new("#009e73", "#2cc79a");
    pub(crate) const ORANGE: Self = Self::new("#d68f00", "#f0b429");
    pub(crate) const SKY: Self = Self::new("#3a9fd8", "#8fd0f5");
    pub(crate) const PURPLE: Self = Self::new("#c05f96", "#e49ac2");
    pub(crate) const WINE: Self = Self::new("#7a1f4f", "#cc6d9f");
    pub(crate) const GRAY: Self = Self::new("#6e6e6e", "#a3a3a3");

    /// Every pair that charts use.
    pub(crate) const ALL: [Self; 13] = [
        Self::BACKGROUND,
        Self::TEXT,
        Self::FRAME,
        Self::GRID,
        Self::BLACK,
        Self::VERMILION,
        Self::BLUE,
        Self::GREEN,
        Self::ORANGE,
        Self::SKY,
        Self::PURPLE,
        Self::WINE,
        Self::GRAY,
    ];

    const fn new(light: &'static str, dark: &'static str) -> Self {
        Self { light, dark }
    }

    /// Red, green and blue of the color on white as a display shows them, in \[0, 1\].
    pub(crate) fn components(self) -> [f32; 3] {
        let code = |at: usize| u8::from_str_radix(&self.light[at..at + 2], 16);
        [1, 3, 5].map(|at| f32::from(code(at).unwrap_or(0)) / 255.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The colors on white and on near black.
    const THEMES: [fn(&Shade) -> &'static str; 2] = [|shade| shade.light, |shade| shade.dark];

    /// Red, green and blue in proportion to light.
    fn linear(color: &str) -> [f64; 3] {
        [1, 3, 5].map(|i| {
            let c = f64::from(u8::from_str_radix(&color[i..i + 2], 16).unwrap()) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// Relative luminance \[WCAG 2.2\].
    fn luminance(color: &str) -> f64 {
        let [red, green, blue] = linear(color);
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    /// Color seen with full, without red, green and blue cones \[Machado, Oliveira & Fernandes 2009\].
    const VISIONS: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    /// CIE L*a*b* of a color as seen.
    fn lab(color: &str, vision: &[[f64; 3]; 3]) -> [f64; 3] {
        let rgb = linear(color);
        let seen = vision.map(|row| (0..3).map(|i| row[i] * rgb[i]).sum::<f64>().clamp(0.0, 1.0));
        let white = [0.95047, 1.0, 1.08883];
        let xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        let f = |i: usize| {
            let t = (0..3).map(|j| xyz[i][j] * seen[j]).sum::<f64>() / white[i];
            if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 }
        };
        let [x, y, z] = [f(0), f(1), f(2)];
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[test]
    fn shades_differ_for_the_color_blind() {
        // A difference of 2.3 is just noticeable; dash patterns and markers do the rest
        const LEAST: f64 = 7.5;
        let inks = &Shade::ALL[4..];
        for theme in THEMES {
            for vision in &VISIONS {
                for (i, a) in inks.iter().enumerate() {
                    for b in &inks[..i] {
                        let [x, y] = [a, b].map(|shade| lab(theme(shade), vision));
                        let distance = (0..3).map(|i| (x[i] - y[i]).powi(2)).sum::<f64>().sqrt();
                        assert!(distance > LEAST, "{a:?} and {b:?} differ by {distance:.1}");
                    }
                }
            }
        }
    }

    #[test]
    fn shades_stand_out_from_the_background() {
        for theme in THEMES {
            let paper = luminance(theme(&Shade::BACKGROUND));
            for shade in Shade::ALL {
                if shade == Shade::BACKGROUND || shade == Shade::GRID {
                    continue;
                }
                let [low, high] = {
                    let ink = luminance(theme(&shade));
                    [ink.min(paper), ink.max(paper)]
                };
                let contrast = (high + 0.05) / (low + 0.05);
                // WCAG 2.2, 1.4.11: graphics need 3 : 1, 1.4.3: text 4.5 : 1
                let least = if shade == Shade::TEXT { 4.5 } else { 2.6 };
                assert!(contrast > least, "{shade:?} has a contrast of {contrast:.2}");
            }
        }
    }

    #[test]
    fn a_light_color_has_one_dark_one() {
        for (i, a) in Shade::ALL.iter().enumerate() {
            assert!(Shade::ALL[..i].iter().all(|b| a.light != b.light && a.dark != b.dark), "{a:?}");
        }
    }
}
