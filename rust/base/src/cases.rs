//! The number of test cases: a subset, or all of them if `RAYWRIGHT_SLOW` is set.

/// Return whether all cases are tested.
pub fn are_all() -> bool {
    std::env::var_os("RAYWRIGHT_SLOW").is_some()
}

/// Every `step`-th case, or all of them. Inner loops pass an offset so that each starts at another case.
pub fn every<T>(step: usize, offset: usize, cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    let are_all = are_all();
    cases
        .into_iter()
        .enumerate()
        .filter(move |(i, _)| are_all || (i + offset).is_multiple_of(step))
        .map(|(_, case)| case)
}
