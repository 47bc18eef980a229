//! The boundary between C and Rust: the only file that reads and writes the caller's memory, and runs the caller's code.

use std::any::Any;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::NonNull;

use crate::status::{Failure, TranslucidStatus};

/// Right to use the pointers of one call: they are as the head of the header says.
pub(crate) struct Caller(());

/// Runs the work of an entry; a failure or a panic becomes a status and a message.
///
/// # Safety
/// Every pointer that the work hands to the methods of its [`Caller`] is NULL or as the head of the header says.
pub(crate) unsafe fn run_entry(work: impl FnOnce(&Caller) -> Result<(), Failure>) -> TranslucidStatus {
    match catch_unwind(AssertUnwindSafe(|| work(&Caller(())))) {
        Ok(Ok(())) => TranslucidStatus::Ok,
        Ok(Err(failure)) => failure.report(),
        Err(panic) => {
            let message = format!("a mistake in translucid, please report it: {}", message_of(&*panic));
            Failure::new(TranslucidStatus::InternalError, message).report()
        }
    }
}

/// [`run_entry`] from an entry, whose arguments are what its caller promised.
macro_rules! enter {
    (|$caller:ident| $work:expr) => {
        // SAFETY: the pointers are arguments of this entry, of which its caller has promised what the header says.
        unsafe { $crate::ffi_guard::run_entry(|$caller| $work) }
    };
}
pub(crate) use enter;

fn message_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("a panic")
}

/// A type of handle in the header, and what stands behind it.
pub(crate) trait Kind {
    type Value: Send + Sync;
    /// Eight letters that tell it from other handles.
    const TAG: [u8; 8];
    /// Name in the header.
    const NAME: &'static str;
}

/// A value, and the tag of its type: handles point at one.
#[repr(C)]
struct Tagged<V> {
    tag: [u8; 8],
    value: V,
}

/// Numbers that a buffer holds at a time.
const CHUNK: usize = 256;

/// Range of numbers, for messages.
pub(crate) struct Rule {
    pub(crate) name: &'static str,
    /// Worded to follow "must be".
    pub(crate) allowed: &'static str,
    pub(crate) least: f64,
    pub(crate) most: f64,
}

impl Rule {
    fn allows(&self, x: f64) -> bool {
        (self.least..=self.most).contains(&x)
    }

    /// Refuses a number outside of the range, and NaN.
    pub(crate) fn require(&self, x: f64) -> Result<(), Failure> {
        if self.allows(x) { Ok(()) } else { Err(self.failure("", x)) }
    }

    fn failure(&self, index: &str, x: f64) -> Failure {
        Failure::argument(format_args!("{}{index} is {x}, but must be {}", self.name, self.allowed))
    }
}

/// Numbers of the caller's to be read.
pub(crate) struct Input<'a> {
    start: *const f64,
    count: usize,
    caller: PhantomData<&'a Caller>,
}

/// Room of the caller's for numbers.
pub(crate) struct Output<'a> {
    start: *mut f64,
    count: usize,
    caller: PhantomData<&'a Caller>,
}

/// Room of the caller's for one thing.
pub(crate) struct Slot<'a, T> {
    place: NonNull<T>,
    caller: PhantomData<&'a Caller>,
}

/// Function of the caller's that is told of progress.
pub(crate) struct Progress<'a> {
    function: Option<ProgressFunction>,
    user: *mut c_void,
    caller: PhantomData<&'a Caller>,
}

type ProgressFunction = unsafe extern "C" fn(done: u64, total: u64, user: *mut c_void) -> c_int;

fn null(name: &str) -> Failure {
    Failure::new(TranslucidStatus::NullPointer, format!("{name} is NULL"))
}

