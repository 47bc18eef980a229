//! Rust as WGSL, for a small part of the language that both share.
//!
//! | in Rust | in WGSL |
//! |---|---|
//! | `f32`, `u32`, `i32`, `bool`, `Vec2`, `Vec3`, `BVec3`, structs of them | the same types |
//! | `[f32; 2]`, `[f32; 3]` | vectors |
//! | a method of a struct, whose name no other struct has | a function that begins with the struct's name |
//! | `&T` of such a type | the value |
//! | `&[f32]` | the place in the array `tables` where the slice begins |
//! | `&impl Trait` | `u32`, which is the first argument of the trait's functions; these are written by hand |
//! | `words!(…)` | a function that reads the struct from a place in `tables` |
//! | `if` that chooses between two expressions | `select`, or a statement where it ends a function or a `let` that states its type |
//! | methods of `METHODS`, and constants of `CONSTANTS` | built-in functions, and values |
//!
//! Types are never inferred: whole numbers bear their suffix. Functions that return an `Option` or take a `usize` are the
//! processor's alone, as are imports, traits, their implementations and tests. All else is refused by a panic that shows it.

use std::collections::BTreeMap;
use std::fmt::{Debug, Write};

use syn::{BinOp, Block, Expr, FnArg, Item, Lit, Local, Member, Pat, ReturnType, Stmt, Type, UnOp};

/// Methods of numbers and vectors whose receiver is the first argument.
const METHODS: [(&str, &str); 11] = [
    ("abs", "abs"),
    ("clamp", "clamp"),
    ("cross", "cross"),
    ("dot", "dot"),
    ("floor", "floor"),
    ("length", "length"),
    ("lerp", "mix"),
    ("max", "max"),
    ("min", "min"),
    ("normalize", "normalize"),
    ("sqrt", "sqrt"),
];

/// Constants of Rust's and glam's.
const CONSTANTS: [(&str, &str); 12] = [
    ("FRAC_1_PI", "0.31830987"),
    ("FRAC_PI_2", "1.5707964"),
    ("FRAC_PI_4", "0.7853982"),
    ("MIN_POSITIVE", "1.1754944e-38"),
    ("PI", "3.1415927"),
    ("TAU", "6.2831855"),
    ("Vec2::ONE", "vec2f(1.0)"),
    ("Vec2::ZERO", "vec2f(0.0)"),
    ("Vec3::ONE", "vec3f(1.0)"),
    ("Vec3::X", "vec3f(1.0, 0.0, 0.0)"),
    ("Vec3::Z", "vec3f(0.0, 0.0, 1.0)"),
    ("Vec3::ZERO", "vec3f(0.0)"),
];

fn refuse(what: &str, found: &dyn Debug) -> ! {
    let found: String = format!("{found:?}").chars().take(400).collect();
    panic!("{what} cannot be written as WGSL: {found}")
}

/// Modules that a crate's root names.
pub(crate) fn modules(root: &str) -> Vec<String> {
    let items = syn::parse_file(root).unwrap().items;
    let name = |item| if let Item::Mod(module) = item { Some(module.ident.to_string()) } else { None };
    items.into_iter().filter_map(name).collect()
}

