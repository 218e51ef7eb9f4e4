//! A hierarchy of boxes.

use abf_mesh::Point2;

/// An axis-aligned box, its sides included.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Lower left.
    pub low: Point2<f64>,
    /// Upper right.
    pub high: Point2<f64>,
}

impl Extent {
    /// The smallest box around two points.
    #[must_use]
    pub fn around(a: Point2<f64>, b: Point2<f64>) -> Self {
        Self { low: a.inf(&b), high: a.sup(&b) }
    }

    /// The smallest box around two boxes.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// Whether two boxes have a point in common.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
    }

    /// Whether a point is in the box.
    #[must_use]
    pub fn holds(&self, p: Point2<f64>) -> bool {
        self.meets(&Self { low: p, high: p })
    }
}

/// A binary tree of boxes over items, halved at the median of the longer side.
pub struct BoxTree {
    /// The items, those of every node together.
    items: Vec<u32>,
    nodes: Vec<Node>,
}

struct Node {
    extent: Extent,
    /// Where its items are.
    begin: u32,
    end: u32,
    /// Its second child; the first stands right behind it. Zero for a leaf.
    second: u32,
}

impl BoxTree {
    /// The most items of a leaf.
    const LEAF: usize = 8;

    /// A tree of these items, which have these boxes.
    pub fn new(mut items: Vec<u32>, extent: impl Fn(u32) -> Extent) -> Self {
        let mut nodes = Vec::with_capacity(items.len() / 2 + 1);
        if !items.is_empty() {
            grow(&mut items, 0, &mut nodes, &extent);
        }
        Self { items, nodes }
    }

    /// Calls `visit` for every item of the leaves whose box, and the boxes above it, are `wanted`.
    pub fn visit(&self, wanted: impl Fn(&Extent) -> bool, mut visit: impl FnMut(u32)) {
        let mut stack = vec![0];
        while let Some(k) = stack.pop() {
            let Some(node) = self.nodes.get(k).filter(|node| wanted(&node.extent)) else { continue };
            if node.second == 0 {
                self.items_of(node).iter().for_each(|&item| visit(item));
            } else {
                stack.extend([node.second as usize, k + 1]);
            }
        }
    }

    /// Calls `visit` once for every two items of leaves whose boxes meet, until it fails.
    ///
    /// # Errors
    /// Those of `visit`.
    pub fn pairs<E>(&self, mut visit: impl FnMut(u32, u32) -> Result<(), E>) -> Result<(), E> {
        let mut stack = if self.nodes.is_empty() { vec![] } else { vec![(0, 0)] };
        while let Some((j, k)) = stack.pop() {
            let (a, b) = (&self.nodes[j], &self.nodes[k]);
            if j == k {
                if a.second == 0 {
                    let items = self.items_of(a);
                    for (i, &x) in items.iter().enumerate() {
                        items[i + 1..].iter().try_for_each(|&y| visit(x, y))?;
                    }
                } else {
                    let (first, second) = (j + 1, a.second as usize);
                    stack.extend([(first, first), (second, second), (first, second)]);
                }
            } else if a.extent.meets(&b.extent) {
                // The larger of two nodes is opened, until both are leaves.
                let (size_a, size_b) = (a.end - a.begin, b.end - b.begin);
                if a.second != 0 && (b.second == 0 || size_a >= size_b) {
                    stack.extend([(j + 1, k), (a.second as usize, k)]);
                } else if b.second != 0 {
                    stack.extend([(j, k + 1), (j, b.second as usize)]);
                } else {
                    for &x in self.items_of(a) {
                        self.items_of(b).iter().try_for_each(|&y| visit(x, y))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn items_of(&self, node: &Node) -> &[u32] {
        &self.items[node.begin as usize..node.end as usize]
    }
}

/// Adds the node of these items and all below it; `begin` is where they stand among all.
fn grow(items: &mut [u32], begin: usize, nodes: &mut Vec<Node>, extent: &impl Fn(u32) -> Extent) {
    let bounds = items.iter().map(|&i| extent(i)).reduce(Extent::with).expect("a node has items");
    let (this, end) = (nodes.len(), begin + items.len());
    nodes.push(Node { extent: bounds, begin: begin as u32, end: end as u32, second: 0 });
    if items.len() <= BoxTree::LEAF {
        return;
    }
    let size = bounds.high - bounds.low;
    let axis = usize::from(size.y > size.x);
    let centre = |i: u32| {
        let e = extent(i);
        e.low[axis] + e.high[axis]
    };
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
    let (low, high) = items.split_at_mut(half);
    grow(low, begin, nodes, extent);
    nodes[this].second = nodes.len() as u32;
    grow(high, begin + half, nodes, extent);
}
