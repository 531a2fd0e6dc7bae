//! `stress`: input at the limits of numbers, and beyond. Every row runs in a process of its own, so that a
//! panic is a row of the table and not its end.

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::provenance::provenance;
use crate::common::report::{Outcome, write};
use crate::stress::check::Verdict;
use crate::stress::rows;

/// Seconds after which a row has failed.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs every row and writes `stress.md` and `stress.csv`; `false` if one failed.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let checks = rows::all();
    let mut verdicts = vec![];
    for (i, check) in checks.iter().enumerate() {
        let verdict = in_child(i)?;
        if !verdict.passed {
            eprintln!("stress: {}: {}", check.input, verdict.happened);
        }
        verdicts.push(verdict);
    }
    let failed = verdicts.iter().filter(|v| !v.passed).count();
    let mut text = format!(
        "# Stress\n\n`cargo run --release -p studies -- stress` made this ({}). Each row ran in a process of its own. \
         {} of {} rows passed. Two errors are called the same if they differ by 5 % or by less than 3e-8, which is what \
         the pictures' `f32` resolves.\n\n| input | expected | what happened | |\n| --- | --- | --- | --- |\n",
        provenance(),
        checks.len() - failed,
        checks.len()
    );
    let mut csv = "input,expected,happened,passed\n".to_owned();
    for (c, v) in checks.iter().zip(&verdicts) {
        let cell = |s: &str| s.replace('|', "\\|");
        let mark = if v.passed { "pass" } else { "**fail**" };
        let _ = writeln!(text, "| {} | {} | {} | {mark} |", cell(&c.input), c.expected, cell(&v.happened));
        let field = |s: &str| format!("\"{}\"", s.replace('"', "\"\""));
        let _ =
            writeln!(csv, "{},{},{},{}", field(&c.input), field(c.expected), field(&v.happened), v.passed);
    }
    write(out_dir, "stress.md", &text)?;
    write(out_dir, "stress.csv", &csv)?;
    Ok(failed == 0)
}

fn in_child(row: usize) -> std::io::Result<Verdict> {
    let mut child = Command::new(std::env::current_exe()?)
        .args(["stress", &row.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let start = Instant::now();
    while child.try_wait()?.is_none() {
        if start.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Ok(Verdict {
                happened: format!("did not end in {} s", PATIENCE.as_secs()),
                passed: false,
            });
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    match text.trim().split_once('\t') {
        Some((mark, happened)) => Ok(Verdict { happened: happened.to_owned(), passed: mark == "pass" }),
        None => {
            let errors = String::from_utf8_lossy(&output.stderr);
            let message =
                errors.lines().filter(|l| !l.is_empty() && !l.starts_with("note:")).collect::<Vec<_>>();
            Ok(Verdict { happened: format!("panicked: {}", message.join(" ")), passed: false })
        }
    }
}

/// Runs one row in this process and prints its verdict.
pub(crate) fn run_row(row: usize) -> bool {
    let Some(check) = rows::all().into_iter().nth(row) else { return false };
    let verdict = (check.run)();
    let mark = if verdict.passed { "pass" } else { "fail" };
    println!("{mark}\t{}", verdict.happened.replace(['\n', '\t'], " "));
    true
}
