//! The joint tree: names and parents of joints, without positions.

use std::collections::BTreeSet;

use crate::{Error, Result};

/// The most joints that a skeleton may have.
pub const MAX_JOINTS: usize = 4096;

/// Names and parents of joints, parents before their children. All skeletons of one rig share it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointTree {
    names: Vec<String>,
    parents: Vec<Option<u32>>,
}

impl JointTree {
    /// A joint tree from names and parents, one entry per joint. Several joints may have no parent.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there is no joint or more than [`MAX_JOINTS`], the lengths differ, a name is empty or
    /// used twice, or a parent does not come before its joint.
    pub fn new(names: Vec<String>, parents: Vec<Option<u32>>) -> Result<Self> {
        let fail = |message: String| Err(Error::invalid("skeleton", message));
        let count = names.len();
        if count == 0 || count > MAX_JOINTS {
            return fail(format!("expected 1 to {MAX_JOINTS} joints, got {count}"));
        }
        if parents.len() != count {
            return fail(format!("{count} names with {} parents", parents.len()));
        }
        let mut seen = BTreeSet::new();
        for (j, (name, parent)) in names.iter().zip(&parents).enumerate() {
            if name.is_empty() || !seen.insert(name) {
                return fail(format!("joint {j}: name `{name}` is empty or taken"));
            }
            if parent.is_some_and(|p| p as usize >= j) {
                return fail(format!("joint `{name}`: parent {parent:?} does not stand before {j}"));
            }
        }
        Ok(Self { names, parents })
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Always false: a joint tree has at least one joint.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Names, each unique.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Index of each joint's parent, which is less than the joint's own; `None` for a root.
    pub fn parents(&self) -> &[Option<u32>] {
        &self.parents
    }

    /// Index of the joint with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// Index of the joint with this name, which must exist.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the joint that is missing.
    pub fn require(&self, name: &str) -> Result<usize> {
        self.find(name).ok_or_else(|| {
            Error::invalid("skeleton", format!("expected a joint `{name}`, which is not there"))
        })
    }

    /// Whether the first joint is the only one without a parent.
    pub fn has_one_root(&self) -> bool {
        self.parents.iter().skip(1).all(Option::is_some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_must_come_first() {
        let names = ["a", "b"].map(String::from).to_vec();
        assert!(JointTree::new(names.clone(), vec![None, Some(1)]).is_err());
        assert!(!JointTree::new(names.clone(), vec![None, None]).unwrap().has_one_root());
        assert!(JointTree::new(vec!["a".into(), "a".into()], vec![None, Some(0)]).is_err());
        assert!(JointTree::new(names, vec![None]).is_err());
    }
}
