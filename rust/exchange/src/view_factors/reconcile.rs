//! Constrained least squares: adjust estimates to given sums.

/// An estimate that counts in the sums of one row or two.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// Both rows; the same twice for one.
    pub rows: [u32; 2],
    pub value: f64,
    pub variance: f64,
    /// Its upper bound; the lower bound is 0.
    pub most: f64,
}

/// Maximum number of Newton steps, and of conjugate gradient steps in each.
const STEPS: usize = 40;
const INNER: usize = 100;

/// Tolerance of sums relative to their rows' scales.
const ENOUGH: f64 = 1e-14;

/// The method ends after PATIENCE steps that do not halve the greatest error, if that error is GOOD. Otherwise it
/// continues with more careful steps, up to MORE_PATIENCE of them without progress.
const PATIENCE: u32 = 2;
const MORE_PATIENCE: u32 = 16;
const GOOD: f64 = 1e-12;

/// Standard deviation allowed for a sum relative to its row's scale. It matters only in rows whose terms, by their
/// errors and bounds, are more constrained than that. Such sums cannot be reached, for example if rounding has moved
/// the corners of touching faces.
const SLACK: f64 = 1e-12;

/// Curvature of a row whose terms are all at their bounds, relative to that of a free row. It lets careful steps lead
/// back to free terms.
const DAMPING: f64 = 1e-10;

/// Adjust terms to the wanted row sums within their bounds.
///
/// The result x minimizes Σ (x − x̂)² / variance for the estimates x̂: weighted least squares, which reduce the error
/// of every term if the variances are correct. With a Lagrange multiplier λ for each row, x = x̂ + variance (λᵢ + λⱼ),
/// clamped to the bounds. Newton's method solves the sums for λ, in one step if no bound is active. Rows without a
/// wanted sum are unchanged, as are terms with no constrained row.
pub fn reconcile(terms: &mut [Term], wanted: &[Option<f64>], scales: &[f64]) {
    let without = multipliers(terms, wanted, scales, 0.0);
    let best = if without.0 <= GOOD {
        without
    } else {
        let with = multipliers(terms, wanted, scales, SLACK);
        if with.0 < without.0 { with } else { without }
    };
    for term in terms {
        term.value = moved(term, &best.1).0;
    }
}

/// The multipliers, and the greatest error of a sum relative to its row's scale. `error` is the allowed relative error
/// of the sums.
fn multipliers(terms: &[Term], wanted: &[Option<f64>], scales: &[f64], error: f64) -> (f64, Vec<f64>) {
    let slack: Vec<f64> = scales.iter().map(|scale| (error * scale) * (error * scale)).collect();
    let mut lambda = vec![0.0; wanted.len()];
    let mut best = (f64::INFINITY, lambda.clone());
    let mut waited = 0;
    let mut is_careful = false;
    let mut residual = residuals(terms, wanted, &slack, &lambda);
    for _ in 0..STEPS {
        let off = worst(&residual, scales);
        waited = if off < 0.5 * best.0 { 0 } else { waited + 1 };
        if off < best.0 {
            best = (off, lambda.clone());
        }
        if off <= ENOUGH || (best.0 <= GOOD && waited >= PATIENCE) {
            best.1 = lambda;
            break;
        }
        if waited == PATIENCE && !is_careful {
            (is_careful, waited) = (true, 0);
        } else if waited == MORE_PATIENCE {
            break;
        }
        let step = newton(terms, wanted, &slack, &lambda, &residual, if is_careful { DAMPING } else { 0.0 });
        let rise = dot(&residual, &step);
        // If no term of a row is free enough, steps may overflow.
        if !rise.is_finite() {
            break;
        }
        let mut share = 1.0;
        // A step beyond the maximum of the concave dual has a negative slope at its end, and is halved. At first, so is
        // a step that hardly changes the slope. That converges faster if few bounds are active, but may end too soon.
        loop {
            let next: Vec<f64> = lambda.iter().zip(&step).map(|(l, s)| l + share * s).collect();
            let left = residuals(terms, wanted, &slack, &next);
            let (slope, most) = (dot(&left, &step), 0.9 * rise.abs());
            let is_taken =
                if is_careful { slope >= -most || share < 1e-12 } else { slope.abs() <= most || share < 1e-3 };
            if is_taken {
                (lambda, residual) = (next, left);
                break;
            }
            share *= 0.5;
        }
    }
    let sums = residuals(terms, wanted, &vec![0.0; wanted.len()], &best.1);
    (worst(&sums, scales), best.1)
}

/// The greatest error of a sum relative to its row's scale; infinite for NaN.
fn worst(residual: &[f64], scales: &[f64]) -> f64 {
    let shares = residual.iter().zip(scales).map(|(r, scale)| r.abs() / scale);
    shares.fold(0.0f64, |most, share| if share.is_nan() { f64::INFINITY } else { most.max(share) })
}

