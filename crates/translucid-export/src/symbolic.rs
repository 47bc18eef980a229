//! Formulas as graphs of nodes: their WGSL is run with nodes in the place of numbers.
//!
//! Formulas use a small part of WGSL: functions of numbers and of structs of numbers, `let` and `var` with a type, `if`,
//! `select` and a `return` at the end.
//! Calls are run where they stand. Of an `if` both branches are, and every variable takes what the condition chooses.

use std::collections::HashMap;

use crate::node_graph::{NodeGraph, Operand};
use crate::token::{Token, tokens};

/// The value of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value<'a> {
    /// A number of the text, or what is made of some: it becomes one of single precision where it meets others.
    Literal(f64),
    Number(Operand),
    Truth(Condition),
    /// Fields of a struct, with their names.
    Fields(Vec<(&'a str, Value<'a>)>),
}

/// A comparison, or what is made of some.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Condition {
    Is(bool),
    /// The node that tells, and what it compares.
    Compared(&'static str, Operand, Operand),
    /// What chooses, what holds if so, and what holds if not.
    Chosen(Box<[Condition; 3]>),
}

/// A construct that formulas do not use.
#[derive(Debug)]
pub(crate) struct Unknown(pub(crate) String);

fn unknown<T>(what: impl std::fmt::Debug) -> Result<T, Unknown> {
    Err(Unknown(format!("{what:?}")))
}

/// Functions and structs of a text, by their names.
pub(crate) struct Source<'a> {
    functions: HashMap<&'a str, Function<'a>>,
    /// Names of the fields of each struct; all are numbers.
    structs: HashMap<&'a str, Vec<&'a str>>,
}

struct Function<'a> {
    parameters: Vec<&'a str>,
    body: Vec<Token<'a>>,
}

impl<'a> Source<'a> {
    /// Reads a text. Constants outside of functions are left out.
    pub(crate) fn new(text: &'a str) -> Self {
        let mut source = Self { functions: HashMap::new(), structs: HashMap::new() };
        let code = code(text);
        let mut rest = &code[..];
        while let Some(start) = rest.iter().position(|token| is_keyword(*token)) {
            let [keyword, Token::Word(name), item @ ..] = &rest[start..] else { break };
            let Some(open) = item.iter().position(|token| *token == Token::Sign("{")) else { break };
            let (head, body) = (&item[..open], braced(&item[open..]));
            if *keyword == Token::Word("fn") {
                let function = Function { parameters: before_colons(head), body: body.to_vec() };
                source.functions.insert(name, function);
            } else {
                source.structs.insert(name, before_colons(body));
            }
            rest = &item[open + body.len()..];
        }
        source
    }

    /// The value of an expression with variables of given names.
    pub(crate) fn evaluate(
        &self,
        graph: &mut NodeGraph,
        expression: &'a str,
        variables: Vec<(&'a str, Value<'a>)>,
    ) -> Result<Value<'a>, Unknown> {
        Run { source: self, graph, code: &code(expression), next: 0, variables }.expression()
    }
}

/// The words, numbers and signs of a text.
fn code(text: &str) -> Vec<Token<'_>> {
    let is_code = |token: &Token<'_>| !matches!(token, Token::Space(_) | Token::Comment(_));
    tokens(text).into_iter().filter(is_code).collect()
}

fn is_keyword(token: Token<'_>) -> bool {
    matches!(token, Token::Word("fn" | "struct"))
}

/// The text within the braces that a text begins with.
fn braced<'c, 'a>(code: &'c [Token<'a>]) -> &'c [Token<'a>] {
    let mut depth = 0;
    let end = code.iter().position(|token| {
        depth += i32::from(*token == Token::Sign("{")) - i32::from(*token == Token::Sign("}"));
        depth == 0
    });
    &code[1..end.unwrap_or(code.len())]
}

/// Names before a colon: those of parameters or fields.
fn before_colons<'a>(code: &[Token<'a>]) -> Vec<&'a str> {
    let named = code.windows(2).filter_map(|window| match window {
        [Token::Word(name), Token::Sign(":")] => Some(*name),
        _ => None,
    });
    named.collect()
}

/// The run of a piece of code.
struct Run<'a, 'r> {
    source: &'r Source<'a>,
    graph: &'r mut NodeGraph,
    code: &'r [Token<'a>],
    next: usize,
    variables: Vec<(&'a str, Value<'a>)>,
}

