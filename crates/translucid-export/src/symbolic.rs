//! Formulas as graphs of nodes: a function of WGSL is run with names in the place of numbers.
//!
//! Calls are run where they stand. Of an `if` both branches are, and every variable takes what the condition chooses.

use std::collections::HashMap;

use naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, MathFunction, Module,
    Statement, TypeInner, UnaryOperator,
};

use crate::node_graph::{NodeGraph, Operand};

/// What an expression is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Number(Operand),
    Truth(Condition),
    Fields(Vec<Value>),
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

/// Runs a function for arguments.
pub(crate) fn run(
    graph: &mut NodeGraph,
    module: &Module,
    function: &Function,
    arguments: &[Value],
) -> Result<Value, Unknown> {
    let mut run =
        Run { graph, module, function, arguments, values: HashMap::new(), variables: HashMap::new() };
    for (handle, variable) in function.local_variables.iter() {
        let value = match variable.init {
            Some(init) => run.value(init)?,
            None => run.zero(variable.ty)?,
        };
        run.variables.insert(handle, value);
    }
    match run.block(&function.body)? {
        Some(value) => Ok(value),
        None => unknown("a function without a result"),
    }
}

struct Run<'a> {
    graph: &'a mut NodeGraph,
    module: &'a Module,
    function: &'a Function,
    arguments: &'a [Value],
    /// Values of expressions that were met.
    values: HashMap<Handle<Expression>, Value>,
    variables: HashMap<Handle<LocalVariable>, Value>,
}

