//! Curves that were computed last, for a search that asks for the same ones again.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// Curves that are kept: those of three channels, changed and unchanged.
const KEPT: usize = 8;

/// Curves by what they are of: most parameters of a search change one channel's or none.
pub(crate) struct RecentCurves<K>(RefCell<VecDeque<(K, Rc<Vec<f64>>)>>);

impl<K: Copy + PartialEq> RecentCurves<K> {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self(RefCell::default())
    }

    /// The curve of a key, computed where it is not kept.
    pub(crate) fn get(&self, key: &K, eval: impl FnOnce(&K) -> Vec<f64>) -> Rc<Vec<f64>> {
        let mut curves = self.0.borrow_mut();
        if let Some(i) = curves.iter().position(|(known, _)| known == key)
            && let Some(found) = curves.remove(i)
        {
            // Last used, last to go
            curves.push_front(found);
        } else {
            curves.truncate(KEPT - 1);
            curves.push_front((*key, Rc::new(eval(key))));
        }
        Rc::clone(&curves[0].1)
    }
}