impl Caller {
    /// The value behind a handle.
    pub(crate) fn handle<'a, K: Kind>(
        &'a self,
        name: &str,
        handle: *const K,
    ) -> Result<&'a K::Value, Failure> {
        // SAFETY: it is the caller's, who keeps it until the call has ended.
        unsafe { Ok(&(*tagged(name, handle)?).value) }
    }

    /// Frees a handle; NULL is none.
    pub(crate) fn free<K: Kind>(&self, name: &str, handle: *mut K) -> Result<(), Failure> {
        if !handle.is_null() {
            // SAFETY: `Slot::put_handle` made it of a box, and the caller gives it back once.
            drop(unsafe { Box::from_raw(tagged(name, handle)?.cast_mut()) });
        }
        Ok(())
    }

    /// Numbers to be read; of none the pointer may be NULL.
    pub(crate) fn input(&self, name: &str, start: *const f64, count: usize) -> Result<Input<'_>, Failure> {
        check_extent(name, start, count)?;
        Ok(Input { start, count, caller: PhantomData })
    }

    /// Room for numbers; of none the pointer may be NULL.
    pub(crate) fn output(&self, name: &str, start: *mut f64, count: usize) -> Result<Output<'_>, Failure> {
        check_extent(name, start, count)?;
        Ok(Output { start, count, caller: PhantomData })
    }

    /// Room for numbers that are not wanted where the pointer is NULL.
    pub(crate) fn optional_output(
        &self,
        name: &str,
        start: *mut f64,
        count: usize,
    ) -> Result<Output<'_>, Failure> {
        self.output(name, start, if start.is_null() { 0 } else { count })
    }

    /// Room for one thing.
    pub(crate) fn slot<T>(&self, name: &str, place: *mut T) -> Result<Slot<'_, T>, Failure> {
        Ok(Slot { place: NonNull::new(place).ok_or_else(|| null(name))?, caller: PhantomData })
    }

    /// A structure of the header.
    pub(crate) fn structure<T: Copy>(&self, name: &str, place: *const T) -> Result<T, Failure> {
        if place.is_null() {
            return Err(null(name));
        }
        // SAFETY: it is the caller's; structures of the header hold numbers and pointers, valid whatever their bits.
        Ok(unsafe { place.read_unaligned() })
    }

    /// Structures of the header, one after the other; of none the pointer may be NULL.
    pub(crate) fn structures<T: Copy>(
        &self,
        name: &str,
        start: *const T,
        count: usize,
    ) -> Result<Vec<T>, Failure> {
        check_extent(name, start, count)?;
        let mut all = room(count)?;
        // SAFETY: as of one structure; `count` of them are the caller's.
        all.extend((0..count).map(|i| unsafe { start.add(i).read_unaligned() }));
        Ok(all)
    }

    /// A text, which must be there.
    pub(crate) fn text(&self, name: &str, text: *const c_char) -> Result<&str, Failure> {
        if text.is_null() {
            return Err(null(name));
        }
        // SAFETY: the caller's text ends with a 0 and stays until the call has ended.
        let text = unsafe { CStr::from_ptr(text) };
        text.to_str().map_err(|error| Failure::argument(format_args!("{name} is not UTF-8: {error}")))
    }

    /// A text; the default in place of NULL.
    pub(crate) fn text_or<'a>(
        &'a self,
        name: &str,
        text: *const c_char,
        default: &'a str,
    ) -> Result<&'a str, Failure> {
        if text.is_null() { Ok(default) } else { self.text(name, text) }
    }

    /// A function that is told of progress; none where it is NULL.
    pub(crate) fn progress(&self, function: Option<ProgressFunction>, user: *mut c_void) -> Progress<'_> {
        Progress { function, user, caller: PhantomData }
    }
}

fn tagged<K: Kind>(name: &str, handle: *const K) -> Result<*const Tagged<K::Value>, Failure> {
    let tagged = handle.cast::<Tagged<K::Value>>();
    if tagged.is_null() {
        return Err(null(name));
    }
    // SAFETY: the caller's pointer leads to a handle of one type or another, and all of them begin with a tag.
    if !tagged.is_aligned() || unsafe { *handle.cast::<[u8; 8]>() } != K::TAG {
        let message = format!("{name} is no {}", K::NAME);
        return Err(Failure::new(TranslucidStatus::WrongHandle, message));
    }
    Ok(tagged)
}