/// Constants, structs and functions of files.
pub(crate) fn wgsl(files: &[syn::File]) -> String {
    let items: Vec<&Item> = files.iter().flat_map(|file| &file.items).collect();
    let fields = |item: &&Item| {
        let Item::Struct(of) = item else { return None };
        let names = of.fields.iter().filter_map(|field| Some(field.ident.as_ref()?.to_string()));
        Some((of.ident.to_string(), names.collect()))
    };
    let structs = items.iter().filter_map(fields).collect();
    let mut methods = BTreeMap::<String, Vec<String>>::new();
    for of in items.iter().filter_map(|item| if let Item::Impl(of) = item { Some(of) } else { None }) {
        for method in functions(of) {
            methods.entry(method.sig.ident.to_string()).or_default().push(own_name(of));
        }
    }
    let new = |own: &str| Writer {
        structs: &structs,
        methods: &methods,
        own: own.to_owned(),
        slices: Vec::new(),
        traits: Vec::new(),
    };
    let mut text =
        "// Written by the example `laws` of `translucid-law` from its sources: change those.\n".to_owned();
    for item in &items {
        let writer = new("");
        let written = match item {
            Item::Const(of) => {
                let (docs, ty) = (docs(&of.attrs), writer.ty(&of.ty));
                let value = match &*of.expr {
                    Expr::Lit(number) if ty == "u32" => format!("{}u", digits(&number.lit)),
                    value => writer.expr(value),
                };
                format!("{docs}const {}: {ty} = {value};\n", of.ident)
            }
            Item::Struct(of) => {
                let field = |field: &syn::Field| {
                    let name = field.ident.as_ref().unwrap_or_else(|| refuse("a tuple", &field.ty));
                    format!("{}    {name}: {},\n", indented(&docs(&field.attrs)), writer.ty(&field.ty))
                };
                let fields: String = of.fields.iter().map(field).collect();
                format!("{}struct {} {{\n{fields}}}\n", docs(&of.attrs), of.ident)
            }
            Item::Fn(of) if is_of_processors(&of.sig) => continue,
            Item::Fn(of) => new("").function(&of.attrs, &of.sig, &of.block),
            Item::Impl(of) => {
                let write = |of_struct: &syn::ImplItemFn, own: &str| {
                    new(own).function(&of_struct.attrs, &of_struct.sig, &of_struct.block)
                };
                functions(of).map(|method| write(method, &own_name(of))).collect::<Vec<_>>().join("\n")
            }
            Item::Macro(of) if of.mac.path.is_ident("words") => {
                let name = of.mac.tokens.clone().into_iter().next().map(|name| name.to_string());
                reader(&items, &name.unwrap_or_default())
            }
            Item::Use(_) | Item::Trait(_) | Item::Mod(_) | Item::Macro(_) => continue,
            other => refuse("an item", other),
        };
        if !written.is_empty() {
            text += "\n";
        }
        text += &written;
    }
    text
}

/// A function that reads a struct's fields from numbers that stand behind each other.
fn reader(items: &[&Item], name: &str) -> String {
    let (function, mut place) = (function_of(name, "at"), 0);
    let mut read = |ty: &str| {
        let at = format!("at + {place}u");
        place += width(items, ty);
        match ty {
            "f32" => format!("tables[{at}]"),
            "u32" => format!("u32(tables[{at}])"),
            "bool" => format!("tables[{at}] != 0.0"),
            "Vec3" => format!("table_vector({at})"),
            inner => format!("{}({at})", function_of(inner, "at")),
        }
    };
    let fields: Vec<String> = field_types(items, name).iter().map(|ty| read(ty)).collect();
    format!("fn {function}(at: u32) -> {name} {{\n    return {name}({});\n}}\n", fields.join(", "))
}

/// Numbers that a value of a type is written as.
fn width(items: &[&Item], ty: &str) -> usize {
    match ty {
        "f32" | "u32" | "bool" => 1,
        "Vec3" => 3,
        name => field_types(items, name).iter().map(|ty| width(items, ty)).sum(),
    }
}

fn field_types(items: &[&Item], name: &str) -> Vec<String> {
    let found = items.iter().find_map(|item| match item {
        Item::Struct(of) if of.ident == name => Some(of),
        _ => None,
    });
    let fields = &found.unwrap_or_else(|| refuse("a struct", &name)).fields;
    let ty = |field: &syn::Field| match &field.ty {
        Type::Path(path) => last(&path.path),
        other => refuse("a field", other),
    };
    fields.iter().map(ty).collect()
}

/// Whether a function asks for or gives what devices have not.
fn is_of_processors(of: &syn::Signature) -> bool {
    let is_foreign = |ty: &Type| match ty {
        Type::Path(path) => ["Option", "usize"].contains(&last(&path.path).as_str()),
        _ => false,
    };
    let takes = of.inputs.iter().any(|input| matches!(input, FnArg::Typed(input) if is_foreign(&input.ty)));
    takes || matches!(&of.output, ReturnType::Type(_, ty) if is_foreign(ty))
}

/// The methods of a struct that devices have.
fn functions(of: &syn::ItemImpl) -> impl Iterator<Item = &syn::ImplItemFn> {
    let methods = of.items.iter().filter(|_| of.trait_.is_none());
    methods.filter_map(|item| match item {
        syn::ImplItem::Fn(method) if !is_of_processors(&method.sig) => Some(method),
        _ => None,
    })
}

fn own_name(of: &syn::ItemImpl) -> String {
    if let Type::Path(path) = &*of.self_ty {
        last(&path.path)
    } else {
        refuse("an implementation", &of.self_ty)
    }
}