/// A term for the given multipliers, and whether it is free.
fn moved(term: &Term, lambda: &[f64]) -> (f64, bool) {
    let [i, j] = term.rows.map(|row| row as usize);
    let by = lambda[i] + if i == j { 0.0 } else { lambda[j] };
    let free = term.value + term.variance * by;
    // A term exactly at a bound counts as free: it may move away from it.
    (free.clamp(0.0, term.most), free >= 0.0 && free <= term.most && term.variance > 0.0)
}

/// The missing part of each sum; 0 for unconstrained rows.
fn residuals(terms: &[Term], wanted: &[Option<f64>], slack: &[f64], lambda: &[f64]) -> Vec<f64> {
    let mut left: Vec<f64> =
        (0..wanted.len()).map(|row| wanted[row].unwrap_or(0.0) - slack[row] * lambda[row]).collect();
    for term in terms {
        let [i, j] = term.rows.map(|row| row as usize);
        let value = moved(term, lambda).0;
        left[i] -= value;
        if i != j {
            left[j] -= value;
        }
    }
    left.iter().zip(wanted).map(|(left, wanted)| if wanted.is_some() { *left } else { 0.0 }).collect()
}

/// A Newton step by conjugate gradients with a diagonal preconditioner.
fn newton(
    terms: &[Term],
    wanted: &[Option<f64>],
    slack: &[f64],
    lambda: &[f64],
    residual: &[f64],
    damped: f64,
) -> Vec<f64> {
    let is_held = |row: usize| wanted[row].is_some();
    let free: Vec<([usize; 2], f64)> = terms
        .iter()
        .filter(|term| moved(term, lambda).1)
        .map(|term| (term.rows.map(|row| row as usize), term.variance))
        .filter(|([i, j], _)| is_held(*i) || is_held(*j))
        .collect();
    let mut diagonal = vec![0.0; wanted.len()];
    for &([i, j], variance) in &free {
        diagonal[i] += if is_held(i) { variance } else { 0.0 };
        diagonal[j] += if i != j && is_held(j) { variance } else { 0.0 };
    }
    let mut damping = vec![0.0; wanted.len()];
    for (term, row) in terms.iter().flat_map(|term| term.rows.map(|row| (term, row as usize))) {
        damping[row] += if is_held(row) && diagonal[row] == 0.0 { damped * term.variance } else { 0.0 };
    }
    for row in (0..wanted.len()).filter(|&row| is_held(row)) {
        damping[row] += slack[row];
    }
    diagonal.iter_mut().zip(&damping).for_each(|(diagonal, damping)| *diagonal += damping);
    let share: Vec<f64> = diagonal.iter().map(|&d| if d > 0.0 { 1.0 / d } else { 0.0 }).collect();
    let times = |x: &[f64]| {
        let mut y: Vec<f64> = x.iter().zip(&damping).map(|(x, damping)| x * damping).collect();
        for &([i, j], variance) in &free {
            let of = variance * (x[i] + if i == j { 0.0 } else { x[j] });
            y[i] += of;
            if i != j {
                y[j] += of;
            }
        }
        y
    };
    let scaled = |x: &[f64]| -> Vec<f64> { x.iter().zip(&share).map(|(x, s)| x * s).collect() };
    let mut step = vec![0.0; residual.len()];
    let mut rest: Vec<f64> = residual.iter().zip(&share).map(|(r, s)| if *s > 0.0 { *r } else { 0.0 }).collect();
    let mut way = scaled(&rest);
    let mut along = way.clone();
    let mut length = dot(&rest, &way);
    let least = 1e-26 * length;
    for _ in 0..INNER {
        if length <= least {
            break;
        }
        let mut turned = times(&along);
        turned.iter_mut().zip(&share).for_each(|(t, s)| *t = if *s > 0.0 { *t } else { 0.0 });
        let curve = dot(&along, &turned);
        if curve <= 0.0 {
            break;
        }
        let much = length / curve;
        for i in 0..step.len() {
            step[i] += much * along[i];
            rest[i] -= much * turned[i];
        }
        way = scaled(&rest);
        let next = dot(&rest, &way);
        let share = next / length;
        length = next;
        along.iter_mut().zip(&way).for_each(|(a, w)| *a = w + share * *a);
    }
    step
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    /// Every pair of rows, each with a true value, an estimate of it, and its variance.
    fn terms(rows: u32, seed: u64) -> (Vec<Term>, Vec<f64>) {
        let mut terms = Vec::new();
        let mut truths = Vec::new();
        for i in 0..rows {
            for j in i..rows {
                let mut sampler = Sampler::new(seed, i, j);
                let truth = sampler.one(0).powi(4);
                let error = 0.3 * sampler.one(1).powi(3);
                let off = (0..12).map(|d| sampler.one(2 + d)).sum::<f64>() - 6.0;
                let value = (truth + error * off).clamp(0.0, 1.0);
                terms.push(Term { rows: [i, j], value, variance: error * error, most: 1.0 });
                truths.push(truth);
            }
        }
        (terms, truths)
    }

    fn sums(terms: &[Term], values: impl Iterator<Item = f64>, rows: usize) -> Vec<f64> {
        let mut sums = vec![0.0; rows];
        for (term, value) in terms.iter().zip(values) {
            let [i, j] = term.rows.map(|row| row as usize);
            sums[i] += value;
            sums[j] += if i == j { 0.0 } else { value };
        }
        sums
    }

    #[test]
    fn sums_are_as_wanted_within_bounds_and_errors_fall() {
        for seed in 0..4 {
            let rows = 20;
            let (mut terms, truths) = terms(rows as u32, seed);
            let whole = sums(&terms, truths.iter().copied(), rows);
            let mut wanted: Vec<Option<f64>> = whole.iter().copied().map(Some).collect();
            wanted[3] = None;
            let before = terms.clone();
            reconcile(&mut terms, &wanted, &vec![1.0; rows]);
            let found = sums(&terms, terms.iter().map(|term| term.value), rows);
            for row in (0..rows).filter(|&row| row != 3) {
                assert!((found[row] - whole[row]).abs() < 1e-13, "{row}: {} {}", found[row], whole[row]);
            }
            assert!(terms.iter().all(|term| (0.0..=1.0).contains(&term.value)));
            let off = |of: &[Term]| {
                of.iter().zip(&truths).map(|(t, truth)| (t.value - truth).powi(2) / t.variance).sum::<f64>()
            };
            // The true values satisfy bounds and sums, so the projection onto these is at least as close to them.
            assert!(off(&terms) < off(&before), "{} {}", off(&terms), off(&before));
        }
    }

    #[test]
    fn sums_are_as_wanted_where_most_terms_are_at_bounds() {
        let mut stuck = 0;
        for seed in 0..200 {
            let rows = 10;
            let mut truths = Vec::new();
            let mut terms = Vec::new();
            for i in 0..rows {
                for j in i + 1..rows {
                    let mut sampler = Sampler::new(seed, i, j);
                    let [kind, size, at, off, error] = std::array::from_fn(|k| sampler.one(k as u32));
                    let most = size.powi(3) + 0.01;
                    let (is_bound, truth) = match kind {
                        kind if kind < 0.3 => continue,
                        kind if kind < 0.6 => (true, most),
                        kind if kind < 0.8 => (true, 0.0),
                        _ => (false, at * most),
                    };
                    let error = most * 10f64.powf(-3.0 + 2.3 * error);
                    let value = if is_bound && off < 0.6 { truth } else { truth + error * (6.0 * off - 3.0) };
                    let value = value.clamp(0.0, most);
                    terms.push(Term { rows: [i, j], value, variance: error * error, most });
                    truths.push(truth);
                }
            }
            let whole = sums(&terms, truths.iter().copied(), rows as usize);
            let wanted: Vec<Option<f64>> = whole.iter().copied().map(Some).collect();
            reconcile(&mut terms, &wanted, &[1.0; 10]);
            let found = sums(&terms, terms.iter().map(|term| term.value), rows as usize);
            let off = found.iter().zip(&whole).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(off < 1e-3, "{seed}: {off}");
            stuck += u32::from(off > 1e-12);
        }
        // Newton's method may stop at a bound: in 5 of 3,000 such problems.
        assert!(stuck <= 2, "{stuck}");
    }

    #[test]
    fn a_sum_that_is_no_number_is_never_right() {
        assert_eq!(worst(&[0.0, f64::NAN, 1.0], &[1.0; 3]), f64::INFINITY);
        let term = |rows, value| Term { rows, value, variance: 0.1, most: 1.0 };
        let mut terms = [term([0, 0], f64::NAN), term([1, 1], 0.3)];
        reconcile(&mut terms, &[Some(0.5), Some(0.4)], &[1.0; 2]);
        // Other rows are no worse than before.
        assert!(terms[0].value.is_nan() && (0.3..=0.4).contains(&terms[1].value), "{terms:?}");
    }

    #[test]
    fn what_has_no_error_or_no_row_stays_and_what_cannot_be_ends() {
        let term = |rows, value, variance| Term { rows, value, variance, most: 1.0 };
        let mut terms = [term([0, 1], 0.3, 0.0), term([0, 2], 0.3, 0.1), term([1, 2], 0.3, 0.1)];
        reconcile(&mut terms, &[Some(0.5), None, None], &[1.0; 3]);
        assert_eq!((terms[0].value, terms[2].value), (0.3, 0.3));
        assert!((terms[1].value - 0.2).abs() < 1e-15);
        // Two rows with one term and contradictory sums.
        let mut alone = [term([0, 1], 0.3, 0.1)];
        reconcile(&mut alone, &[Some(0.4), Some(0.5)], &[1.0; 2]);
        assert!((0.2..=0.7).contains(&alone[0].value), "{}", alone[0].value);
    }
}
