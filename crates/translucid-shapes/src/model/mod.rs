//! Models of things: fruit, a bust, toys, a candle, what stands on a table.

pub(super) mod bust;
pub(super) mod candle;
pub(super) mod carving;
pub(super) mod ear;
pub(super) mod fruit;
pub(super) mod furniture;
pub(super) mod grapes;
pub(super) mod lithophane;
pub(super) mod tableware;
pub(super) mod tooth;
pub(super) mod toy;