/// The name of a struct's function.
fn function_of(own: &str, method: &str) -> String {
    let mut name = String::new();
    for letter in own.chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    format!("{name}_{method}")
}

/// Comments of an item.
fn docs(attributes: &[syn::Attribute]) -> String {
    let mut text = String::new();
    for attribute in attributes {
        let syn::Meta::NameValue(pair) = &attribute.meta else { continue };
        if let Expr::Lit(literal) = &pair.value
            && let Lit::Str(line) = &literal.lit
            && !line.value().trim().starts_with("```")
        {
            let _ = writeln!(text, "{}", format!("//{}", line.value().replace(['\\', '`'], "")).trim_end());
        }
    }
    text
}

fn indented(text: &str) -> String {
    text.lines().map(|line| format!("    {line}\n")).collect()
}

/// Writes one item.
struct Writer<'a> {
    /// Fields of each struct, in their order.
    structs: &'a BTreeMap<String, Vec<String>>,
    /// Structs that have a method of a name.
    methods: &'a BTreeMap<String, Vec<String>>,
    /// The struct whose method it is.
    own: String,
    /// Parameters that are slices, and those of a trait.
    slices: Vec<String>,
    traits: Vec<String>,
}

impl Writer<'_> {
    fn function(&mut self, attributes: &[syn::Attribute], of: &syn::Signature, body: &Block) -> String {
        let mut parameters = Vec::new();
        for input in &of.inputs {
            let FnArg::Typed(input) = input else {
                parameters.push(format!("own: {}", self.own));
                continue;
            };
            let name = self.name(&input.pat);
            match peeled(&input.ty) {
                Type::Slice(_) => self.slices.push(name.clone()),
                Type::ImplTrait(_) => self.traits.push(name.clone()),
                _ => {}
            }
            parameters.push(format!("{name}: {}", self.ty(&input.ty)));
        }
        let result = match &of.output {
            ReturnType::Default => refuse("a function without a result", &of.ident),
            ReturnType::Type(_, ty) => self.ty(ty),
        };
        let body = self.block(body, &Tail::Return);
        let name = match self.own.as_str() {
            "" => of.ident.to_string(),
            own => function_of(own, &of.ident.to_string()),
        };
        let comments = docs(attributes);
        format!("{comments}fn {name}({}) -> {result} {{\n{}}}\n", parameters.join(", "), indented(&body))
    }

    fn ty(&self, ty: &Type) -> String {
        match peeled(ty) {
            Type::Slice(_) | Type::ImplTrait(_) => "u32".into(),
            Type::Array(array) => match &array.len {
                Expr::Lit(length) => format!("vec{}f", digits(&length.lit)),
                other => refuse("an array", other),
            },
            Type::Path(path) => match last(&path.path).as_str() {
                "Self" => self.own.clone(),
                "BVec3" => "vec3<bool>".into(),
                "Vec2" => "vec2f".into(),
                "Vec3" => "vec3f".into(),
                name if ["f32", "u32", "i32", "bool"].contains(&name) || self.structs.contains_key(name) => {
                    name.into()
                }
                _ => refuse("a type", ty),
            },
            other => refuse("a type", other),
        }
    }

    fn name(&self, pattern: &Pat) -> String {
        match pattern {
            Pat::Ident(name) => name.ident.to_string(),
            Pat::Type(typed) => self.name(&typed.pat),
            other => refuse("a pattern", other),
        }
    }

    fn block(&self, block: &Block, tail: &Tail) -> String {
        block.stmts.iter().map(|statement| self.statement(statement, tail)).collect()
    }

    fn statement(&self, statement: &Stmt, tail: &Tail) -> String {
        match statement {
            Stmt::Local(local) => self.local(local),
            Stmt::Expr(expr, None) => self.last(expr, tail),
            Stmt::Expr(expr, Some(_)) => self.last(expr, &Tail::Nothing),
            other => refuse("a statement", other),
        }
    }

    fn local(&self, local: &Local) -> String {
        let Some(init) = &local.init else { refuse("a variable without a value", local) };
        if let (Pat::Tuple(names), Expr::Tuple(values)) = (&local.pat, &*init.expr) {
            let pairs = names.elems.iter().zip(&values.elems);
            let written = |(name, value)| format!("let {} = {};\n", self.name(name), self.expr(value));
            return pairs.map(written).collect();
        }
        let name = self.name(&local.pat);
        let ty = match &local.pat {
            Pat::Type(typed) => format!(": {}", self.ty(&typed.ty)),
            _ => String::new(),
        };
        if let (Expr::If(_), false) = (&*init.expr, ty.is_empty()) {
            return format!("var {name}{ty};\n{}", self.last(&init.expr, &Tail::Assign(&name)));
        }
        let pattern = if let Pat::Type(typed) = &local.pat { &*typed.pat } else { &local.pat };
        let is_mutable = matches!(pattern, Pat::Ident(name) if name.mutability.is_some());
        format!("{} {name}{ty} = {};\n", if is_mutable { "var" } else { "let" }, self.expr(&init.expr))
    }

    /// The last expression of a block, whose value goes where the block's goes.
    fn last(&self, expr: &Expr, tail: &Tail) -> String {
        match expr {
            Expr::If(of) => {
                let then = indented(&self.block(&of.then_branch, tail));
                let mut text = format!("if ({}) {{\n{then}}}", self.expr(&of.cond));
                match of.else_branch.as_ref().map(|(_, otherwise)| &**otherwise) {
                    None => {}
                    Some(otherwise @ Expr::If(_)) => {
                        text = format!("{text} else {}", self.last(otherwise, tail).trim_end());
                    }
                    Some(Expr::Block(block)) => {
                        let _ = write!(text, " else {{\n{}}}", indented(&self.block(&block.block, tail)));
                    }
                    Some(other) => refuse("an alternative", other),
                }
                text + "\n"
            }
            Expr::While(of) => {
                let body = indented(&self.block(&of.body, &Tail::Nothing));
                format!("while ({}) {{\n{body}}}\n", self.expr(&of.cond))
            }
            Expr::ForLoop(of) => {
                let Expr::Range(range) = &*of.expr else { refuse("a loop", &of.expr) };
                let (Some(start), Some(end)) = (&range.start, &range.end) else { refuse("a range", range) };
                let (name, start, end) = (self.name(&of.pat), self.expr(start), self.expr(end));
                let body = indented(&self.block(&of.body, &Tail::Nothing));
                format!("for (var {name} = {start}; {name} < {end}; {name}++) {{\n{body}}}\n")
            }
            Expr::Return(of) => match &of.expr {
                Some(value) => self.last(value, &Tail::Return),
                None => refuse("a return without a value", of),
            },
            Expr::Break(_) => "break;\n".into(),
            Expr::Continue(_) => "continue;\n".into(),
            _ => match tail {
                Tail::Return => format!("return {};\n", self.expr(expr)),
                Tail::Assign(name) => format!("{name} = {};\n", self.expr(expr)),
                Tail::Nothing => format!("{};\n", self.expr(expr)),
            },
        }
    }

    fn expr(&self, expr: &Expr) -> String {
        match expr {
            Expr::Array(of) => format!("vec{}f({})", of.elems.len(), self.arguments(&of.elems)),
            Expr::Assign(of) => format!("{} = {}", self.expr(&of.left), self.expr(&of.right)),
            Expr::Binary(of) => {
                let operator = operator(&of.op);
                let side = |side: &Expr| match side {
                    Expr::Binary(inner) if !may_stand(&inner.op, &of.op) => format!("({})", self.expr(side)),
                    _ => self.expr(side),
                };
                format!("{} {operator} {}", side(&of.left), side(&of.right))
            }
            Expr::Block(of) => self.only(&of.block),
            Expr::Call(of) => self.call(of),
            Expr::Cast(of) => match &*of.ty {
                Type::Path(path) if path.path.is_ident("usize") => self.expr(&of.expr),
                ty => match &*of.expr {
                    Expr::Paren(inner) => format!("{}({})", self.ty(ty), self.expr(&inner.expr)),
                    inner => format!("{}({})", self.ty(ty), self.expr(inner)),
                },
            },
            Expr::Field(of) => match &of.member {
                Member::Named(name) => format!("{}.{name}", self.expr(&of.base)),
                other @ Member::Unnamed(_) => refuse("a field", other),
            },
            Expr::If(of) => {
                let Some((_, otherwise)) = &of.else_branch else { refuse("a choice of one", of) };
                let then = self.only(&of.then_branch);
                format!("select({}, {then}, {})", self.expr(otherwise), self.expr(&of.cond))
            }
            Expr::Index(of) => match &*of.expr {
                Expr::Path(path) if self.slices.contains(&last(&path.path)) => {
                    format!("tables[{} + {}]", last(&path.path), self.expr(&of.index))
                }
                array => match &*of.index {
                    Expr::Lit(place) => format!("{}[{}]", self.expr(array), digits(&place.lit)),
                    other => refuse("an index", other),
                },
            },
            Expr::Lit(of) => literal(&of.lit),
            Expr::MethodCall(of) => self.method(of),
            Expr::Paren(of) => format!("({})", self.expr(&of.expr)),
            Expr::Path(path) if path.path.is_ident("self") => "own".into(),
            Expr::Path(path) => constant(&path.path),
            Expr::Reference(of) => match &*of.expr {
                // A slice from some place on
                Expr::Index(inner) => match (&*inner.expr, &*inner.index) {
                    (Expr::Path(path), Expr::Range(range)) if self.slices.contains(&last(&path.path)) => {
                        let start = range.start.as_ref().unwrap_or_else(|| refuse("a slice", range));
                        format!("{} + {}", last(&path.path), self.expr(start))
                    }
                    _ => refuse("a reference", inner),
                },
                inner => self.expr(inner),
            },
            Expr::Struct(of) => {
                let name = self.struct_name(&last(&of.path));
                let Some(order) = self.structs.get(&name) else { refuse("a struct", &name) };
                let given = |name: &String| {
                    let is_it =
                        |field: &&syn::FieldValue| matches!(&field.member, Member::Named(of) if of == name);
                    let found =
                        of.fields.iter().find(is_it).unwrap_or_else(|| refuse("a struct without", name));
                    self.expr(&found.expr)
                };
                format!("{name}({})", order.iter().map(given).collect::<Vec<_>>().join(", "))
            }
            Expr::Unary(of) => {
                let operand = match &*of.expr {
                    Expr::Binary(_) | Expr::Cast(_) => refuse("an operand", &of.expr),
                    inner => self.expr(inner),
                };
                match of.op {
                    UnOp::Neg(_) => format!("-{operand}"),
                    UnOp::Not(_) => format!("!{operand}"),
                    _ => operand,
                }
            }
            other => refuse("an expression", other),
        }
    }

    fn struct_name(&self, name: &str) -> String {
        if name == "Self" { self.own.clone() } else { name.to_owned() }
    }

    /// The expression that a block consists of.
    fn only(&self, block: &Block) -> String {
        match &block.stmts[..] {
            [Stmt::Expr(expr, None)] => self.expr(expr),
            other => refuse("a block as a value", &other),
        }
    }

    fn arguments<'e>(&self, arguments: impl IntoIterator<Item = &'e Expr>) -> String {
        arguments.into_iter().map(|argument| self.expr(argument)).collect::<Vec<_>>().join(", ")
    }

    fn call(&self, of: &syn::ExprCall) -> String {
        let Expr::Path(path) = &*of.func else { refuse("a call", &of.func) };
        let arguments = self.arguments(&of.args);
        match two(&path.path).as_str() {
            "Vec2::new" | "Vec2::splat" => format!("vec2f({arguments})"),
            "Vec3::new" | "Vec3::splat" => format!("vec3f({arguments})"),
            "Vec3::select" => {
                let [mask, then, otherwise] = [0, 1, 2].map(|k| self.expr(&of.args[k]));
                format!("select({otherwise}, {then}, {mask})")
            }
            name => match name.split_once("::") {
                Some((of, method)) if of.starts_with(char::is_uppercase) => {
                    format!("{}({arguments})", function_of(&self.struct_name(of), method))
                }
                _ => format!("{}({arguments})", last(&path.path)),
            },
        }
    }

    fn method(&self, of: &syn::ExprMethodCall) -> String {
        let name = of.method.to_string();
        if let Expr::Path(receiver) = &*of.receiver
            && self.traits.contains(&last(&receiver.path))
        {
            return format!("{name}({})", self.arguments(std::iter::once(&*of.receiver).chain(&of.args)));
        }
        let built_in = METHODS.iter().find(|(rust, _)| *rust == name);
        let receiver = match &*of.receiver {
            Expr::Paren(inner) if built_in.is_some() => self.expr(&inner.expr),
            receiver => self.expr(receiver),
        };
        match (name.as_str(), built_in) {
            (method, _) if self.methods.contains_key(method) => {
                let own = match &self.methods[method][..] {
                    [own] => own,
                    _ if receiver == "own" => &self.own,
                    several => refuse("a method of several structs", &(method, several)),
                };
                let rest = of.args.iter().map(|argument| format!(", {}", self.expr(argument)));
                format!("{}({receiver}{})", function_of(own, method), rest.collect::<String>())
            }
            ("truncate", _) => format!("{receiver}.xy"),
            ("extend", _) => format!("vec3f({receiver}, {})", self.arguments(&of.args)),
            ("cmpgt", _) => format!("{receiver} > {}", self.arguments(&of.args)),
            ("wrapping_add", _) => format!("({receiver} + {})", self.arguments(&of.args)),
            ("wrapping_mul", _) => format!("({receiver} * {})", self.arguments(&of.args)),
            (_, Some((_, built_in))) => {
                let rest = of.args.iter().map(|argument| format!(", {}", self.expr(argument)));
                format!("{built_in}({receiver}{})", rest.collect::<String>())
            }
            _ => refuse("a method", &name),
        }
    }
}

