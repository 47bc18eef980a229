#!/usr/bin/env bash
# The Rust crate exr: an OpenEXR file of a flat part and a deep one.
#
# `no_deep_data().…first_valid_layer()` is documented to skip layers with deep data. The headers are validated before any
# layer is chosen, and one deep part refuses the file: the flat part beside it cannot be read.
# Python's OpenEXR writes the file and reads the flat part back.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/pip" install --quiet --disable-pip-version-check "OpenEXR==3.5.3" "numpy<3"
"$folder/environment/bin/python" - "$folder/parts.exr" <<'END'
import sys

import numpy
import OpenEXR

flat = numpy.ones((4, 5, 3), "float32")
deep = numpy.empty((4, 5), object)
for pixel in numpy.ndindex(4, 5):
    deep[pixel] = numpy.array([1.0, 2.0], "float32")
header = {"compression": OpenEXR.ZIPS_COMPRESSION}
parts = [
    OpenEXR.Part(header | {"type": OpenEXR.scanlineimage}, {"RGB": flat}, name="flat"),
    OpenEXR.Part(header | {"type": OpenEXR.deepscanline}, {"Z": deep}, name="deep"),
]
OpenEXR.File(parts).write(sys.argv[1])
with OpenEXR.File(sys.argv[1]) as file:
    assert numpy.array_equal(file.parts[0].channels["RGB"].pixels, flat)
print("OpenEXR 3.5.3 reads the flat part")
END

mkdir "$folder/src"
cat >"$folder/Cargo.toml" <<'END'
[package]
name = "deep"
version = "0.0.0"
edition = "2021"
[dependencies]
exr = "=1.74.2"
[workspace]
END
cat >"$folder/src/main.rs" <<'END'
use exr::prelude::{read, ReadChannels, ReadLayers};

fn main() {
    let path = std::env::args().nth(1).unwrap();
    let flat = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    match flat.from_file(path) {
        Ok(image) => println!("read {:?}", image.layer_data.attributes.layer_name),
        Err(error) => println!("{error}"),
    }
}
END
seen=$(cargo run --quiet --manifest-path "$folder/Cargo.toml" --target-dir "$folder/target" -- "$folder/parts.exr")
before="not supported: deep data not supported yet"
echo "exr 1.74.2: expected the part flat; seen before \"$before\"; seen now \"$seen\""
[ "$seen" = "$before" ]
