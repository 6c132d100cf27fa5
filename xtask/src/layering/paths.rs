//! Every path in a source file that starts at the crate's root, parsed by syn.

use proc_macro2::{Delimiter, Ident, TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Item, ItemMod, ItemUse, Path, UseTree, Visibility};

/// The line and first name of every path from the crate's root in a file that lies `depth` modules deep, by line.
pub(super) fn root_uses(source: &str, depth: usize) -> syn::Result<Vec<(usize, String)>> {
    let mut paths = Paths { depth, found: Vec::new() };
    paths.visit_file(&syn::parse_file(source)?);
    paths.found.sort_by_key(|(line, _)| *line);
    Ok(paths.found)
}

/// What the root re-exports, each name with the room it comes from: `pub use error::{Error, Result};`.
pub(super) fn root_names(lib: &syn::File) -> Vec<(String, String)> {
    let mut names = Vec::new();
    for item in &lib.items {
        if let Item::Use(ItemUse { tree: UseTree::Path(path), vis: Visibility::Public(_), .. }) = item {
            leaves(&path.tree, &path.ident.to_string(), &mut names);
        }
    }
    names
}

/// The names that a tree of uses ends in.
fn leaves(tree: &UseTree, room: &str, names: &mut Vec<(String, String)>) {
    match tree {
        UseTree::Path(path) => leaves(&path.tree, room, names),
        UseTree::Name(name) => names.push((name.ident.to_string(), room.to_owned())),
        UseTree::Rename(name) => names.push((name.rename.to_string(), room.to_owned())),
        UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, room, names)),
        _ => {}
    }
}

/// The module that the names of a path so far lead to.
#[derive(Clone, Copy)]
enum Place {
    /// The module that contains the path, or this many modules above it.
    Above(usize),
    /// The crate's root: the next name is one of its items.
    Root,
}

struct Paths {
    /// Number of modules around the current code, inline ones included.
    depth: usize,
    found: Vec<(usize, String)>,
}

impl Paths {
    /// The module after one more name; `None` when the path cannot reach the root any more. Records a name at the root.
    fn step(&mut self, place: Place, name: &Ident) -> Option<Place> {
        match place {
            Place::Root => {
                self.note(name.span(), &name.to_string());
                None
            }
            Place::Above(_) if name == "crate" => Some(Place::Root),
            Place::Above(0) if name == "self" => Some(place),
            Place::Above(n) if name == "super" && n + 1 < self.depth => Some(Place::Above(n + 1)),
            Place::Above(_) if name == "super" => Some(Place::Root),
            Place::Above(_) => None,
        }
    }

    fn note(&mut self, span: proc_macro2::Span, name: &str) {
        // `crate::{self}` names the root itself.
        if name != "self" {
            self.found.push((span.start().line, name.to_owned()));
        }
    }

    fn tree(&mut self, tree: &UseTree, place: Place) {
        match tree {
            UseTree::Path(path) => {
                if let Some(place) = self.step(place, &path.ident) {
                    self.tree(&path.tree, place);
                }
            }
            UseTree::Name(name) => drop(self.step(place, &name.ident)),
            UseTree::Rename(name) => drop(self.step(place, &name.ident)),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.tree(tree, place)),
            // A glob of the root is every room, which no row of the table allows.
            UseTree::Glob(glob) if matches!(place, Place::Root) => {
                self.note(glob.star_token.spans[0], "*");
            }
            _ => {}
        }
    }

    /// Paths among the tokens of a macro, which need not parse as Rust: alternating names and `::`, from a name without `::`
    /// before it, and into braces at the end.
    fn tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut i = 0;
        while i < tokens.len() {
            match &tokens[i] {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Ident(_) if !(i >= 2 && is_separator(&tokens[i - 2..])) => {
                    i = self.chain(&tokens, i, Place::Above(0));
                    continue;
                }
                _ => {}
            }
            i += 1;
        }
    }

    /// Follows a path among tokens from its first name; returns where it ends.
    fn chain(&mut self, tokens: &[TokenTree], start: usize, mut place: Place) -> usize {
        let mut i = start;
        while let Some(TokenTree::Ident(name)) = tokens.get(i) {
            let next = self.step(place, name);
            i += 1;
            match next {
                Some(next) if is_separator(&tokens[i..]) => (place, i) = (next, i + 2),
                _ => return i,
            }
        }
        if let Some(TokenTree::Group(group)) = tokens.get(i)
            && group.delimiter() == Delimiter::Brace
        {
            let inner: Vec<TokenTree> = group.stream().into_iter().collect();
            for branch in inner.split(|token| is_mark(token, ',')) {
                self.chain(branch, 0, place);
            }
            return i + 1;
        }
        i
    }
}