/// Refuses arrays that are not there, or larger than all memory.
fn check_extent<T>(name: &str, start: *const T, count: usize) -> Result<(), Failure> {
    let most = isize::MAX as usize / size_of::<T>();
    if count > most {
        return Err(Failure::argument(format_args!("{name} has {count} elements, but memory holds {most}")));
    }
    if count > 0 && start.is_null() {
        return Err(null(name));
    }
    if start.addr().checked_add(count * size_of::<T>()).is_none() {
        return Err(Failure::argument(format_args!(
            "{name} has {count} elements, which reach beyond memory"
        )));
    }
    Ok(())
}

/// An empty vector with room, if there is memory.
pub(crate) fn room<T>(count: usize) -> Result<Vec<T>, Failure> {
    let mut vector = Vec::new();
    vector.try_reserve_exact(count).map_err(|error| {
        Failure::new(TranslucidStatus::OutOfResources, format!("no memory for {count} elements: {error}"))
    })?;
    Ok(vector)
}

impl Input<'_> {
    /// Copies the numbers from a place on, as many as there is room for.
    fn read(&self, from: usize, to: &mut [f64]) {
        assert!(from + to.len() <= self.count);
        // SAFETY: as many numbers are the caller's. As bytes, since C may have laid them anywhere, `out` included.
        unsafe {
            let start = self.start.add(from).cast::<u8>();
            start.copy_to_nonoverlapping(to.as_mut_ptr().cast(), size_of_val(to));
        }
    }

    /// All numbers.
    pub(crate) fn to_vec(&self) -> Result<Vec<f64>, Failure> {
        let mut all = room(self.count)?;
        all.resize(self.count, 0.0);
        self.read(0, &mut all);
        Ok(all)
    }

    /// Refuses numbers outside of a range, and NaN.
    pub(crate) fn require(&self, rule: &Rule) -> Result<(), Failure> {
        self.in_chunks(|start, chunk| match chunk.iter().position(|&x| !rule.allows(x)) {
            Some(i) => Err(rule.failure(&format!("[{}]", start + i), chunk[i])),
            None => Ok(()),
        })
    }

    /// Gives a function of the numbers out, which may have the very same place.
    pub(crate) fn map(&self, out: &Output<'_>, mut f: impl FnMut(usize, &[f64], &mut [f64])) {
        let mut results = [0.0; CHUNK];
        let _: Result<(), Failure> = self.in_chunks(|start, chunk| {
            let results = &mut results[..chunk.len()];
            f(start, chunk, results);
            out.write(start, results);
            Ok(())
        });
    }

    /// Calls with copies of the numbers, part by part, and where each part starts.
    fn in_chunks(&self, mut f: impl FnMut(usize, &[f64]) -> Result<(), Failure>) -> Result<(), Failure> {
        let mut buffer = [0.0; CHUNK];
        for start in (0..self.count).step_by(CHUNK) {
            let chunk = &mut buffer[..CHUNK.min(self.count - start)];
            self.read(start, chunk);
            f(start, chunk)?;
        }
        Ok(())
    }

    /// Copies of numbers from a place on, at most as many as a chunk has.
    pub(crate) fn chunk(&self, start: usize, count: usize) -> [f64; CHUNK] {
        let mut chunk = [0.0; CHUNK];
        self.read(start, &mut chunk[..count]);
        chunk
    }
}

impl Output<'_> {
    /// Writes numbers from a place on; nothing where none are wanted.
    pub(crate) fn write(&self, at: usize, from: &[f64]) {
        if self.count == 0 {
            return;
        }
        assert!(at + from.len() <= self.count);
        // SAFETY: there is room for as many; as bytes, since C may have laid them anywhere.
        unsafe {
            let start = self.start.add(at).cast::<u8>();
            start.copy_from_nonoverlapping(from.as_ptr().cast(), size_of_val(from));
        }
    }
}

impl<T> Slot<'_, T> {
    pub(crate) fn put(self, value: T) {
        // SAFETY: there is room for one.
        unsafe { self.place.as_ptr().write_unaligned(value) };
    }
}

impl<K: Kind> Slot<'_, *mut K> {
    /// Makes a handle, which is the caller's to free.
    pub(crate) fn put_handle(self, value: K::Value) {
        let tagged = Box::new(Tagged { tag: K::TAG, value });
        self.put(Box::into_raw(tagged).cast());
    }
}

