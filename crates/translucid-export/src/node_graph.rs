//! A graph of MaterialX nodes that compute numbers, each thing once.

use std::collections::HashMap;
use std::fmt::Write as _;

/// An operand of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Operand {
    /// A constant.
    Number(f32),
    /// An input of the graph.
    Input(&'static str),
    /// The result of a node.
    Node(usize),
}

/// A node: its category, and what its inputs take.
type Node = (&'static str, Vec<Operand>);

/// The nodes that compute the outputs of a function.
#[derive(Default)]
pub(crate) struct NodeGraph {
    nodes: Vec<Node>,
    numbers: HashMap<String, usize>,
}

/// Decimals of a constant in the shaders that MaterialX generates, whatever the document has.
const DECIMALS: usize = 6;

impl NodeGraph {
    /// The result of a node of a category; that of constants is one.
    pub(crate) fn node(&mut self, category: &'static str, operands: &[Operand]) -> Operand {
        if let Some(number) = folded(category, operands) {
            return Operand::Number(number);
        }
        let operands: Vec<Operand> = operands.iter().map(|operand| self.exact(*operand)).collect();
        self.add(category, operands)
    }

    fn add(&mut self, category: &'static str, operands: Vec<Operand>) -> Operand {
        let count = self.nodes.len();
        let number = *self.numbers.entry(format!("{category} {operands:?}")).or_insert(count);
        if number == count {
            self.nodes.push((category, operands));
        }
        Operand::Node(number)
    }

    /// A constant that keeps every bit in six decimals: as a quotient by a power of two, where it does not by itself.
    fn exact(&mut self, operand: Operand) -> Operand {
        let Operand::Number(number) = operand else {
            return operand;
        };
        let shown = format!("{number:.DECIMALS$}").parse();
        if !number.is_finite() || shown == Ok(number) {
            return operand;
        }
        // 2^18 ≤ |dividend| < 2^19 has no more than six binary places
        let mut dividend = f64::from(number);
        let mut exponent = 0;
        while dividend.abs() < 262_144.0 {
            dividend *= 2.0;
            exponent += 1;
        }
        let mut result = Operand::Number(dividend as f32);
        while exponent > 0 {
            let step = exponent.min(64);
            result = self.add("divide", vec![result, Operand::Number(2f32.powi(step))]);
            exponent -= step;
        }
        result
    }

    /// The nodes that outputs of given names need, and the outputs, as MaterialX writes what is in a nodegraph.
    pub(crate) fn text(&mut self, outputs: &[(&str, Operand)]) -> String {
        let outputs: Vec<(&str, Operand)> =
            outputs.iter().map(|(name, operand)| (*name, self.as_node(*operand))).collect();
        let mut is_needed = vec![false; self.nodes.len()];
        let mut open: Vec<Operand> = outputs.iter().map(|output| output.1).collect();
        while let Some(operand) = open.pop() {
            if let Operand::Node(number) = operand
                && !is_needed[number]
            {
                is_needed[number] = true;
                open.extend(&self.nodes[number].1);
            }
        }
        let mut names = vec![0; self.nodes.len()];
        let mut text = String::new();
        for (number, (category, operands)) in self.nodes.iter().enumerate().filter(|(i, _)| is_needed[*i]) {
            names[number] = names.iter().max().map_or(1, |last| last + 1);
            // Writing to a string cannot fail
            let _ = writeln!(text, "    <{category} name=\"n{}\" type=\"float\">", names[number]);
            for (input, operand) in input_names(category).iter().zip(operands) {
                let source = match operand {
                    Operand::Number(number) => format!("value=\"{number:?}\""),
                    Operand::Input(name) => format!("interfacename=\"{name}\""),
                    Operand::Node(number) => format!("nodename=\"n{}\"", names[*number]),
                };
                let _ = writeln!(text, "      <input name=\"{input}\" type=\"float\" {source} />");
            }
            let _ = writeln!(text, "    </{category}>");
        }
        for (name, operand) in outputs {
            if let Operand::Node(number) = operand {
                let _ = writeln!(
                    text,
                    "    <output name=\"{name}\" type=\"float\" nodename=\"n{}\" />",
                    names[number]
                );
            }
        }
        text
    }

    /// A node for what an output shows.
    fn as_node(&mut self, operand: Operand) -> Operand {
        match self.exact(operand) {
            node @ Operand::Node(_) => node,
            other => self.add("add", vec![other, Operand::Number(0.0)]),
        }
    }
}

/// Names of a node's inputs.
fn input_names(category: &str) -> &'static [&'static str] {
    match category {
        "ifgreater" | "ifgreatereq" | "ifequal" => &["value1", "value2", "in1", "in2"],
        "add" | "subtract" | "multiply" | "divide" | "min" | "max" | "power" => &["in1", "in2"],
        _ => &["in"],
    }
}

/// The result of a node of constants, where it is needed.
fn folded(category: &str, operands: &[Operand]) -> Option<f32> {
    let numbers: Option<Vec<f32>> = operands
        .iter()
        .map(|operand| match operand {
            Operand::Number(number) => Some(*number),
            _ => None,
        })
        .collect();
    match (category, numbers?.as_slice()) {
        ("add", [a, b]) => Some(a + b),
        ("subtract", [a, b]) => Some(a - b),
        ("multiply", [a, b]) => Some(a * b),
        ("divide", [a, b]) => Some(a / b),
        ("min", [a, b]) => Some(a.min(*b)),
        ("max", [a, b]) => Some(a.max(*b)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_keep_their_bits_in_six_decimals() {
        for number in [0.1_f32, 1e-18, f32::MIN_POSITIVE, 0.99999994, -1.428_912_4, 3.0000002] {
            let mut graph = NodeGraph::default();
            let mut value = graph.exact(Operand::Number(number));
            let mut divisors = Vec::new();
            while let Operand::Node(at) = value {
                value = graph.nodes[at].1[0];
                divisors.push(graph.nodes[at].1[1]);
            }
            let shown = |operand: Operand| match operand {
                Operand::Number(number) => format!("{number:.DECIMALS$}").parse::<f32>().unwrap(),
                _ => f32::NAN,
            };
            let found = divisors.iter().rev().fold(shown(value), |value, divisor| value / shown(*divisor));
            assert_eq!(found, number);
        }
    }

    #[test]
    fn equal_nodes_are_one() {
        let mut graph = NodeGraph::default();
        let x = Operand::Input("x");
        let twice = graph.node("add", &[x, x]);
        assert_eq!(graph.node("add", &[x, x]), twice);
        let two = graph.node("add", &[Operand::Number(1.0), Operand::Number(1.0)]);
        assert_eq!(two, Operand::Number(2.0));
        let text = graph.text(&[("out", twice)]);
        assert_eq!(text.matches("<add").count(), 1);
    }
}
