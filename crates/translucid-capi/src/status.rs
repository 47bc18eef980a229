//! Outcomes of calls, and the message of a thread's last failure.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::fmt::Display;

/// Outcome of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TranslucidStatus {
    /// It has worked.
    Ok = 0,
    /// A pointer is NULL that must not be.
    NullPointer = 1,
    /// A handle is of another type, or no handle at all.
    WrongHandle = 2,
    /// A number, a name, a length of an array or the content of a file is not what it must be.
    InvalidArgument = 3,
    /// A file cannot be read or written.
    FileError = 4,
    /// The progress function has stopped the work.
    Stopped = 5,
    /// Another thread is changing the handle.
    Busy = 6,
    /// There is not enough memory, or no thread can be started.
    OutOfResources = 7,
    /// A mistake of the library, which is to be reported.
    InternalError = 8,
}

/// A call that did not do what it should, and why.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: TranslucidStatus,
    pub(crate) message: String,
}

impl Failure {
    pub(crate) fn new(status: TranslucidStatus, message: impl Into<String>) -> Self {
        Self { status, message: message.into() }
    }

    /// The failure of an argument, in the words of an error.
    pub(crate) fn argument(error: impl Display) -> Self {
        Self::new(TranslucidStatus::InvalidArgument, error.to_string())
    }

    /// The failure of a name that is none of those there are.
    pub(crate) fn unknown(argument: &str, name: &str, known: &[&str]) -> Self {
        Self::argument(format_args!("{argument} is {name:?}, but must be one of {}", known.join(", ")))
    }

    /// Keeps the message for the thread.
    pub(crate) fn report(self) -> TranslucidStatus {
        let text = CString::new(self.message.replace('\0', "\u{fffd}")).unwrap_or_default();
        // A thread that is about to end has no message any more
        let _ = LAST.try_with(|last| last.replace(text));
        self.status
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

const GONE: &CStr = c"the thread is about to end";

/// Message of the last call on this thread that failed, in English and UTF-8; empty if none has.
///
/// It belongs to the library and is valid until another call on the same thread fails.
#[unsafe(no_mangle)]
pub extern "C" fn translucid_last_error() -> *const c_char {
    LAST.try_with(|last| last.borrow().as_ptr()).unwrap_or(GONE.as_ptr())
}
