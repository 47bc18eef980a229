pub(super) struct LightWords { pub tables: Vec<f32>, pub images: Vec<u32> }
impl LightWords { pub fn triangle(&self, _primitive: u64) -> Option<u32> { None } }
pub(super) fn lights(_: &crate::render::PreparedScene) -> LightWords { LightWords { tables: vec![], images: vec![] } }