/// Where the value of a block goes.
enum Tail<'a> {
    Return,
    Assign(&'a str),
    Nothing,
}

/// The type that a reference is to.
fn peeled(ty: &Type) -> &Type {
    if let Type::Reference(reference) = ty { &reference.elem } else { ty }
}

fn last(path: &syn::Path) -> String {
    path.segments.last().map_or_else(String::new, |segment| segment.ident.to_string())
}

/// The last two names of a path.
fn two(path: &syn::Path) -> String {
    let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
    names[names.len().saturating_sub(2)..].join("::")
}

fn constant(path: &syn::Path) -> String {
    let of =
        |name: &str| CONSTANTS.iter().find(|(rust, _)| *rust == name).map(|(_, value)| (*value).to_owned());
    of(&two(path)).or_else(|| of(&last(path))).unwrap_or_else(|| last(path))
}

fn literal(literal: &Lit) -> String {
    match literal {
        Lit::Float(number) => number.base10_digits().to_owned(),
        Lit::Int(number) if number.suffix() == "u32" => format!("{}u", number.base10_digits()),
        Lit::Int(number) if number.suffix() == "i32" => format!("{}i", number.base10_digits()),
        Lit::Bool(value) => value.value.to_string(),
        other => refuse("a literal", other),
    }
}

