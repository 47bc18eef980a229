//! SPIR-V: a module that computes functions for buffers of arguments.

use std::fmt::Write as _;

use naga::Module;
use naga::back::spv;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

use crate::error::ExportError;
use crate::function::Function;

/// Threads of a workgroup.
const WORKGROUP: usize = 64;

/// Entry points in WGSL that compute each function for every row of a buffer: `each_NAME`.
///
/// Binding 0 of group 0 has the arguments of all calls one after the other, binding 1 takes the results.
pub fn entry_points(functions: &[Function]) -> String {
    let mut text = String::from(
        "
@group(0) @binding(0) var<storage, read> arguments_of_all: array<f32>;
@group(0) @binding(1) var<storage, read_write> results_of_all: array<f32>;
",
    );
    for Function { name, arguments, call, outputs, .. } in functions {
        let (inputs, results) = (arguments.len(), outputs.len());
        // Writing to a string cannot fail
        let _ = writeln!(
            text,
            "
@compute @workgroup_size({WORKGROUP})
fn each_{name}(@builtin(global_invocation_id) id: vec3<u32>) {{
    let i: u32 = id.x;
    if (i * {results}u >= arrayLength(&results_of_all)) {{
        return;
    }}"
        );
        for (j, argument) in arguments.iter().enumerate() {
            let _ = writeln!(text, "    let {argument}: f32 = arguments_of_all[{inputs}u * i + {j}u];");
        }
        let _ = writeln!(text, "    let result = {call};");
        for (j, output) in outputs.iter().enumerate() {
            let field = if output.is_empty() { String::new() } else { format!(".{output}") };
            let _ = writeln!(text, "    results_of_all[{results}u * i + {j}u] = result{field};");
        }
        text += "}\n";
    }
    text
}

/// Reads WGSL and checks it, for a target.
pub(crate) fn checked(wgsl: &str, target: &str) -> Result<(Module, ModuleInfo), ExportError> {
    // A failure is a defect of the formulas, which tests of every text rule out
    let defect = |message: String| ExportError::new("to", target, format!("another: {message}"));
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|error| defect(error.emit_to_string(wgsl)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| defect(error.emit_to_string(wgsl)))?;
    Ok((module, info))
}

/// Compiles WGSL, little-endian.
pub(crate) fn compile(wgsl: &str) -> Result<Vec<u8>, ExportError> {
    let (module, info) = checked(wgsl, "spirv")?;
    let options = spv::Options { lang_version: (1, 3), ..spv::Options::default() };
    let words = spv::write_vec(&module, &info, &options, None)
        .map_err(|error| ExportError::new("to", "spirv", format!("another: {error}")))?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
