//! Parts that the benches share: the tree they grow, the times they take, the tables they print.
#![allow(dead_code, reason = "no bench uses all of it")]

use criterion::{Bencher, BenchmarkGroup, Criterion, SamplingMode, measurement::WallTime};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use treesynth::guided::TreeSynth;
use treesynth::{Observer, Progress, Work, presets};

/// Five stages and up to 1 + 130 + 700 + 2200 + 3500 = 6531 endpoints.
pub(crate) const PRESET: &str = "figure-18";
/// The seed of every tree and graph.
pub(crate) const SEED: u64 = 1;

/// The tree of [`PRESET`] on a graph of about so many nodes.
pub(crate) fn tree(nodes: usize) -> TreeSynth {
    presets::by_name(PRESET).expect("a preset of this name").guided().unwrap().synth(nodes)
}

/// `true` if all benches are only to be run once, to see that they work: `cargo bench -- --test`.
pub(crate) fn is_test() -> bool {
    std::env::args().any(|argument| argument == "--test")
}

/// `full`, or `small` where the bench is only tested.
pub(crate) fn size(full: usize, small: usize) -> usize {
    if is_test() { small } else { full }
}

/// Keeps the feature `parallel`, if it is on, to one thread: all figures are single-threaded.
pub(crate) fn single_thread() {
    #[cfg(feature = "parallel")]
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool has been built before");
}

/// Criterion as the command line wants it, without pictures.
pub(crate) fn criterion() -> Criterion {
    Criterion::default().without_plots().configure_from_args()
}

/// A group of long benches: 10 samples of equal size. Runs longer than a fifth of a second are samples by
/// themselves; criterion then warns that they take more than the two seconds set here, as they should.
pub(crate) fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .sampling_mode(SamplingMode::Flat)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    group
}

/// Milliseconds taken, by name.
#[derive(Default)]
pub(crate) struct Samples(BTreeMap<String, Vec<f64>>);

impl Samples {
    fn add(&mut self, name: String, time: Duration) {
        self.0.entry(name).or_default().push(time.as_secs_f64() * 1e3);
    }

    /// The median, if `name` was measured; the command line may have left it out.
    pub(crate) fn median(&self, name: &str) -> Option<f64> {
        let mut times = self.0.get(name)?.clone();
        times.sort_by(f64::total_cmp);
        let half = times.len() / 2;
        Some(if times.len() % 2 == 1 { times[half] } else { f64::midpoint(times[half - 1], times[half]) })
    }

    /// Has criterion measure `work`. Dropping what it returns takes no part.
    pub(crate) fn time<T>(&mut self, bencher: &mut Bencher<'_>, name: &str, mut work: impl FnMut() -> T) {
        self.steps(bencher, name, |_| work());
    }

    /// Measures `work` three times without criterion, whose ten samples of several seconds would take minutes. A name
    /// that the command line filters out is left out here too.
    pub(crate) fn thrice<T>(&mut self, name: &str, work: impl FnMut() -> T) {
        self.repeat(3, name, work);
    }

    /// As [`thrice`](Self::thrice), so many times.
    pub(crate) fn repeat<T>(&mut self, times: usize, name: &str, mut work: impl FnMut() -> T) {
        let filter = std::env::args().skip(1).rfind(|argument| !argument.starts_with('-'));
        if filter.is_some_and(|filter| !name.contains(&filter)) {
            return;
        }
        for _ in 0..if is_test() { 1 } else { times } {
            let start = Instant::now();
            let result = black_box(work());
            let time = start.elapsed();
            drop(result);
            println!("{name}: {:.3} s", time.as_secs_f64());
            self.add(name.to_owned(), time);
        }
    }

    /// As [`time`](Self::time), and splits each run into the steps that it reports: `name/step`. `name/graph` and
    /// `name/stages` are sums over steps of the same run.
    pub(crate) fn steps<T>(
        &mut self,
        bencher: &mut Bencher<'_>,
        name: &str,
        mut work: impl FnMut(&Clock) -> T,
    ) {
        bencher.iter_custom(|runs| {
            let mut total = Duration::ZERO;
            for _ in 0..runs {
                let clock = Clock::start();
                let result = black_box(work(&clock));
                let (whole, steps) = clock.stop();
                drop(result);
                total += whole;
                self.add(name.to_owned(), whole);
                let mut sums: BTreeMap<&str, Duration> = BTreeMap::new();
                for (step, time) in steps {
                    let sum = if matches!(step, Work::Stage { .. }) { "stages" } else { "graph" };
                    if !matches!(step, Work::Radii) {
                        *sums.entry(sum).or_default() += time;
                    }
                    self.add(format!("{name}/{}", label(step)), time);
                }
                for (sum, time) in sums {
                    self.add(format!("{name}/{sum}"), time);
                }
            }
            total
        });
    }
}

/// Name of a step in the tables.
pub(crate) fn label(step: Work) -> String {
    match step {
        Work::Nodes => "nodes".to_owned(),
        Work::Edges => "edges".to_owned(),
        Work::Stage { index, .. } => format!("stage {}", index + 1),
        Work::Radii => "radii".to_owned(),
        other => format!("{other:?}"),
    }
}

/// An observer that notes when each step ends. What lies between two steps counts to the later one: choosing
/// endpoints, and joining the paths of the stage before, to a stage; the bare skeleton to the radii.
pub(crate) struct Clock {
    start: Instant,
    steps: Mutex<(Instant, Vec<(Work, Duration)>)>,
}

impl Clock {
    fn start() -> Self {
        let start = Instant::now();
        Self { start, steps: Mutex::new((start, Vec::new())) }
    }

    fn stop(self) -> (Duration, Vec<(Work, Duration)>) {
        (self.start.elapsed(), self.steps.into_inner().unwrap_or_else(PoisonError::into_inner).1)
    }
}

impl Observer for Clock {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        if progress.fraction >= 1.0 {
            let mut steps = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
            let now = Instant::now();
            let time = now - steps.0;
            steps.0 = now;
            steps.1.push((progress.work, time));
        }
        ControlFlow::Continue(())
    }
}

/// Prints a table in Markdown, the first column to the left and the others to the right.
pub(crate) fn print_table(title: &str, head: &[&str], rows: &[Vec<String>]) {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([head[column].chars().count()]).max().unwrap_or_default()
    };
    let line = |cells: Vec<&str>| {
        let cells: Vec<String> = cells
            .iter()
            .enumerate()
            .map(|(column, cell)| match width(column) {
                width if column == 0 => format!("{cell:<width$}"),
                width => format!("{cell:>width$}"),
            })
            .collect();
        println!("| {} |", cells.join(" | "));
    };
    println!("\n{title}\n");
    line(head.to_vec());
    let rules: Vec<String> = (0..head.len())
        .map(|column| {
            let dashes = "-".repeat(width(column).max(3) - 1);
            if column == 0 { format!("{dashes}-") } else { format!("{dashes}:") }
        })
        .collect();
    line(rules.iter().map(String::as_str).collect());
    for row in rows {
        line(row.iter().map(String::as_str).collect());
    }
    println!();
}

/// A number with about three digits that count.
pub(crate) fn number(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    }
}

/// A count with its thousands apart.
pub(crate) fn count(value: usize) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
