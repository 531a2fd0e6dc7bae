//! Reads gzip: any number of members one after the other; other bytes after them are an error.

use flate2::bufread::GzDecoder;
use std::io::{self, BufRead, Read};

/// Unpacks gzip.
///
/// Not `flate2`'s `MultiGzDecoder`: it reports rubbish behind the stream as a broken header, without its place, and
/// refuses zeros, with which tapes and block devices fill up.
pub(super) struct Gunzip<R> {
    state: State<R>,
}

enum State<R> {
    Inside(Box<GzDecoder<Counted<R>>>),
    Done,
}

impl<R: BufRead> Gunzip<R> {
    pub(super) fn new(packed: R) -> Self {
        Self { state: State::Inside(Box::new(GzDecoder::new(Counted { inner: packed, taken: 0 }))) }
    }

    /// After one stream: begins the next, or ends.
    fn go_on(&mut self) -> io::Result<()> {
        if let State::Inside(decoder) = std::mem::replace(&mut self.state, State::Done) {
            let mut packed = decoder.into_inner();
            if packed.skip_zeros()? {
                return Ok(());
            }
            // Two bytes may be on two sides of the buffer's end; then the decoder finds out about the second.
            let ahead = packed.fill_buf()?;
            if ahead[0] != 0x1f || ahead.get(1).is_some_and(|&second| second != 0x8b) {
                let message = format!("there is something behind the gzip stream, at byte {}", packed.taken);
                return Err(io::Error::new(io::ErrorKind::InvalidData, message));
            }
            self.state = State::Inside(Box::new(GzDecoder::new(packed)));
        }
        Ok(())
    }
}

impl<R: BufRead> Read for Gunzip<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if into.is_empty() {
            return Ok(0);
        }
        loop {
            let State::Inside(decoder) = &mut self.state else { return Ok(0) };
            let count = decoder.read(into).map_err(|error| {
                let at = decoder.get_ref().taken;
                io::Error::new(
                    error.kind(),
                    format!("the gzip stream is damaged or cut off at byte {at} ({error})"),
                )
            })?;
            if count > 0 {
                return Ok(count);
            }
            self.go_on()?;
        }
    }
}

/// A stream that knows how many bytes were taken from it.
struct Counted<R> {
    inner: R,
    taken: u64,
}

impl<R: BufRead> Counted<R> {
    /// Passes over zeros; `true` if nothing but zeros was left.
    fn skip_zeros(&mut self) -> io::Result<bool> {
        loop {
            let ahead = self.fill_buf()?;
            if ahead.is_empty() {
                return Ok(true);
            }
            let zeros = ahead.iter().position(|&byte| byte != 0);
            let count = zeros.unwrap_or(ahead.len());
            self.consume(count);
            if zeros.is_some() {
                return Ok(false);
            }
        }
    }
}

impl<R: BufRead> Read for Counted<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(into)?;
        self.taken += count as u64;
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Counted<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.inner.consume(count);
        self.taken += count as u64;
    }
}
