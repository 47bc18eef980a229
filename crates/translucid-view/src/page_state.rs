//! The state as pages receive it: all of it once, then the changes.

use std::sync::Arc;

use serde_json::{Map, Value, json};

use crate::json;
use crate::look::Look;

/// A state as the message `state` carries it.
#[derive(Clone, Debug)]
pub(crate) struct PageState {
    pub(crate) version: u32,
    /// Everything but the looks, by its key.
    pub(crate) parts: Map<String, Value>,
    pub(crate) looks: [Option<Arc<Look>>; 2],
}

impl PageState {
    /// The message for a page that was told another state before, or none.
    pub(crate) fn message(&self, told: Option<&Self>) -> String {
        let is_new =
            |(key, value): &(&String, &Value)| told.is_none_or(|told| told.parts.get(*key) != Some(*value));
        let mut message: Map<String, Value> =
            self.parts.iter().filter(is_new).map(|(key, value)| (key.clone(), value.clone())).collect();
        let sides: Map<String, Value> = ["a", "b"]
            .into_iter()
            .zip(0..)
            .filter(|(_, side)| told.is_none_or(|told| !is_same(&told.looks[*side], &self.looks[*side])))
            .map(|(name, side)| {
                (name.to_owned(), self.looks[side].as_deref().map_or(Value::Null, json::look))
            })
            .collect();
        if !sides.is_empty() {
            message.insert("sides".to_owned(), sides.into());
        }
        message.insert("type".to_owned(), json!("state"));
        message.insert("version".to_owned(), json!(self.version));
        Value::Object(message).to_string()
    }
}

/// Whether both are one look in memory: comparing what is in them takes as long as telling it.
fn is_same(a: &Option<Arc<Look>>, b: &Option<Arc<Look>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (a, b) => a.is_none() && b.is_none(),
    }
}