impl<'a> Run<'a, '_> {
    fn take(&mut self) -> Option<Token<'a>> {
        let token = self.code.get(self.next).copied();
        self.next += 1;
        token
    }

    fn name(&mut self) -> Result<&'a str, Unknown> {
        match self.take() {
            Some(Token::Word(name)) => Ok(name),
            other => unknown(other),
        }
    }

    /// Whether signs stand here; if so, they are taken.
    fn takes(&mut self, signs: &[&str]) -> bool {
        let stand = |(i, sign): (usize, &&str)| self.code.get(self.next + i) == Some(&Token::Sign(sign));
        let all = signs.iter().enumerate().all(stand);
        self.next += if all { signs.len() } else { 0 };
        all
    }

    fn expect(&mut self, sign: &str) -> Result<(), Unknown> {
        if self.takes(&[sign]) { Ok(()) } else { unknown((sign, self.take())) }
    }

    /// Runs statements up to the end of their block; what they return.
    fn block(&mut self) -> Result<Option<Value<'a>>, Unknown> {
        while !self.takes(&["}"]) {
            let Some(Token::Word(word)) = self.take() else { return Ok(None) };
            match word {
                "let" | "var" => {
                    let name = self.name()?;
                    self.expect(":")?;
                    let kind = self.name()?;
                    let value = if self.takes(&["="]) { self.value()? } else { self.zero(kind)? };
                    self.variables.push((name, value));
                }
                "return" => return self.value().map(Some),
                "if" => {
                    self.branch()?;
                    continue;
                }
                name => {
                    let field = if self.takes(&["."]) { Some(self.name()?) } else { None };
                    self.expect("=")?;
                    let value = self.value()?;
                    *self.place(name, field)? = value;
                }
            }
            self.expect(";")?;
        }
        Ok(None)
    }

    /// Runs what follows an `if`.
    fn branch(&mut self) -> Result<(), Unknown> {
        let condition = self.expression()?;
        let before = self.variables.clone();
        self.nested_block()?;
        let accepted = std::mem::replace(&mut self.variables, before);
        let count = self.variables.len();
        if self.code.get(self.next) == Some(&Token::Word("else")) {
            self.next += 1;
            if self.code.get(self.next) == Some(&Token::Word("if")) {
                self.next += 1;
                self.branch()?;
            } else {
                self.nested_block()?;
            }
        }
        self.variables.truncate(count);
        let condition = truth(condition)?;
        for (i, (_, accept)) in accepted.into_iter().take(count).enumerate() {
            let reject = self.variables[i].1.clone();
            self.variables[i].1 = self.choose(&condition, accept, reject)?;
        }
        Ok(())
    }

    fn nested_block(&mut self) -> Result<(), Unknown> {
        self.expect("{")?;
        match self.block()? {
            None => Ok(()),
            Some(_) => unknown("a return within an if"),
        }
    }

    /// Where a variable, or a field of one, is kept.
    fn place(&mut self, name: &str, field: Option<&str>) -> Result<&mut Value<'a>, Unknown> {
        let variable = self.variables.iter_mut().rev().find(|(known, _)| *known == name);
        match (variable, field) {
            (Some((_, value)), None) => Ok(value),
            (Some((_, Value::Fields(fields))), Some(field)) => {
                let found = fields.iter_mut().find(|(known, _)| *known == field);
                found.map_or_else(|| unknown(field), |(_, value)| Ok(value))
            }
            _ => unknown(name),
        }
    }

    /// The value of an expression; a literal is a number of single precision.
    fn value(&mut self) -> Result<Value<'a>, Unknown> {
        match self.expression()? {
            Value::Literal(number) => Ok(Value::Number(Operand::Number(number as f32))),
            other => Ok(other),
        }
    }

    fn expression(&mut self) -> Result<Value<'a>, Unknown> {
        let mut left = self.comparison()?;
        while self.takes(&["|", "|"]) {
            let right = self.comparison()?;
            left = self.choose(&truth(left)?, Value::Truth(Condition::Is(true)), right)?;
        }
        Ok(left)
    }

    fn comparison(&mut self) -> Result<Value<'a>, Unknown> {
        const OPERATORS: [(&[&str], &str, bool); 5] = [
            (&["=", "="], "ifequal", false),
            (&["<", "="], "ifgreatereq", true),
            (&[">", "="], "ifgreatereq", false),
            (&["<"], "ifgreater", true),
            (&[">"], "ifgreater", false),
        ];
        let left = self.sum()?;
        for (signs, category, is_turned) in OPERATORS {
            if self.takes(signs) {
                let (left, right) = (number(left)?, number(self.sum()?)?);
                let (left, right) = if is_turned { (right, left) } else { (left, right) };
                return Ok(Value::Truth(Condition::Compared(category, left, right)));
            }
        }
        Ok(left)
    }

    fn sum(&mut self) -> Result<Value<'a>, Unknown> {
        let mut left = self.product()?;
        loop {
            if self.takes(&["+"]) {
                let right = self.product()?;
                left = self.arithmetic("add", |a, b| a + b, left, right)?;
            } else if self.takes(&["-"]) {
                let right = self.product()?;
                left = self.arithmetic("subtract", |a, b| a - b, left, right)?;
            } else {
                return Ok(left);
            }
        }
    }

    fn product(&mut self) -> Result<Value<'a>, Unknown> {
        let mut left = self.factor()?;
        loop {
            if self.takes(&["*"]) {
                let right = self.factor()?;
                left = self.arithmetic("multiply", |a, b| a * b, left, right)?;
            } else if self.takes(&["/"]) {
                let right = self.factor()?;
                left = self.arithmetic("divide", |a, b| a / b, left, right)?;
            } else {
                return Ok(left);
            }
        }
    }

    fn arithmetic(
        &mut self,
        category: &'static str,
        of_literals: fn(f64, f64) -> f64,
        left: Value<'a>,
        right: Value<'a>,
    ) -> Result<Value<'a>, Unknown> {
        if let (Value::Literal(left), Value::Literal(right)) = (&left, &right) {
            return Ok(Value::Literal(of_literals(*left, *right)));
        }
        let operands = [number(left)?, number(right)?];
        Ok(Value::Number(self.graph.node(category, &operands)))
    }

    fn factor(&mut self) -> Result<Value<'a>, Unknown> {
        let mut value = match self.take() {
            Some(Token::Sign("-")) => {
                let operand = self.factor()?;
                return match operand {
                    Value::Literal(number) => Ok(Value::Literal(-number)),
                    other => self.arithmetic("subtract", |a, b| a - b, Value::Literal(0.0), other),
                };
            }
            Some(Token::Sign("(")) => {
                let inner = self.expression()?;
                self.expect(")")?;
                inner
            }
            Some(Token::Number(text)) => match text.parse() {
                Ok(number) => Value::Literal(number),
                Err(_) => return unknown(text),
            },
            Some(Token::Word(name)) if self.takes(&["("]) => self.call(name)?,
            Some(Token::Word(name)) => self.place(name, None)?.clone(),
            other => return unknown(other),
        };
        while self.takes(&["."]) {
            let name = self.name()?;
            value = field(value, name)?;
        }
        Ok(value)
    }

    /// Runs a call behind its opening parenthesis.
    fn call(&mut self, name: &'a str) -> Result<Value<'a>, Unknown> {
        let mut arguments = Vec::new();
        while !self.takes(&[")"]) {
            arguments.push(self.value()?);
            if !self.takes(&[","]) {
                self.expect(")")?;
                break;
            }
        }
        let source = self.source;
        if let Some(Function { parameters, body }) = source.functions.get(name) {
            let variables = parameters.iter().copied().zip(arguments).collect();
            let mut run = Run { source, graph: self.graph, code: body, next: 0, variables };
            return run.block()?.map_or_else(|| unknown("a function without a result"), Ok);
        }
        if name == "select"
            && let [reject, accept, condition] = &arguments[..]
        {
            return self.choose(&truth(condition.clone())?, accept.clone(), reject.clone());
        }
        let category = match name {
            "abs" => "absval",
            "log" => "ln",
            "pow" => "power",
            "cos" => "cos",
            "exp" => "exp",
            "max" => "max",
            "min" => "min",
            "sin" => "sin",
            "sqrt" => "sqrt",
            other => return unknown(other),
        };
        let operands: Vec<Operand> = arguments.into_iter().map(number).collect::<Result<_, _>>()?;
        Ok(Value::Number(self.graph.node(category, &operands)))
    }

    /// One value or the other.
    fn choose(
        &mut self,
        condition: &Condition,
        accept: Value<'a>,
        reject: Value<'a>,
    ) -> Result<Value<'a>, Unknown> {
        if accept == reject {
            return Ok(accept);
        }
        match (condition, accept, reject) {
            (Condition::Is(is), accept, reject) => Ok(if *is { accept } else { reject }),
            (Condition::Chosen(parts), accept, reject) => {
                let [first, accepted, rejected] = &**parts;
                let accept_first = self.choose(accepted, accept.clone(), reject.clone())?;
                let reject_first = self.choose(rejected, accept, reject)?;
                self.choose(first, accept_first, reject_first)
            }
            (Condition::Compared(category, a, b), Value::Number(accept), Value::Number(reject)) => {
                Ok(Value::Number(self.graph.node(category, &[*a, *b, accept, reject])))
            }
            (_, Value::Truth(accept), Value::Truth(reject)) => {
                Ok(Value::Truth(Condition::Chosen(Box::new([condition.clone(), accept, reject]))))
            }
            (_, Value::Fields(accept), Value::Fields(reject)) => {
                let fields = accept.into_iter().zip(reject);
                let fields = fields.map(|((name, a), (_, r))| Ok((name, self.choose(condition, a, r)?)));
                Ok(Value::Fields(fields.collect::<Result<_, _>>()?))
            }
            _ => unknown("a choice between different things"),
        }
    }

    /// The value of a variable of a type before it is assigned.
    fn zero(&self, kind: &str) -> Result<Value<'a>, Unknown> {
        let zero = Value::Number(Operand::Number(0.0));
        match (kind, self.source.structs.get(kind)) {
            (_, Some(fields)) => Ok(Value::Fields(fields.iter().map(|name| (*name, zero.clone())).collect())),
            ("f32", None) => Ok(zero),
            (other, None) => unknown(other),
        }
    }
}

