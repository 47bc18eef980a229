//! Parts of a prepared scene as numbers, for devices that trace paths by themselves.

mod tables;

pub use tables::material_tables;
