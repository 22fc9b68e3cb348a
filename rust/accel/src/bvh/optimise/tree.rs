//! A binary tree whose subtrees can be moved.

use crate::bvh::build::Bounds;
use crate::bvh::{BinaryBvh, Node};
use raywright_base::math::Aabb;
use raywright_base::parallel;

/// A tree whose nodes know what is above them. Its leaves are whole subtrees of the tree that it was made of.
///
/// Node 0 is the root; pairs of children fill the rest, in any order.
pub struct Tree {
    boxes: Vec<Bounds>,
    /// Half the surface of every box.
    areas: Vec<f32>,
    /// Of an inner node, the first of its children; of a leaf, [`LEAF`] and the node that it stands for.
    links: Vec<u32>,
    sizes: Vec<Size>,
    /// By pair, the node whose children they are.
    parents: Vec<u32>,
    /// When a node last was part of a move, or above one.
    marks: Vec<u32>,
    time: u32,
}

/// Marks the links of leaves.
const LEAF: u32 = 1 << 31;

/// What there is in a subtree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    nodes: u32,
    primitives: u32,
    /// The longest way down to a leaf.
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

/// A subtree and a place for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The root of the subtree.
    pub node: u32,
    /// Whose sibling it becomes.
    pub to: u32,
}

/// A move that was made.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    node: u32,
    /// The parent that it had.
    from: u32,
    to: u32,
}

/// Some nodes below a node, and how they are to hang together.
pub struct Treelet {
    /// The node.
    pub root: u32,
    /// Nodes whose subtrees stay as they are.
    pub leaves: Vec<u32>,
    /// The pairs between them and the root, by the first of each: one less than leaves.
    pub pairs: Vec<u32>,
    /// Of every set of leaves that has a node, those on the left, each leaf as a bit.
    pub left: Box<[u8; 128]>,
}

/// The pair that a node is one of; not of the root.
#[inline(always)]
fn pair(node: u32) -> usize {
    (node as usize - 1) / 2
}

/// The other child of a node's parent.
#[inline(always)]
pub fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

impl Tree {
    /// A tree whose leaves are the largest subtrees of at most so many primitives. `bvh` is not empty.
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

    /// Takes over what is below a node, children before their parents; what links to it, and its size.
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

    /// Tells the children of a node whose they are.
    fn own(&mut self, node: u32) {
        if let Some(children) = self.below(node) {
            self.parents[pair(children)] = node;
        }
    }

    /// How many nodes it has.
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

    /// The longest way from the root down, to the leaves of the tree that it was made of.
    pub fn height(&self) -> u32 {
        self.size(0).height
    }

    /// The longest way from a node down.
    pub fn height_of(&self, node: u32) -> u32 {
        self.size(node).height
    }

    /// The first of the children of an inner node.
    #[inline(always)]
    pub fn below(&self, node: u32) -> Option<u32> {
        let link = self.links[node as usize];
        (link & LEAF == 0).then_some(link)
    }

    /// The parent of a node, which is not the root.
    #[inline(always)]
    pub fn parent(&self, node: u32) -> u32 {
        self.parents[pair(node)]
    }

    /// The areas of all nodes.
    pub fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// What the inner nodes cost: their area.
    pub fn cost(&self) -> f64 {
        (0..self.len() as u32).filter(|&n| self.below(n).is_some()).map(|n| f64::from(self.area(n))).sum()
    }

    /// Makes the moves that do not get into each other's way, the first ones first; which they are, and how much area
    /// they save in all.
    pub fn apply(&mut self, moves: impl IntoIterator<Item = Move>) -> (Vec<Made>, f64) {
        self.time += 1;
        let (mut made, mut saved) = (Vec::new(), 0.0);
        for Move { node, to } in moves {
            let from = self.parent(node);
            let around = [node, sibling(node), from, to, if to == 0 { 0 } else { self.parent(to) }];
            // No subtree moves into itself, but the place may have moved there meanwhile.
            if around.iter().any(|&n| self.marks[n as usize] == self.time) || self.is_within(to, node) {
                continue;
            }
            for n in around {
                self.marks[n as usize] = self.time;
            }
            // Until it is refitted, the new parent has the box of what it stands above.
            saved += f64::from(self.area(from)) - f64::from(self.area(to));
            self.reinsert(node, to);
            made.push(Made { node, from, to });
        }
        saved += self.refit(&made);
        (made, saved)
    }