/// Whether tokens begin with `::`.
fn is_separator(tokens: &[TokenTree]) -> bool {
    matches!(tokens, [first, second, ..] if is_mark(first, ':') && is_mark(second, ':'))
}

fn is_mark(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(found) if found.as_char() == mark)
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        self.depth += 1;
        visit::visit_item_mod(self, module);
        self.depth -= 1;
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        // `use ::name` is another crate's.
        if item.leading_colon.is_none() {
            self.tree(&item.tree, Place::Above(0));
        }
        visit::visit_item_use(self, item);
    }

    fn visit_path(&mut self, path: &'ast Path) {
        let mut place = path.leading_colon.is_none().then_some(Place::Above(0));
        for segment in &path.segments {
            let Some(reached) = place else { break };
            place = self.step(reached, &segment.ident);
        }
        visit::visit_path(self, path);
    }

    fn visit_token_stream(&mut self, tokens: &'ast TokenStream) {
        self.tokens(tokens.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(source: &str, depth: usize) -> Vec<(usize, String)> {
        root_uses(source, depth).unwrap()
    }

    fn lines<const N: usize>(expected: [(usize, &str); N]) -> Vec<(usize, String)> {
        expected.map(|(line, name)| (line, name.to_owned())).to_vec()
    }

    #[test]
    fn every_way_to_name_the_root_is_found() {
        let source = "use crate::mesh::Topology;\nuse crate::{\n  measure::{self, Sex}, rig::Skeleton,\n  Error};\n\
                      fn f() -> crate::Result<()> { crate::export::gltf::to_glb() }\npub(crate) fn g() {}\n\
                      impl crate::pose::Pose for Vec<crate::skin::Job> {}\npub(in crate::clip) fn h() {}";
        let expected = [
            (1, "mesh"),
            (3, "measure"),
            (3, "rig"),
            (4, "Error"),
            (5, "Result"),
            (5, "export"),
            (7, "pose"),
            (7, "skin"),
            (8, "clip"),
        ];
        assert_eq!(names(source, 2), lines(expected));
    }

    #[test]
    fn super_counts_only_where_it_reaches_the_root() {
        let source = "use super::names;\nuse super::super::body;\nmod tests { use super::super::names; \
                      use super::super::super::export; }\nuse self::super::{super::{mesh, rig as r}, clip};\n\
                      fn f() { super::super::skin::g(super::h()) }";
        let expected = [(2, "body"), (3, "export"), (4, "mesh"), (4, "rig"), (5, "skin")];
        assert_eq!(names(source, 2), lines(expected));
    }

    #[test]
    fn comments_strings_and_characters_are_not_code() {
        let source = "// crate::body\n/* crate::body /* nested */ */\nfn h() { let s = \"crate::body\"; let r = r#\"crate::body\"#;\
                      \nlet c = '\"'; let d = '\\''; fn f<'a>(x: &'a str) { crate::mesh::g() } }";
        assert_eq!(names(source, 1), lines([(4, "mesh")]));
    }

    #[test]
    fn paths_in_macros_are_found() {
        let source = "macro_rules! m { ($x:expr) => {\nuse $crate::{body::Body, mesh::{a, b}};\ncrate::rig::f($x); } }\n\
                      fn f() { assert_eq!(crate::pose::A,\n[super::clip::g(), other::crate_::x]); }\n\
                      #[cfg_attr(test, doc(crate::skin))]\nstruct S;";
        let expected = [(2, "body"), (2, "mesh"), (3, "rig"), (4, "pose"), (5, "clip"), (6, "skin")];
        assert_eq!(names(source, 1), lines(expected));
    }

    #[test]
    fn globs_of_the_root_and_other_crates_are_distinguished() {
        let source =
            "use crate::*;\nuse crate::{self as root, mesh::*};\nuse ::body::Body;\nfn f() { ::body::g() }";
        assert_eq!(names(source, 1), lines([(1, "*"), (2, "mesh")]));
    }

    #[test]
    fn names_of_the_root_belong_to_their_rooms() {
        let lib = "pub mod body;\npub use body::Body;\npub use error::{Error, sub::Why as Reason, Result};\nuse model::Model;";
        let expected = [("Body", "body"), ("Error", "error"), ("Reason", "error"), ("Result", "error")];
        let expected = expected.map(|(name, room)| (name.to_owned(), room.to_owned()));
        assert_eq!(root_names(&syn::parse_file(lib).unwrap()), expected);
    }
}