impl Progress<'_> {
    /// Tells of progress; whether to go on.
    pub(crate) fn report(&self, done: u64, total: u64) -> bool {
        // SAFETY: the function is the caller's, and so is what it is given.
        self.function.is_none_or(|function| unsafe { function(done, total, self.user) } == 0)
    }
}

#[cfg(test)]
mod tests {
    use std::ffi::CString;
    use std::ptr::{null, null_mut, without_provenance};
    use std::sync::atomic::{AtomicPtr, Ordering};

    use super::*;
    use crate::status::translucid_last_error;

    struct Sheep;
    struct Goat;

    impl Kind for Sheep {
        type Value = String;
        const TAG: [u8; 8] = *b"tl-sheep";
        const NAME: &'static str = "Sheep";
    }

    impl Kind for Goat {
        type Value = u8;
        const TAG: [u8; 8] = *b"tl--goat";
        const NAME: &'static str = "Goat";
    }

    const CALLER: Caller = Caller(());
    const ANY: Rule = Rule { name: "x", allowed: "at least 0", least: 0.0, most: f64::INFINITY };

    fn last_error() -> String {
        // SAFETY: the library's own text, on this thread.
        unsafe { CStr::from_ptr(translucid_last_error()) }.to_str().unwrap().to_owned()
    }

    fn status<T>(result: Result<T, Failure>) -> TranslucidStatus {
        result.err().unwrap().status
    }

    fn sheep() -> *mut Sheep {
        let mut sheep = null_mut();
        CALLER.slot("sheep", &mut sheep).unwrap().put_handle(String::from("wool"));
        sheep
    }

    #[test]
    fn panics_become_messages() {
        for (work, message) in [
            ((|_| panic!("two {}", "words")) as fn(&Caller) -> Result<(), Failure>, "two words"),
            (|_| panic!("plain"), "plain"),
            (|_| std::panic::resume_unwind(Box::new(7)), "a panic"),
        ] {
            assert_eq!(enter!(|caller| work(caller)), TranslucidStatus::InternalError);
            assert!(last_error().ends_with(message), "{}", last_error());
        }
    }

    #[test]
    fn handles_are_told_apart() {
        let mut sheep = sheep();
        assert_eq!(CALLER.handle("sheep", sheep).unwrap(), "wool");
        let mistaken = CALLER.handle("goat", sheep.cast::<Goat>());
        assert_eq!(mistaken.err().unwrap().message, "goat is no Goat");
        assert_eq!(status(CALLER.free("goat", sheep.cast::<Goat>())), TranslucidStatus::WrongHandle);
        let other = [0_u64; 4];
        assert_eq!(
            status(CALLER.handle("sheep", other.as_ptr().cast::<Sheep>())),
            TranslucidStatus::WrongHandle
        );
        let askew = other.as_ptr().cast::<u8>().wrapping_add(1).cast::<Sheep>();
        assert_eq!(status(CALLER.handle("sheep", askew)), TranslucidStatus::WrongHandle);
        assert_eq!(status(CALLER.handle("sheep", null::<Sheep>())), TranslucidStatus::NullPointer);
        CALLER.free("sheep", sheep).unwrap();
        sheep = null_mut();
        CALLER.free("sheep", sheep).unwrap();
    }

    #[test]
    fn arrays_may_lie_anywhere_and_be_written_in_place() {
        const COUNT: usize = 2 * CHUNK + 7;
        let numbers: Vec<f64> = (0..COUNT).map(|i| i as f64).collect();
        for shift in [0, 1, 3] {
            let mut bytes = vec![0_u8; 8 * COUNT + 8];
            let start: *mut f64 = bytes.as_mut_ptr().wrapping_add(shift).cast();
            CALLER.output("x", start, COUNT).unwrap().write(0, &numbers);
            let (x, out) =
                (CALLER.input("x", start, COUNT).unwrap(), CALLER.output("x", start, COUNT).unwrap());
            x.require(&ANY).unwrap();
            x.map(&out, |place, from, to| {
                assert_eq!(from[0], place as f64);
                to.iter_mut().zip(from).for_each(|(to, from)| *to = from + 1.0);
            });
            let expected: Vec<f64> = numbers.iter().map(|x| x + 1.0).collect();
            assert_eq!(x.to_vec().unwrap(), expected);
            out.write(COUNT - 1, &[-2.0]);
            let message = format!("x[{}] is -2, but must be at least 0", COUNT - 1);
            assert_eq!(x.require(&ANY).err().unwrap().message, message);
        }
    }

