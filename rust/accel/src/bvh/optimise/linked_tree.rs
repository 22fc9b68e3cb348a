//! A binary tree with movable subtrees.

use crate::bvh::build::Bounds;
use crate::bvh::{BinaryBvh, Node};
use raywright_base::math::Aabb;
use raywright_base::parallel;

/// A tree with parent links. Its leaves stand for whole subtrees of the original tree.
///
/// Node 0 is the root; pairs of siblings fill the rest in any order.
pub struct LinkedTree {
    boxes: Vec<Bounds>,
    /// Half the surface area of every box.
    areas: Vec<f32>,
    /// The first child of an inner node; [`LEAF`] and the original node for a leaf.
    links: Vec<u32>,
    sizes: Vec<Size>,
    /// The parent of each pair of siblings.
    parents: Vec<u32>,
    /// The last time a node or a descendant was part of a move.
    marks: Vec<u32>,
    time: u32,
}

/// Marks the links of leaves.
const LEAF: u32 = 1 << 31;

/// The size of a subtree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    nodes: u32,
    primitives: u32,
    /// Its height.
    height: u32,
}

impl Size {
    fn above(left: Self, right: Self) -> Self {
        Self {
            nodes: 1 + left.nodes + right.nodes,
            primitives: left.primitives + right.primitives,
            height: 1 + left.height.max(right.height),
        }
    }
}

/// A subtree and its new place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The root of the subtree.
    pub node: u32,
    /// Its new sibling.
    pub to: u32,
}

/// A completed move.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    node: u32,
    /// Its former parent.
    from: u32,
    to: u32,
}

/// Nodes below a root, and a new topology for them.
pub struct Treelet {
    /// The root.
    pub root: u32,
    /// Nodes whose subtrees stay unchanged.
    pub leaves: Vec<u32>,
    /// The sibling pairs between them and the root, by their first node: one less than leaves.
    pub pairs: Vec<u32>,
    /// For every set of leaves with a node, its left subset; each leaf is a bit.
    pub left: Box<[u8; 128]>,
}

/// The index of a node's pair; not for the root.
#[inline(always)]
fn pair(node: u32) -> usize {
    (node as usize - 1) / 2
}

/// The sibling of a node.
#[inline(always)]
pub fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

impl LinkedTree {
    /// Create a tree whose leaves are the largest subtrees of at most `block` primitives. `bvh` is not empty.
    pub fn new(bvh: &BinaryBvh, block: u32) -> Self {
        // Blocks are rarely full.
        let nodes = 1 + bvh.nodes.len().min(3 * bvh.order.len() / block.max(1) as usize);
        let mut tree = Self {
            boxes: Vec::with_capacity(nodes),
            areas: Vec::with_capacity(nodes),
            links: Vec::with_capacity(nodes),
            sizes: Vec::with_capacity(nodes),
            parents: Vec::with_capacity(nodes / 2),
            marks: Vec::new(),
            time: 0,
        };
        let nothing = Size { nodes: 0, primitives: 0, height: 0 };
        tree.push(bvh, 0, LEAF, nothing);
        (tree.links[0], tree.sizes[0]) = tree.take(bvh, block, 0);
        tree.own(0);
        tree.marks = vec![0; tree.links.len()];
        tree
    }

    /// Import the subtree of a node, children first; return its link and size.
    fn take(&mut self, bvh: &BinaryBvh, block: u32, at: usize) -> (u32, Size) {
        let node = &bvh.nodes[at];
        let as_leaf = LEAF | at as u32;
        if node.is_leaf() {
            return (as_leaf, Size { nodes: 1, primitives: node.count, height: 0 });
        }
        let [left, right] = node.children();
        let (left_link, left_size) = self.take(bvh, block, left);
        let (right_link, right_size) = self.take(bvh, block, right);
        let size = Size::above(left_size, right_size);
        if size.primitives <= block {
            return (as_leaf, size);
        }
        let first = self.links.len() as u32;
        self.push(bvh, left, left_link, left_size);
        self.push(bvh, right, right_link, right_size);
        self.parents.push(0);
        self.own(first);
        self.own(first + 1);
        (first, size)
    }

    fn push(&mut self, bvh: &BinaryBvh, at: usize, link: u32, size: Size) {
        let bounds = Bounds::from(&bvh.nodes[at].aabb());
        self.boxes.push(bounds);
        self.areas.push(bounds.half_area());
        self.links.push(link);
        self.sizes.push(size);
    }

