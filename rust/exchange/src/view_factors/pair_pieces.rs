//! Subdivision of triangle pairs for importance sampling of their exchange.

use super::distant::Quadrature;
use super::facet::Facet;
use super::pair::{Facing, facing};

/// Maximum number of pieces per pair; each split adds three.
const MOST: usize = 48;

/// Pieces with less than this fraction of the exchange are not split.
const SMALL: f64 = 1.0 / 16.0;

/// Nor are pieces with a greater view factor from the smaller part: no sample then has many times the weight of
/// another.
const SHARE: f64 = 1.0 / 8.0;

/// Triangles closer than this multiple of both radii are split, since their exchange varies strongly with position.
const NEAR: f64 = 2.0;

/// Parts of two triangles, in front of each other.
pub struct PairPiece {
    /// The smaller part, from which rays start, and the larger one.
    pub facets: [Facet; 2],
    /// The triangle that the first part belongs to.
    pub from: usize,
    /// Their unblocked exchange.
    pub whole: f64,
}

/// All pieces of a pair.
pub struct Pieces {
    pieces: Vec<PairPiece>,
    /// The cumulative sums of `whole`.
    sums: Vec<f64>,
}

impl Pieces {
    /// Split the mutually facing parts of two triangles until no near piece has much of the exchange.
    ///
    /// Nearly coplanar triangles are not split. With uniform points over whole triangles, a few samples near a common
    /// edge would carry most of the weight, and could all be missed. The total exchange is given, and belongs to the
    /// only piece of most pairs.
    pub fn new(quadrature: &mut Quadrature, one: &Facet, other: &Facet, total: f64) -> Self {
        let mut parts: Vec<(Facing, f64)> = facing(one, other).map(|part| (part, total)).collect();
        if parts.len() > 1 {
            parts.iter_mut().for_each(|(part, whole)| *whole = part.exchanged(quadrature));
            parts.retain(|part| part.1 > 0.0);
        }
        let is_cut = |(part, whole): &(Facing, f64)| {
            let area = part.facets[0].area.min(part.facets[1].area);
            *whole > SMALL * total && *whole < SHARE * area && part.is_within(NEAR) && !part.is_flat()
        };
        while parts.len() < MOST {
            let most =
                (0..parts.len()).filter(|&i| is_cut(&parts[i])).max_by(|&i, &j| parts[i].1.total_cmp(&parts[j].1));
            let Some(most) = most else { break };
            let quarters = parts.swap_remove(most).0.quarters();
            parts.extend(
                quarters.map(|part| (part, part.exchanged(quadrature))).into_iter().filter(|part| part.1 > 0.0),
            );
        }
        let piece = |(part, whole): (Facing, f64)| {
            let [one, other] = part.facets;
            let from = usize::from(one.area > other.area);
            PairPiece { facets: if from == 0 { [one, other] } else { [other, one] }, from, whole }
        };
        let pieces: Vec<PairPiece> = parts.into_iter().map(piece).collect();
        let mut sum = 0.0;
        let sums = pieces.iter().map(|piece| (sum += piece.whole, sum).1).collect();
        Self { pieces, sums }
    }

    /// The piece at a fraction of the exchange; `None` if there is no exchange.
    pub fn at(&self, share: f64) -> Option<&PairPiece> {
        let at = share * self.sums.last()?;
        let i = self.sums.partition_point(|&sum| sum <= at).min(self.pieces.len() - 1);
        Some(&self.pieces[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view_factors::pair;
    use raywright_base::math::DVec3;
    use raywright_base::simd::Level;

    #[test]
    fn pieces_make_the_whole_and_none_at_a_contact_holds_much() {
        // Slender walls that meet at an edge, and a wall half below a large floor.
        let at = |corners: [[f64; 3]; 3]| Facet::new(corners.map(DVec3::from));
        let floor = at([[0.0; 3], [100.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let wall = at([[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 50.0]]);
        let low = at([[5.0, -20.0, -20.0], [5.0, 3.0, -20.0], [5.0, 0.5, 1.0]]);
        let mut quadrature = Quadrature::new(Level::current().unwrap());
        for other in [wall, low, Facet::new([low.corners[0], low.corners[2], low.corners[1]])] {
            let whole = pair(&mut quadrature, &floor, &other);
            let pieces = Pieces::new(&mut quadrature, &floor, &other, whole);
            let sum: f64 = pieces.pieces.iter().map(|piece| piece.whole).sum();
            assert!((sum - whole).abs() <= 1e-8 * whole, "{sum} for {whole}");
            for piece in &pieces.pieces {
                assert!(piece.facets[0].area <= piece.facets[1].area);
                let far = piece.facets[0].centre.distance(piece.facets[1].centre);
                let is_near = far < NEAR * (piece.facets[0].radius + piece.facets[1].radius);
                let is_small = piece.whole <= SMALL * whole * 1.001 || piece.whole >= SHARE * piece.facets[0].area;
                let is_flat = piece.whole < 1e-3 * piece.facets[0].area;
                assert!(!is_near || is_small || is_flat || pieces.pieces.len() + 3 > MOST);
            }
        }
    }
}
