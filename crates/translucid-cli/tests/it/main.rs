//! The command from outside: what it prints and writes, how it ends, and what the documentation says of it.

mod bits;
mod broken_files;
mod command_line;
mod common;
mod compare;
mod convert;
mod export;
mod fit;
mod gallery;
mod killed;
mod known_shape;
mod layers;
mod look;
mod markdown;
mod measure;
mod pages;
mod photographs;
mod points;
mod reference;
mod render;
mod shards;
mod side_by_side;
mod stopped;
mod tables;
mod tev;
mod watch;
