//! How many cases a test tries: a part, or all of them where `RAYWRIGHT_SLOW` is set.

/// Whether all cases are tried.
pub fn are_all() -> bool {
    std::env::var_os("RAYWRIGHT_SLOW").is_some()
}

/// Every `step`-th case, or all of them. Loops within loops start at another one each time, by an offset.
pub fn every<T>(step: usize, offset: usize, cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    let are_all = are_all();
    cases
        .into_iter()
        .enumerate()
        .filter(move |(i, _)| are_all || (i + offset).is_multiple_of(step))
        .map(|(_, case)| case)
}
