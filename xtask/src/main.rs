//! Chores of the project, one file per verb; continuous integration calls the same commands as a person.
//!
//! | verb | what it does |
//! |---|---|
//! | `check` | formatting, lints, documentation, layering of the library's rooms |
//! | `test`  | `check`, the Rust tests, and the cross-boundary tests in programs that are not ours |
//! | `train` | trains the committed model from scratch |
//! | `bench` | the library's benchmarks, skinning beside numpy and PyTorch, and whole runs of the command |
//! | `package` | builds the packages for users, in `target/dist` |
//! | `gen`   | rewrites generated files: the C header, the C# bindings, the pictures in `docs/` |
//! | `bless` | rewrites the goldens in `tests/golden/` after an intended change |

mod bench;
mod bindings;
mod bless;
mod check;
mod environment;
mod r#gen;
mod hosts;
mod layering;
mod package;
mod requests;
mod test;
mod tools;
mod train;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Chores of AnthroNet", disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Check formatting, lints, documentation, the layering of the library's rooms and the generated bindings
    Check,
    /// Run all tests; first installs what they need into target/test-env
    Test {
        /// Only this part
        #[arg(long, value_enum)]
        only: Option<test::Part>,
        /// What the part uses is there already: `test` runs itself so for every part
        #[arg(long, hide = true, requires = "only")]
        prepared: bool,
    },
    /// Train model/anthronet.safetensors from scratch; arguments are passed to `anthronet train generator`
    Train {
        /// Arguments passed through
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Run the benchmarks; with arguments only `cargo bench`, which gets them
    Bench {
        /// Arguments passed through
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Build a package for users, in target/dist
    Package {
        /// The package
        #[arg(value_enum)]
        kind: package::Kind,
    },
    /// Rewrite generated files: ffi/include/anthronet.h, the bindings of C# and Python, the pictures in docs
    Gen {
        /// Only this kind
        #[arg(long, value_enum)]
        only: Option<r#gen::Kind>,
    },
    /// Rewrite tests/golden/hashes.json; look at the difference before you commit it
    Bless,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().verb {
        Verb::Check => check::run(),
        Verb::Test { only, prepared } => test::run(only, prepared),
        Verb::Train { rest } => train::run(&rest),
        Verb::Bench { rest } => bench::run(&rest),
        Verb::Package { kind } => package::run(kind),
        Verb::Gen { only } => r#gen::run(only),
        Verb::Bless => bless::run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
