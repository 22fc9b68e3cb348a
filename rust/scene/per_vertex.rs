//! What meshes may know of their vertices beside where they are.

/// Values of all vertices of a geometry; nothing is kept as long as no mesh has any.
#[derive(Debug, Default)]
pub(super) struct PerVertex<T>(Vec<T>);

impl<T: Copy> PerVertex<T> {
    /// Adds those of a mesh of `count` vertices, of which there were `before`; `none` stands for what is not known.
    ///
    /// # Panics
    /// If there is not one for each vertex.
    pub fn extend(&mut self, before: usize, count: usize, values: Option<&[T]>, none: T) {
        match values {
            Some(values) => {
                assert_eq!(values.len(), count, "a value for each vertex");
                self.0.resize(before, none);
                self.0.extend_from_slice(values);
            }
            None if self.0.is_empty() => {}
            None => self.0.resize(before + count, none),
        }
    }

    /// Those of a face's corners; none if no mesh has any.
    #[inline]
    pub fn of(&self, face: [u32; 3]) -> Option<[T; 3]> {
        (!self.0.is_empty()).then(|| face.map(|v| self.0[v as usize]))
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_kept_only_where_a_mesh_has_some() {
        let mut all = PerVertex::default();
        all.extend(0, 3, None, 0);
        assert_eq!((all.of([0, 1, 2]), all.bytes()), (None, 0));
        all.extend(3, 2, Some(&[7, 8]), 0);
        all.extend(5, 1, None, 0);
        assert_eq!(all.of([2, 4, 5]), Some([0, 8, 0]));
    }
}
