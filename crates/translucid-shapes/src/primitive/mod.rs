//! Geometric shapes, and surfaces that others are made from.

pub(super) mod basic;
pub(super) mod lathe;
pub(super) mod rounded_box;
