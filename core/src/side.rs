//! Left and right of the character.

/// A side of the character, as the character sees it: +X is its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// The character's left, +X.
    Left,
    /// The character's right, −X.
    Right,
}

impl Side {
    /// Both, left first, in the order of [`Side::index`].
    pub const ALL: [Self; 2] = [Self::Left, Self::Right];

    /// 0 for left, 1 for right.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// `left` or `right`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// The other side.
    pub const fn mirrored(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Sign of x on this side: 1 on the left, −1 on the right. Turns about Y and Z mirror by it too.
    pub const fn sign(self) -> f32 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// How names of joints of our rig end on this side: `_l` or `_r`.
    pub const fn joint_suffix(self) -> &'static str {
        match self {
            Self::Left => "_l",
            Self::Right => "_r",
        }
    }

    /// How names of measures end on this side: `_left` or `_right`.
    pub const fn measure_suffix(self) -> &'static str {
        match self {
            Self::Left => "_left",
            Self::Right => "_right",
        }
    }

    /// The side that a joint's name in our rig ends in; `None` for one in the middle.
    pub fn of_joint_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|side| name.ends_with(side.joint_suffix()))
    }

    /// A measure's name parted from the side that it ends in, whether there is such a measure or not:
    /// `("arm_length", Some(Left))` of `arm_length_left`.
    pub fn part_measure_name(name: &str) -> (&str, Option<Self>) {
        let parted = |side: Self| Some((name.strip_suffix(side.measure_suffix())?, Some(side)));
        Self::ALL.into_iter().find_map(parted).unwrap_or((name, None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_mirror_each_other() {
        for side in Side::ALL {
            assert_eq!(Side::ALL[side.index()], side);
            assert_eq!(side.mirrored().mirrored(), side);
            assert_eq!(side.mirrored().sign(), -side.sign());
        }
    }

    #[test]
    fn names_tell_their_side() {
        assert_eq!(Side::of_joint_name("thigh_r"), Some(Side::Right));
        assert_eq!(Side::of_joint_name("pelvis"), None);
        assert_eq!(Side::part_measure_name("arm_length_left"), ("arm_length", Some(Side::Left)));
        assert_eq!(Side::part_measure_name("height"), ("height", None));
    }
}
