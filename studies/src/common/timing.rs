//! Time of work on a machine that may have other work, too.
//!
//! A fixed piece of work, the *calibration*, is timed before and after each run. Both must take at most [`DRIFT`] longer than the calibration
//! takes on the quiet machine, which is the shortest that this process has seen; else the run is repeated. After [`MOST_TRIES`]
//! a time of which too few runs were quiet is marked as noisy.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::report::{Limit, on_threads};
use cpu_time::ThreadTime;

/// How much longer the calibration may take around a run.
const DRIFT: f64 = 0.05;

/// Quiet runs that make a time.
const RUNS: usize = 3;

/// Runs after which no quiet ones are waited for any more, once [`PATIENCE`] is at its end.
const MOST_TRIES: usize = 9;

/// Seconds in which quiet runs are waited for, however many runs that takes: other work on the machine comes and goes.
const PATIENCE: f64 = 8.0;

/// Pause between calibrations while the machine is busy.
const PAUSE: Duration = Duration::from_millis(5);

/// Seconds beyond which one quiet run has to do, and only [`RUNS`] are tried.
const LONG: f64 = 1.0;

/// What a report says of its times.
pub(crate) const HOW: &str = "Times are medians of three quiet runs, or one if it takes more than a second: fixed work before and after each takes no more \
    than 5 % longer than the fastest that the study has seen. ± is half of what they differ by; *noisy* times found too few quiet runs in eight seconds.";

/// Whether each time is that of one run, quiet or not, and each ratio that of one pair.
static IS_TRIAL: AtomicBool = AtomicBool::new(false);

/// From now on each time is that of one run: for trials, whose figures are nobody's.
pub(crate) fn take_one_run_each() {
    IS_TRIAL.store(true, Ordering::Relaxed);
}

/// What times are taken with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Clock {
    /// Processor time of this thread.
    Processor,
    /// Time that passes.
    Wall,
}

impl Clock {
    /// A function that says how many seconds this clock has run.
    fn start(self) -> impl Fn() -> f64 {
        let start = Instant::now();
        move || match self {
            Self::Processor => ThreadTime::now().as_duration().as_secs_f64(),
            Self::Wall => start.elapsed().as_secs_f64(),
        }
    }
}

/// A measured time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Timing {
    /// Median of the quiet runs, or of all if too few were quiet.
    pub(crate) seconds: f64,
    /// Largest less smallest of them, over the median; 0 of a single run.
    pub(crate) spread: f64,
    /// The calibration drifted around too many of the runs.
    pub(crate) noisy: bool,
}

impl Timing {
    /// A time that was measured once, or another number in its place.
    pub(crate) fn exactly(seconds: f64) -> Self {
        Self { seconds, ..Self::default() }
    }

    /// The same time in milliseconds.
    pub(crate) fn in_ms(self) -> Self {
        Self { seconds: 1e3 * self.seconds, ..self }
    }

    /// Of runs with the time of each, and whether it was quiet.
    fn of(runs: &[(f64, bool)], enough: usize) -> Self {
        let quiet = runs.iter().filter(|run| run.1).count();
        let noisy = quiet < enough;
        let mut seconds: Vec<f64> = runs.iter().filter(|run| noisy || run.1).map(|run| run.0).collect();
        seconds.sort_by(f64::total_cmp);
        let median = seconds[seconds.len() / 2];
        let spread = (seconds[seconds.len() - 1] - seconds[0]) / median;
        Self { seconds: median, spread: if spread.is_finite() { spread } else { 0.0 }, noisy }
    }
}

impl fmt::Display for Timing {
    /// `0.0123 ± 2 %`: half of the spread; `0.0123, noisy`. Four digits after the point unless told otherwise.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.*}", f.precision().unwrap_or(4), self.seconds)?;
        match self {
            Self { noisy: true, .. } => write!(f, ", noisy"),
            Self { spread, .. } if *spread > 0.0 => write!(f, " ± {:.0} %", 50.0 * spread),
            _ => Ok(()),
        }
    }
}

/// Time of some work in wall-clock seconds, and the result of its last run.
pub(crate) fn timed<T>(work: impl FnMut() -> T) -> (Timing, T) {
    timed_by(Clock::Wall, work)
}

/// [`timed`] by another clock.
pub(crate) fn timed_by<T>(clock: Clock, mut work: impl FnMut() -> T) -> (Timing, T) {
    let now = clock.start();
    timed_part(clock, || {
        let begin = now();
        let result = work();
        (now() - begin, result)
    })
}

