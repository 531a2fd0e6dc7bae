//! Answers the requests of `site/requests.txt` natively and writes all replies to a file, each with its length before it (32 bits, the lowest
//! first). `.ci/site` compares them with those of the module in the page.
//!
//! `cargo run -p pointillist-site --example replies -- FILE`

use pointillist_site::Site;
use std::error::Error;

const REQUESTS: &str = include_str!("../requests.txt");

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("the file to write is missing")?;
    let mut site = Site::new();
    let mut bytes = vec![];
    for line in REQUESTS.lines().filter(|line| !line.starts_with('#')) {
        let (_, request) = line.split_once(' ').ok_or("a line has no request")?;
        let reply = site.answer(request.replace("\\n", "\n").as_bytes()).to_bytes();
        bytes.extend(u32::try_from(reply.len())?.to_le_bytes());
        bytes.extend(reply);
    }
    std::fs::write(path, bytes)?;
    Ok(())
}
