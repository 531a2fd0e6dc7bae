//! Tables, charts and the machine they were made on.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::kept::{lacks_something, with_former};
use super::timing::Timing;

/// What a study tells its caller: whether everything was as it must be.
pub(crate) type Outcome = Result<bool, Box<dyn std::error::Error + Send + Sync>>;

/// Where trials write: their figures are not results.
pub(crate) fn trial_folder() -> PathBuf {
    let folder = std::env::temp_dir().join("pointillist-studies");
    eprintln!("a trial; its tables go to {}", folder.display());
    folder
}

/// One measurement of a study of time against error.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) scene: String,
    /// Rows of one series are joined in the chart.
    pub(crate) series: String,
    pub(crate) setting: String,
    pub(crate) time: Timing,
    pub(crate) rmse: f64,
    pub(crate) largest: f64,
    /// Further columns, as the study names them.
    pub(crate) more: Vec<String>,
}

/// What a figure must not pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    AtMost(f64),
    AtLeast(f64),
}

impl Limit {
    pub(crate) fn is_kept_by(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
        }
    }

    /// What tables of goals say: a value that is nearer to its limit than its spread says nothing.
    pub(crate) fn verdict(self, value: f64, spread: f64) -> &'static str {
        let (Self::AtMost(limit) | Self::AtLeast(limit)) = self;
        if (value - limit).abs() <= spread { "undecided" } else { verdict(self.is_kept_by(value)) }
    }

    /// The one of two values that is farther on the wrong side.
    pub(crate) fn worse(self, a: f64, b: f64) -> f64 {
        match self {
            Self::AtMost(_) => a.max(b),
            Self::AtLeast(_) => a.min(b),
        }
    }
}

impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::AtMost(limit) => write!(f, "≤ {limit}"),
            Self::AtLeast(limit) => write!(f, "≥ {limit}"),
        }
    }
}

/// What tables of goals say.
pub(crate) fn verdict(reached: bool) -> &'static str {
    if reached { "reached" } else { "**missed**" }
}

/// Each name once, in the order in which they first occur.
pub(crate) fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    names.fold(vec![], |mut list, name| {
        if !list.contains(&name) {
            list.push(name);
        }
        list
    })
}

/// Runs on one thread, so that seconds are processor seconds.
pub(crate) fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    on_threads(1, work)
}

pub(crate) fn on_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    pool.expect("threads can be started").install(work)
}

/// Writes `NAME.csv`; `more` names the further columns.
pub(crate) fn write_csv(out_dir: &Path, name: &str, more: &[&str], rows: &[Row]) -> std::io::Result<()> {
    let mut text = "scene,series,setting,seconds,spread,noisy,rmse,largest_error".to_owned();
    more.iter().for_each(|column| text += &format!(",{column}"));
    text.push('\n');
    for r in rows {
        let _ = write!(
            text,
            "{},{},{},{:.6},{:.3},{},{:e},{:e}",
            r.scene, r.series, r.setting, r.time.seconds, r.time.spread, r.time.noisy, r.rmse, r.largest
        );
        r.more.iter().for_each(|value| text += &format!(",{value}"));
        text.push('\n');
    }
    write(out_dir, &format!("{name}.csv"), &text)
}

/// The rows as a Markdown table.
pub(crate) fn table(more: &[&str], rows: &[Row]) -> String {
    let mut text = "| scene | method | setting | seconds | RMSE | largest error |".to_owned();
    more.iter().for_each(|column| text += &format!(" {column} |"));
    text += "\n| --- | --- | --- | ---: | ---: | ---: |";
    more.iter().for_each(|_| text += " ---: |");
    text.push('\n');
    for r in rows {
        let _ = write!(
            text,
            "| {} | {} | {} | {} | {:.2e} | {:.1e} |",
            r.scene, r.series, r.setting, r.time, r.rmse, r.largest
        );
        r.more.iter().for_each(|value| text += &format!(" {value} |"));
        text.push('\n');
    }
    text
}

/// Writes a file of results. Sections that lack the large data or a peer keep what they said before.
pub(crate) fn write(out_dir: &Path, file: &str, text: &str) -> std::io::Result<()> {
    std::fs::create_dir_all(out_dir)?;
    let path = out_dir.join(file);
    if !lacks_something(text) {
        return std::fs::write(path, text);
    }
    let former = std::fs::read_to_string(&path).unwrap_or_default();
    std::fs::write(path, with_former(text, &former))
}

/// Rows in the order in which their scenes first occur.
pub(crate) fn scenes(rows: &[Row]) -> Vec<&str> {
    distinct(rows.iter().map(|r| r.scene.as_str()))
}

/// Errors below this count as this much: a logarithmic axis has no zero.
pub(crate) const SMALLEST: f64 = 1e-9;

/// By what factor a series is faster than another at the same error, by log-log interpolation of `other`.
///
/// `None` where `other` never gets as good as the row: then it is slower than its slowest row by an unknown factor.
pub(crate) fn time_ratio(row: &Row, other: &[&Row]) -> Option<f64> {
    let mut points: Vec<(f64, f64)> = other.iter().map(|r| (r.rmse.max(SMALLEST), r.time.seconds)).collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let reached = points.windows(2).find(|w| w[0].0 >= row.rmse && row.rmse >= w[1].0)?;
    let [(e0, t0), (e1, t1)] = [reached[0], reached[1]];
    let s = if e0 > e1 { (row.rmse.ln() - e0.ln()) / (e1.ln() - e0.ln()) } else { 1.0 };
    Some((t0.ln() + s * (t1.ln() - t0.ln())).exp() / row.time.seconds)
}