/// [`timed_by`] of work of which only a part counts: it returns the seconds of that part, too.
pub(crate) fn timed_part<T>(clock: Clock, mut work: impl FnMut() -> (f64, T)) -> (Timing, T) {
    let start = Instant::now();
    let is_trial = IS_TRIAL.load(Ordering::Relaxed);
    let has_patience = || !is_trial && start.elapsed().as_secs_f64() < PATIENCE;
    let mut tries = Tries { runs: vec![], enough: RUNS };
    loop {
        let quiet_before = begins_quietly(clock, has_patience);
        let begin = start.elapsed();
        let (seconds, result) = work();
        let quiet = is_quiet(clock, calibration(clock)) && quiet_before;
        let long = (start.elapsed() - begin).as_secs_f64() > LONG;
        if tries.end_with((seconds, quiet), long, has_patience()) || is_trial {
            return (Timing::of(&tries.runs, tries.enough), result);
        }
    }
}

/// Waits until the calibration is quiet, as long as there is patience; whether it is.
fn begins_quietly(clock: Clock, has_patience: impl Fn() -> bool) -> bool {
    loop {
        let quiet = is_quiet(clock, calibration(clock));
        if quiet || !has_patience() {
            return quiet;
        }
        sleep(PAUSE);
    }
}

/// Runs of some work until enough are quiet.
struct Tries {
    /// Seconds of each, and whether it was quiet.
    runs: Vec<(f64, bool)>,
    /// How many quiet ones are.
    enough: usize,
}

impl Tries {
    /// Adds a run, which was `long` or not; whether it is the last, if there is `patience` for more or not.
    fn end_with(&mut self, run: (f64, bool), long: bool, patience: bool) -> bool {
        self.runs.push(run);
        if long {
            self.enough = 1;
        }
        let enough = self.runs.iter().filter(|run| run.1).count() >= self.enough;
        let most = if long { RUNS } else { MOST_TRIES };
        enough || (self.runs.len() >= most && (long || !patience))
    }
}

/// By what factor one work takes longer than another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ratio {
    /// Median over pairs of runs.
    pub(crate) value: f64,
    /// Half of the range that the middle half of the pairs lies in.
    pub(crate) spread: f64,
}

impl Ratio {
    /// What tables of goals say of a ratio that may be so large.
    pub(crate) fn at_most(self, bound: f64) -> &'static str {
        Limit::AtMost(bound).verdict(self.value, self.spread)
    }

    fn of(mut ratios: Vec<f64>) -> Self {
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| ratios[(share * (ratios.len() - 1) as f64).round() as usize];
        Self { value: at(0.5), spread: 0.5 * (at(0.75) - at(0.25)) }
    }
}

/// How much longer `work` takes than `other`: both in turns, so that what else the machine does meets both alike.
pub(crate) fn ratio(clock: Clock, mut work: impl FnMut(), mut other: impl FnMut()) -> Ratio {
    let now = clock.start();
    let seconds = |work: &mut dyn FnMut()| {
        let begin = now();
        work();
        now() - begin
    };
    ratio_of(|| seconds(&mut work), || seconds(&mut other))
}

/// [`ratio`] of work that says how long it took.
pub(crate) fn ratio_of(mut work: impl FnMut() -> f64, mut other: impl FnMut() -> f64) -> Ratio {
    /// Pairs of runs, an odd number; the first pair warms up and does not count.
    const PAIRS: usize = 15;
    let mut pair = |_| {
        let own = work();
        own / other()
    };
    if IS_TRIAL.load(Ordering::Relaxed) {
        return Ratio::of(vec![pair(0)]);
    }
    pair(0);
    Ratio::of((0..PAIRS).map(pair).collect())
}

/// Seconds of the fastest of several runs: at least `runs`, and more while they take no longer than `together` seconds.
pub(crate) fn least_seconds<E>(
    clock: Clock,
    runs: usize,
    together: f64,
    mut work: impl FnMut() -> Result<(), E>,
) -> Result<f64, E> {
    let start = Instant::now();
    let now = clock.start();
    let (mut least, mut done) = (f64::INFINITY, 0);
    while done < runs || start.elapsed().as_secs_f64() < together {
        let begin = now();
        work()?;
        least = least.min(now() - begin);
        done += 1;
    }
    Ok(least)
}

/// How much longer fixed work takes on so many threads at once than on one: 1 where each has a processor core of its own.
pub(crate) fn slowdown(threads: usize) -> Ratio {
    let on = |threads: usize| move || on_threads(threads, || calibration(Clock::Wall));
    let (many, one) = (on(threads), on(1));
    ratio_of(many, one)
}

