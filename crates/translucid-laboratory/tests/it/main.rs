//! Laws of the laboratory, in one binary: what takes long to compute is computed once.

mod charts;
mod comparison;
mod documents;
mod model_ranking;
mod whole;
