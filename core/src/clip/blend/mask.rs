//! Weights of a blend per joint.

use crate::skeleton::Skeleton;
use crate::{Error, Result};

/// One weight per joint for a blend: 0 excludes the joint, 1 includes it fully.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMask {
    weights: Vec<f32>,
}

impl JointMask {
    /// Weight 1 for every joint.
    pub fn all(rest: &Skeleton) -> Self {
        Self { weights: vec![1.0; rest.len()] }
    }

    /// A weight for each joint.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the number of weights is not that of the joints, or one is not in 0..=1.
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

    /// Weight 1 for the named joints and all below them, 0 for the others: `spine_01` selects the upper body.
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

    /// The weight of a joint; 0 for one that does not exist.
    pub fn weight(&self, joint: usize) -> f32 {
        self.weights.get(joint).copied().unwrap_or(0.0)
    }
}
