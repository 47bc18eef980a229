//! How far every model is from the exact solution, as tables in Markdown.
//!
//! ```text
//! cargo bench -p translucid-laboratory --bench model_errors
//! ```
//!
//! The half space scatters isotropically and has the refractive index of its surroundings; its mean free path is 1.

#![allow(clippy::print_stdout, reason = "the tables are what the bench is for")]

use translucid_laboratory::comparison::{
    Claim, Contender, ErrorTable, Inversion, Watch, claims, talk_albedos,
};
use translucid_profile::Configuration;

/// Surface albedos of which the talk speaks.
const SPOKEN_OF: [f64; 3] = [0.2, 0.5, 0.8];
const SEARCHLIGHT: Configuration = Configuration::Searchlight;
const DIFFUSE: Configuration = Configuration::Diffuse;

fn main() {
    let contenders = Contender::all();
    let configurations = [SEARCHLIGHT, DIFFUSE];
    let table = ErrorTable::new(&contenders, &configurations, &talk_albedos(), &SPOKEN_OF, Watch::default());
    let table = table.expect("nobody stops it");

    print_heading(
        "Searchlight: every model from the surface albedo A and the mean free path, its total being A",
    );
    contenders.iter().for_each(|one| print_row(&table, one, SEARCHLIGHT, Inversion::Own));
    println!();
    println!(
        "\"Best\" is the least-squares fit at each A in the norm ∫ (R_fit − R)² r³ dr, as the Gaussians are."
    );

    print_heading(
        "Searchlight: models that know media, from the single-scattering albedo that A has exactly",
    );
    contenders.iter().for_each(|one| print_row(&table, one, SEARCHLIGHT, Inversion::Exact));

    print_heading("Diffuse transmission");
    contenders.iter().for_each(|one| print_row(&table, one, DIFFUSE, Inversion::Own));

    print_claims(&claims(&contenders, &table, &SPOKEN_OF));
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

/// Prints nothing where the model has no errors.
fn print_row(table: &ErrorTable, contender: &Contender, configuration: Configuration, inversion: Inversion) {
    let Some(summary) = table.summary(contender.name, configuration, inversion) else { return };
    let percent = |error: f64| format!("{:.2}", 100.0 * error);
    let means = summary.errors.map(|errors| percent(errors.mean)).join(" | ");
    let at = SPOKEN_OF
        .map(|a| table.at(contender.name, configuration, inversion, a).map_or("–".to_owned(), percent));
    let [.., all_r] = summary.errors;
    println!(
        "| {} | {means} | {} | {} at {} | {} |",
        contender.title,
        at.join(" | "),
        percent(all_r.worst),
        all_r.worst_surface_albedo,
        summary.reached
    );
}

/// What the talk says, and what the tables say of it.
fn print_claims(claims: &[Claim]) {
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
    let verdict = |errors: &Option<[f64; 2]>| match errors {
        Some([better, worse]) => {
            let word = if Claim::is_confirmed([*better, *worse]) { "confirmed" } else { "**refuted**" };
            format!("{word} ({:.2} : {:.2})", 100.0 * better, 100.0 * worse)
        }
        None => "–".to_owned(),
    };
    for claim in claims {
        let text = match claim.worse.inversion {
            Inversion::Own => claim.statement(),
            Inversion::Exact => "… and of the exact α".to_owned(),
        };
        let verdicts: Vec<String> = claim.errors.iter().chain([&claim.means]).map(verdict).collect();
        println!("| {text} | {} |", verdicts.join(" | "));
    }
}
