//! How much of a blend each joint takes.

use crate::skeleton::Skeleton;
use crate::{Error, Result};

/// How much each joint takes part: 0 not at all, 1 fully.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMask {
    weights: Vec<f32>,
}

impl JointMask {
    /// Every joint.
    pub fn all(rest: &Skeleton) -> Self {
        Self { weights: vec![1.0; rest.len()] }
    }

    /// A share of each joint.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there is not one per joint, or one is not in 0..=1.
    pub fn of_weights(rest: &Skeleton, weights: &[f32]) -> Result<Self> {
        if weights.len() != rest.len() {
            let message = format!("expected {} joints, got {}", rest.len(), weights.len());
            return Err(Error::invalid("joint mask", message));
        }
        if let Some(joint) = weights.iter().position(|weight| !(0.0..=1.0).contains(weight)) {
            let (name, weight) = (&rest.names()[joint], weights[joint]);
            return Err(Error::invalid("joint mask", format!("`{name}`: expected 0 to 1, got {weight}")));
        }
        Ok(Self { weights: weights.to_vec() })
    }

    /// The joints below and including those named: `spine_01` is the upper body, `pelvis` everything that moves.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming a joint that is missing.
    pub fn below(rest: &Skeleton, names: &[&str]) -> Result<Self> {
        let mut weights = vec![0.0; rest.len()];
        for name in names {
            weights[rest.require(name)?] = 1.0;
        }
        for (joint, parent) in rest.parents().iter().enumerate() {
            if parent.is_some_and(|p| weights[p as usize] > 0.0) {
                weights[joint] = 1.0;
            }
        }
        Ok(Self { weights })
    }

    /// The share of a joint; 0 for one that does not exist.
    pub fn weight(&self, joint: usize) -> f32 {
        self.weights.get(joint).copied().unwrap_or(0.0)
    }
}
