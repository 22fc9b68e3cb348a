//! Gauss-Legendre quadrature.

/// Nodes and weights of the Gauss-Legendre rule on [0, 1] with `count` points, by Newton's method on Legendre
/// polynomials.
pub fn gauss(count: usize) -> Vec<(f64, f64)> {
    let node = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
        loop {
            let (mut last, mut now) = (1.0, x);
            for k in 2..=count {
                let k = k as f64;
                (last, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * last) / k);
            }
            let slope = count as f64 * (x * now - last) / (x * x - 1.0);
            let step = now / slope;
            x -= step;
            if step.abs() < 1e-14 {
                return (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope));
            }
        }
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_integrates_polynomials() {
        for count in [2, 7, 16, 32] {
            let rule = gauss(count);
            for power in 0..2 * count as i32 {
                let sum: f64 = rule.iter().map(|(x, weight)| weight * x.powi(power)).sum();
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-11, "{count} {power} {sum}");
            }
        }
    }
}
