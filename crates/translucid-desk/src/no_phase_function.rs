//! Phase functions in WebAssembly, where layers have moments alone.

use translucid_reference::layers::Layer;
use translucid_words::{Context, Error, Item, Parse};

/// A phase function by its name, of which there is none.
#[derive(Clone, Debug)]
pub(crate) enum GivenPhaseFunction {}

impl GivenPhaseFunction {
    pub(crate) fn of(&self, _: Layer) -> Layer {
        match *self {}
    }
}

impl Parse for GivenPhaseFunction {
    const FORM: &'static str = "no phase function by its name";

    fn parse(item: &Item<'_>, _: &mut Context) -> Result<Self, Error> {
        Err(item.error(format!("{} is not in this module, but moments are", item.path())))
    }
}
