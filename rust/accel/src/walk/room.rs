//! How much a builder may yet do, so that no input takes time or memory without bound.

/// What is left below a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Levels.
    pub depth: usize,
    /// Parts added to the primitives by parting them. A node shares what it has left among its children by how many
    /// parts these have, so that threads need not agree.
    spare: usize,
    /// What is below as a share of the work: a node shares it alike.
    steps: usize,
}

impl Room {
    /// Parts that may be added, over the number of primitives.
    const SPARE: usize = 8;

    /// What all work is counted as.
    pub const STEPS: usize = 1 << 40;

    /// And to however few.
    const AT_LEAST: usize = 64;

    /// For so many primitives, down to some depth.
    pub fn new(primitives: usize, depth: usize) -> Self {
        Self { depth, spare: Self::SPARE * primitives + Self::AT_LEAST, steps: Self::STEPS }
    }

    /// How many steps of work there are below.
    pub fn steps(self) -> usize {
        self.steps
    }

    /// How deep a tree of planes should be at most: 8 + 1.3 log₂ n, which Havran found to be enough ("Heuristic Ray
    /// Shooting Algorithms", 2000).
    pub fn depth_for(primitives: usize) -> usize {
        (8.0 + 1.3 * (primitives.max(1) as f64).log2()) as usize
    }

    /// What is left for each child, if so many of so many parts are to go there; none if that is too many.
    pub fn shared<const N: usize>(self, parts: usize, children: [usize; N]) -> Option<[Self; N]> {
        let sum: usize = children.iter().sum();
        let spare = self.spare.checked_sub(sum.saturating_sub(parts))?;
        let depth = self.depth.checked_sub(1)?;
        let share = |of: usize, child: usize| (of as u128 * child as u128 / sum.max(1) as u128) as usize;
        Some(children.map(|child| Self { depth, spare: share(spare, child), steps: share(self.steps, child) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shared_is_never_more_than_there_was() {
        let room = Room::new(10, 2);
        assert_eq!(room.spare, 144);
        let children = room.shared(10, [9, 7]).unwrap();
        assert_eq!(children.map(|room| (room.depth, room.spare)), [(1, 77), (1, 60)]);
        assert_eq!(room.shared(10, [150, 4]).unwrap().map(|room| room.spare), [0, 0]);
        assert_eq!(room.shared(10, [150, 5]), None);
        assert_eq!(Room::new(10, 0).shared(10, [5, 5]), None);
        assert_eq!((Room::depth_for(0), Room::depth_for(1), Room::depth_for(1 << 20)), (8, 8, 34));
    }
}
