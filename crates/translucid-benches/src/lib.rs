//! Benches of the renderer, and tests that need readers of files beside it.
//!
//! They are a crate of their own, so that what they need is no dependency of the renderer, not even of its tests: a change
//! in a reader of meshes compiles none of them. The library itself is empty.
