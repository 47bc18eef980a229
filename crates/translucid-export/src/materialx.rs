//! MaterialX: every function as a node of its own, made of nodes that each renderer has, and materials.

use std::fmt::Write as _;

use translucid_profile::{Configuration, RefinedDiffusion};

use crate::error::ExportError;
use crate::function::Function;
use crate::material::{Material, Surface};
use crate::node_graph::{NodeGraph, Operand};
use crate::number::literal;
use crate::symbolic::{Source, Unknown, Value, field, number};

/// A whole document.
pub(crate) fn document(comment: &str, made_by: &str, definitions: &str) -> String {
    // XML allows no two hyphens in a row within a comment
    let comment: String =
        comment.lines().map(|line| line.trim_start_matches("//").to_owned() + "\n").collect();
    format!(
        "<?xml version=\"1.0\"?>\n<!--\n{}-->\n<materialx version=\"1.39\" colorspace=\"lin_rec709\" doc=\"{}\">\n{definitions}</materialx>\n",
        comment.replace("--", "- -"),
        escaped(made_by)
    )
}

/// Text as an attribute's value.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\n', "&#10;")
}

/// Functions as definitions of nodes.
pub(crate) fn definitions(formulas: &str, functions: &[Function]) -> Result<String, ExportError> {
    // A failure is a defect of the formulas, which tests of every text rule out
    let defect = |Unknown(what): Unknown| ExportError::new("to", "materialx", format!("another: {what}"));
    let source = Source::new(formulas);
    let mut text = String::new();
    for function in functions {
        text += &definition(&source, function, &comment_of(formulas, function.name)).map_err(defect)?;
    }
    Ok(text)
}

fn definition(source: &Source<'_>, function: &Function, doc: &str) -> Result<String, Unknown> {
    let Function { name, arguments, call, outputs, .. } = function;
    let inputs = arguments.iter().map(|argument| (*argument, Value::Number(Operand::Input(input(argument)))));
    let mut graph = NodeGraph::default();
    let value = source.evaluate(&mut graph, call, inputs.collect())?;
    let mut results = Vec::new();
    for output in outputs.iter().copied() {
        let result = if output.is_empty() { value.clone() } else { field(value.clone(), output)? };
        results.push((if output.is_empty() { "out" } else { output }, number(result)?));
    }
    let mut text = format!(
        "  <nodedef name=\"ND_translucid_{name}\" node=\"translucid_{name}\" nodegroup=\"math\" doc=\"{}\">\n",
        escaped(doc)
    );
    for argument in arguments.iter().copied() {
        let (name, value) = (input(argument), default(argument));
        let _ = writeln!(text, "    <input name=\"{name}\" type=\"float\" value=\"{value}\" />");
    }
    for (output, _) in &results {
        let _ = writeln!(text, "    <output name=\"{output}\" type=\"float\" />");
    }
    let _ = write!(
        text,
        "  </nodedef>\n  <nodegraph name=\"NG_translucid_{name}\" nodedef=\"ND_translucid_{name}\">\n{}  </nodegraph>\n",
        graph.text(&results)
    );
    Ok(text)
}

/// The name of an input: a shader in OSL has a `u` of its own.
fn input(argument: &'static str) -> &'static str {
    if argument == "u" { "random_number" } else { argument }
}

/// An input's value where nothing is connected.
fn default(argument: &str) -> &'static str {
    if argument == "eta" { "1.5" } else { "0.5" }
}

/// The comment before a function.
fn comment_of(formulas: &str, name: &str) -> String {
    let before = formulas.split(&format!("fn {name}(")).next().unwrap_or_default();
    let lines: Vec<&str> = before.lines().rev().take_while(|line| line.starts_with("//")).collect();
    let lines = lines.into_iter().rev().map(|line| line.trim_start_matches('/').trim());
    lines.collect::<Vec<_>>().join("\n")
}

/// A material, as OpenPBR Surface has it.
pub(crate) fn material(material: &Material, configuration: Configuration) -> Result<String, ExportError> {
    let Material { surface_albedo, length, parameterization, surface } = material;
    let mut mfp = [0.0; 3];
    for c in 0..3 {
        mfp[c] = RefinedDiffusion::new(surface_albedo[c], length[c], *parameterization, configuration)?.mfp();
    }
    let radius = mfp.into_iter().fold(0.0, f64::max);
    let three = |numbers: [f64; 3]| numbers.map(literal).join(", ");
    let clear = surface.and_then(|surface| surface.clear);
    let mut inputs = Vec::new();
    if let Some(Surface { ior, roughness, coat: [coat, coat_roughness], .. }) = *surface {
        inputs.push(("specular_ior", "float", literal(ior)));
        inputs.push(("specular_roughness", "float", literal(roughness)));
        if coat > 0.0 {
            inputs.push(("coat_weight", "float", literal(coat)));
            inputs.push(("coat_roughness", "float", literal(coat_roughness)));
        }
    }
    if let Some((color, depth)) = clear {
        inputs.push(("transmission_weight", "float", literal(1.0)));
        inputs.push(("transmission_color", "color3", three(color)));
        inputs.push(("transmission_depth", "float", literal(depth)));
    }
    inputs.extend([
        ("subsurface_weight", "float", literal(if clear.is_some() { 0.0 } else { 1.0 })),
        ("subsurface_color", "color3", three(*surface_albedo)),
        ("subsurface_radius", "float", literal(radius)),
        ("subsurface_radius_scale", "color3", three(mfp.map(|mfp| mfp / radius))),
        ("subsurface_scatter_anisotropy", "float", literal(0.0)),
    ]);
    let inputs = inputs.into_iter().map(|(name, kind, value)| {
        format!("    <input name=\"{name}\" type=\"{kind}\" value=\"{value}\" />\n")
    });
    let inputs: String = inputs.collect();
    Ok(format!(
        "  <open_pbr_surface name=\"translucid_surface\" type=\"surfaceshader\">
{inputs}  </open_pbr_surface>
  <surfacematerial name=\"translucid_material\" type=\"material\">
    <input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"translucid_surface\" />
  </surfacematerial>
"
    ))
}
