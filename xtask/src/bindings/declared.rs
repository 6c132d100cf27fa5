//! The public declarations in the sources of `ffi`, parsed by syn: constants, structures, callbacks and functions.

use crate::tools;
use anyhow::{Result, anyhow};
use std::collections::BTreeMap;
use std::path::PathBuf;
use syn::spanned::Spanned as _;
use syn::{
    Expr, FnArg, GenericArgument, Item, Lit, Pat, PathArguments, PointerMutability, ReturnType, Visibility,
};

/// A type of the interface.
#[derive(Clone)]
pub(super) enum Type {
    /// A number, a structure, a handle, a callback or an alias: by the last name of its path.
    Named(String),
    Array(Box<Type>, u64),
    Pointer {
        constant: bool,
        to: Box<Type>,
    },
}

/// A function of the library or a callback of the caller.
pub(super) struct Function {
    pub(super) name: String,
    /// Names, empty where a callback has none, and types.
    pub(super) parameters: Vec<(String, Type)>,
    pub(super) result: Option<Type>,
}

/// All declarations, each kind in the order of the sources.
#[derive(Default)]
pub(super) struct Declared {
    /// Names and values.
    pub(super) constants: Vec<(String, String)>,
    /// Other names of types.
    pub(super) aliases: BTreeMap<String, Type>,
    pub(super) callbacks: Vec<Function>,
    /// `#[repr(C)]` structures with their fields; all others are opaque handles.
    pub(super) structures: Vec<(String, Vec<(String, Type)>)>,
    pub(super) functions: Vec<Function>,
}

impl Declared {
    /// Reads source files. An unsupported declaration is an error that names its line.
    pub(super) fn read(sources: impl Iterator<Item = PathBuf>) -> Result<Self> {
        let mut declared = Self::default();
        for path in sources {
            let in_file = |e: syn::Error| anyhow!("{}:{}: {e}", path.display(), e.span().start().line);
            let file = syn::parse_file(&tools::read(&path)?).map_err(in_file)?;
            for item in file.items {
                declared.item(item).map_err(in_file)?;
            }
        }
        Ok(declared)
    }

    pub(super) fn fields(&self, structure: &str) -> Option<&[(String, Type)]> {
        let found = self.structures.iter().find(|(name, _)| name == structure)?;
        Some(&found.1)
    }

    fn item(&mut self, item: Item) -> syn::Result<()> {
        match item {
            Item::Const(item) if is_public(&item.vis) => {
                self.constants.push((item.ident.to_string(), number(&item.expr)?.to_owned()));
            }
            Item::Type(item) if is_public(&item.vis) => {
                let name = item.ident.to_string();
                match optional_callback(&item.ty) {
                    Some(called) => {
                        let parameters = called.inputs.iter().map(|parameter| {
                            let name = parameter
                                .name
                                .as_ref()
                                .map_or_else(String::new, |(name, _)| name.to_string());
                            Ok((name, Type::of(&parameter.ty)?))
                        });
                        let parameters = parameters.collect::<syn::Result<_>>()?;
                        self.callbacks.push(Function { name, parameters, result: result(&called.output)? });
                    }
                    None => drop(self.aliases.insert(name, Type::of(&item.ty)?)),
                }
            }
            Item::Struct(item) if is_public(&item.vis) && item.attrs.iter().any(is_laid_out_as_in_c) => {
                let fields = item.fields.iter().map(|field| {
                    let name = field
                        .ident
                        .as_ref()
                        .ok_or_else(|| syn::Error::new(field.span(), "a field without a name"))?;
                    Ok((name.to_string(), Type::of(&field.ty)?))
                });
                self.structures.push((item.ident.to_string(), fields.collect::<syn::Result<_>>()?));
            }
            Item::Fn(item) if is_public(&item.vis) && item.sig.abi.is_some() => {
                let parameters = item.sig.inputs.iter().map(|parameter| match parameter {
                    FnArg::Typed(typed) => match &*typed.pat {
                        Pat::Ident(name) => Ok((name.ident.to_string(), Type::of(&typed.ty)?)),
                        other => Err(syn::Error::new(other.span(), "a parameter without a name")),
                    },
                    FnArg::Receiver(own) => Err(syn::Error::new(own.span(), "a method is not for C")),
                });
                self.functions.push(Function {
                    name: item.sig.ident.to_string(),
                    parameters: parameters.collect::<syn::Result<_>>()?,
                    result: result(&item.sig.output)?,
                });
            }
            _ => {}
        }
        Ok(())
    }
}

impl Type {
    fn of(written: &syn::Type) -> syn::Result<Self> {
        let unknown = || syn::Error::new(written.span(), "a type that is not known in C");
        Ok(match written {
            syn::Type::Path(named) => {
                Self::Named(named.path.segments.last().ok_or_else(unknown)?.ident.to_string())
            }
            syn::Type::Ptr(pointer) => Self::Pointer {
                constant: matches!(pointer.mutability, PointerMutability::Const(_)),
                to: Box::new(Self::of(&pointer.elem)?),
            },
            syn::Type::Array(array) => {
                let count = number(&array.len)?.parse().map_err(|_| unknown())?;
                Self::Array(Box::new(Self::of(&array.elem)?), count)
            }
            _ => return Err(unknown()),
        })
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Whether an attribute is `#[repr(C)]`.
fn is_laid_out_as_in_c(attribute: &syn::Attribute) -> bool {
    attribute.path().is_ident("repr") && attribute.parse_args::<syn::Ident>().is_ok_and(|word| word == "C")
}

/// The function of `Option<extern "C" fn(…)>`, which C takes as a pointer that may be NULL.
fn optional_callback(written: &syn::Type) -> Option<&syn::TypeFnPtr> {
    let syn::Type::Path(option) = written else { return None };
    let PathArguments::AngleBracketed(inner) = &option.path.segments.last()?.arguments else { return None };
    match inner.args.first()? {
        GenericArgument::Type(syn::Type::FnPtr(called)) => Some(called),
        _ => None,
    }
}

fn result(written: &ReturnType) -> syn::Result<Option<Type>> {
    match written {
        ReturnType::Default => Ok(None),
        ReturnType::Type(_, returned) => Type::of(returned).map(Some),
    }
}

/// The digits of a whole number.
fn number(written: &Expr) -> syn::Result<&str> {
    match written {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(number) => Ok(number.base10_digits()),
            other => Err(syn::Error::new(other.span(), "a whole number is expected")),
        },
        other => Err(syn::Error::new(other.span(), "a whole number is expected, written out")),
    }
}
