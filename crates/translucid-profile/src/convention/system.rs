//! A system with its parameters, and the way from them to a material and back.

use super::parameter::WALK_G;
use super::rule::{Factor, Rule};
use super::{Channel, CyclesMethod, CyclesWalk, Parameter, Role, SurfaceAlbedo, Unit, multiscatter};
use crate::error::{ParameterError, require};
use crate::{Configuration, Medium, half_space_single_scattering_albedo, scaling_from_mfp_diffuse};

/// One way to specify a translucent material in one system.
///
/// Some systems have several, with the same name and other parameters.
#[derive(Clone, Copy, Debug)]
pub struct System {
    /// Name, in letters, digits, hyphens and dots.
    pub name: &'static str,
    /// Name in words.
    pub title: &'static str,
    /// Versions of the system for which the rule is known to hold.
    pub version: &'static str,
    /// Name of the surface albedo in the system; none where coefficients determine it.
    pub albedo_name: Option<&'static str>,
    /// The parameters, in the order of the values that [`read`](Self::read) takes.
    pub parameters: &'static [Parameter],
    /// Unit of the length, the product of the parameters, and the reciprocal of coefficients' unit; none where it is the unit that
    /// the scene is modeled in, whatever that is.
    pub unit: Option<Unit>,
    pub(super) rule: Rule,
    /// The method of Cycles, if the system is one; a walk is told a color that is not the surface albedo.
    pub(super) cycles: Option<CyclesMethod>,
    /// The rule as a formula, for people; `length` is the product of the parameters.
    pub formula: &'static str,
    /// The shortest length that the system uses as it is; it takes this one for every shorter one.
    pub least_length: Option<f64>,
    /// Source of the rule.
    pub source: Source,
}

/// Source of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// File with its repository and revision, or document.
    pub place: &'static str,
    /// "code" if the rule was read there as source, "document" if only its description was, "measured" if pictures show it.
    pub kind: &'static str,
}

/// Quantity that stays the same when a material goes to a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equal {
    /// The width d of Burley's profile.
    Width,
    /// The transport mean free path ℓ*.
    MeanFreePath,
}

/// A channel in the numbers of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Written {
    /// Product of the parameters that are lengths \[L\]; factors are divided out.
    Length(f64),
    /// Coefficients \[L⁻¹\]; factors are divided out.
    Coefficients {
        /// Absorption σ_a.
        sigma_a: f64,
        /// Scattering σ_s.
        sigma_s: f64,
    },
}

impl System {
    /// Quantity that a conversion to this system keeps.
    pub fn equal(&self) -> Equal {
        match self.rule {
            Rule::Width(_) | Rule::MediumAsProfile => Equal::Width,
            Rule::Mfp(_) | Rule::Medium => Equal::MeanFreePath,
        }
    }

    /// Returns whether the parameters determine the surface albedo, too.
    pub fn has_coefficients(&self) -> bool {
        self.albedo_name.is_none()
    }