    /// Takes moves back.
    pub fn undo(&mut self, made: &[Made]) {
        for &Made { node, from, .. } in made.iter().rev() {
            self.reinsert(node, from);
        }
        self.refit(made);
    }

    /// Puts a treelet's inner nodes together anew; the box around it stays as it is.
    pub fn regrow(&mut self, treelet: &Treelet) {
        let leaves = treelet.leaves.iter().map(|&leaf| {
            let i = leaf as usize;
            (self.boxes[i], self.areas[i], self.links[i], self.sizes[i])
        });
        let leaves: Vec<_> = leaves.collect();
        let mut pairs = treelet.pairs.iter().copied();
        // A set of leaves and the node that is to hold it; what holds two is made when both are.
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

    /// Takes the size of an inner node from its children, which have changed.
    pub fn measure(&mut self, node: u32) {
        if let Some(left) = self.below(node) {
            self.sizes[node as usize] = Size::above(self.size(left), self.size(left + 1));
        }
    }

    /// Whether a node lies in the subtree of another.
    fn is_within(&self, mut node: u32, root: u32) -> bool {
        while node != root && node != 0 {
            node = self.parent(node);
        }
        node == root
    }

    /// Takes out a subtree and makes it the sibling of what stands at `to`. Pairs stay pairs, so only three nodes
    /// change: the sibling left behind takes the parent's place, what stood at `to` the sibling's, and the pair hangs
    /// below `to`. The same with the former parent for `to` takes it back.
    fn reinsert(&mut self, node: u32, to: u32) {
        let (from, beside) = (self.parent(node), sibling(node));
        self.put(from, beside);
        self.put(beside, to);
        self.links[to as usize] = node.min(beside);
        self.own(to);
    }

    /// Puts what stands at one place at another.
    fn put(&mut self, to: u32, from: u32) {
        let (to_index, from_index) = (to as usize, from as usize);
        self.boxes[to_index] = self.boxes[from_index];
        self.areas[to_index] = self.areas[from_index];
        self.links[to_index] = self.links[from_index];
        self.sizes[to_index] = self.sizes[from_index];
        self.own(to);
    }

    /// Makes boxes and sizes right above what has moved; how much area that saves.
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

    /// The whole tree, with what its leaves stand for in `from`, laid out depth first as builders do it.
    pub fn lay_out(&self, from: &BinaryBvh) -> BinaryBvh {
        let mut nodes: Vec<Node> = parallel::collect(from.nodes.len(), |_| Node::leaf(Aabb::EMPTY, 0, 0));
        let mut order = vec![0; from.order.len()];
        let (root, below) = nodes.split_at_mut(1);
        self.place(from, 0, &mut root[0], Target { base: 1, below, first: 0, order: &mut order });
        BinaryBvh { nodes, order }
    }

    fn place(&self, from: &BinaryBvh, node: u32, root: &mut Node, to: Target) {
        /// Subtrees of fewer nodes are placed by one thread.
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

/// Where a subtree is laid out.
struct Target<'a> {
    /// The number of the first node below its root.
    base: u32,
    below: &'a mut [Node],
    /// The place of its first primitive in the order.
    first: u32,
    order: &'a mut [u32],
}

impl<'a> Target<'a> {
    /// Where two children stand, and where what is below them goes.
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

    /// Moves a subtree here as it is.
    fn copy(self, from: &BinaryBvh, at: usize, root: &mut Node) {
        // Depth first, the nodes below it and its primitives lie together.
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
