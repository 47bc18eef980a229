//! Time per call of tables, and what making them takes.
//!
//! `cargo bench -p translucid-profile --bench tables`.
//! Figures of calls are for 4,096 of them on random arguments: divide by 4,096, or take the reciprocal of `item/s`.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use translucid_profile::{
    AlbedoTable, AlbedoTableF32, Appearance, BetterDipole, Configuration, ExactProfile, NormalizedDiffusion,
    ParameterError, Parameterization, PhotonBeamDiffusion, Profile, ProfileViewF32, TabulatedProfile,
};
use translucid_testing::golden_uniforms;

const COUNT: usize = 4096;

fn main() {
    divan::main();
}

fn appearance(surface_albedo: f64) -> Appearance {
    Appearance { surface_albedo, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 }
}

fn dipole(surface_albedo: f64) -> Result<Box<dyn Profile>, ParameterError> {
    Ok(Box::new(BetterDipole::new(&appearance(surface_albedo), 1.0)?))
}

/// Calls f on every element, one at a time.
fn one_by_one<T: Copy>(bencher: Bencher<'_, '_>, arguments: &[T], f: impl Fn(T) -> T) {
    bencher.counter(ItemsCount::new(arguments.len())).bench_local(|| {
        for argument in arguments {
            black_box(f(black_box(*argument)));
        }
    });
}

mod double {
    use super::*;

    fn bench_table(bencher: Bencher<'_, '_>, of_share: bool, f: impl Fn(&TabulatedProfile, f64) -> f64) {
        let source = dipole(0.8).expect("valid parameters");
        let table = TabulatedProfile::new(&*source);
        let arguments: Vec<f64> = if of_share {
            golden_uniforms(COUNT)
        } else {
            golden_uniforms(COUNT).iter().map(|u| table.quantile(*u)).collect()
        };
        one_by_one(bencher, &arguments, |argument| f(&table, argument));
    }

    #[divan::bench]
    fn eval(bencher: Bencher<'_, '_>) {
        bench_table(bencher, false, TabulatedProfile::eval);
    }

    #[divan::bench]
    fn pdf(bencher: Bencher<'_, '_>) {
        bench_table(bencher, false, TabulatedProfile::pdf);
    }

    #[divan::bench]
    fn cdf(bencher: Bencher<'_, '_>) {
        bench_table(bencher, false, TabulatedProfile::cdf);
    }

    #[divan::bench]
    fn quantile(bencher: Bencher<'_, '_>) {
        bench_table(bencher, true, TabulatedProfile::quantile);
    }
}

/// A view between two rows of an albedo table.
mod single {
    use super::*;

    fn table() -> AlbedoTableF32 {
        AlbedoTableF32::from(&AlbedoTable::for_every_albedo(dipole).expect("every albedo"))
    }

    fn bench_view(bencher: Bencher<'_, '_>, of_share: bool, f: impl Fn(ProfileViewF32<'_>, f32) -> f32) {
        let table = table();
        let view = table.at(0.8, 1.0);
        let arguments: Vec<f32> = golden_uniforms(COUNT)
            .iter()
            .map(|u| *u as f32)
            .map(|u| if of_share { u } else { view.sample(u) })
            .collect();
        one_by_one(bencher, &arguments, |argument| f(view, argument));
    }

    #[divan::bench]
    fn at(bencher: Bencher<'_, '_>) {
        let table = table();
        let albedos: Vec<f32> = golden_uniforms(COUNT).iter().map(|u| *u as f32).collect();
        bencher.counter(ItemsCount::new(albedos.len())).bench_local(|| {
            for albedo in &albedos {
                black_box(table.at(black_box(*albedo), 1.0));
            }
        });
    }

    #[divan::bench]
    fn pdf(bencher: Bencher<'_, '_>) {
        bench_view(bencher, false, |view, x| view.pdf(x));
    }

    /// Tables of a material whose albedo is no texture.
    #[divan::bench]
    fn pdf_of_one_row(bencher: Bencher<'_, '_>) {
        let table = AlbedoTableF32::from(&AlbedoTable::new(&[0.8], dipole).expect("one albedo"));
        let view = table.at(0.8, 1.0);
        let radii: Vec<f32> = golden_uniforms(COUNT).iter().map(|u| view.sample(*u as f32)).collect();
        one_by_one(bencher, &radii, |r| view.pdf(r));
    }

    #[divan::bench]
    fn pdf_area(bencher: Bencher<'_, '_>) {
        bench_view(bencher, false, |view, x| view.pdf_area(x));
    }

    #[divan::bench]
    fn cdf(bencher: Bencher<'_, '_>) {
        bench_view(bencher, false, |view, x| view.cdf(x));
    }

    #[divan::bench]
    fn sample(bencher: Bencher<'_, '_>) {
        bench_view(bencher, true, |view, x| view.sample(x));
    }

    #[divan::bench]
    fn sample_within(bencher: Bencher<'_, '_>) {
        bench_view(bencher, true, |view, u| view.sample_within(u, 10.0));
    }

    #[divan::bench]
    fn truncation_radius(bencher: Bencher<'_, '_>) {
        bench_view(bencher, true, |view, tail| view.truncation_radius(0.01 * tail));
    }
}

mod build {
    use super::*;

    fn bench_build(bencher: Bencher<'_, '_>, source: &dyn Profile) {
        bencher.bench_local(|| TabulatedProfile::new(black_box(source)));
    }

    #[divan::bench]
    fn normalized_diffusion(bencher: Bencher<'_, '_>) {
        bench_build(bencher, &NormalizedDiffusion::from_d(0.8, 1.0).expect("valid parameters"));
    }

    #[divan::bench]
    fn better_dipole(bencher: Bencher<'_, '_>) {
        bench_build(bencher, &*dipole(0.8).expect("valid parameters"));
    }

    #[divan::bench]
    fn photon_beam_diffusion(bencher: Bencher<'_, '_>) {
        bench_build(bencher, &PhotonBeamDiffusion::new(&appearance(0.8), 1.0).expect("valid parameters"));
    }

    #[divan::bench]
    fn exact(bencher: Bencher<'_, '_>) {
        let new = |a| ExactProfile::new(a, 1.0, Parameterization::Mfp, Configuration::Searchlight);
        bencher.bench_local(|| new(black_box(0.8)));
    }

    #[divan::bench]
    fn every_albedo_of_better_dipole(bencher: Bencher<'_, '_>) {
        bencher.bench_local(|| AlbedoTable::for_every_albedo(dipole));
    }
}