    /// Set the parent of a node's children.
    fn own(&mut self, node: u32) {
        if let Some(children) = self.below(node) {
            self.parents[pair(children)] = node;
        }
    }

    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.links.len()
    }

    #[inline(always)]
    pub fn bounds(&self, node: u32) -> &Bounds {
        &self.boxes[node as usize]
    }

    #[inline(always)]
    pub fn area(&self, node: u32) -> f32 {
        self.areas[node as usize]
    }

    fn size(&self, node: u32) -> Size {
        self.sizes[node as usize]
    }

    /// The height of the tree, including the original subtrees.
    pub fn height(&self) -> u32 {
        self.size(0).height
    }

    /// The height of a node.
    pub fn height_of(&self, node: u32) -> u32 {
        self.size(node).height
    }

    /// The first child of an inner node.
    #[inline(always)]
    pub fn below(&self, node: u32) -> Option<u32> {
        let link = self.links[node as usize];
        (link & LEAF == 0).then_some(link)
    }

    /// The parent of a node other than the root.
    #[inline(always)]
    pub fn parent(&self, node: u32) -> u32 {
        self.parents[pair(node)]
    }

    /// The areas of all nodes.
    pub fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// The total area of the inner nodes.
    pub fn cost(&self) -> f64 {
        (0..self.len() as u32).filter(|&n| self.below(n).is_some()).map(|n| f64::from(self.area(n))).sum()
    }

    /// Make the moves in order, skipping those that conflict with earlier ones. Return the completed moves and the
    /// saved area.
    pub fn apply(&mut self, moves: impl IntoIterator<Item = Move>) -> (Vec<Made>, f64) {
        self.time += 1;
        let (mut made, mut saved) = (Vec::new(), 0.0);
        for Move { node, to } in moves {
            let from = self.parent(node);
            let around = [node, sibling(node), from, to, if to == 0 { 0 } else { self.parent(to) }];
            // An earlier move may have put the place inside the subtree.
            if around.iter().any(|&n| self.marks[n as usize] == self.time) || self.is_within(to, node) {
                continue;
            }
            for n in around {
                self.marks[n as usize] = self.time;
            }
            // Until refitting, the new parent has the box of its child.
            saved += f64::from(self.area(from)) - f64::from(self.area(to));
            self.reinsert(node, to);
            made.push(Made { node, from, to });
        }
        saved += self.refit(&made);
        (made, saved)
    }

    /// Undo moves.
    pub fn undo(&mut self, made: &[Made]) {
        for &Made { node, from, .. } in made.iter().rev() {
            self.reinsert(node, from);
        }
        self.refit(made);
    }

    /// Restructure a treelet; its root's box is unchanged.
    pub fn regrow(&mut self, treelet: &Treelet) {
        let leaves = treelet.leaves.iter().map(|&leaf| {
            let i = leaf as usize;
            (self.boxes[i], self.areas[i], self.links[i], self.sizes[i])
        });
        let leaves: Vec<_> = leaves.collect();
        let mut pairs = treelet.pairs.iter().copied();
        // Sets of leaves with their nodes. A parent is completed after both children.
        let (mut open, mut made) =
            (vec![(((1u32 << leaves.len()) - 1) as u8, treelet.root)], Vec::with_capacity(leaves.len()));
        while let Some((set, node)) = open.pop() {
            let at = node as usize;
            if set.is_power_of_two() {
                (self.boxes[at], self.areas[at], self.links[at], self.sizes[at]) =
                    leaves[set.trailing_zeros() as usize];
                self.own(node);
            } else {
                let first = pairs.next().expect("one leaf less than pairs and the root have places for");
                self.links[at] = first;
                self.own(node);
                let left = treelet.left[set as usize];
                open.extend([(left, first), (set & !left, first + 1)]);
                made.push(at);
            }
        }
        for &at in made.iter().rev() {
            let left = self.links[at] as usize;
            self.boxes[at] = self.boxes[left].union(&self.boxes[left + 1]);
            self.areas[at] = self.boxes[at].half_area();
            self.sizes[at] = Size::above(self.sizes[left], self.sizes[left + 1]);
        }
    }

    /// Recompute the size of an inner node from its children.
    pub fn measure(&mut self, node: u32) {
        if let Some(left) = self.below(node) {
            self.sizes[node as usize] = Size::above(self.size(left), self.size(left + 1));
        }
    }

    /// Return whether a node is in the subtree of another.
    fn is_within(&self, mut node: u32, root: u32) -> bool {
        while node != root && node != 0 {
            node = self.parent(node);
        }
        node == root
    }

    /// Remove a subtree and make it the sibling of the node at `to`. Pairs remain pairs, so only three nodes change.
    /// The former sibling replaces its parent, the node at `to` takes the sibling's place, and the pair becomes the
    /// children of `to`. Doing the same with the former parent as `to` undoes it.
    fn reinsert(&mut self, node: u32, to: u32) {
        let (from, beside) = (self.parent(node), sibling(node));
        self.put(from, beside);
        self.put(beside, to);
        self.links[to as usize] = node.min(beside);
        self.own(to);
    }

    /// Copy a node to another place.
    fn put(&mut self, to: u32, from: u32) {
        let (to_index, from_index) = (to as usize, from as usize);
        self.boxes[to_index] = self.boxes[from_index];
        self.areas[to_index] = self.areas[from_index];
        self.links[to_index] = self.links[from_index];
        self.sizes[to_index] = self.sizes[from_index];
        self.own(to);
    }

    /// Recompute boxes and sizes above the moved subtrees; return the saved area.
    fn refit(&mut self, made: &[Made]) -> f64 {
        self.time += 1;
        for &Made { from, to, .. } in made {
            for mut at in [from, to] {
                while self.marks[at as usize] != self.time {
                    self.marks[at as usize] = self.time;
                    if at != 0 {
                        at = self.parent(at);
                    }
                }
            }
        }
        self.refit_marked(0)
    }

    fn refit_marked(&mut self, node: u32) -> f64 {
        let at = node as usize;
        let Some(left) = self.below(node).filter(|_| self.marks[at] == self.time) else { return 0.0 };
        let saved = self.refit_marked(left) + self.refit_marked(left + 1);
        let before = self.area(node);
        let left = left as usize;
        self.boxes[at] = self.boxes[left].union(&self.boxes[left + 1]);
        self.areas[at] = self.boxes[at].half_area();
        self.sizes[at] = Size::above(self.sizes[left], self.sizes[left + 1]);
        saved + f64::from(before) - f64::from(self.area(node))
    }

    /// The whole tree, with the original subtrees from `from`, in depth-first order.
    pub fn lay_out(&self, from: &BinaryBvh) -> BinaryBvh {
        let mut nodes: Vec<Node> = parallel::collect(from.nodes.len(), |_| Node::leaf(Aabb::EMPTY, 0, 0));
        let mut order = vec![0; from.order.len()];
        let (root, below) = nodes.split_at_mut(1);
        self.place(from, 0, &mut root[0], Target { base: 1, below, first: 0, order: &mut order });
        BinaryBvh { nodes, order }
    }

    fn place(&self, from: &BinaryBvh, node: u32, root: &mut Node, to: Target) {
        /// Smaller subtrees are written by one thread.
        const PARALLEL: u32 = 4096;
        let Some(left) = self.below(node) else {
            to.copy(from, (self.links[node as usize] & !LEAF) as usize, root);
            return;
        };
        *root = Node::inner(self.bounds(node).aabb(), to.base);
        let ([left_root, right_root], [left_to, right_to]) = to.split(self.size(left));
        let place_left = || self.place(from, left, left_root, left_to);
        let place_right = || self.place(from, left + 1, right_root, right_to);
        if self.size(node).nodes < PARALLEL {
            place_left();
            place_right();
        } else {
            parallel::join(place_left, place_right);
        }
    }
}

