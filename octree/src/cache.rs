//! Nodes that were read, kept as long as there is room.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Keeps what was read last. Frames of a flight see much the same nodes, and read them once.
#[derive(Debug)]
pub struct NodeCache<T> {
    most_bytes: u64,
    bytes: u64,
    clock: u64,
    entries: HashMap<(usize, u32), Entry<T>>,
    /// By the time of the last use.
    by_age: BTreeMap<u64, (usize, u32)>,
}

#[derive(Debug)]
struct Entry<T> {
    value: Arc<T>,
    bytes: u64,
    used: u64,
}

impl<T> NodeCache<T> {
    /// A cache of at most so many bytes.
    #[must_use]
    pub fn new(most_bytes: u64) -> Self {
        Self { most_bytes, bytes: 0, clock: 0, entries: HashMap::new(), by_age: BTreeMap::new() }
    }

    /// Bytes of what is kept.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The node, if it is kept; it then counts as the one used last.
    pub fn get(&mut self, id: (usize, u32)) -> Option<Arc<T>> {
        let entry = self.entries.get_mut(&id)?;
        self.clock += 1;
        self.by_age.remove(&entry.used);
        self.by_age.insert(self.clock, id);
        entry.used = self.clock;
        Some(Arc::clone(&entry.value))
    }

    /// Keeps a node of so many bytes, in the place of those that were not used for longest. One that is larger than the cache is not kept.
    pub fn insert(&mut self, id: (usize, u32), value: Arc<T>, bytes: u64) {
        self.remove(id);
        if bytes > self.most_bytes {
            return;
        }
        while self.bytes + bytes > self.most_bytes {
            let Some((_, &oldest)) = self.by_age.first_key_value() else { break };
            self.remove(oldest);
        }
        self.clock += 1;
        self.bytes += bytes;
        self.by_age.insert(self.clock, id);
        self.entries.insert(id, Entry { value, bytes, used: self.clock });
    }

    fn remove(&mut self, id: (usize, u32)) {
        if let Some(entry) = self.entries.remove(&id) {
            self.by_age.remove(&entry.used);
            self.bytes -= entry.bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_used_for_longest_goes_first() {
        let mut cache = NodeCache::new(100);
        for node in 0..10 {
            cache.insert((0, node), Arc::new(node), 10);
        }
        assert_eq!(cache.get((0, 0)).as_deref(), Some(&0));
        cache.insert((1, 0), Arc::new(99), 20);
        assert_eq!(cache.bytes(), 100);
        let kept: Vec<u32> = (0..10).filter(|&node| cache.get((0, node)).is_some()).collect();
        assert_eq!(kept, [0, 3, 4, 5, 6, 7, 8, 9]);
        cache.insert((2, 0), Arc::new(7), 101);
        assert!(cache.get((2, 0)).is_none() && cache.bytes() == 100);
    }
}
