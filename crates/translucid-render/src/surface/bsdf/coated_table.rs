//! Light that a rough lobe under a coat loses to the coat, beyond the coat's loss in the direction seen.
//!
//! A facet lobe under a coat is scaled by the lesser of the coat's transmittances in both directions,
//! which is reciprocal. Of a lobe with directional albedo E seen at μ, the coat of reflectance `E_c` then
//! leaves `(1 − E_c(μ)) E − X`, with
//!
//! ```text
//! X(μ) = ∫ f cosθi max(0, E_c(μi) − E_c(μ)) dωi
//! ```
//!
//! X is given to the matte base or, for a metal, to the light between facets.

use translucid_law::{
    Ggx, LOSS_COLUMNS, LOSS_ROWS, average_at_both, average_loss_at, fresnel_dielectric, loss_at,
};

use super::reflectance_table::{
    AVERAGE_ROWS, COSINE_NODES, MetalTable, ReflectanceTable, ReflectionQuadrature, TableGrid,
    average_roughness, cosine_mean, gauss_legendre, mirrored_cos, passed_share,
};

/// Nodes over t, over the base's roughness and over the coat's.
const COLUMNS: usize = LOSS_COLUMNS as usize;
const BASE_ROWS: usize = LOSS_ROWS as usize;
const COAT_ROWS: usize = translucid_law::COAT_ROWS as usize;

/// X over (μ, roughness of the base, roughness of the coat), and its cosine mean.
#[derive(Clone, Debug)]
struct Loss {
    losses: Box<[[f32; COLUMNS * BASE_ROWS]; COAT_ROWS]>,
    average: [[f32; BASE_ROWS]; COAT_ROWS],
}

impl Loss {
    fn new(coat: &ReflectanceTable, fresnel: impl Fn(f32) -> f32) -> Self {
        let facets = ReflectionQuadrature::new();
        let grids: [TableGrid<COLUMNS, BASE_ROWS>; COAT_ROWS] = std::array::from_fn(|row| {
            let coat_roughness = row as f32 / (COAT_ROWS - 1) as f32;
            TableGrid::new(|mu, roughness| {
                let ggx = Ggx::from_roughness(roughness);
                let seen = coat.eval(mu, coat_roughness);
                facets.mean(mu, roughness, |wo, h| {
                    let cos_i = mirrored_cos(wo, h);
                    let more = coat.eval(cos_i.max(0.0), coat_roughness) - seen;
                    fresnel(wo.dot(h)) * passed_share(&ggx, wo, cos_i) * more.max(0.0)
                })
            })
        });
        let average = std::array::from_fn(|coat_row| {
            std::array::from_fn(|row| {
                let roughness = TableGrid::<COLUMNS, BASE_ROWS>::row_roughness(row);
                cosine_mean(|mu| grids[coat_row].eval(mu, roughness))
            })
        });
        let losses = grids.map(|grid| std::array::from_fn(|place| grid.values()[place]));
        Self { losses: Box::new(losses), average }
    }

    fn eval(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
        loss_at(self.losses.as_flattened(), mu, roughness, coat_roughness)
    }

    /// The losses, then their averages.
    fn numbers(&self) -> Vec<f32> {
        [self.losses.as_flattened(), self.average.as_flattened()].concat()
    }

    fn average(&self, roughness: f32, coat_roughness: f32) -> f32 {
        average_loss_at(self.average.as_flattened(), roughness, coat_roughness)
    }
}

/// Means over roughness of the coat (first index) and of the base.
type Averages = Box<[[f32; AVERAGE_ROWS]; AVERAGE_ROWS]>;

/// Couplings of a coat with the lobes under it, for a coat weight of 1.
#[derive(Clone, Debug)]
pub(super) struct CoatedTable {
    dielectric: Loss,
    metal: Loss,
    coat_dielectric: Averages,
    coat_metal: Averages,
}

impl CoatedTable {
    /// The table of a coat over a dielectric.
    pub(super) fn new(coat: &ReflectanceTable, specular: &ReflectanceTable) -> Self {
        let deficit = MetalTable::shared();
        Self {
            dielectric: Loss::new(coat, |cos| fresnel_dielectric(cos, specular.eta())),
            metal: Loss::new(coat, |_| 1.0),
            coat_dielectric: averages(coat, |mu, roughness| specular.eval(mu, roughness)),
            coat_metal: averages(coat, |mu, roughness| deficit.deficit(mu, roughness)),
        }
    }

    /// Losses of a dielectric and of a metal, then the averages of both.
    pub(super) fn numbers(&self) -> [Vec<f32>; 4] {
        let averages = |of: &Averages| of.as_flattened().to_vec();
        [
            self.dielectric.numbers(),
            self.metal.numbers(),
            averages(&self.coat_dielectric),
            averages(&self.coat_metal),
        ]
    }

    /// X of the dielectric's reflection.
    pub(super) fn dielectric_loss(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
        self.dielectric.eval(mu, roughness, coat_roughness)
    }

    /// X of a white metal.
    pub(super) fn metal_loss(&self, mu: f32, roughness: f32, coat_roughness: f32) -> f32 {
        self.metal.eval(mu, roughness, coat_roughness)
    }

    /// 2 ∫ (E_c E + X) μ dμ for the dielectric's reflection of albedo E.
    pub(super) fn dielectric_average(&self, roughness: f32, coat_roughness: f32) -> f32 {
        average_at_both(self.coat_dielectric.as_flattened(), roughness, coat_roughness)
            + self.dielectric.average(roughness, coat_roughness)
    }

    /// 2 ∫ (X − E_c (1 − E)) μ dμ for a white metal of albedo E.
    pub(super) fn metal_average(&self, roughness: f32, coat_roughness: f32) -> f32 {
        self.metal.average(roughness, coat_roughness)
            - average_at_both(self.coat_metal.as_flattened(), roughness, coat_roughness)
    }
}

fn averages(coat: &ReflectanceTable, base: impl Fn(f32, f32) -> f32) -> Averages {
    let nodes = gauss_legendre::<COSINE_NODES>();
    let sampled = |f: &dyn Fn(f32, f32) -> f32| -> [[f32; COSINE_NODES]; AVERAGE_ROWS] {
        std::array::from_fn(|row| nodes.map(|(mu, _)| f(mu, average_roughness(row))))
    };
    let (e_c, e_b) = (sampled(&|mu, roughness| coat.eval(mu, roughness)), sampled(&base));
    let mut averages = Box::new([[0.0; AVERAGE_ROWS]; AVERAGE_ROWS]);
    for (line, c) in averages.iter_mut().zip(&e_c) {
        for (value, b) in line.iter_mut().zip(&e_b) {
            *value = nodes.iter().zip(c.iter().zip(b)).map(|((mu, w), (c, b))| 2.0 * mu * w * c * b).sum();
        }
    }
    averages
}
