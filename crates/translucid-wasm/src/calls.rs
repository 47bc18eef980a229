//! Memory that the package and this module share, and the calls that it makes.
//!
//! The package asks for room, writes a request and numbers there, calls, and reads the answer in the same two places.
//! It never passes a pointer in: every place is a buffer of this module, found again by its name.

use std::cell::RefCell;
use std::sync::Arc;

use serde_json::{Value, json};
use translucid_profile::{Model, Profile, TabulatedProfile};

use crate::exact::Exact;
use crate::options::Options;
use crate::{ask, conversion, export, profile};

/// A thing of JavaScript's that lives here, until it is freed.
enum Handle {
    Profile(Arc<dyn Profile>),
    Exact(Exact),
    Freed,
}

/// Memory that both sides read and write, and the things that live here.
#[derive(Default)]
struct Shared {
    text: Vec<u8>,
    numbers: Vec<f64>,
    handles: Vec<Handle>,
}

thread_local! {
    static SHARED: RefCell<Shared> = RefCell::default();
}

/// Makes room for a request, in UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn text(length: usize) -> *mut u8 {
    SHARED.with_borrow_mut(|shared| {
        shared.text.resize(length, 0);
        shared.text.as_mut_ptr()
    })
}

/// Makes room for numbers.
#[unsafe(no_mangle)]
pub extern "C" fn numbers(count: usize) -> *mut f64 {
    SHARED.with_borrow_mut(|shared| {
        shared.numbers.resize(count, 0.0);
        shared.numbers.as_mut_ptr()
    })
}

/// Answers the request: 0 with JSON, 1 with the message of an error.
#[unsafe(no_mangle)]
pub extern "C" fn call() -> u32 {
    SHARED.with_borrow_mut(|shared| {
        let (status, text) = match shared.answer() {
            Ok(value) => (0, value.to_string()),
            Err(message) => (1, message),
        };
        shared.text = text.into_bytes();
        status
    })
}

/// Length of the answer's text.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> usize {
    SHARED.with_borrow(|shared| shared.text.len())
}

/// Number of the answer's numbers.
#[unsafe(no_mangle)]
pub extern "C" fn numbers_count() -> usize {
    SHARED.with_borrow(|shared| shared.numbers.len())
}

impl Shared {
    fn answer(&mut self) -> Result<Value, String> {
        let request = serde_json::from_slice(&self.text).map_err(|error| error.to_string())?;
        let mut request = Options::new("request", request)?;
        let call = request.text("call")?.unwrap_or_default();
        let index = request.number("handle")?.map(|index| index as usize);
        let options = Options::new("options", request.take("options").unwrap_or_else(|| json!({})))?;
        let made = match call.as_str() {
            "profile" => Handle::Profile(profile::of_appearance(options)?),
            "fromMedium" => Handle::Profile(profile::of_medium(options)?),
            "fromTable" => Handle::Profile(profile::of_samples(options)?),
            "tabulated" => Handle::Profile(Arc::new(TabulatedProfile::new(&**self.profile(index)?))),
            "halfSpace" => Handle::Exact(Exact::new(options)?),
            "total" => return Ok(self.profile(index)?.surface_albedo().into()),
            "apply" => return self.apply(index, options),
            "free" => return Ok(self.free(index)),
            "cyclesMaterial" => return conversion::cycles_material(options),
            "systems" => return Ok(conversion::systems()),
            "presets" => return Ok(conversion::presets()),
            "preset" => return conversion::preset(options),
            "models" => return Ok(Model::ALL.map(Model::name).to_vec().into()),
            "version" => return Ok(env!("CARGO_PKG_VERSION").into()),
            "export" => return export::export(options),
            "ask" => return ask::ask(options),
            other => return Err(format!("there is no call {other:?}")),
        };
        Ok(self.keep(made).into())
    }

    /// Keeps a thing where there is room, and gives its index.
    fn keep(&mut self, made: Handle) -> usize {
        let free = self.handles.iter().position(|handle| matches!(handle, Handle::Freed));
        let index = free.unwrap_or(self.handles.len());
        match free {
            Some(index) => self.handles[index] = made,
            None => self.handles.push(made),
        }
        index
    }

    fn free(&mut self, index: Option<usize>) -> Value {
        if let Some(handle) = index.and_then(|index| self.handles.get_mut(index)) {
            *handle = Handle::Freed;
        }
        Value::Null
    }

    fn profile(&self, index: Option<usize>) -> Result<&Arc<dyn Profile>, String> {
        match index.and_then(|index| self.handles.get(index)) {
            Some(Handle::Profile(profile)) => Ok(profile),
            _ => Err(String::from("there is no such profile")),
        }
    }

