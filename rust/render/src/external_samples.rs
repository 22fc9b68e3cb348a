//! Samples taken and summed elsewhere, such as on a GPU.

use super::Rendering;
use super::bytes::{Malformed, check};
use super::tile::FilmTile;
use raywright_base::parallel;
use raywright_optics::Rgb;

impl Rendering {
    /// Adds `count` samples of each pixel, which follow those here. For each pixel, row by row from the top, they are
    /// given as their sum, the sum of their squares, and the largest. `dropped` samples were invalid and count as
    /// black.
    ///
    /// # Errors
    /// If the film keeps more than these sums, the pass has another number of samples, the number of sums is wrong, or
    /// some are invalid.
    pub fn add(&mut self, count: u32, sums: &[[f64; 9]], dropped: u64) -> Result<(), Malformed> {
        let film = &self.film;
        let (batch, clamp, apart) = (film.batch(), film.clamp(), film.is_apart());
        check(batch == 1 && film.appends() && clamp.is_none() && !apart, "the film stores more than sums")?;
        check(sums.len() == film.pixel_count(), "they belong to a picture of another size")?;
        let most = self.aim().min(FilmTile::MOST);
        let fits = |tile: &FilmTile| tile.counts().iter().all(|&there| count <= most.saturating_sub(there));
        check(film.tiles().iter().all(fits), "the pass has fewer samples")?;
        check(dropped <= sums.len() as u64 * u64::from(count), "more samples were dropped than taken")?;
        check(sums.as_flattened().iter().all(|x| x.is_finite() && *x >= 0.0), "sums must be finite and at least 0")?;
        let width = film.width() as usize;
        parallel::each_mut(self.film.tiles_mut(), &|_, tile| {
            tile.add_sums(count, |(x, y)| {
                let [a, b, c, d, e, f, g, h, i] = sums[y as usize * width + x as usize];
                [Rgb::new(a, b, c), Rgb::new(d, e, f), Rgb::new(g, h, i)]
            });
        });
        if let Some(tile) = self.film.tiles_mut().first_mut() {
            tile.drop_more(dropped);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{Film, Rendering};
    use raywright_optics::Rgb;

    #[test]
    fn sums_are_worth_their_samples() {
        // Whole numbers, so that the order of addition does not matter.
        let sample = |x: u32, y: u32, number: u32| Rgb::new(f64::from(x + number), f64::from(y), f64::from(number % 3));
        let film = || Film::new(7, 5, 4, 1, false, None);
        let mut one_by_one = film();
        for tile in one_by_one.extend_to(24) {
            for (i, (x, y)) in tile.pixels().enumerate() {
                (0..24).for_each(|number| tile.add(i, sample(x, y, number), 1.0));
            }
        }
        let mut rendering = Rendering::new(film());
        for (from, to) in [(0, 5), (5, 24)] {
            let mut sums = Vec::new();
            for (y, x) in (0..5).flat_map(|y| (0..7).map(move |x| (y, x))) {
                let all: Vec<Rgb> = (from..to).map(|number| sample(x, y, number)).collect();
                let largest = all.iter().copied().reduce(|a, b| if b.max() > a.max() { b } else { a }).unwrap();
                let sum: Rgb = all.iter().copied().sum();
                let squares: Rgb = all.iter().map(|&rgb| rgb * rgb).sum();
                let mut row = [0.0; 9];
                for (to, of) in row.chunks_mut(3).zip([sum, squares, largest]) {
                    to.copy_from_slice(&[of[0], of[1], of[2]]);
                }
                sums.push(row);
            }
            rendering.begin(to);
            rendering.add(to - from, &sums, 0).unwrap();
            rendering.end(1.0);
            assert!(rendering.add(1, &sums, 0).is_err(), "the pass is over");
        }
        assert_eq!(rendering.film.means(), one_by_one.means());
        assert_eq!(rendering.film.variances(), one_by_one.variances());
        let mut clamped = Rendering::new(Film::new(1, 1, 4, 1, false, Some(1.0)));
        clamped.begin(1);
        assert!(clamped.add(1, &[[0.0; 9]], 0).is_err());
    }
}
