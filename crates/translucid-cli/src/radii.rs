//! The radii of a table.

use clap::Args;

use crate::failure::Failure;
use crate::table::exact;

/// Which radii a table has.
#[derive(Args, Debug)]
pub(crate) struct RadiiArguments {
    /// Radii, comma-separated
    #[arg(
        long,
        value_name = "R1,R2,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        required_unless_present = "points",
        conflicts_with_all = ["points", "max"]
    )]
    at: Vec<f64>,
    /// Number of evenly spaced radii max/N, 2 max/N, ..., max
    #[arg(long, value_name = "N", requires = "max", value_parser = clap::value_parser!(u32).range(1..))]
    points: Option<u32>,
    /// Largest radius of --points
    #[arg(long, value_name = "R", requires = "points", allow_negative_numbers = true)]
    max: Option<f64>,
}

impl RadiiArguments {
    /// The radii one by one; there may be billions.
    pub(crate) fn iter(&self) -> Result<impl Iterator<Item = f64> + '_, Failure> {
        let even = match (self.points, self.max) {
            (Some(points), Some(max)) => {
                require_radius("--max", max)?;
                if max == 0.0 {
                    return Err(Failure::input("--max is 0, but must be greater"));
                }
                Some((points, max))
            }
            _ => {
                self.at.iter().try_for_each(|&r| require_radius("--at", r))?;
                None
            }
        };
        let radius =
            |(points, max): (u32, f64)| (1..=points).map(move |i| max * (f64::from(i) / f64::from(points)));
        Ok(even.into_iter().flat_map(radius).chain(self.at.iter().copied()))
    }

    /// Number of radii.
    pub(crate) fn count(&self) -> usize {
        self.points.map_or(self.at.len(), |points| points as usize)
    }
}

fn require_radius(option: &str, r: f64) -> Result<(), Failure> {
    if r >= 0.0 && r.is_finite() {
        return Ok(());
    }
    let r = exact(r);
    Err(Failure::input(format!("{option} has the radius {r}, but radii must be finite and at least 0")))
}
