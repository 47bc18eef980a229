//! Claims of the talk, against the numbers.

use translucid_profile::Configuration;

use super::{Contender, ErrorTable, Inversion};

/// Something with an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Comparand {
    /// [`Contender::name`].
    pub contender: &'static str,
    /// [`Contender::title`].
    pub title: &'static str,
    /// Way in which it found its medium.
    pub inversion: Inversion,
}

/// "This one is closer to the truth than that one", searchlight, over all radii.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Side that is said to be closer.
    pub better: Comparand,
    /// Side that is said to be farther off.
    pub worse: Comparand,
    /// Whether the talk itself names the pair; the others are ours.
    pub is_the_talks: bool,
    /// Errors of the better and the worse one at each surface albedo that was asked for.
    pub errors: Vec<Option<[f64; 2]>>,
    /// Their means over the albedos that means are over.
    pub means: Option<[f64; 2]>,
}

impl Claim {
    /// The claim in words.
    pub fn statement(&self) -> String {
        let mut statement = match self.better.contender {
            "exponentials-2" => String::from("two exponentials are closer than two Gaussians"),
            _ => format!("{} is closer than {}", self.better.title, self.worse.title),
        };
        if self.worse.inversion == Inversion::Exact {
            statement += " of the exact α";
        }
        statement
    }

    /// Tells whether a pair of errors bears the claim out.
    pub fn is_confirmed(errors: [f64; 2]) -> bool {
        errors[0] < errors[1]
    }

    /// Tells whether it holds at every albedo that was asked for and in the mean; `None` where there is nothing to go by.
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
    let find = |name: &str, inversion: Inversion| {
        let found = contenders.iter().find(|one| one.name == name)?;
        Some(Comparand { contender: found.name, title: found.title, inversion })
    };
    let normalized = find("normalized-diffusion", Inversion::Own);
    let of_media = contenders.iter().filter(|one| one.knows_media());
    let pairs = of_media
        .flat_map(|one| [Inversion::Own, Inversion::Exact].map(|way| (normalized, find(one.name, way))))
        .chain([(find("exponentials-2", Inversion::Own), find("gaussians-2", Inversion::Own))]);
    let claim = |(better, worse): (Option<Comparand>, Option<Comparand>)| {
        let claim = Claim::new(better?, worse?, table, surface_albedos);
        claim.holds().map(|_| claim)
    };
    pairs.filter_map(claim).collect()
}

impl Claim {
    fn new(better: Comparand, worse: Comparand, table: &ErrorTable, surface_albedos: &[f64]) -> Self {
        const NAMED: [&str; 4] = ["dipole", "better-dipole", "photon-beam-diffusion", "gaussians-2"];
        let searchlight = Configuration::Searchlight;
        let both = |of: &dyn Fn(&Comparand) -> Option<f64>| Some([of(&better)?, of(&worse)?]);
        let at = |a: &f64| both(&|one: &Comparand| table.at(one.contender, searchlight, one.inversion, *a));
        let mean =
            |one: &Comparand| Some(table.summary(one.contender, searchlight, one.inversion)?.errors[2].mean);
        Self {
            better,
            worse,
            is_the_talks: NAMED.contains(&worse.contender) && worse.inversion == Inversion::Own,
            errors: surface_albedos.iter().map(at).collect(),
            means: both(&mean),
        }
    }
}