    fn apply(&mut self, index: Option<usize>, options: Options) -> Result<Value, String> {
        let Self { handles, numbers, .. } = self;
        match index.and_then(|index| handles.get(index)) {
            Some(Handle::Profile(profile)) => profile::apply(&**profile, options, numbers)?,
            Some(Handle::Exact(exact)) => exact.apply(options, numbers)?,
            _ => return Err(String::from("there is no such profile")),
        }
        Ok(Value::Null)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the package would receive: the status, and the answer.
    fn call_with(shared: &mut Shared, request: &Value, numbers: &[f64]) -> Result<Value, String> {
        shared.text = request.to_string().into_bytes();
        shared.numbers = numbers.to_vec();
        shared.answer()
    }

    #[test]
    fn profile_is_made_applied_and_freed() {
        let mut shared = Shared::default();
        let jade = json!({ "call": "'profile", "options": { "surfaceAlbedo": "#0.6", "mfp": "#1.5" } });
        assert_eq!(call_with(&mut shared, &jade, &[]), Ok(json!(0)));
        assert_eq!(call_with(&mut shared, &jade, &[]), Ok(json!(1)));
        let eval =
            json!({ "call": "'apply", "handle": "#1", "options": { "quantity": "'eval", "isOne": false } });
        assert_eq!(call_with(&mut shared, &eval, &[0.5, 1.0]), Ok(Value::Null));
        assert!((shared.numbers[0] - 0.06838).abs() < 1e-5 && (shared.numbers[1] - 0.02588).abs() < 1e-5);
        let wrong = call_with(&mut shared, &eval, &[0.5, -1.0]);
        assert_eq!(wrong.unwrap_err(), "r[1] is -1, but must be at least 0");
        assert_eq!(call_with(&mut shared, &json!({ "call": "'free", "handle": "#1" }), &[]), Ok(Value::Null));
        assert_eq!(call_with(&mut shared, &eval, &[0.5]).unwrap_err(), "there is no such profile");
        assert_eq!(call_with(&mut shared, &jade, &[]), Ok(json!(1)));
    }

    #[test]
    fn half_space_answers_with_errors_behind_values() {
        let mut shared = Shared::default();
        let options = json!({ "singleScatteringAlbedo": "#0.9", "configuration": "'searchlight" });
        let made = call_with(&mut shared, &json!({ "call": "'halfSpace", "options": options }), &[]);
        assert_eq!(made, Ok(json!(0)));
        let eval = json!({ "call": "'apply", "handle": "#0", "options": { "quantity": "'eval" } });
        assert_eq!(call_with(&mut shared, &eval, &[0.1, 1.0]), Ok(Value::Null));
        assert_eq!(shared.numbers.len(), 4);
        assert!((shared.numbers[0] - 0.56107803).abs() < 1e-8 && shared.numbers[2] < 1e-9);
    }

    #[test]
    fn questions_are_answered_or_refused_in_the_spelling_of_javascript() {
        let ask = |said: Value| {
            let options = json!({ "question": "'stack", "said": said });
            call_with(&mut Shared::default(), &json!({ "call": "'ask", "options": options }), &[])
        };
        let layer = json!({ "thickness": "#1", "surfaceAlbedo": ["#0.8", "#0.5", "#0.3"], "mfp": "#0.1" });
        let answer = ask(json!({ "layers": [layer.clone()] })).unwrap();
        assert_eq!(answer["columns"]["ground"], json!(["black", "white", "below"]));
        assert!(answer["svg"].as_str().unwrap().starts_with("<svg"));
        let wrong = ask(json!({ "layers": [{ "thickness": "#1", "surfaceAlbedo": "#2", "mfp": "#0.1" }] }));
        assert_eq!(wrong.unwrap_err(), "layers[0].surfaceAlbedo is 2, but must be in (0, 1]");
        let wrong = ask(json!({ "layers": [layer.clone()], "observr": "'2" })).unwrap_err();
        assert!(wrong.starts_with("the question has no key observr (did you mean observer?"), "{wrong}");
    }

    #[test]
    fn export_names_the_command_that_makes_it() {
        let options = json!({ "to": "'wgsl", "what": ["'profile", "'sampler"], "surfaceAlbedo": "#0.8", "mfp": ["#1", "#2", "#3"] });
        let text = call_with(&mut Shared::default(), &json!({ "call": "'export", "options": options }), &[])
            .unwrap();
        let command = "translucid export --to wgsl --what profile,sampler --surface-albedo 0.8 --mfp 1,2,3";
        assert!(text.as_str().unwrap().contains(command));
    }
}