    #[test]
    fn arrays_that_cannot_be_are_refused() {
        let number = 1.0_f64;
        let refused = |start, count| status(CALLER.input("x", start, count));
        assert_eq!(refused(null(), 1), TranslucidStatus::NullPointer);
        for count in [usize::MAX, usize::MAX / 8 + 1, isize::MAX as usize / 8 + 1] {
            assert_eq!(refused(&raw const number, count), TranslucidStatus::InvalidArgument);
            assert_eq!(refused(null(), count), TranslucidStatus::InvalidArgument);
        }
        // Up to the end of memory, and past it
        assert_eq!(refused(without_provenance(usize::MAX - 15), 2), TranslucidStatus::InvalidArgument);
        assert!(CALLER.input("x", null(), 0).unwrap().to_vec().unwrap().is_empty());
        // None wanted: nothing is written
        CALLER.optional_output("x", null_mut(), 5).unwrap().write(0, &[1.0]);
    }

    #[test]
    #[cfg_attr(miri, ignore = "there, memory that is refused ends the program")]
    fn memory_that_is_not_there_is_a_failure() {
        let refused = status(room::<f64>(isize::MAX as usize / 8));
        assert_eq!(refused, TranslucidStatus::OutOfResources);
    }

    #[test]
    fn structures_may_lie_askew() {
        let bytes = [1_u8, 2, 0, 3, 0, 4];
        let start = bytes.as_ptr().wrapping_add(1).cast::<[u8; 2]>();
        assert_eq!(CALLER.structures("all", start, 2).unwrap(), [[2, 0], [3, 0]]);
        assert_eq!(CALLER.structure("one", start).unwrap(), [2, 0]);
        assert_eq!(status(CALLER.structure("one", null::<u8>())), TranslucidStatus::NullPointer);
        assert_eq!(status(CALLER.structures("all", start, usize::MAX)), TranslucidStatus::InvalidArgument);
    }

    #[test]
    fn texts_are_utf8() {
        let (good, bad) = (CString::new("é").unwrap(), CString::new(*b"a\xff").unwrap());
        assert_eq!(CALLER.text("name", good.as_ptr()).unwrap(), "é");
        assert_eq!(status(CALLER.text("name", bad.as_ptr())), TranslucidStatus::InvalidArgument);
        assert_eq!(status(CALLER.text("name", null())), TranslucidStatus::NullPointer);
        assert_eq!(CALLER.text_or("name", null(), "default").unwrap(), "default");
    }

    #[test]
    fn progress_gets_the_callers_own() {
        unsafe extern "C" fn count(done: u64, _: u64, user: *mut c_void) -> c_int {
            // SAFETY: it is the number below.
            unsafe { *user.cast::<u64>() += done };
            c_int::from(done == 2)
        }
        let mut sum = 0_u64;
        let progress = CALLER.progress(Some(count), (&raw mut sum).cast());
        assert!(progress.report(1, 3) && !progress.report(2, 3));
        assert!(CALLER.progress(None, null_mut()).report(1, 2));
        assert_eq!(sum, 3);
    }

    #[test]
    fn messages_belong_to_their_threads() {
        let fail = |message: &str| {
            let message = message.to_owned();
            enter!(|_caller| Err(Failure::argument(message)))
        };
        fail("mine\0and more");
        let other = std::thread::spawn(move || {
            let before = last_error();
            fail("other");
            (before, last_error())
        });
        assert_eq!(other.join().unwrap(), (String::new(), String::from("other")));
        assert_eq!(last_error(), "mine\u{fffd}and more");
    }

    #[test]
    fn handles_are_shared_by_threads() {
        let shared = AtomicPtr::new(sheep());
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    let handle = shared.load(Ordering::Relaxed);
                    assert_eq!(CALLER.handle("sheep", handle).unwrap(), "wool");
                });
            }
        });
        CALLER.free("sheep", shared.into_inner()).unwrap();
    }
}
