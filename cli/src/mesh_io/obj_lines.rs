//! OBJ lines, checked and made plain where they are not, on their way to the parser.
//!
//! `tobj` stops without saying where, takes no comments after a face, no continued lines and no tabs, makes up
//! coordinates that a face lacks, and forgets the name of a material that it has no definition of. So it reads
//! through [`ObjLines`], which passes on vertices and faces, puts a group in front of every run of faces with the
//! same material and the same kinds of index, and remembers the line. Runs of lines that [`plain_line`] knows are
//! passed on as they are, without a copy; every other line is taken apart and written anew.

use super::obj_index::{Kinds, Range};
use super::obj_plain::{PlainLine, plain_line};
use std::io::{self, BufRead, Read};

/// What is wrong with a line, numbered from 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LineFault {
    pub(super) line: usize,
    pub(super) message: String,
    pub(super) help: &'static str,
}

/// A run of plain lines ends after this many bytes, so that the parser finds them in the cache.
const LONGEST_RUN: usize = 1 << 14;

/// Reads like a file with only `v`, `vt`, `vn`, `f` and `g` lines.
pub(super) struct ObjLines<'a> {
    rest: &'a [u8],
    line: usize,
    next_line: usize,
    /// Lines written anew, which come before `run`, and how much of them has been read.
    out: Vec<u8>,
    given: usize,
    /// What has not been read of a run of plain lines.
    run: &'a [u8],
    takes_runs: bool,
    group: Option<(Kinds, u32)>,
    material: u32,
    ranges: [Range; 3],
    pub(super) fault: Option<LineFault>,
    pub(super) material_names: Vec<String>,
    pub(super) material_files: Vec<String>,
}

const NO_NAME: &str = "";

