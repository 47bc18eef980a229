//! Our walk against MCML itself.
//!
//! The numbers are what MCML 1.2.2 prints after 10⁷ photons, built by gcc 13 from its source at
//! <https://github.com/scottprahl/MCML> (commit 92f1a646, `V1/mcR5unix/mcmlcode`) and run as `mcml_v1 judge.mci`, whose two
//! runs are the texts below. Their standard errors are ours, for as many photons, and half a unit of the last digit
//! printed. Some 140 comparisons at |z| < 5, in Student's distribution of 63 degrees of freedom: false-alarm rate 1e-3.

use translucid_testing::power;

use super::parse_mci;
use crate::walk::Control;

/// Photons that MCML walked.
const PHOTONS: f64 = 1e7;

/// A quantity's name, and some of its figures by their number.
type Figures = &'static [(&'static str, &'static [(usize, f64)])];

/// Three layers of the example that comes with MCML.
const SKIN: &str = "1.0\n1\nskin.mco A\nPHOTONS\n0.01 0.02\n40 20 6\n3\n1.0\n1.37 1 100 0.9 0.1\n1.37 1 10 0 0.1\n1.37 2 10 0.7 0.2\n1.0\n";

const SKIN_FIGURES: Figures = &[
    ("Rd", &[(0, 0.237968)]),
    ("A", &[(0, 0.641472)]),
    ("Tt", &[(0, 0.0961877)]),
    ("A_l", &[(0, 0.2613), (1, 0.1488), (2, 0.2314)]),
    (
        "A_z",
        &[
            (0, 2.7968),
            (5, 2.6511),
            (10, 2.0616),
            (15, 1.4137),
            (20, 1.7348),
            (25, 1.3303),
            (30, 1.0695),
            (35, 0.89872),
        ],
    ),
    ("Rd_r", &[(0, 15.261), (1, 5.141), (2, 3.1723), (3, 2.236), (18, 0.062534), (19, 0.40771)]),
    ("Rd_a", &[(0, 0.074213), (1, 0.07016), (2, 0.061389), (3, 0.047711), (4, 0.028306), (5, 0.0068159)]),
    ("Tt_r", &[(0, 0.58221), (1, 0.56134), (2, 0.52622), (3, 0.49196), (18, 0.049205), (19, 0.39193)]),
    ("Tt_a", &[(0, 0.038558), (1, 0.033812), (2, 0.026165), (3, 0.017634), (4, 0.0092649), (5, 0.0020431)]),
    (
        "A_rz",
        &[
            (0, 881.03),
            (5, 426.3),
            (10, 100.83),
            (15, 28.342),
            (20, 18.96),
            (25, 9.1659),
            (30, 5.1984),
            (35, 3.2877),
            (120, 16.914),
            (125, 22.526),
            (130, 22.268),
            (135, 13.471),
            (140, 12.244),
            (145, 7.0308),
            (150, 4.3511),
            (155, 2.8428),
            (760, 3.0424),
            (765, 3.1882),
            (770, 3.4512),
            (775, 3.4679),
            (780, 6.546),
            (785, 6.544),
            (790, 6.4392),
            (795, 6.3187),
        ],
    ),
    (
        "Rd_ra",
        &[
            (0, 5.6429),
            (1, 5.5369),
            (2, 5.1694),
            (3, 4.7388),
            (4, 4.1642),
            (5, 2.7709),
            (114, 0.13108),
            (115, 0.13124),
            (116, 0.13305),
            (117, 0.13437),
            (118, 0.12631),
            (119, 0.088026),
        ],
    ),
    (
        "Tt_ra",
        &[
            (0, 0.7892),
            (1, 0.27498),
            (2, 0.16056),
            (3, 0.10012),
            (4, 0.069786),
            (5, 0.038892),
            (114, 0.111),
            (115, 0.11616),
            (116, 0.12413),
            (117, 0.13301),
            (118, 0.1327),
            (119, 0.095909),
        ],
    ),
];

/// A pane on two layers whose indices differ, on a medium; the cells end within the last layer, and cut through it. (MCML's
/// A_l is left out here: it counts a cell that two layers share as one's.)
const GLASS: &str = "1.0\n1\nglass.mco A\nPHOTONS\n0.02 0.05\n10 12 5\n3\n1.0\n1.5 0 0 0 0.1\n1.4 2 30 0.8 0.05\n1.33 0.5 20 0.6 0.3\n1.45\n";

const GLASS_FIGURES: Figures = &[
    ("Rd", &[(0, 0.211769)]),
    ("A", &[(0, 0.491653)]),
    ("Tt", &[(0, 0.255482)]),
    ("A_z", &[(5, 5.1364), (6, 5.1543), (7, 3.1968), (8, 1.2142), (9, 9.881)]),
    ("Rd_r", &[(0, 1.6223), (1, 1.317), (2, 0.78465), (3, 0.45734), (10, 0.037324), (11, 0.17188)]),
    ("Rd_a", &[(0, 0.067607), (1, 0.061464), (2, 0.049166), (3, 0.029891), (4, 0.0074972)]),
    ("Tt_r", &[(0, 1.7133), (1, 1.2306), (2, 0.86897), (3, 0.59063), (10, 0.045847), (11, 0.17987)]),
    ("Tt_a", &[(0, 0.12519), (1, 0.10007), (2, 0.065003), (3, 0.020707)]),
    (
        "A_rz",
        &[
            (5, 285.08),
            (6, 279.11),
            (7, 163.47),
            (8, 54.718),
            (9, 184.36),
            (35, 4.413),
            (36, 5.1898),
            (37, 3.4827),
            (38, 1.5425),
            (39, 19.462),
            (115, 4.2946),
            (116, 3.5603),
            (117, 2.0378),
            (118, 0.68329),
            (119, 6.1489),
        ],
    ),
    (
        "Rd_ra",
        &[
            (0, 1.428),
            (1, 0.93139),
            (2, 0.30837),
            (3, 0.15101),
            (4, 0.081522),
            (55, 0.049859),
            (56, 0.052336),
            (57, 0.056354),
            (58, 0.058043),
            (59, 0.044683),
        ],
    ),
    (
        "Tt_ra",
        &[
            (0, 1.7669),
            (1, 0.77487),
            (2, 0.43037),
            (3, 0.17285),
            (55, 0.076761),
            (56, 0.074995),
            (57, 0.068357),
            (58, 0.037391),
        ],
    ),
];

#[test]
fn walk_finds_what_mcml_finds() {
    let photons = power(2_000_000);
    for (text, figures, specular) in [(SKIN, SKIN_FIGURES, 0.0243729), (GLASS, GLASS_FIGURES, 0.0410959)] {
        let run = parse_mci(text.replace("PHOTONS", &photons.to_string()).as_bytes()).unwrap().remove(0);
        let result = run.walk(6, &Control::default()).unwrap();
        assert!((result.tally().specular() - specular).abs() < 1e-7);
        let mut compared = 0;
        for (name, list) in figures {
            let found: Vec<_> = result.figures().filter(|figure| figure.name == *name).collect();
            for (i, mcml) in *list {
                let ours = found[*i].density;
                let printed = 5e-5 * mcml.abs();
                let error = ours.error.hypot(ours.error * (photons as f64 / PHOTONS).sqrt()).hypot(printed);
                let z = (ours.value - mcml) / error;
                assert!(z.abs() < 5.0, "{} {name} {i}: {ours:?}, MCML {mcml}, z = {z}", run.output);
                compared += 1;
            }
        }
        assert!(compared > 60, "{compared}");
    }
}
