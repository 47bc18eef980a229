//! Pictures on graphics processors: the path tracer of `translucid-render` in WGSL.

#[cfg(test)]
mod evaluate;
#[cfg(test)]
mod light_tests;
