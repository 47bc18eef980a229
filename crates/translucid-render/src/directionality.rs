//! How much more or less light leaves at a point for the direction in which it enters at another.
//!
//! Probes find entry points by a radial profile, before any light is known.
//! Where the model knows directions, light at the entry is then weighted with R(x_o − x_i; ω_i)/R(|x_o − x_i|).

use glam::Vec3;
use translucid_profile::DirectionalDipoleF32;

use crate::material::Subsurface;
use crate::profile_tables::{ProfileSource, ProfileTables};

/// The way of light below the surface, with normals on the side that is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// From the entry to the exit \[L\].
    pub(crate) offset: Vec3,
    /// Unit normal at the entry.
    pub(crate) entry_normal: Vec3,
    /// Unit normal at the exit.
    pub(crate) exit_normal: Vec3,
}

/// The weight of light by its direction, per channel.
#[allow(
    clippy::large_enum_variant,
    reason = "it lives on the stack for one event: a box would allocate in the inner loop"
)]
pub(crate) enum Directionality {
    /// All directions alike.
    Radial,
    /// The directional dipole.
    Dipole {
        passage: Passage,
        dipoles: [DirectionalDipoleF32; 3],
        /// 1/R(|x_o − x_i|) of the profile that the entry was found by; 0 in channels that do not scatter.
        inverse: Vec3,
    },
}

impl Directionality {
    /// What the exit's subsurface parameters say.
    pub(crate) fn new(tables: &ProfileTables, subsurface: &Subsurface, passage: Passage) -> Self {
        let ProfileSource::Directional { table, dipole } = subsurface.source else { return Self::Radial };
        let (table, dipole) = (tables.table(table), tables.dipole(dipole));
        let Subsurface { albedo, length, .. } = *subsurface;
        let distance = passage.offset.length();
        let inverse = |c: usize| {
            if length[c] <= 0.0 {
                return 0.0;
            }
            let radial = albedo[c] * table.at(albedo[c], length[c]).pdf_area(distance);
            if radial > 0.0 { radial.recip() } else { 0.0 }
        };
        Self::Dipole {
            passage,
            dipoles: [0, 1, 2].map(|c: usize| dipole.at(albedo[c], length[c])),
            inverse: Vec3::new(inverse(0), inverse(1), inverse(2)),
        }
    }

    /// Factor on light that comes from a unit direction.
    #[inline]
    pub(crate) fn weight(&self, toward_light: Vec3) -> Vec3 {
        let Self::Dipole { passage, dipoles, inverse } = self else { return Vec3::ONE };
        let arguments = [passage.offset, toward_light, passage.entry_normal, passage.exit_normal];
        let [offset, omega, entry_normal, exit_normal] = arguments.map(|v| v.to_array());
        let value = |c: usize| {
            if inverse[c] <= 0.0 {
                return 0.0;
            }
            dipoles[c].eval(offset, omega, entry_normal, exit_normal) * inverse[c]
        };
        let weight = Vec3::new(value(0), value(1), value(2));
        // A product of the greatest and the least numbers
        if weight.is_finite() { weight } else { Vec3::ZERO }
    }
}
