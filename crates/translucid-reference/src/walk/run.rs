//! Runs that extend a table, on all cores.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::device::{Device, DeviceTally, DeviceWalk, Machine};
use super::orders::Cell;
use super::photon_exit::{PhotonCounts, PhotonExit};
use super::photon_ranges::{PhotonRange, PhotonRanges};
use super::table_error::TableError;
use super::trace_until;
use super::white_table::WhiteTable;

/// Means by which the world outside takes part in a run.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set to true, from any thread, it ends the run once the photons under way have ended, within some hundredths of a
    /// second, on a device longer near an albedo of 1; the table then holds the photons that were done.
    pub stop: &'a AtomicBool,
    /// Called with the number of photons done since the run started, from any of its threads, some times a second.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Time to stop at in any case, give or take a fraction of a second.
    pub deadline: Option<Instant>,
    /// Machine that walks the photons in the processor's place.
    pub device: Option<&'a dyn Device>,
}

impl Default for Control<'_> {
    /// A run that nobody watches, to its end.
    fn default() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { stop: &NEVER, progress: &|_| {}, deadline: None, device: None }
    }
}

impl Control<'_> {
    /// Returns whether the run is to end now.
    pub(crate) fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

impl WhiteTable {
    /// Walks `photons` more photons of a seed, the first ones that the table does not hold yet, on all threads of
    /// the current rayon pool. Returns how many were done: fewer where the run was stopped.
    ///
    /// The table's bits do not depend on the threads, on stops, or on how photons are split over runs: 10⁶ and then
    /// 10⁶ more are 2·10⁶ at once.
    ///
    /// # Errors
    /// The seed does not have so many photons left (of 2⁶⁴ − 1), or a sum overflows. The table is then unchanged.
    pub fn run(&mut self, seed: u64, photons: u64, control: &Control) -> Result<u64, TableError> {
        let pieces = Pieces::new(self.missing(seed, photons));
        if pieces.left < photons {
            return Err(TableError::TooMany);
        }
        self.run_pieces(seed, pieces, control)
    }

    /// Walks the photons of a range, as one of many machines does that share the work; otherwise as [`run`](Self::run).
    ///
    /// # Errors
    /// The table holds one of them already, or a sum overflows. The table is then unchanged.
    pub fn run_range(&mut self, range: PhotonRange, control: &Control) -> Result<u64, TableError> {
        let wanted = PhotonRanges::new([range]).map_err(TableError::Repeated)?;
        let held = PhotonRanges::new(self.photon_ranges().iter().copied()).map_err(TableError::Repeated)?;
        held.union(&wanted).map_err(TableError::Repeated)?;
        self.run_rest(range, control)
    }

    /// Walks those photons of a range that the table does not hold yet, to go on from where
    /// [`run_range`](Self::run_range) was stopped.
    ///
    /// # Errors
    /// A sum overflows. The table is then unchanged.
    pub fn run_rest(&mut self, range: PhotonRange, control: &Control) -> Result<u64, TableError> {
        let pieces = self.missing_of(range).into_iter().map(|range| range.start..range.end).collect();
        self.run_pieces(range.seed, Pieces::new(pieces), control)
    }

    fn run_pieces(&mut self, seed: u64, pieces: Pieces, control: &Control) -> Result<u64, TableError> {
        let photons = pieces.left;
        if self.photons().checked_add(photons).is_none() {
            return Err(TableError::TooMany);
        }
        self.require_machine(if control.device.is_some() { Machine::Device } else { Machine::Processor })?;
        if let Some(device) = control.device {
            return self.run_on_device(device, seed, pieces, control);
        }
        let threads = photons.div_ceil(SMALLEST_PIECE).clamp(1, rayon::current_num_threads() as u64);
        let tallies = (TALLY_BYTES / size_of_val(self.all_cells())).clamp(1, threads as usize);
        let run = Run {
            table: self,
            seed,
            control,
            threads,
            pieces: Mutex::new(pieces),
            tallies: (0..tallies).map(|_| Mutex::default()).collect(),
            done: Mutex::default(),
            photons_done: AtomicU64::new(0),
        };
        rayon::scope(|scope| {
            let run = &run;
            (0..threads as usize).for_each(|worker| scope.spawn(move |_| run.work(worker)));
        });

        // Nothing of the table has changed so far, whatever happened
        let Run { tallies, done, photons_done, .. } = run;
        self.take_in(seed, &into_inner(done), tallies.into_iter().map(into_inner).collect())?;
        Ok(photons_done.into_inner())
    }