fn digits(of: &Lit) -> &str {
    if let Lit::Int(number) = of { number.base10_digits() } else { refuse("a number", of) }
}

fn operator(of: &BinOp) -> &'static str {
    match of {
        BinOp::Add(_) => "+",
        BinOp::Sub(_) => "-",
        BinOp::Mul(_) => "*",
        BinOp::Div(_) => "/",
        BinOp::Rem(_) => "%",
        BinOp::And(_) => "&&",
        BinOp::Or(_) => "||",
        BinOp::BitXor(_) => "^",
        BinOp::BitAnd(_) => "&",
        BinOp::BitOr(_) => "|",
        BinOp::Shl(_) => "<<",
        BinOp::Shr(_) => ">>",
        BinOp::Eq(_) => "==",
        BinOp::Lt(_) => "<",
        BinOp::Le(_) => "<=",
        BinOp::Ne(_) => "!=",
        BinOp::Ge(_) => ">=",
        BinOp::Gt(_) => ">",
        BinOp::AddAssign(_) => "+=",
        BinOp::SubAssign(_) => "-=",
        BinOp::MulAssign(_) => "*=",
        BinOp::DivAssign(_) => "/=",
        other => refuse("an operator", other),
    }
}

/// Whether an operator's result may be an operand of another one without parentheses in both languages.
fn may_stand(inner: &BinOp, outer: &BinOp) -> bool {
    let rank = |of: &BinOp| match operator(of) {
        "+" | "-" | "*" | "/" | "%" => 0,
        "==" | "!=" | "<" | "<=" | ">" | ">=" => 1,
        "&&" => 2,
        "||" => 3,
        assigned if assigned.ends_with('=') => 5,
        _ => 4,
    };
    match (rank(inner), rank(outer)) {
        (_, 5) | (0, 0..=3) | (1, 2 | 3) => true,
        (a, b) => a == b && (a == 2 || a == 3),
    }
}
