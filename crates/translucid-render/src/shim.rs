use translucid_scene::*;
pub(crate) trait V {
    fn validate(&self) -> Result<(), SceneError> {
        Ok(())
    }
    fn validate_light(&self, _: usize) -> Result<(), SceneError> {
        Ok(())
    }
    fn validate_material(&self, _: usize) -> Result<(), SceneError> {
        Ok(())
    }
    fn validate_object(&self, _: usize) -> Result<(), SceneError> {
        Ok(())
    }
    fn validate_triangle_count(&self) -> Result<(), SceneError> {
        Ok(())
    }
    fn validate_environment(&self) -> Result<(), SceneError> {
        Ok(())
    }
}
impl V for Scene {}
impl V for Camera {}
impl V for Film {}
impl V for Integrator {}
