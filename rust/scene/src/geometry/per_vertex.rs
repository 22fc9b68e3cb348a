//! Optional vertex attributes.

/// Values of one attribute; meshes without it take no memory.
#[derive(Debug)]
pub(super) struct PerVertex<T> {
    values: Vec<T>,
    /// Ranges of vertices with values, in order; adjacent meshes with values share a range.
    runs: Vec<VertexRun>,
}

/// A range of vertices that all have a value.
#[derive(Clone, Copy, Debug)]
struct VertexRun {
    /// First vertex, and one past the last.
    vertices: [u32; 2],
    /// Number of vertices before the range that have no value.
    without: u32,
}

impl<T> Default for PerVertex<T> {
    fn default() -> Self {
        Self { values: Vec::new(), runs: Vec::new() }
    }
}

impl<T: Copy> PerVertex<T> {
    /// Adds the values of a mesh, if it has any. Its vertices are numbered from `first`, after those of all earlier
    /// meshes.
    pub fn extend(&mut self, first: u32, values: Option<Vec<T>>) {
        let Some(values) = values.filter(|values| !values.is_empty()) else { return };
        let end = first + values.len() as u32;
        match self.runs.last_mut() {
            Some(run) if run.vertices[1] == first => run.vertices[1] = end,
            _ => self.runs.push(VertexRun { vertices: [first, end], without: first - self.values.len() as u32 }),
        }
        if self.values.is_empty() {
            self.values = values;
        } else {
            self.values.extend(values);
        }
    }

    /// Frees unused capacity.
    pub fn shrink_to_fit(&mut self) {
        self.values.shrink_to_fit();
        self.runs.shrink_to_fit();
    }

    /// Values at a face's corners; `None` if its mesh has none.
    #[inline]
    pub fn of(&self, face: [u32; 3]) -> Option<[T; 3]> {
        // All corners of a face belong to one mesh, so one lookup is enough.
        let run = match &*self.runs {
            [] => return None,
            [run] => run,
            runs => runs.get(runs.partition_point(|run| run.vertices[1] <= face[0]))?,
        };
        let [first, end] = run.vertices;
        (first <= face[0] && face[0] < end).then(|| face.map(|v| self.values[(v - run.without) as usize]))
    }

    /// Returns whether no mesh has values.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.values.capacity() * size_of::<T>() + self.runs.capacity() * size_of::<VertexRun>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn is_kept_only_where_a_mesh_has_some() {
        let mut all = PerVertex::<u8>::default();
        assert_eq!((all.of([0, 1, 2]), all.bytes(), all.is_empty()), (None, 0, true));
        // Three vertices without values, two with, one without.
        all.extend(0, None);
        all.extend(3, Some(vec![7, 8]));
        all.extend(5, None);
        all.shrink_to_fit();
        assert_eq!((all.of([0, 1, 2]), all.of([3, 4, 3]), all.of([5; 3])), (None, Some([7, 8, 7]), None));
        assert_eq!(all.bytes(), 2 + size_of::<VertexRun>());
    }

    proptest! {
        #[test]
        fn meshes_have_their_own_and_no_more_is_kept(meshes in prop::collection::vec((1u32..5, any::<bool>()), 0..12)) {
            let (mut all, mut first, mut kept) = (PerVertex::<u32>::default(), 0, 0);
            for &(count, has) in &meshes {
                all.extend(first, has.then(|| (first..first + count).map(|v| 3 * v + 1).collect()));
                kept += if has { count as usize } else { 0 };
                first += count;
            }
            let mut first = 0;
            for (count, has) in meshes {
                for v in first..first + count {
                    let expected = [v, first, first + count - 1];
                    prop_assert_eq!(all.of(expected), has.then(|| expected.map(|v| 3 * v + 1)));
                }
                first += count;
            }
            prop_assert_eq!(all.values.len(), kept);
        }
    }
}
