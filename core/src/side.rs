//! Left and right of the character, and the suffixes of names that say so.

/// A side of the character, from the character's own point of view: +X is its left.
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

    /// Sign of x on this side: 1 on the left, −1 on the right. Rotations about Y and Z change sign with it too when mirrored.
    pub const fn sign(self) -> f32 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// Suffix of this side's joints in our rig: `_l` or `_r`.
    pub const fn joint_suffix(self) -> &'static str {
        match self {
            Self::Left => "_l",
            Self::Right => "_r",
        }
    }

    /// Suffix of this side's measures: `_left` or `_right`.
    pub const fn measure_suffix(self) -> &'static str {
        match self {
            Self::Left => "_left",
            Self::Right => "_right",
        }
    }

    /// The side of a joint of our rig, from the suffix of its name; `None` for a central one.
    pub fn of_joint_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|side| name.ends_with(side.joint_suffix()))
    }

    /// Splits a measure's name into its base name and side: `arm_length_left` gives `("arm_length", Some(Left))`. The
    /// name need not be in the catalogue.
    pub fn split_measure_name(name: &str) -> (&str, Option<Self>) {
        let split = |side: Self| Some((name.strip_suffix(side.measure_suffix())?, Some(side)));
        Self::ALL.into_iter().find_map(split).unwrap_or((name, None))
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
    fn names_have_the_side_as_suffix() {
        assert_eq!(Side::of_joint_name("thigh_r"), Some(Side::Right));
        assert_eq!(Side::of_joint_name("pelvis"), None);
        assert_eq!(Side::split_measure_name("arm_length_left"), ("arm_length", Some(Side::Left)));
        assert_eq!(Side::split_measure_name("height"), ("height", None));
    }
}