    /// Default values: 1 for lengths, the system's own for factors and settings.
    pub fn defaults(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.role.default()).collect()
    }

    /// Surface albedo that the parameters of one channel determine, if they do.
    ///
    /// For a medium it is that of the half space without a boundary ([`Medium::surface_albedo`]).
    ///
    /// # Errors
    /// A value is outside its range.
    pub fn surface_albedo(
        &self,
        values: &[f64],
        configuration: Configuration,
    ) -> Result<Option<f64>, ParameterError> {
        Ok(match self.rule {
            Rule::Width(_) | Rule::Mfp(_) => None,
            Rule::Medium => Some(self.medium(values)?.surface_albedo(configuration)),
            Rule::MediumAsProfile => Some(self.medium(values)?.alpha_prime()),
        })
    }

    /// One channel of the material that the parameters describe, in the system's unit.
    ///
    /// `values` are those of [`parameters`](Self::parameters); the surface albedo is what the system is told, or what
    /// [`surface_albedo`](Self::surface_albedo) says. That of the channel is the one that comes out.
    ///
    /// # Errors
    /// A value is outside its range, or the rule has no meaning at this surface albedo.
    pub fn read(
        &self,
        values: &[f64],
        albedo: SurfaceAlbedo,
        configuration: Configuration,
    ) -> Result<Channel, ParameterError> {
        match self.rule {
            Rule::Width(factor) => {
                let d = self.length(values)? * self.factor(factor, albedo, values)?;
                Channel::from_d(albedo, d, configuration)
            }
            Rule::Mfp(factor) => {
                let mfp = self.length(values)? * self.factor(factor, albedo, values)?;
                let Some(walk) = self.walk(values)? else {
                    let (albedo, mfp) = self.absorbed(values, albedo, mfp)?;
                    return Channel::from_mfp(albedo, mfp, configuration);
                };
                let mfp = walk.transport_mfp(albedo.of_channel(), mfp);
                Channel::from_mfp(albedo.map(|color| walk.surface_albedo(color))?, mfp, configuration)
            }
            Rule::Medium => Channel::from_mfp(albedo, self.medium(values)?.transport_mfp(), configuration),
            Rule::MediumAsProfile => {
                let medium = self.medium(values)?;
                let d = medium.transport_mfp() / scaling_from_mfp_diffuse(medium.alpha_prime());
                Channel::from_d(albedo, d, configuration)
            }
        }
    }

    /// One channel in the numbers of the system, its lengths being in the system's unit.
    ///
    /// `settings` has a value for each of [`parameters`](Self::parameters); those of factors and settings count.
    ///
    /// # Errors
    /// A value is outside its range, or the rule has no meaning at this surface albedo.
    pub fn write(
        &self,
        channel: &Channel,
        settings: &[f64],
        configuration: Configuration,
    ) -> Result<Written, ParameterError> {
        let albedo = self.own_albedo(channel.albedo(), settings)?;
        let factors = self.factors(settings)?;
        Ok(match self.rule {
            Rule::Width(factor) => {
                Written::Length(channel.d() / factors / self.factor(factor, albedo, settings)?)
            }
            Rule::Mfp(factor) => {
                let of_walk = self.walk(settings)?.map(|walk| walk.transport_mfp(albedo.of_channel(), 1.0));
                let factor = self.factor(factor, albedo, settings)? * of_walk.unwrap_or(1.0);
                Written::Length(channel.mfp() / factors / factor)
            }
            Rule::Medium => {
                let alpha_prime = half_space_single_scattering_albedo(albedo.of_channel(), configuration);
                self.coefficients(alpha_prime, channel.mfp(), settings)?
            }
            Rule::MediumAsProfile => {
                let alpha_prime = albedo.of_channel();
                self.coefficients(alpha_prime, channel.d() * scaling_from_mfp_diffuse(alpha_prime), settings)?
            }
        })
    }

    /// The color to tell the system for a surface albedo, or for the nearest that it reaches.
    ///
    /// # Errors
    /// A setting is outside its range.
    pub fn own_albedo(
        &self,
        albedo: SurfaceAlbedo,
        settings: &[f64],
    ) -> Result<SurfaceAlbedo, ParameterError> {
        match self.walk(settings)? {
            Some(walk) => albedo.map(|albedo| walk.color(albedo)),
            None => Ok(albedo),
        }
    }

    /// The greatest surface albedo that the system reaches; 1 for most.
    ///
    /// # Errors
    /// A setting is outside its range.
    pub fn brightest(&self, settings: &[f64]) -> Result<f64, ParameterError> {
        Ok(self.walk(settings)?.map_or(1.0, |walk| walk.brightest()))
    }

    /// Cycles' random walk, if the system is one.
    fn walk(&self, values: &[f64]) -> Result<Option<CyclesWalk>, ParameterError> {
        let Some(method) = self.cycles else { return Ok(None) };
        self.setting(values)?;
        let g = self.with_values(values).find(|(parameter, _)| parameter.name == WALK_G);
        Ok(method.walk(g.map_or(0.0, |(_, g)| g)))
    }

    /// Each parameter with its value, the default where there is none.
    fn with_values(&self, values: &[f64]) -> impl Iterator<Item = (&'static Parameter, f64)> {
        self.parameters
            .iter()
            .enumerate()
            .map(|(i, parameter)| (parameter, values.get(i).copied().unwrap_or(parameter.role.default())))
    }

    /// Product of lengths and factors.
    fn length(&self, values: &[f64]) -> Result<f64, ParameterError> {
        let mut length = self.factors(values)?;
        for (parameter, value) in self.with_values(values) {
            // Length 0 is a Lambertian channel
            length *= match parameter.role {
                Role::Length | Role::Distance if value == 0.0 => value,
                Role::Length | Role::Distance => require_moderate(parameter, value)?,
                Role::Attenuation => {
                    let is_color = (0.0..1.0).contains(&value);
                    -1.0 / libm::log(require(is_color, parameter.name, value, "in [0, 1)")?)
                }
                _ => 1.0,
            };
        }
        Ok(length)
    }

    /// The surface albedo and the mean free path of a medium that a filter over the distance of a setting makes absorb more.
    fn absorbed(
        &self,
        values: &[f64],
        albedo: SurfaceAlbedo,
        mfp: f64,
    ) -> Result<(SurfaceAlbedo, f64), ParameterError> {
        let filter = self.with_values(values).find(|(parameter, _)| parameter.role == Role::Filter);
        let Some((parameter, color)) = filter else { return Ok((albedo, mfp)) };
        require(color > 0.0 && color <= 1.0, parameter.name, color, "in (0, 1]")?;
        let distance = self.setting(values)?;
        if distance == 0.0 || color == 1.0 {
            return Ok((albedo, mfp));
        }
        let more = 1.0 - mfp * libm::log(color) / distance;
        let absorbing = |a: f64| multiscatter::color(multiscatter::single_scattering_albedo(a, 0.0) / more);
        Ok((albedo.map(absorbing)?, mfp / more))
    }

    /// Product of the factors, each over the value that changes nothing.
    fn factors(&self, values: &[f64]) -> Result<f64, ParameterError> {
        let mut product = 1.0;
        for (parameter, value) in self.with_values(values) {
            if let Role::Factor { per, .. } = parameter.role {
                product *= require_moderate(parameter, value)? / per;
            }
        }
        Ok(product)
    }

    /// The first setting, of which no rule needs two, once all are in their ranges; 0 without one.
    fn setting(&self, values: &[f64]) -> Result<f64, ParameterError> {
        let mut first = None;
        for (parameter, value) in self.with_values(values) {
            if let Role::Setting { above, below, allowed, .. } = parameter.role {
                let value = require(value > above && value < below, parameter.name, value, allowed)?;
                first.get_or_insert(value);
            }
        }
        Ok(first.unwrap_or(0.0))
    }

    fn factor(&self, factor: Factor, albedo: SurfaceAlbedo, values: &[f64]) -> Result<f64, ParameterError> {
        factor.value(albedo, self.setting(values)?)
    }

    /// The medium of σ_a, σ_s, g and a factor of the coefficients.
    fn medium(&self, values: &[f64]) -> Result<Medium, ParameterError> {
        let (mut sigma_a, mut sigma_s) = (self.factors(values)?, self.factors(values)?);
        for (parameter, value) in self.with_values(values) {
            match parameter.role {
                Role::Absorption => sigma_a *= value,
                Role::Scattering => sigma_s *= value,
                _ => {}
            }
        }
        Medium::new(sigma_a, sigma_s, self.setting(values)?)
    }

    /// The coefficients of a reduced albedo and a transport mean free path, with the g and the factor of the settings.
    fn coefficients(
        &self,
        alpha_prime: f64,
        transport_mfp: f64,
        settings: &[f64],
    ) -> Result<Written, ParameterError> {
        let g = self.setting(settings)?;
        let scale = self.factors(settings)?;
        let medium =
            Medium::from_reduced((1.0 - alpha_prime) / transport_mfp, alpha_prime / transport_mfp, g)?;
        Ok(Written::Coefficients { sigma_a: medium.sigma_a() / scale, sigma_s: medium.sigma_s() / scale })
    }
}

/// Passes on a length or a factor that leaves room for products.
fn require_moderate(parameter: &Parameter, value: f64) -> Result<f64, ParameterError> {
    require((1e-110..=1e110).contains(&value), parameter.name, value, "in [1e-110, 1e110]")
}
