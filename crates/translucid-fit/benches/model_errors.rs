//! How far every model is from the exact solution, as tables in Markdown.
//!
//! ```text
//! cargo bench -p translucid-fit --bench model_errors
//! ```
//!
//! The half space scatters isotropically and has the refractive index of its surroundings; its mean free path is 1.

#![allow(clippy::print_stdout, reason = "the tables are what the bench is for")]

#[path = "../tests/contenders/mod.rs"]
mod contenders;
#[path = "../tests/exact_profile/mod.rs"]
mod exact_profile;

use contenders::{Contender, Made, contenders, normalized_diffusion, refined};
use exact_profile::ExactHalfSpace;
use translucid_fit::{Burley, Exponential, Judge, Target};
use translucid_profile::{
    Configuration, Medium, NormalizedDiffusion, Parameterization, SumOfGaussians,
    half_space_single_scattering_albedo,
};

/// Greatest radii in mean free paths.
const R_MAX: [f64; 3] = [8.0, 16.0, f64::INFINITY];
/// Surface albedos are these numbers of percent.
const PERCENTS: std::ops::RangeInclusive<u32> = 1..=99;
/// Surface albedos of which the talk speaks.
const SPOKEN_OF: [u32; 3] = [20, 50, 80];

fn main() {
    let searchlight = References::new(Configuration::Searchlight);
    let diffuse = References::new(Configuration::Diffuse);
    let contenders = contenders();

    print_heading(
        "Searchlight: every model from the surface albedo A and the mean free path, its total being A",
    );
    let mut errors: Vec<Errors> = contenders.iter().map(|one| searchlight.errors_from_albedo(one)).collect();
    errors.push(searchlight.errors("normalized diffusion from the dmfp", normalized_diffusion_from_dmfp));
    errors.push(searchlight.errors("best normalized diffusion", |reference| reference.best::<Burley>(1)));
    for terms in [1, 2, 3] {
        let name = format!("best {terms} exponential{}", if terms == 1 { "" } else { "s" });
        errors.push(searchlight.errors(&name, |reference| reference.best::<Exponential>(terms)));
    }
    errors.iter().for_each(Errors::print);
    println!();
    println!(
        "\"Best\" is the least-squares fit at each A in the norm ∫ (R_fit − R)² r³ dr, as the Gaussians are."
    );

    print_heading(
        "Searchlight: models that know media, from the single-scattering albedo that A has exactly",
    );
    let of_media: Vec<Errors> =
        contenders.iter().filter_map(|one| searchlight.errors_from_medium(one)).collect();
    of_media.iter().for_each(Errors::print);

    print_heading("Diffuse transmission");
    let normalized = diffuse.errors("normalized-diffusion", |reference| {
        Ok(Box::new(normalized_diffusion(reference.surface_albedo, Configuration::Diffuse)?))
    });
    normalized.print();
    diffuse
        .errors("normalized-diffusion-refined", |reference| {
            Ok(Box::new(refined(reference.surface_albedo, Configuration::Diffuse)?))
        })
        .print();
    for terms in [2, 4, SumOfGaussians::DEFAULT_TERMS] {
        let gaussians = |reference: &Reference| -> Made {
            let (mfp, diffuse) = (Parameterization::Mfp, Configuration::Diffuse);
            Ok(Box::new(SumOfGaussians::new(reference.surface_albedo, 1.0, mfp, diffuse, terms)?))
        };
        diffuse.errors(&format!("gaussians, {terms} terms"), gaussians).print();
    }
    diffuse.errors("best normalized diffusion", |reference| reference.best::<Burley>(1)).print();
    for terms in [2, 3] {
        let name = format!("best {terms} exponentials");
        diffuse.errors(&name, |reference| reference.best::<Exponential>(terms)).print();
    }

    print_claims(&errors, &of_media);
}

/// Normalized diffusion by the talk's fit in the diffuse mean free path of the exact medium.
fn normalized_diffusion_from_dmfp(reference: &Reference) -> Made {
    let (dmfp, searchlight) = (Parameterization::Dmfp, Configuration::Searchlight);
    let length = reference.medium.dmfp();
    Ok(Box::new(NormalizedDiffusion::new(reference.surface_albedo, length, dmfp, searchlight)?))
}

/// The exact solution for every surface albedo.
struct References(Vec<Reference>);

struct Reference {
    percent: u32,
    surface_albedo: f64,
    medium: Medium,
    judge: Judge,
    target: Target,
}

impl References {
    fn new(configuration: Configuration) -> Self {
        Self(PERCENTS.map(|percent| Reference::new(percent, configuration)).collect())
    }

    fn errors(&self, name: &str, make: impl Fn(&Reference) -> Made) -> Errors {
        let made = self.0.iter().filter_map(|reference| Some((reference, make(reference).ok()?)));
        let errors = made.map(|(reference, profile)| {
            (reference.percent, reference.judge.l1_errors(profile.as_ref(), R_MAX))
        });
        Errors { name: name.to_owned(), errors: errors.collect() }
    }

    fn errors_from_albedo(&self, contender: &Contender) -> Errors {
        self.errors(&contender.name, |reference| (contender.from_albedo)(reference.surface_albedo))
    }

    fn errors_from_medium(&self, contender: &Contender) -> Option<Errors> {
        let from_medium = contender.from_medium?;
        Some(self.errors(&contender.name, |reference| from_medium(&reference.medium)))
    }
}

