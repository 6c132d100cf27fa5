//! Converts arbitrary names to USD identifiers.

use std::collections::BTreeSet;

/// A name as an identifier: ASCII letters, digits and underscores, accepted by every version of USD, without leading digit.
pub(crate) fn identifier(name: &str) -> String {
    let mut identifier: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if identifier.is_empty() || identifier.starts_with(|c: char| c.is_ascii_digit()) {
        identifier.insert(0, '_');
    }
    identifier
}

/// Identifiers in use.
#[derive(Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// Starts with these identifiers in use.
    pub(super) fn reserved<const N: usize>(names: [&str; N]) -> Self {
        Self(names.map(String::from).into())
    }

    /// The name's identifier, with a number appended if it is in use already.
    pub(super) fn unique(&mut self, name: &str) -> String {
        let identifier = identifier(name);
        let numbered = (2..).map(|n| format!("{identifier}_{n}"));
        let mut candidates = std::iter::once(identifier.clone()).chain(numbered);
        let free = candidates.find(|c| !self.0.contains(c)).unwrap_or(identifier);
        self.0.insert(free.clone());
        free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers_and_stay_apart() {
        let mut names = Names::reserved(["Skel"]);
        let given = ["Skel", "mixamorig:Hips", "mixamorig Hips", "2nd", "", "Ärmel"].map(|n| names.unique(n));
        assert_eq!(given, ["Skel_2", "mixamorig_Hips", "mixamorig_Hips_2", "_2nd", "_", "_rmel"]);
    }
}