fn truth(value: Value<'_>) -> Result<Condition, Unknown> {
    match value {
        Value::Truth(condition) => Ok(condition),
        other => unknown(other),
    }
}

/// A number, a literal as one of single precision.
pub(crate) fn number(value: Value<'_>) -> Result<Operand, Unknown> {
    match value {
        Value::Number(operand) => Ok(operand),
        Value::Literal(number) => Ok(Operand::Number(number as f32)),
        other => unknown(other),
    }
}

/// A field of a struct.
pub(crate) fn field<'a>(value: Value<'a>, name: &str) -> Result<Value<'a>, Unknown> {
    let Value::Fields(fields) = value else { return unknown(value) };
    let found = fields.into_iter().find(|(known, _)| *known == name);
    found.map_or_else(|| unknown(name), |(_, value)| Ok(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number that an expression of numbers alone is.
    fn evaluated(text: &str, expression: &str) -> f32 {
        let value = Source::new(text).evaluate(&mut NodeGraph::default(), expression, Vec::new());
        match value.and_then(number).unwrap() {
            Operand::Number(number) => number,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn operators_bind_as_in_wgsl() {
        for (expression, expected) in [
            ("1.0 - 2.0 - 4.0", -5.0),
            ("8.0 / 2.0 / 4.0 * 3.0", 3.0),
            ("1.0 + 2.0 * -3.0", -5.0),
            ("-(1.0 + 2.0) * 2.0", -6.0),
            ("1.0 / 3.0", (1.0_f64 / 3.0) as f32),
            ("max(min(7.0, 5.0), 2.0)", 5.0),
        ] {
            assert_eq!(evaluated("", expression), expected, "{expression}");
        }
    }

    #[test]
    fn functions_structs_and_branches_run() {
        let text = "
            const X: f32 = 3.0;
            struct Pair { low: f32, high: f32, }
            // A comment
            fn pair(x: f32) -> Pair {
                var both: Pair;
                both.low = x;
                both.high = x + 1.0;
                return both;
            }
            fn chosen(x: f32) -> f32 {
                var result: f32 = 1.0;
                if (x < 0.5 || x == 2.0) { result = 10.0; } else if (x >= 1.0) { result = pair(x).high; }
                return select(result, 0.0, x > 100.0);
            }";
        assert_eq!(evaluated(text, "pair(2.0).high + pair(0.5).low"), 3.5);
        let mut graph = NodeGraph::default();
        let x = vec![("x", Value::Number(Operand::Input("x")))];
        let value = Source::new(text).evaluate(&mut graph, "chosen(x)", x).unwrap();
        let nodes = graph.text(&[("out", number(value).unwrap())]);
        // Two conditions of the first `if`, one of the second, one of `select`
        for (category, count) in [("ifgreater", 2), ("ifequal", 1), ("ifgreatereq", 1), ("add", 1)] {
            assert_eq!(nodes.matches(&format!("<{category} ")).count(), count, "{category} in {nodes}");
        }
    }

    #[test]
    fn other_constructs_are_refused() {
        for text in [
            "fn f(x: f32) -> f32 { if (x < 1.0) { return x; } return 0.0; }",
            "fn f(x: f32) -> f32 { loop { } return x; }",
            "fn f(x: f32) -> f32 { return tan(x); }",
            "fn f(x: f32) -> f32 { return y; }",
            "fn f(x: f32) -> f32 { let y: f32 = x; }",
        ] {
            let x = vec![("x", Value::Number(Operand::Input("x")))];
            assert!(Source::new(text).evaluate(&mut NodeGraph::default(), "f(x)", x).is_err(), "{text}");
        }
    }
}
