//! A map's line of an MTL: options, then a file.

use super::mtl_keys::{OPTIONS, Words};
use super::names::unquoted;
use glam::DVec2;
use pointillist_render::Channel;

/// A texture as a line names it.
#[derive(Clone, Debug, PartialEq)]
pub struct MtlMap {
    /// `map_Kd`, `map_d`, … with `map_Bump` and `bump` both as `map_bump`.
    pub keyword: &'static str,
    /// The file, after the options.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// `-clamp on`.
    pub clamp: bool,
    /// `-bm`: the factor on a bump map's heights.
    pub bump_multiplier: Option<f32>,
    /// `-type`: what kind of reflection map it is, or which face of a cube.
    pub kind: Option<String>,
    /// `-s`: the factor on texture coordinates.
    pub scale: DVec2,
    /// `-o`: what is added to them then.
    pub offset: DVec2,
    /// `-mm`: what is added to values, and what they are multiplied by before.
    pub base_and_gain: [f32; 2],
    /// `-imfchan r|g|b`: what stands for a number.
    pub channel: Channel,
    /// Options that stand for something we do not draw, as they are written.
    pub ignored: Vec<String>,
}

impl MtlMap {
    /// Reads what follows a keyword on its line.
    ///
    /// # Errors
    ///
    /// An option whose value makes no sense, as a message.
    pub(super) fn read(keyword: &'static str, text: &str, line: usize) -> Result<Self, String> {
        let mut map = Self {
            keyword,
            file: String::new(),
            line,
            clamp: false,
            bump_multiplier: None,
            kind: None,
            scale: DVec2::ONE,
            offset: DVec2::ZERO,
            base_and_gain: [0.0, 1.0],
            channel: Channel::Mean,
            ignored: Vec::new(),
        };
        let mut rest = text.trim();
        while let Some((option, words, after)) = next_option(rest) {
            map.set(option, &words)?;
            rest = after;
        }
        map.file = unquoted(rest).to_owned();
        Ok(map)
    }

    fn set(&mut self, option: &str, words: &[&str]) -> Result<(), String> {
        let keyword = self.keyword;
        let number = |word: &str| {
            let number = word.parse::<f32>().ok().filter(|n| n.is_finite());
            number.ok_or_else(|| format!("`{keyword} {option} {word}`: not a number"))
        };
        let numbers = || words.iter().map(|word| number(word)).collect::<Result<Vec<f32>, String>>();
        let word = words.first().copied().unwrap_or_default();
        match option {
            "-bm" => self.bump_multiplier = Some(number(word)?),
            "-type" => self.kind = Some(word.to_owned()),
            "-clamp" => self.clamp = word == "on",
            "-s" => self.scale = two(&numbers()?, 1.0),
            "-o" => self.offset = two(&numbers()?, 0.0),
            "-mm" => {
                let numbers = numbers()?;
                let [base, gain] = numbers[..] else {
                    return Err(format!("`{keyword} -mm` needs a base and a gain, such as -mm 0 1"));
                };
                self.base_and_gain = [base, gain];
            }
            "-imfchan" => self.set_channel(word),
            // What they say is so anyway, or about how a map is filtered: here, exactly.
            "-blendu" | "-blendv" if word == "on" => {}
            "-cc" if word == "off" => {}
            _ => self.ignored.push(format!("{keyword} {option}")),
        }
        Ok(())
    }

    fn set_channel(&mut self, word: &str) {
        self.channel = match word {
            "r" => Channel::Red,
            "g" => Channel::Green,
            "b" => Channel::Blue,
            // The mean, and for opacity alpha if the picture has one: that is how they are read anyway.
            "l" => Channel::Mean,
            "m" if self.keyword == "map_d" => Channel::Mean,
            _ => {
                self.ignored.push(format!("{} -imfchan {word}", self.keyword));
                Channel::Mean
            }
        };
    }
}

/// The first two of one to three numbers, of which those left out have a default.
fn two(numbers: &[f32], default: f32) -> DVec2 {
    let at = |i: usize| f64::from(numbers.get(i).copied().unwrap_or(default));
    DVec2::new(at(0), at(1))
}

/// An option with its words and the text after it; nothing if the text is a file name, which may hold spaces.
fn next_option(text: &str) -> Option<(&str, Vec<&str>, &str)> {
    let (option, after) = text.split_once(char::is_whitespace)?;
    if !option.starts_with('-') {
        return None;
    }
    let words =
        OPTIONS.iter().find(|(name, ..)| *name == option).map_or(Words::Just(1), |(_, words, _)| *words);
    let most = if let Words::Just(count) = words { count } else { 3 };
    let mut rest = after.trim_start();
    let mut taken = Vec::new();
    while taken.len() < most {
        // The last word of the line is the file's name.
        let Some((word, following)) = rest.split_once(char::is_whitespace) else { break };
        let may_end = words == Words::UpToThreeNumbers && !taken.is_empty();
        if may_end && word.parse::<f32>().is_err() {
            break;
        }
        taken.push(word);
        rest = following.trim_start();
    }
    Some((option, taken, rest))
}