impl Run<'_> {
    /// Runs statements; what they return.
    fn block(&mut self, block: &Block) -> Result<Option<Value>, Unknown> {
        for statement in block {
            match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        if !self.is_pointer(handle) {
                            let value = self.evaluate(handle)?;
                            self.values.insert(handle, value);
                        }
                    }
                }
                Statement::Block(block) => {
                    if let Some(value) = self.block(block)? {
                        return Ok(Some(value));
                    }
                }
                Statement::If { condition, accept, reject } => self.branch(*condition, accept, reject)?,
                Statement::Return { value: Some(value) } => return self.value(*value).map(Some),
                Statement::Store { pointer, value } => {
                    let value = self.value(*value)?;
                    *self.place(*pointer)? = value;
                }
                Statement::Call { function, arguments, result: Some(result) } => {
                    let arguments: Vec<Value> =
                        arguments.iter().map(|argument| self.value(*argument)).collect::<Result<_, _>>()?;
                    let called = &self.module.functions[*function];
                    let value = run(self.graph, self.module, called, &arguments)?;
                    self.values.insert(*result, value);
                }
                other => return unknown(other),
            }
        }
        Ok(None)
    }

    fn branch(
        &mut self,
        condition: Handle<Expression>,
        accept: &Block,
        reject: &Block,
    ) -> Result<(), Unknown> {
        let Value::Truth(condition) = self.value(condition)? else {
            return unknown("a condition that is none");
        };
        let before = self.variables.clone();
        let accepted = self.block(accept)?;
        let after = std::mem::replace(&mut self.variables, before);
        let rejected = self.block(reject)?;
        if accepted.is_some() || rejected.is_some() {
            return unknown("a return within an if");
        }
        for (handle, value) in after {
            let other = self.variables[&handle].clone();
            let chosen = self.choose(&condition, &value, &other)?;
            self.variables.insert(handle, chosen);
        }
        Ok(())
    }

    /// One value or the other.
    fn choose(&mut self, condition: &Condition, accept: &Value, reject: &Value) -> Result<Value, Unknown> {
        if accept == reject {
            return Ok(accept.clone());
        }
        match (condition, accept, reject) {
            (Condition::Is(is), ..) => Ok(if *is { accept.clone() } else { reject.clone() }),
            (Condition::Chosen(parts), ..) => {
                let [first, accepted, rejected] = &**parts;
                let accept_first = self.choose(accepted, accept, reject)?;
                let reject_first = self.choose(rejected, accept, reject)?;
                self.choose(first, &accept_first, &reject_first)
            }
            (Condition::Compared(category, a, b), Value::Number(accept), Value::Number(reject)) => {
                Ok(Value::Number(self.graph.node(category, &[*a, *b, *accept, *reject])))
            }
            (_, Value::Truth(accept), Value::Truth(reject)) => {
                let parts = [condition.clone(), accept.clone(), reject.clone()];
                Ok(Value::Truth(Condition::Chosen(Box::new(parts))))
            }
            (_, Value::Fields(accept), Value::Fields(reject)) => {
                let fields = accept.iter().zip(reject).map(|(a, r)| self.choose(condition, a, r));
                Ok(Value::Fields(fields.collect::<Result<_, _>>()?))
            }
            _ => unknown("a choice between different things"),
        }
    }

    fn is_pointer(&self, handle: Handle<Expression>) -> bool {
        match &self.function.expressions[handle] {
            Expression::LocalVariable(_) => true,
            Expression::AccessIndex { base, .. } => self.is_pointer(*base),
            _ => false,
        }
    }

    /// Where a pointer leads.
    fn place(&mut self, pointer: Handle<Expression>) -> Result<&mut Value, Unknown> {
        match &self.function.expressions[pointer] {
            Expression::LocalVariable(variable) => match self.variables.get_mut(variable) {
                Some(value) => Ok(value),
                None => unknown("a variable without a value"),
            },
            Expression::AccessIndex { base, index } => match self.place(*base)? {
                Value::Fields(fields) => Ok(&mut fields[*index as usize]),
                other => unknown(other),
            },
            other => unknown(other),
        }
    }

    fn value(&mut self, handle: Handle<Expression>) -> Result<Value, Unknown> {
        match self.values.get(&handle) {
            Some(value) => Ok(value.clone()),
            None => self.evaluate(handle),
        }
    }

    fn number(&mut self, handle: Handle<Expression>) -> Result<Operand, Unknown> {
        match self.value(handle)? {
            Value::Number(operand) => Ok(operand),
            other => unknown(other),
        }
    }

    fn evaluate(&mut self, handle: Handle<Expression>) -> Result<Value, Unknown> {
        let function = self.function;
        match &function.expressions[handle] {
            Expression::Literal(literal) => constant(*literal),
            Expression::Constant(constant) => {
                let init = self.module.constants[*constant].init;
                global(self.module, init)
            }
            Expression::ZeroValue(ty) => self.zero(*ty),
            Expression::FunctionArgument(index) => Ok(self.arguments[*index as usize].clone()),
            Expression::Load { pointer } => Ok(self.place(*pointer)?.clone()),
            Expression::AccessIndex { base, index } => match self.value(*base)? {
                Value::Fields(fields) => Ok(fields[*index as usize].clone()),
                other => unknown(other),
            },
            Expression::Compose { components, .. } => {
                let fields = components.iter().map(|component| self.value(*component));
                Ok(Value::Fields(fields.collect::<Result<_, _>>()?))
            }
            Expression::Unary { op: UnaryOperator::Negate, expr } => {
                let operand = self.number(*expr)?;
                Ok(Value::Number(self.graph.node("subtract", &[Operand::Number(0.0), operand])))
            }
            Expression::Unary { op: UnaryOperator::LogicalNot, expr } => {
                let value = self.value(*expr)?;
                self.opposite(value)
            }
            Expression::Binary { op, left, right } => self.binary(*op, *left, *right),
            Expression::Select { condition, accept, reject } => {
                let Value::Truth(condition) = self.value(*condition)? else {
                    return unknown("a condition that is none");
                };
                let (accept, reject) = (self.value(*accept)?, self.value(*reject)?);
                self.choose(&condition, &accept, &reject)
            }
            Expression::Math { fun, arg, arg1, arg2: None, arg3: None } => {
                let category = match fun {
                    MathFunction::Abs => "absval",
                    MathFunction::Cos => "cos",
                    MathFunction::Exp => "exp",
                    MathFunction::Log => "ln",
                    MathFunction::Max => "max",
                    MathFunction::Min => "min",
                    MathFunction::Pow => "power",
                    MathFunction::Sin => "sin",
                    MathFunction::Sqrt => "sqrt",
                    other => return unknown(other),
                };
                let mut operands = vec![self.number(*arg)?];
                if let Some(arg1) = arg1 {
                    operands.push(self.number(*arg1)?);
                }
                Ok(Value::Number(self.graph.node(category, &operands)))
            }
            other => unknown(other),
        }
    }

    fn binary(
        &mut self,
        operator: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Result<Value, Unknown> {
        let (left, right) = match (self.value(left)?, self.value(right)?) {
            (Value::Number(left), Value::Number(right)) => (left, right),
            other => return unknown(other),
        };
        let category = match operator {
            BinaryOperator::Add => "add",
            BinaryOperator::Subtract => "subtract",
            BinaryOperator::Multiply => "multiply",
            BinaryOperator::Divide => "divide",
            BinaryOperator::Greater => return Ok(compared("ifgreater", left, right)),
            BinaryOperator::GreaterEqual => return Ok(compared("ifgreatereq", left, right)),
            BinaryOperator::Less => return Ok(compared("ifgreater", right, left)),
            BinaryOperator::LessEqual => return Ok(compared("ifgreatereq", right, left)),
            BinaryOperator::Equal => return Ok(compared("ifequal", left, right)),
            BinaryOperator::NotEqual => return self.opposite(compared("ifequal", left, right)),
            other => return unknown(other),
        };
        Ok(Value::Number(self.graph.node(category, &[left, right])))
    }

    fn opposite(&mut self, value: Value) -> Result<Value, Unknown> {
        let Value::Truth(condition) = value else {
            return unknown(value);
        };
        let [yes, no] = [true, false].map(|is| Value::Truth(Condition::Is(is)));
        self.choose(&condition, &no, &yes)
    }

    fn zero(&self, ty: Handle<naga::Type>) -> Result<Value, Unknown> {
        match &self.module.types[ty].inner {
            TypeInner::Scalar(scalar) if scalar.kind == naga::ScalarKind::Bool => {
                Ok(Value::Truth(Condition::Is(false)))
            }
            TypeInner::Scalar(_) => Ok(Value::Number(Operand::Number(0.0))),
            TypeInner::Struct { members, .. } => {
                let fields = members.iter().map(|member| self.zero(member.ty));
                Ok(Value::Fields(fields.collect::<Result<_, _>>()?))
            }
            other => unknown(other),
        }
    }
}

fn compared(category: &'static str, left: Operand, right: Operand) -> Value {
    Value::Truth(Condition::Compared(category, left, right))
}

fn constant(literal: Literal) -> Result<Value, Unknown> {
    match literal {
        Literal::F32(number) => Ok(Value::Number(Operand::Number(number))),
        Literal::Bool(is) => Ok(Value::Truth(Condition::Is(is))),
        other => unknown(other),
    }
}

/// The value of a constant of the module.
fn global(module: &Module, init: Handle<Expression>) -> Result<Value, Unknown> {
    match &module.global_expressions[init] {
        Expression::Literal(literal) => constant(*literal),
        other => unknown(other),
    }
}