impl<'a> ObjLines<'a> {
    /// Passes plain lines on as they are: [`ObjLines::line`] is then up to a run ahead of the parser.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { takes_runs: true, ..Self::one_by_one(bytes) }
    }

    /// Takes every line apart: slower, but the line of an error is known.
    pub(super) fn one_by_one(bytes: &'a [u8]) -> Self {
        Self {
            // Some editors put a byte-order mark in front, which is not part of the first keyword.
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            line: 0,
            next_line: 1,
            out: Vec::new(),
            given: 0,
            run: &[],
            takes_runs: false,
            group: None,
            material: 0,
            ranges: [Range::default(); 3],
            fault: None,
            material_names: vec![NO_NAME.to_owned()],
            material_files: Vec::new(),
        }
    }

    /// The line that was passed on last.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// What a group's name says: kinds of index and material.
    pub(super) fn decode(group: &str) -> Option<(Kinds, u32)> {
        let (kinds, material) = group.split_once(' ')?;
        let kinds = Kinds { uv: kinds.contains('t'), normal: kinds.contains('n') };
        Some((kinds, material.parse().ok()?))
    }

    /// Takes plain lines into `run`, as long as they need no other group than the first of them.
    fn take_run(&mut self) {
        let bytes = self.rest;
        let mut taken = 0;
        while taken < bytes.len().min(LONGEST_RUN) {
            let Some((line, length)) = plain_line(&bytes[taken..], &mut self.ranges, self.next_line) else {
                break;
            };
            match line {
                PlainLine::Element(kind) => self.ranges[kind].count += 1,
                PlainLine::Face(kinds) if self.group != Some((kinds, self.material)) => {
                    if taken > 0 {
                        break;
                    }
                    let group = self.open_group(kinds);
                    self.out.extend_from_slice(group.as_bytes());
                }
                PlainLine::Face(_) => {}
            }
            self.line = self.next_line;
            self.next_line += 1;
            taken += length;
        }
        (self.run, self.rest) = bytes.split_at(taken);
    }

    /// The line, with those it continues on, without comment; `None` at the end.
    fn logical_line(&mut self) -> Result<Option<String>, LineFault> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        self.line = self.next_line;
        let mut line = String::new();
        loop {
            let end = self.rest.iter().position(|&b| b == b'\n');
            let (physical, rest) = match end {
                Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
                None => (self.rest, &self.rest[self.rest.len()..]),
            };
            self.rest = rest;
            self.next_line += 1;
            // A comment in Latin-1 is no reason to refuse the mesh.
            let statement = physical.split(|&b| b == b'#').next().unwrap_or_default();
            let text = std::str::from_utf8(statement).map_err(|_| LineFault {
                line: self.next_line - 1,
                message: "bytes that are not UTF-8 text".to_owned(),
                help: "save the file as UTF-8; is it an OBJ file?",
            })?;
            let text = text.trim_end();
            match text.strip_suffix('\\') {
                Some(start) if !rest.is_empty() => line.extend([start, " "]),
                _ => {
                    line.push_str(text);
                    return Ok(Some(line));
                }
            }
        }
    }

    /// Fills `out` with what the next line comes to, perhaps nothing.
    fn convert(&mut self, line: &str) -> Result<(), LineFault> {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => self.numbers("v", words, 3, 8),
            Some("vt") => self.numbers("vt", words, 1, 3),
            Some("vn") => self.numbers("vn", words, 3, 3),
            Some("f" | "fo") => self.face(words),
            Some("usemtl") => {
                self.material = self.material_number(line.trim_start()["usemtl".len()..].trim());
                Ok(())
            }
            Some("mtllib") => {
                let name = line.trim_start()["mtllib".len()..].trim();
                self.material_files.push(name.to_owned());
                Ok(())
            }
            // Groups, smoothing, curves, points, lines: not part of the surface.
            Some(
                "o" | "g" | "s" | "l" | "p" | "vp" | "mg" | "lod" | "bevel" | "c_interp" | "d_interp"
                | "usemap" | "maplib" | "shadow_obj" | "trace_obj" | "ctech" | "stech" | "cstype" | "deg"
                | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim" | "hole" | "scrv" | "sp"
                | "end" | "con" | "call" | "csh",
            )
            | None => Ok(()),
            Some(other) => Err(self.fault(
                format!("`{}` is not an OBJ keyword", other.chars().take(30).collect::<String>()),
                "lines start with v, vt, vn, f, usemtl, mtllib, o, g, s or #",
            )),
        }
    }

    fn fault(&self, message: String, help: &'static str) -> LineFault {
        LineFault { line: self.line, message, help }
    }

    /// Passes on the numbers of a vertex, the texture coordinate always as two.
    fn numbers<'w>(
        &mut self,
        keyword: &str,
        words: impl Iterator<Item = &'w str>,
        least: usize,
        most: usize,
    ) -> Result<(), LineFault> {
        let kept = if keyword == "vt" { 2 } else { 3 };
        self.out.extend_from_slice(keyword.as_bytes());
        let mut found = 0;
        for word in words {
            // The parser reads those we keep; one that we drop is looked at here.
            let bad = found >= kept && word.parse::<f64>().is_err();
            if bad || found == most {
                return Err(self.fault(format!("`{keyword}` cannot end in `{word}`"), number_help(keyword)));
            }
            if found < kept {
                self.out.push(b' ');
                self.out.extend_from_slice(word.as_bytes());
            }
            found += 1;
        }
        if found < least {
            return Err(self.fault(format!("`{keyword}` with {found} numbers"), number_help(keyword)));
        }
        // `vt u` alone is allowed; v is then 0.
        (found..kept).for_each(|_| self.out.extend_from_slice(b" 0"));
        self.out.push(b'\n');
        let kind = usize::from(keyword == "vt") + 2 * usize::from(keyword == "vn");
        self.ranges[kind].count += 1;
        Ok(())
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<(), LineFault> {
        let start = self.out.len();
        let before = self.ranges;
        let mut kinds = Kinds::ALL;
        let mut corners = 0;
        self.out.push(b'f');
        for word in words {
            kinds = kinds.and(self.corner(word)?);
            corners += 1;
        }
        self.out.push(b'\n');
        if corners < 3 {
            return Err(
                self.fault(format!("a face with {corners} corners"), "a face needs 3 or more, as in f 1 2 3")
            );
        }
        if self.group != Some((kinds, self.material)) {
            // The parser ends the group before, and looks up what its faces ask for.
            check_ranges(&before, "before faces of another kind or material there are")?;
            let group = self.open_group(kinds);
            self.out.splice(start..start, group.into_bytes());
        }
        Ok(())
    }

    /// The line before faces with other kinds of index, or another material, than those before them.
    fn open_group(&mut self, kinds: Kinds) -> String {
        self.group = Some((kinds, self.material));
        let uv = if kinds.uv { "t" } else { "" };
        let normal = if kinds.normal { "n" } else { "" };
        format!("g -{uv}{normal} {}\n", self.material)
    }

    /// Checks `v`, `v/vt`, `v//vn` or `v/vt/vn` and passes it on with indices from 1.
    fn corner(&mut self, word: &str) -> Result<Kinds, LineFault> {
        const HELP: &str =
            "corners are v, v/vt, v//vn or v/vt/vn, counted from 1, or from the end with a minus";
        let mut present = [false; 3];
        self.out.push(b' ');
        for (kind, part) in word.split('/').enumerate() {
            if kind == 3 || (kind == 0 && part.is_empty()) {
                return Err(self.fault(format!("`{word}` is no corner of a face"), HELP));
            }
            if kind > 0 {
                self.out.push(b'/');
            }
            if part.is_empty() {
                continue;
            }
            let Ok(number) = part.parse::<i32>() else {
                return Err(self.fault(format!("`{word}` is no corner of a face"), HELP));
            };
            let range = &mut self.ranges[kind];
            let Some(index) = range.index(number, self.line) else {
                let name = ["vertex", "texture coordinate", "normal"][kind];
                let message = format!("{name} {number} in `{word}`, but {} are defined so far", range.count);
                return Err(self.fault(message, HELP));
            };
            self.out.extend_from_slice(index.to_string().as_bytes());
            present[kind] = true;
        }
        Ok(Kinds { uv: present[1], normal: present[2] })
    }

    fn material_number(&mut self, name: &str) -> u32 {
        // From the back: files return to recent names.
        let known = self.material_names.iter().rposition(|known| known == name);
        let index = known.unwrap_or_else(|| {
            self.material_names.push(name.to_owned());
            self.material_names.len() - 1
        });
        index as u32
    }
}