/// Seconds that the calibration takes now; by the wall clock on all threads of the pool at once, the slowest of them.
fn calibration(clock: Clock) -> f64 {
    match clock {
        Clock::Processor => fixed_work(clock),
        Clock::Wall => rayon::broadcast(|_| fixed_work(clock)).into_iter().fold(0.0, f64::max),
    }
}

/// Seconds of sums of products over an array that fits the first-level cache: some milliseconds.
fn fixed_work(clock: Clock) -> f64 {
    const NUMBERS: usize = 2048;
    const ROUNDS: usize = 1500;
    let mut numbers: Vec<f64> = (0..NUMBERS).map(|i| 1.0 + i as f64 / NUMBERS as f64).collect();
    let now = clock.start();
    let begin = now();
    for _ in 0..ROUNDS {
        for pair in numbers.chunks_exact_mut(2) {
            pair[0] = 0.5 * pair[0] + 0.25 * pair[1] + 0.125;
        }
        std::hint::black_box(&mut numbers);
    }
    now() - begin
}

/// Shortest calibration that was seen, by clock and number of threads.
static QUIETEST: Mutex<BTreeMap<(Clock, usize), f64>> = Mutex::new(BTreeMap::new());

/// Whether a calibration of these seconds is as fast as on the quiet machine, as far as this process has seen it.
fn is_quiet(clock: Clock, seconds: f64) -> bool {
    let threads = rayon::current_num_threads();
    let mut quietest = QUIETEST.lock().expect("no panic while it is held");
    // What a machine can do is not known from two calibrations.
    let several = || (0..20).map(|_| calibration(clock)).fold(f64::INFINITY, f64::min);
    let least = quietest.entry((clock, threads)).or_insert_with(several);
    *least = least.min(seconds);
    seconds <= *least * (1.0 + DRIFT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noisy_runs_do_not_count_where_enough_are_quiet() {
        let runs = [(1.0, true), (9.0, false), (1.2, true), (1.1, true)];
        let timing = Timing::of(&runs, 3);
        assert_eq!((timing.seconds, timing.noisy), (1.1, false));
        assert!((timing.spread - 0.2 / 1.1).abs() < 1e-15);
        assert_eq!(timing.to_string(), "1.1000 ± 9 %");
        assert!(Timing::of(&runs[..3], 3).noisy);
        assert_eq!(Timing::of(&runs[..3], 3).to_string(), "1.2000, noisy");
    }

    #[test]
    fn a_ratio_near_its_bound_is_undecided() {
        let ratio = Ratio::of(vec![1.0, 5.0, 1.02, 1.04, 0.98]);
        assert_eq!(ratio.value, 1.02);
        assert!((ratio.spread - 0.02).abs() < 1e-12);
        assert_eq!(
            [1.0, 1.03, 1.05].map(|bound| ratio.at_most(bound)),
            ["undecided", "undecided", "reached"]
        );
        assert_eq!(ratio.at_most(0.9), "**missed**");
    }

    /// Of runs of which these are quiet and these long, how many are made with patience for some.
    fn made_with(patience: usize, quiet: impl Fn(usize) -> bool, long: impl Fn(usize) -> bool) -> usize {
        let mut tries = Tries { runs: vec![], enough: RUNS };
        1 + (0..).position(|i| tries.end_with((1.0, quiet(i)), long(i), i < patience)).expect("they end")
    }

    /// [`made_with`] none.
    fn made(quiet: impl Fn(usize) -> bool, long: impl Fn(usize) -> bool) -> usize {
        made_with(0, quiet, long)
    }

    #[test]
    fn quiet_runs_are_waited_for_with_patience() {
        assert_eq!(made_with(40, |i| i % 10 == 9, |_| false), 30);
        assert_eq!(made_with(40, |_| false, |_| false), 41);
        assert_eq!(made_with(40, |_| false, |_| true), RUNS);
    }

    #[test]
    fn runs_are_bounded_on_any_machine() {
        assert_eq!(made(|_| true, |_| false), RUNS);
        assert_eq!(made(|_| false, |_| false), MOST_TRIES);
        assert_eq!(made(|i| i % 2 == 1, |_| false), 2 * RUNS);
        assert_eq!(made(|_| true, |_| true), 1);
        assert_eq!(made(|_| false, |_| true), RUNS);
        // A run that the machine held up counts as long.
        assert_eq!(made(|i| i == 0, |i| i == 1), 2);
    }

    #[test]
    fn the_result_is_that_of_the_last_run() {
        let mut count = 0;
        let (timing, last) = timed_by(Clock::Processor, || {
            count += 1;
            count
        });
        assert_eq!(last, count);
        assert!(count <= MOST_TRIES, "{count} runs");
        assert!(timing.seconds >= 0.0);
    }
}
