//! Units of distance, by the names of MaterialX's standard library.

/// Names with their length \[mm\] (`UD_stdlib_distance` of MaterialX 1.39).
const DISTANCES: [(&str, f64); 10] = [
    ("nanometer", 1e-6),
    ("micron", 1e-3),
    ("millimeter", 1.0),
    ("centimeter", 10.0),
    ("inch", 25.4),
    ("foot", 304.8),
    ("yard", 914.4),
    ("meter", 1e3),
    ("kilometer", 1e6),
    ("mile", 1_609_344.0),
];

/// Millimeters in a unit.
pub(super) fn in_millimeters(name: &str) -> Option<f64> {
    DISTANCES.iter().find(|(known, _)| *known == name).map(|&(_, length)| length)
}

/// All names, for messages.
pub(super) fn names() -> String {
    DISTANCES.map(|(name, _)| name).join(", ")
}