    fn run_on_device(
        &mut self,
        device: &dyn Device,
        seed: u64,
        pieces: Pieces,
        control: &Control,
    ) -> Result<u64, TableError> {
        let mut photons_done = 0;
        for piece in pieces.ranges.into_iter().rev() {
            if control.stops() {
                break;
            }
            let before = photons_done;
            let walk = DeviceWalk {
                problem: self.problem(),
                layout: self.layout(),
                reference_albedo: self.reference_albedo(),
                seed,
            };
            let progress = |done| (control.progress)(before + done);
            let tally = device
                .walk(&walk, piece.clone(), &|| control.stops(), &progress)
                .map_err(TableError::Device)?;
            let DeviceTally { launched, absorbed, collisions, exits } = tally;
            photons_done += launched;
            let counts = PhotonCounts { launched, absorbed, collisions };
            let cells = exits.into_iter().map(|(count, order_sum)| Cell { count, order_sum }).collect();
            self.take_in(seed, &[(piece.start..piece.start + launched, counts)], vec![cells])?;
        }
        Ok(photons_done)
    }
}

/// Time that a piece of work is to take: the longest that a deadline is waited for. A stop is seen within a piece.
///
/// At its end the kernel waits for a last photon with most lanes empty. That is nothing at albedos up to 0.999,
/// where 2¹⁴ photons cost as much per collision as 2²⁰; at 0.99999 they cost half as much again as 2¹⁷, which take
/// this time.
const PIECE_TIME: Duration = Duration::from_millis(250);
/// Photons in the smallest piece of work.
const SMALLEST_PIECE: u64 = 1 << 10;
/// Memory for the tallies of all threads together; threads share them where it is not enough for one each.
const TALLY_BYTES: usize = 64 << 20;
/// Exits that a thread collects before it takes a tally.
const PENDING: usize = 1 << 13;

/// A run under way, as its threads see it.
struct Run<'a> {
    table: &'a WhiteTable,
    seed: u64,
    control: &'a Control<'a>,
    threads: u64,
    pieces: Mutex<Pieces>,
    tallies: Vec<Mutex<Vec<Cell>>>,
    done: Mutex<Vec<(Range<u64>, PhotonCounts)>>,
    photons_done: AtomicU64,
}

impl Run<'_> {
    /// Walks pieces until there are no more or the run is stopped.
    fn work(&self, worker: usize) {
        let tally = &self.tallies[worker % self.tallies.len()];
        let mut pending = Vec::with_capacity(2 * PENDING);
        let mut size = SMALLEST_PIECE;
        while !self.control.stops() {
            let Some(mut piece) = lock(&self.pieces).take(size, self.threads) else { break };
            let start = Instant::now();
            let (problem, albedo) = (self.table.problem(), self.table.reference_albedo());
            let tally_exits = &mut |exits: &[PhotonExit]| {
                pending.extend(exits.iter().map(|exit| (self.table.cell_index(exit), exit.order)));
                if pending.len() >= PENDING {
                    self.flush(&mut pending, tally);
                }
            };
            let stop = self.control.stop;
            let counts = trace_until(stop, problem, albedo, self.seed, piece.clone(), tally_exits);
            self.flush(&mut pending, tally);

            let photons = counts.launched;
            piece.end = piece.start + photons;
            lock(&self.done).push((piece, counts));
            let done = self.photons_done.fetch_add(photons, Ordering::Relaxed) + photons;
            (self.control.progress)(done);
            let speed_up = PIECE_TIME.as_secs_f64() / start.elapsed().as_secs_f64();
            size = (photons as f64 * speed_up.clamp(0.25, 4.0)) as u64;
        }
    }

    fn flush(&self, pending: &mut Vec<(u32, u32)>, tally: &Mutex<Vec<Cell>>) {
        let mut tally = lock(tally);
        tally.resize(self.table.all_cells().len(), Cell::default());
        for (index, order) in pending.drain(..) {
            let cell = &mut tally[index as usize];
            cell.count += 1;
            cell.order_sum += u64::from(order);
        }
    }
}

/// Photons to be walked.
struct Pieces {
    /// Ranges, the next one last.
    ranges: Vec<Range<u64>>,
    /// Number of photons in all ranges.
    left: u64,
}

impl Pieces {
    fn new(mut ranges: Vec<Range<u64>>) -> Self {
        ranges.reverse();
        let left = ranges.iter().map(|range| range.end - range.start).sum();
        Self { ranges, left }
    }

    /// The next piece, of at most `size` photons; towards the end of less, so that all threads end together.
    fn take(&mut self, size: u64, threads: u64) -> Option<Range<u64>> {
        let range = self.ranges.last_mut()?;
        let size = size.min(self.left / (2 * threads)).max(SMALLEST_PIECE).min(range.end - range.start);
        let piece = range.start..range.start + size;
        range.start = piece.end;
        self.left -= size;
        if range.is_empty() {
            self.ranges.pop();
        }
        Some(piece)
    }
}

