use raywright::sampling::{BatchSize, SamplerKind};

#[test]
fn the_samples_of_a_batch_share_no_column_and_no_row() {
    let size = BatchSize::new(16).unwrap();
    for kind in [SamplerKind::Stratified(size), SamplerKind::Sobol(size), SamplerKind::Lattice(size)] {
        for (pixel, dimension) in [(0, 1), (7, 5), (123, 9)] {
            let points: Vec<[f64; 2]> = (0..16).map(|i| kind.sampler(3, pixel, i).two(dimension)).collect();
            for axis in 0..2 {
                let mut sorted: Vec<f64> = points.iter().map(|point| point[axis]).collect();
                sorted.sort_by(f64::total_cmp);
                // Neighbors are a sixteenth apart on average, and never two sixteenths.
                assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] < 2.0 / 16.0), "{kind:?} {sorted:?}");
            }
        }
    }
}
