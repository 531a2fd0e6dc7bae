//! Exposure brackets of any photographs.

use pointillist_sh::invariants::brackets_stay_within;
use proptest::prelude::*;

/// Levels of which many are at the ends.
fn level() -> impl Strategy<Value = u8> {
    prop_oneof![Just(0_u8), Just(255), any::<u8>()]
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn what_is_merged_is_among_what_was_seen_in_any_order(
        photographs in prop::collection::vec((prop::collection::vec([level(), level(), level()], 5), -70.0..70.0_f32), 0..6),
    ) {
        brackets_stay_within(&photographs).map_err(TestCaseError::fail)?;
    }
}