/// A lock that another thread's panic does not spoil: that panic ends the run anyway.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn into_inner<T>(mutex: Mutex<T>) -> T {
    mutex.into_inner().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::super::trace;
    use super::super::{Layout, OrderBins, Parameters, PhotonRange, Problem, Region, Side};
    use super::*;

    fn empty(reference_albedo: f64) -> WhiteTable {
        let bins = OrderBins::new(0.125).unwrap();
        let layout = Layout::with_order_bins(&[0.3, 1.0, 3.0], 3, bins).unwrap();
        WhiteTable::new(Problem::new(Parameters::default()).unwrap(), layout, reference_albedo).unwrap()
    }

    fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
    }

    #[test]
    fn runs_do_not_depend_on_threads_or_pieces() {
        let mut once = empty(0.99);
        assert_eq!(once.run(7, 60_000, &Control::default()).unwrap(), 60_000);
        for threads in [1, 2, 7] {
            let mut table = empty(0.99);
            on_threads(threads, || {
                for photons in [1, 999, 0, 30_000, 29_000] {
                    assert_eq!(table.run(7, photons, &Control::default()).unwrap(), photons);
                }
            });
            assert_eq!(table, once, "{threads} threads");
        }
        assert_eq!(once.photon_ranges(), [PhotonRange { seed: 7, start: 0, end: 60_000 }]);
        let exits = once.exits(Side::Reflected, Region::Everywhere);
        let at = once.at_albedo(0.99).unwrap();
        assert_eq!(at.absorbed().value, 1.0 - exits as f64 / 60_000.0);
    }

    #[test]
    fn ranges_add_up_to_a_run_and_never_count_twice() {
        let mut whole = empty(0.9);
        whole.run(3, 9000, &Control::default()).unwrap();
        let mut parts = empty(0.9);
        for (start, end) in [(5000, 9000), (0, 0), (0, 1), (1, 5000)] {
            let done = parts.run_range(PhotonRange { seed: 3, start, end }, &Control::default());
            assert_eq!(done.unwrap(), end - start);
        }
        assert_eq!(parts, whole);
        let error = parts.run_range(PhotonRange { seed: 3, start: 8999, end: 9001 }, &Control::default());
        assert_eq!(error.unwrap_err().to_string(), "photons 8999..9000 of seed 3 would count twice");
        assert_eq!(parts, whole);
    }

    #[test]
    fn rest_of_a_range_is_what_was_not_walked() {
        let mut whole = empty(0.9);
        whole.run_range(PhotonRange { seed: 3, start: 1000, end: 9000 }, &Control::default()).unwrap();
        let mut parts = empty(0.9);
        parts.run_range(PhotonRange { seed: 3, start: 2000, end: 2500 }, &Control::default()).unwrap();
        parts.run_range(PhotonRange { seed: 3, start: 8000, end: 9000 }, &Control::default()).unwrap();
        let range = PhotonRange { seed: 3, start: 1000, end: 9000 };
        assert_eq!(parts.run_rest(range, &Control::default()).unwrap(), 6500);
        assert_eq!(parts, whole);
        assert_eq!(parts.run_rest(range, &Control::default()).unwrap(), 0);
    }

    #[test]
    fn run_fills_gaps_first() {
        let mut part = empty(0.9);
        let (all, gap) = (0..5000, 1000..2000);
        let mut whole = empty(0.9);
        whole.run(1, all.end, &Control::default()).unwrap();
        // Hold the range's ends
        for range in [0..gap.start, gap.end..all.end] {
            let mut cells = vec![Cell::default(); part.all_cells().len()];
            let counts = trace(part.problem(), 0.9, 1, range.clone(), &mut |exits: &[PhotonExit]| {
                for exit in exits {
                    let cell = &mut cells[part.cell_index(exit) as usize];
                    cell.count += 1;
                    cell.order_sum += u64::from(exit.order);
                }
            });
            part.take_in(1, &[(range, counts)], vec![cells]).unwrap();
        }
        assert_eq!(part.photon_ranges().len(), 2);
        part.run(1, gap.end - gap.start, &Control::default()).unwrap();
        assert_eq!(part, whole);
    }

    /// Stopped at a moment that cannot be foreseen, a table holds what it says, and goes on from there.
    #[test]
    fn stopped_runs_go_on_where_they_were() {
        let mut whole = empty(0.99);
        whole.run(3, 400_000, &Control::default()).unwrap();
        let mut table = empty(0.99);
        let mut stops = 0;
        while table.photons() < 400_000 {
            let stop = AtomicBool::new(false);
            let limit = 20_000 + 7919 * stops;
            let progress = |done: u64| {
                if done > limit {
                    stop.store(true, Ordering::Relaxed);
                }
            };
            let before = table.photons();
            let control = Control { stop: &stop, progress: &progress, ..Control::default() };
            let done = on_threads(3, || table.run(3, 400_000 - before, &control)).unwrap();
            assert_eq!(table.photons(), before + done);
            let held: u64 = table.photon_ranges().iter().map(PhotonRange::len).sum();
            assert_eq!(held, table.photons());
            stops += 1;
        }
        assert!(stops > 2, "{stops}");
        assert_eq!(table, whole);
    }

    #[test]
    fn stop_and_deadline_come_soon() {
        for albedo in [0.9, 0.9999] {
            for by_deadline in [false, true] {
                let (stop, has_photons) = (AtomicBool::new(false), AtomicBool::new(false));
                let (start, wait) = (Instant::now(), Duration::from_millis(200));
                let mut table = empty(albedo);
                let deadline = by_deadline.then(|| start + wait);
                let asked = std::thread::scope(|scope| {
                    // A stop, unlike a deadline, does not wait for the first piece: a busy machine has not got it yet
                    let asked = scope.spawn(|| {
                        std::thread::sleep(wait);
                        while !by_deadline && !has_photons.load(Ordering::Relaxed) {
                            std::thread::yield_now();
                        }
                        stop.store(!by_deadline, Ordering::Relaxed);
                        Instant::now()
                    });
                    let progress = |done: u64| has_photons.store(done > 0, Ordering::Relaxed);
                    let control =
                        Control { stop: &stop, deadline, progress: &progress, ..Control::default() };
                    // On threads of its own: those of all tests may be busy until the deadline is over
                    let done = on_threads(2, || table.run(1, u64::MAX / 2, &control)).unwrap();
                    assert_eq!(done, table.photons());
                    asked.join().unwrap()
                });
                // A piece more, on a machine that may be busy.
                assert!(start.elapsed() >= wait);
                assert!(asked.elapsed() < Duration::from_secs(3), "{:?}", asked.elapsed());
                assert!(table.photons() > 0);
            }
        }
    }

    /// Whoever waits for a stop waits for the photons under way alone, not for a piece of work: asked for as a piece
    /// has just begun, it leaves most of the piece's photons where they are. Photons are counted, as a busy machine's
    /// time says nothing.
    #[test]
    fn stop_is_seen_within_a_piece() {
        for albedo in [0.5, 0.99, 0.99999] {
            // Share of a piece that is still walked
            let attempt = |seed| {
                let stop = &AtomicBool::new(false);
                let (has_ended, ends) = mpsc::channel();
                let done_at_ends = Mutex::new(vec![0]);
                let stop_within_a_piece = move || {
                    // Pieces have grown to their size by then
                    ends.iter().nth(7).unwrap();
                    std::thread::sleep(PIECE_TIME / 10);
                    stop.store(true, Ordering::Relaxed);
                };
                let progress = |done| {
                    lock(&done_at_ends).push(done);
                    has_ended.send(()).unwrap_or(());
                };
                let control = Control { stop, progress: &progress, ..Control::default() };
                let mut table = empty(albedo);
                std::thread::scope(|scope| {
                    scope.spawn(stop_within_a_piece);
                    on_threads(1, || table.run(seed, u64::MAX / 2, &control)).unwrap();
                });
                let done = into_inner(done_at_ends);
                let pieces: Vec<u64> = done.windows(2).map(|ends| ends[1] - ends[0]).collect();
                pieces[pieces.len() - 1] as f64 / pieces[7] as f64
            };
            // A machine that is busy at every attempt is not expected: a stop at the piece's end walks all of it at each
            let shares: Vec<_> = (0..20).map(attempt).take_while(|share| *share >= 0.5).collect();
            assert!(shares.len() < 20, "albedo {albedo}: {shares:?}");
        }
    }

    #[test]
    fn stopped_at_once_changes_nothing() {
        let stop = AtomicBool::new(true);
        let mut table = empty(0.9);
        assert_eq!(table.run(1, 1000, &Control { stop: &stop, ..Control::default() }).unwrap(), 0);
        assert_eq!(table, empty(0.9));
    }

    #[test]
    fn seeds_end() {
        let mut table = empty(0.5);
        assert!(matches!(
            table.run(1, u64::MAX, &Control { deadline: Some(Instant::now()), ..Control::default() }),
            Ok(0)
        ));
        table.run(1, 10, &Control::default()).unwrap();
        assert!(matches!(table.run(1, u64::MAX - 9, &Control::default()), Err(TableError::TooMany)));
        assert!(matches!(table.run(2, u64::MAX - 9, &Control::default()), Err(TableError::TooMany)));
        assert_eq!(table.photons(), 10);
    }
}