impl Reference {
    fn new(percent: u32, configuration: Configuration) -> Self {
        let surface_albedo = f64::from(percent) / 100.0;
        let exact = ExactHalfSpace::new(surface_albedo, configuration);
        let alpha = half_space_single_scattering_albedo(surface_albedo, configuration);
        Self {
            percent,
            surface_albedo,
            medium: Medium::from_mfp(alpha, 1.0, 0.0).expect("an albedo and a length"),
            judge: Judge::new(&exact),
            target: Target::new(&exact).expect("an exact profile has energy"),
        }
    }

    /// The least-squares fit of a number of terms.
    fn best<F: translucid_fit::Family>(&self, terms: usize) -> Made {
        let fits = self.target.fit::<F>(terms)?;
        Ok(Box::new(fits[terms - 1].mixture.clone()))
    }
}

/// L1 errors of one model at the surface albedos that it reaches, for each greatest radius.
struct Errors {
    name: String,
    errors: Vec<(u32, [f64; 3])>,
}

impl Errors {
    fn mean(&self, r_max: usize) -> f64 {
        self.errors.iter().map(|(_, errors)| errors[r_max]).sum::<f64>() / self.errors.len() as f64
    }

    fn worst(&self) -> (u32, f64) {
        let all_r = self.errors.iter().map(|(percent, errors)| (*percent, errors[2]));
        all_r.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN))
    }

    fn at(&self, percent: u32) -> Option<f64> {
        Some(self.errors.iter().find(|(found, _)| *found == percent)?.1[2])
    }

    fn print(&self) {
        let percent = |error: f64| format!("{:.2}", 100.0 * error);
        let means: Vec<String> = (0..3).map(|r_max| percent(self.mean(r_max))).collect();
        let at = SPOKEN_OF.map(|a| self.at(a).map_or("–".to_owned(), percent));
        let (worst_at, worst) = self.worst();
        let albedo = f64::from(worst_at) / 100.0;
        let columns = [means.join(" | "), at.join(" | ")].join(" | ");
        println!("| {} | {columns} | {} at {albedo} | {} |", self.name, percent(worst), self.errors.len());
    }
}

fn print_heading(title: &str) {
    println!("\n### {title}\n");
    println!("L1 error ∫|R_model − R| 2πr dr / ∫ R 2πr dr in percent, up to 200 for equal totals.");
    println!(
        "The first three columns are means over A = 0.01, 0.02, … 0.99 for r ≤ 8 ℓ, r ≤ 16 ℓ and all r;"
    );
    println!("the others are for all r.");
    println!("The last is how many of the 99 albedos the model reaches; means are over those.\n");
    println!("| model | r ≤ 8 | r ≤ 16 | all r | A = 0.2 | A = 0.5 | A = 0.8 | worst A | of 99 |");
    println!("|---|---|---|---|---|---|---|---|---|");
}

/// What the talk says, and what the tables say of it.
fn print_claims(errors: &[Errors], of_media: &[Errors]) {
    let find = |errors: &'_ [Errors], name: &str| -> Option<[Option<f64>; 4]> {
        let found = errors.iter().find(|errors| errors.name == name)?;
        let [a, b, c] = SPOKEN_OF.map(|percent| found.at(percent));
        Some([a, b, c, Some(found.mean(2))])
    };
    let verdict = |better: Option<f64>, worse: Option<f64>| match (better, worse) {
        (Some(better), Some(worse)) => {
            let word = if better < worse { "confirmed" } else { "**refuted**" };
            format!("{word} ({:.2} : {:.2})", 100.0 * better, 100.0 * worse)
        }
        _ => "–".to_owned(),
    };
    println!("\n### What the talk says\n");
    println!("P. H. Christensen and B. Burley 2015, errors in percent over all r, theirs first.");
    println!(
        "The talk names dipole, better dipole and beam diffusion; the other models are put to the same test."
    );
    println!(
        "Normalized diffusion was fitted to this very case, the models of media were derived for all.\n"
    );
    println!("| claim | A = 0.2 | A = 0.5 | A = 0.8 | mean |");
    println!("|---|---|---|---|---|");
    let print = |claim: String, better: Option<[Option<f64>; 4]>, worse: Option<[Option<f64>; 4]>| {
        if let (Some(better), Some(worse)) = (better, worse) {
            let verdicts: Vec<String> = (0..4).map(|i| verdict(better[i], worse[i])).collect();
            println!("| {claim} | {} |", verdicts.join(" | "));
        }
    };
    let normalized = "normalized-diffusion";
    let others = [
        "dipole",
        "better-dipole",
        "better-dipole + single scattering",
        "directional-dipole, average",
        "quantized-diffusion",
        "quantized-diffusion + single scattering",
        "photon-beam-diffusion, multiple only",
        "photon-beam-diffusion",
    ];
    for other in others {
        print(format!("{normalized} is better than {other}"), find(errors, normalized), find(errors, other));
        let claim = "… and of the exact α".to_owned();
        print(claim, find(errors, normalized), find(of_media, other));
    }
    let two = find(errors, "best 2 exponentials");
    print(
        "two exponentials are better than two Gaussians".to_owned(),
        two,
        find(errors, "gaussians, 2 terms"),
    );
}
