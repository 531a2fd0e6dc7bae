//! What the page calls. JavaScript sees the module's memory as one array of bytes: it asks for room, writes its request there, and reads the
//! reply where [`site_reply_address`] says. No address is ever read or written here, so that this is safe code; the attribute alone, which lets a
//! function be found by its name, counts as unsafe, because two functions of one name would be confused.
#![expect(unsafe_code, reason = "`no_mangle`: JavaScript finds functions by their names")]

use crate::Site;
use std::cell::RefCell;

#[derive(Default)]
struct Page {
    site: Site,
    request: Vec<u8>,
    reply: Vec<u8>,
}

thread_local! {
    /// The page has one thread, natively each has its own.
    static PAGE: RefCell<Page> = RefCell::default();
}

/// Makes room for a request of so many bytes, and says where.
#[unsafe(no_mangle)]
pub extern "C" fn site_request_address(length: usize) -> *const u8 {
    PAGE.with_borrow_mut(|page| {
        page.request.clear();
        page.request.resize(length, 0);
        page.request.as_ptr()
    })
}

/// Answers the request, and says how long the reply is.
#[unsafe(no_mangle)]
pub extern "C" fn site_answer() -> usize {
    PAGE.with_borrow_mut(|page| {
        page.reply = page.site.answer(&page.request).to_bytes();
        page.reply.len()
    })
}

/// Where the reply is, until the next request.
#[unsafe(no_mangle)]
pub extern "C" fn site_reply_address() -> *const u8 {
    PAGE.with_borrow(|page| page.reply.as_ptr())
}
