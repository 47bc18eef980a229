//! Claims of the talk, against the numbers.

use translucid_profile::Configuration;

use super::{Contender, ErrorTable, Inversion};

/// "This one is closer to the truth than that one", searchlight, over all radii.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The claim in words.
    pub statement: String,
    /// Albedo inversion of the model that the claim calls less accurate.
    pub inversion: Inversion,
    /// Whether the talk itself names the pair; the others are ours.
    pub is_the_talks: bool,
    /// Errors of the better and the worse one at each surface albedo that was asked for.
    pub errors: Vec<Option<[f64; 2]>>,
    /// Their means over the albedos that means are over.
    pub means: Option<[f64; 2]>,
}

impl Claim {
    /// Returns whether a pair of errors bears the claim out.
    pub fn is_confirmed(errors: [f64; 2]) -> bool {
        errors[0] < errors[1]
    }

    /// Returns whether it holds at every albedo that was asked for and in the mean; `None` where there is nothing to go by.
    pub fn holds(&self) -> Option<bool> {
        let mut all = self.errors.iter().chain([&self.means]).flatten().peekable();
        all.peek()?;
        Some(all.all(|errors| Self::is_confirmed(*errors)))
    }
}

/// P. H. Christensen and B. Burley 2015: normalized diffusion is closer to Monte Carlo than dipole, better dipole and
/// beam diffusion for A = 0.2, 0.5 and 0.8; two exponentials are closer than two Gaussians.
///
/// Every other contender that knows media is put to the same test, by either way to its medium.
/// A claim whose sides are not both in the table is left out.
pub fn claims(contenders: &[Contender], table: &ErrorTable, surface_albedos: &[f64]) -> Vec<Claim> {
    let find = |name: &str| contenders.iter().find(|one| one.name == name);
    let of_media = contenders.iter().filter(|one| one.knows_media());
    let normalized = find("normalized-diffusion");
    let pairs = of_media
        .flat_map(|one| [Inversion::Own, Inversion::Exact].map(|way| (normalized, Some(one), way)))
        .chain([(find("exponentials-2"), find("gaussians-2"), Inversion::Own)]);
    pairs
        .filter_map(|(better, worse, way)| Claim::new([better?, worse?], way, table, surface_albedos))
        .collect()
}

impl Claim {
    /// A better and a worse one, with the worse one's way to its medium; `None` without an error of both.
    fn new(
        [better, worse]: [&Contender; 2],
        inversion: Inversion,
        table: &ErrorTable,
        surface_albedos: &[f64],
    ) -> Option<Self> {
        const NAMED: [&str; 4] = ["dipole", "better-dipole", "photon-beam-diffusion", "gaussians-2"];
        let searchlight = Configuration::Searchlight;
        let both = |of: &dyn Fn(&'static str, Inversion) -> Option<f64>| {
            Some([of(better.name, Inversion::Own)?, of(worse.name, inversion)?])
        };
        let statement = match (better.name, inversion) {
            ("exponentials-2", _) => String::from("two exponentials are closer than two Gaussians"),
            (_, Inversion::Own) => format!("{} is closer than {}", better.title, worse.title),
            (_, Inversion::Exact) => {
                format!("{} is closer than {} of the exact α", better.title, worse.title)
            }
        };
        let at = |a: &f64| both(&|name, way| table.at(name, searchlight, way, *a));
        let claim = Self {
            statement,
            inversion,
            is_the_talks: NAMED.contains(&worse.name) && inversion == Inversion::Own,
            errors: surface_albedos.iter().map(at).collect(),
            means: both(&|name, way| Some(table.summary(name, searchlight, way)?.errors[2].mean)),
        };
        claim.holds().map(|_| claim)
    }
}
