//! Chores of the project, one file per verb; continuous integration calls the same commands as a person.
//!
//! | verb | what it does |
//! |---|---|
//! | `check` | formatting, lints, documentation, layering of the library's rooms |
//! | `test`  | `check`, the Rust tests, and the cross-boundary tests in programs that are not ours |
//! | `train` | rebuilds the committed model from nothing |
//! | `bench` | the library's benchmarks |
//! | `package` | what is handed to users, in `target/dist` |
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
    /// Formatting, lints and documentation without a warning, and the layering of the library's rooms
    Check,
    /// All tests; installs what they need into target/test-env first
    Test {
        /// One part alone
        #[arg(long, value_enum)]
        only: Option<test::Part>,
    },
    /// Rebuild model/anthronet.safetensors from nothing; what follows goes to `anthronet train generator`
    Train {
        /// Handed on as they are
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Benchmarks of the library; what follows goes to `cargo bench`
    Bench {
        /// Handed on as they are
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
    /// Make what is handed to users, in target/dist
    Package {
        /// What
        #[arg(value_enum)]
        kind: package::Kind,
    },
    /// Rewrite generated files: ffi/include/anthronet.h, the bindings of C# and Python, the pictures in docs
    Gen {
        /// One kind alone
        #[arg(long, value_enum)]
        only: Option<r#gen::Kind>,
    },
    /// Rewrite tests/golden/hashes.json; look at the difference before you commit it
    Bless,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().verb {
        Verb::Check => check::run(),
        Verb::Test { only } => test::run(only),
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