/// An index of a face beyond what is defined by now; `so_far` introduces how many that are.
fn check_ranges(ranges: &[Range; 3], so_far: &str) -> Result<(), LineFault> {
    for (range, name) in ranges.iter().zip(["vertices", "texture coordinates", "normals"]) {
        if range.largest > range.count {
            return Err(LineFault {
                line: range.line_of_largest,
                message: format!("index {} of {name}, but {so_far} {}", range.largest, range.count),
                help: "indices count from 1, and what faces use comes before them",
            });
        }
    }
    Ok(())
}

fn number_help(keyword: &str) -> &'static str {
    match keyword {
        "v" => "a vertex is v x y z, perhaps with a weight or a colour",
        "vt" => "a texture coordinate is vt u v",
        _ => "a normal is vn x y z",
    }
}

impl BufRead for ObjLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.given == self.out.len() && self.run.is_empty() {
            self.out.clear();
            self.given = 0;
            if self.takes_runs {
                self.take_run();
                if !self.run.is_empty() {
                    break;
                }
            }
            let result = match self.logical_line() {
                Err(fault) => Err(fault),
                Ok(Some(line)) => self.convert(&line),
                Ok(None) => {
                    check_ranges(&self.ranges, "the file has").map_err(|fault| self.stop(fault))?;
                    break;
                }
            };
            result.map_err(|fault| self.stop(fault))?;
        }
        Ok(if self.given < self.out.len() { &self.out[self.given..] } else { self.run })
    }

    fn consume(&mut self, amount: usize) {
        if self.given < self.out.len() {
            self.given += amount;
        } else {
            self.run = &self.run[amount..];
        }
    }
}

impl ObjLines<'_> {
    fn stop(&mut self, fault: LineFault) -> io::Error {
        self.fault = Some(fault);
        io::Error::from(io::ErrorKind::InvalidData)
    }
}

impl Read for ObjLines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let count = available.len().min(buffer.len());
        buffer[..count].copy_from_slice(&available[..count]);
        self.consume(count);
        Ok(count)
    }
}
