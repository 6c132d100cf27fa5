//! Requests: the input of a model.

use anthronet::Error;
use anthronet::measure::expand_name;

use crate::Result;
use crate::bridge::ffi;
use crate::enums::{Meaning, finite};

pub(crate) struct Request(pub(crate) anthronet::condition::Request);

impl Request {
    pub(crate) fn create() -> Box<Self> {
        Box::new(Self(anthronet::condition::Request::default()))
    }

    pub(crate) fn from_json(json: &str) -> Result<Box<Self>> {
        Ok(Box::new(Self(anthronet::condition::Request::from_json(json)?)))
    }

    pub(crate) fn copy(&self) -> Box<Self> {
        Box::new(Self(self.0.clone()))
    }

    pub(crate) fn to_json(&self) -> String {
        self.0.to_json()
    }

    pub(crate) fn set(&mut self, name: &str, metres: f64) -> Result<&mut Self> {
        finite(name, metres)?;
        self.0.set(name, metres)?;
        Ok(self)
    }

    pub(crate) fn unset(&mut self, name: &str) -> Result<&mut Self> {
        let ids = expand_name(name).ok_or_else(|| Error::request(name, "is not a measure"))?;
        for id in ids {
            self.0.measures[id.index()] = None;
        }
        Ok(self)
    }

    pub(crate) fn set_sex(&mut self, sex: ffi::Sex) -> Result<&mut Self> {
        self.0.sex = sex.meaning()?;
        Ok(self)
    }

    pub(crate) fn set_seed(&mut self, seed: u64) -> &mut Self {
        self.0.seed = seed;
        self
    }

    pub(crate) fn set_latent(&mut self, latent: &[f64]) -> Result<&mut Self> {
        for (i, value) in latent.iter().enumerate() {
            finite(&format!("latent {i}"), *value)?;
        }
        self.0.z = (!latent.is_empty()).then(|| latent.to_vec());
        Ok(self)
    }

    pub(crate) fn set_fill(&mut self, fill: ffi::Fill) -> Result<&mut Self> {
        self.0.fill = fill.meaning()?;
        Ok(self)
    }

    pub(crate) fn set_nearest(&mut self, nearest: bool) -> &mut Self {
        self.0.nearest = nearest;
        self
    }
}
