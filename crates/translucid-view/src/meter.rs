//! Metering: a scene that states no exposure has that of its first picture, as the command's pictures have.

/// So many samples per pixel tell the exposure well enough to keep it.
const ENOUGH: u32 = 16;

/// The meter, which looks at each picture until one is finished. A person who changes something sees the change: the exposure
/// follows no further then than to a picture with few samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Meter {
    samples: u32,
    is_disturbed: bool,
}

impl Meter {
    /// The meter after a picture with so many samples; none once that decides.
    pub(crate) fn after_picture(self, samples: u32, is_last: bool) -> Option<Self> {
        let samples = samples.max(self.samples);
        let decides = is_last || self.is_disturbed && samples >= ENOUGH;
        (!decides).then_some(Self { samples, ..self })
    }

    /// The meter after a change; none if the exposure of the pictures before it stays.
    pub(crate) fn after_change(self) -> Option<Self> {
        (self.samples < ENOUGH).then_some(Self { is_disturbed: true, ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meter_goes_on_until_a_picture_decides() {
        let meter = Meter::default().after_picture(1, false).unwrap();
        assert!(meter.after_picture(4, true).is_none());
        let disturbed = meter.after_change().unwrap();
        assert!(disturbed.after_picture(ENOUGH - 1, false).is_some());
        assert!(disturbed.after_picture(ENOUGH, false).is_none());
        let late = meter.after_picture(ENOUGH, false).unwrap();
        assert!(late.after_change().is_none() && late.after_picture(2 * ENOUGH, false).is_some());
    }
}
