//! Runs a white walk, saves its table, and prints what it says and what it cost.
//!
//! ```text
//! cargo run --release -p translucid-reference --example white_table -- [PHOTONS [REFERENCE_ALBEDO [FILE.npz]]]
//! ```
//!
//! RAYON_NUM_THREADS sets the number of threads.

use std::path::Path;
use std::time::Instant;

use translucid_reference::walk::{Control, Layout, Parameters, Problem, Side, TableError, WhiteTable};

#[allow(clippy::print_stdout, reason = "an example shows its results")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let photons: u64 = arguments.next().map_or(Ok(10_000_000), |argument| argument.parse())?;
    let reference_albedo: f64 = arguments.next().map_or(Ok(0.999), |argument| argument.parse())?;
    let path = arguments.next();

    // 300 rings, from 0.001 to 100 mean free paths
    let radii: Vec<f64> = (0..300).map(|i| 1e-3 * 10f64.powf(f64::from(i) / 60.0)).collect();
    let layout = Layout::new(&radii, 1)?;
    let mut table = WhiteTable::new(Problem::new(Parameters::default())?, layout, reference_albedo)?;
    let start = Instant::now();
    table.run(1, photons, &Control::default())?;
    let seconds = start.elapsed().as_secs_f64();
    let collisions = table.mean_collisions() * photons as f64;
    println!("threads           {}", rayon::current_num_threads());
    println!("photons           {photons}");
    println!("mean collisions   {:.3}", table.mean_collisions());
    println!("wall time         {seconds:.3} s, {:.3} ns a collision", 1e9 * seconds / collisions);

    let start = Instant::now();
    print_totals(&table)?;
    println!("these took        {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    if let Some(path) = path {
        let start = Instant::now();
        table.save(Path::new(&path))?;
        println!("saved in          {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        let same = WhiteTable::load(Path::new(&path))? == table;
        println!(
            "loaded in         {:.1} ms, {}",
            1e3 * start.elapsed().as_secs_f64(),
            if same { "equal" } else { "different" }
        );
    }
    Ok(())
}

#[allow(clippy::print_stdout, reason = "an example shows its results")]
fn print_totals(table: &WhiteTable) -> Result<(), TableError> {
    println!("albedo     total          error     enclosed 1 ℓ   error     grouping at most");
    let albedos = [0.1, 0.5, 0.9, 0.99, 0.999].into_iter().filter(|&alpha| alpha < table.reference_albedo());
    for alpha in albedos.chain([table.reference_albedo()]) {
        let at = table.at_albedo(alpha)?;
        let (total, near) = (at.total(Side::Reflected), at.enclosed(Side::Reflected, 180));
        let grouping = at.grouping_error(Side::Reflected, translucid_reference::walk::Region::Everywhere);
        println!(
            "{alpha:<8} {:.8} ± {:.8}   {:.8} ± {:.8}   {grouping:.1e}",
            total.value, total.error, near.value, near.error
        );
    }
    Ok(())
}
