//! Unique, printable names of the parts of a scene.

use std::collections::BTreeMap;

/// Names in use, each with the last number that was appended to it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Titles(BTreeMap<String, u32>);

impl Titles {
    /// Starts with these names in use.
    pub(crate) fn taken<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        Self(names.map(|name| (name.to_owned(), 0)).collect())
    }

    /// The name without control characters, with a number appended where it is in use; `unnamed` for an empty one.
    pub(crate) fn unique(&mut self, name: &str) -> String {
        let name: String = name.chars().filter(|c| !c.is_control()).collect();
        let name = if name.is_empty() { "unnamed".to_owned() } else { name };
        let mut count = self.0.get(&name).copied().unwrap_or(0);
        let mut title = name.clone();
        while self.0.contains_key(&title) {
            count += 1;
            title = format!("{name} {}", count + 1);
        }
        self.0.insert(title.clone(), 0);
        self.0.insert(name, count);
        title
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_printable() {
        let mut titles = Titles::taken(["Skel"].into_iter());
        let wanted = ["Nail", "Nail 2", "Nail", "Nail", "Nail 2", "Skel", "", "\n", "a\u{7}b", "Nail"];
        let given = wanted.map(|name| titles.unique(name));
        let expected = [
            "Nail",
            "Nail 2",
            "Nail 3",
            "Nail 4",
            "Nail 2 2",
            "Skel 2",
            "unnamed",
            "unnamed 2",
            "ab",
            "Nail 5",
        ];
        assert_eq!(given, expected);
    }
}