/// The destination of a subtree.
struct Target<'a> {
    /// The index of the first node below its root.
    base: u32,
    below: &'a mut [Node],
    /// The index of its first primitive in the order.
    first: u32,
    order: &'a mut [u32],
}

impl<'a> Target<'a> {
    /// Reserve two children, and split the space for the nodes below them.
    fn split(self, left: Size) -> ([&'a mut Node; 2], [Self; 2]) {
        let Self { base, below, first, order } = self;
        let (children, below) = below.split_at_mut(2);
        let [left_root, right_root] = children else { unreachable!("split_at_mut(2) gives two") };
        let (left_below, right_below) = below.split_at_mut(left.nodes as usize - 1);
        let (left_order, right_order) = order.split_at_mut(left.primitives as usize);
        let right_base = base + 2 + left_below.len() as u32;
        let left_to = Self { base: base + 2, below: left_below, first, order: left_order };
        let right_to =
            Self { base: right_base, below: right_below, first: first + left.primitives, order: right_order };
        ([left_root, right_root], [left_to, right_to])
    }

    /// Copy an original subtree.
    fn copy(self, from: &BinaryBvh, at: usize, root: &mut Node) {
        // In depth-first order its nodes and primitives are contiguous.
        let own = &from.nodes[at];
        let start = if own.is_leaf() { 0 } else { own.index };
        let below = &from.nodes[start as usize..start as usize + self.below.len()];
        let leaves = below.iter().chain([own]).filter(|n| n.is_leaf());
        let first = leaves.map(|n| n.index).min().expect("a tree ends in leaves");
        let moved = |n: &Node| {
            let index = if n.is_leaf() { n.index - first + self.first } else { n.index - start + self.base };
            Node { index, ..*n }
        };
        *root = moved(own);
        for (to, n) in self.below.iter_mut().zip(below) {
            *to = moved(n);
        }
        self.order.copy_from_slice(&from.order[first as usize..first as usize + self.order.len()]);
    }
}
