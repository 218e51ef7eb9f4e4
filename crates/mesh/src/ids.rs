//! Typed 32-bit indices. Two billion corners are more than any mesh this project can hold.

use std::fmt;

macro_rules! define_id {
    ($(#[$doc:meta])* $name:ident, $letter:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(u32);

        impl $name {
            /// The id of the `index`-th element, counted from zero.
            ///
            /// # Panics
            /// If `index` does not fit in 32 bits.
            #[inline]
            #[must_use]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("an element index fits in 32 bits"))
            }

            /// The index this id stands for, counted from zero.
            #[inline]
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($letter, "{}"), self.0)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}", self.0)
            }
        }
    };
}

define_id!(
    /// A vertex of the mesh, in the order of the input.
    VertexId,
    "v"
);
define_id!(
    /// A triangle of the mesh, in the order of the input.
    FaceId,
    "f"
);
define_id!(
    /// A corner of a triangle: corner `3f + k` is the `k`-th corner of face `f`.
    CornerId,
    "c"
);
define_id!(
    /// A point of a [`UvMap`](crate::UvMap).
    UvId,
    "uv"
);

impl FaceId {
    /// The three corners of this face, counter-clockwise.
    #[inline]
    #[must_use]
    pub fn corners(self) -> [CornerId; 3] {
        [0, 1, 2].map(|k| self.corner(k))
    }

    /// The `k`-th corner of this face, `k` in `0..3`.
    #[inline]
    #[must_use]
    pub fn corner(self, k: usize) -> CornerId {
        debug_assert!(k < 3);
        CornerId::new(3 * self.index() + k)
    }
}

impl CornerId {
    /// The face this corner belongs to.
    #[inline]
    #[must_use]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// The place of this corner in its face: 0, 1 or 2.
    #[inline]
    #[must_use]
    pub fn place(self) -> usize {
        self.index() % 3
    }

    /// The next corner of the same face, counter-clockwise.
    #[inline]
    #[must_use]
    pub fn next(self) -> Self {
        if self.0 % 3 == 2 { Self(self.0 - 2) } else { Self(self.0 + 1) }
    }

    /// The previous corner of the same face, counter-clockwise.
    #[inline]
    #[must_use]
    pub fn prev(self) -> Self {
        if self.0.is_multiple_of(3) { Self(self.0 + 2) } else { Self(self.0 - 1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_and_prev_stay_in_the_face_and_undo_each_other() {
        for c in (0..12).map(CornerId::new) {
            assert_eq!(c.next().face(), c.face());
            assert_eq!(c.next().prev(), c);
            assert_eq!(c.next().next().next(), c);
        }
    }
}
