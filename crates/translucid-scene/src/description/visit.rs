//! Going through the numbers of a scene's things.

use super::parts::Part;
use super::slot::Thing;

/// Things whose numbers can be visited.
pub trait Visit<T> {
    /// Visits every number of a thing, by its name: `position[1]`.
    fn visit(&self, thing: &mut T, visit: &mut dyn FnMut(&str, Part<'_>));
}

impl<T> Visit<T> for Thing<T> {
    fn visit(&self, thing: &mut T, visit: &mut dyn FnMut(&str, Part<'_>)) {
        for field in self.fields {
            (field.slot)(thing).visit(field.key(), visit);
        }
    }
}
