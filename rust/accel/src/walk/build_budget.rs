//! The budget of a builder, which bounds time and memory for any input.

/// The budget below a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildBudget {
    /// Levels.
    pub depth: usize,
    /// Duplicates that splits may add to the primitives. A node distributes its budget in proportion to the children's
    /// parts, so that threads need not synchronize.
    spare: usize,
    /// The work below as a fraction of [`BuildBudget::STEPS`], distributed likewise.
    steps: usize,
}

impl BuildBudget {
    /// Maximum number of duplicates per primitive.
    const SPARE: usize = 8;

    /// The total work.
    pub const STEPS: usize = 1 << 40;

    /// Additional duplicates, for small inputs.
    const AT_LEAST: usize = 64;

    /// The budget for a number of primitives and a maximum depth.
    pub fn new(primitives: usize, depth: usize) -> Self {
        Self { depth, spare: Self::SPARE * primitives + Self::AT_LEAST, steps: Self::STEPS }
    }

    /// The work below, in steps.
    pub fn steps(self) -> usize {
        self.steps
    }

    /// Maximum depth of a kd-tree or BSP tree: 8 + 1.3 log₂ n, which Havran found sufficient ("Heuristic Ray Shooting
    /// Algorithms", 2000).
    pub fn depth_for(primitives: usize) -> usize {
        (8.0 + 1.3 * (primitives.max(1) as f64).log2()) as usize
    }

    /// The budget of each child after splitting `parts` into the given numbers; None if it is exceeded.
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
        let room = BuildBudget::new(10, 2);
        assert_eq!(room.spare, 144);
        let children = room.shared(10, [9, 7]).unwrap();
        assert_eq!(children.map(|room| (room.depth, room.spare)), [(1, 77), (1, 60)]);
        assert_eq!(room.shared(10, [150, 4]).unwrap().map(|room| room.spare), [0, 0]);
        assert_eq!(room.shared(10, [150, 5]), None);
        assert_eq!(BuildBudget::new(10, 0).shared(10, [5, 5]), None);
        assert_eq!((BuildBudget::depth_for(0), BuildBudget::depth_for(1), BuildBudget::depth_for(1 << 20)), (8, 8, 34));
    }
}
