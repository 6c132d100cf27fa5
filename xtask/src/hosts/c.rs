//! The C ABI from C99 and C++17: results, refused arguments, leaks, exported symbols.
//!
//! The programs are in `tests/c`. gcc, and clang if installed, compile them without a warning; they run under the
//! sanitizers and valgrind. The library itself is not instrumented, which stable Rust does not support.

use super::Tally;
use crate::bindings::HEADER;
use crate::tools::{self, Available, cargo};
use anyhow::{Error, Result, anyhow, bail};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Strict; beyond C99 the programs need threads and clocks of POSIX.
const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-D_POSIX_C_SOURCE=200809L"];
const C99: [&str; 1] = ["-std=c99"];
const CPP17: [&str; 3] = ["-std=c++17", "-x", "c++"];
const SANITIZERS: [&str; 3] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g"];
/// System libraries that the static library needs.
const SYSTEM: [&str; 5] = ["-lstdc++", "-lgcc_s", "-lpthread", "-ldl", "-lm"];

const VALUES: [&str; 7] = [
    "check.c",
    "values_main.c",
    "values_model.c",
    "values_mesh.c",
    "values_skin.c",
    "values_motion.c",
    "values_export.c",
];
const ABUSE: [&str; 7] = [
    "check.c",
    "abuse_main.c",
    "abuse_pointers.c",
    "abuse_numbers.c",
    "abuse_jobs.c",
    "abuse_files.c",
    "abuse_threads.c",
];

/// Cycles of generate and free.
const CYCLES: &str = "10000";
/// Limit of the growth of the resident set meanwhile, MiB: less than three bodies.
const GROWTH: &str = "4";

const MEBIBYTE: u64 = 1 << 20;
/// Limit of the size of the stripped library.
const LARGEST: u64 = 40 * MEBIBYTE;
/// Libraries that it may need: those of glibc, and the unwinder, which comes with every C++ runtime.
const NEEDED: [&str; 4] = ["libc.so", "libm.so", "libgcc_s.so", "ld-linux"];
/// The newest glibc that it may need, by the platform tag of the wheels: manylinux_2_34.
const GLIBC: (u32, u32) = (2, 34);

pub(crate) fn run(programs: &Available<()>, folder: &Path, tally: &mut Tally) -> Result<()> {
    let folder = folder.join("c");
    tools::create_folder(&folder)?;
    tally.case("every function has a test in C", every_function_is_called());
    if let Err(reason) = programs {
        for name in
            ["the C ABI from C and C++", "the C ABI under sanitizers and valgrind", "exports of the library"]
        {
            tally.skip(name, reason);
        }
        return Ok(());
    }
    let bench = Bench { folder, library: tools::target().join("release") };
    exports(&bench, tally);
    // The slow ones first.
    let mut scripts: Vec<_> = leaks(&bench, tally).into_iter().collect();
    scripts.extend(abuse(&bench, tally));
    scripts.extend(values(&bench, tally));
    tally.scripts(scripts);
    same_bytes(&bench, tally)?;
    if let Some(program) = bench.build(tally, "speed", "gcc", &[&C99[..], &["-O2"]].concat(), &["speed.c"]) {
        tally.script("speed of the C ABI", &mut Command::new(program));
    }
    Ok(())
}

/// Where the programs are built, and the folder of the library.
struct Bench {
    folder: PathBuf,
    library: PathBuf,
}

impl Bench {
    /// Compiles a program against the shared library; a program that does not build is a failed case.
    fn build(
        &self,
        tally: &mut Tally,
        name: &str,
        compiler: &str,
        flags: &[&str],
        sources: &[&str],
    ) -> Option<PathBuf> {
        let mut command = self.compiler(compiler, flags, sources, &self.folder.join(name));
        command.arg("-L").arg(&self.library).arg("-lanthronet");
        command.arg(format!("-Wl,-rpath,{}", self.library.display())).args(["-lm", "-lpthread"]);
        self.built(tally, name, &mut command)
    }

    /// Compiles a program with the static library.
    fn build_static(
        &self,
        tally: &mut Tally,
        name: &str,
        flags: &[&str],
        sources: &[&str],
    ) -> Option<PathBuf> {
        let mut command = self.compiler("gcc", flags, sources, &self.folder.join(name));
        command.arg(self.library.join("libanthronet.a")).args(SYSTEM);
        self.built(tally, name, &mut command)
    }

    fn compiler(&self, compiler: &str, flags: &[&str], sources: &[&str], program: &Path) -> Command {
        let mut command = Command::new(compiler);
        let sources = sources.iter().map(|source| tools::root().join("tests/c").join(source));
        // `-x none`, so that the library is not compiled as C++.
        command.args(WARNINGS).args(flags).args(sources).args(["-x", "none"]).arg("-o").arg(program);
        command
    }

    fn built(&self, tally: &mut Tally, name: &str, command: &mut Command) -> Option<PathBuf> {
        let built = tools::output(command);
        let program = built.is_ok().then(|| self.folder.join(name));
        tally.case(&format!("{name} compiles without a warning"), built.map(drop));
        program
    }

    /// A program with the arguments that `run_tests` of tests/c/check.h takes, in a folder of its own.
    fn tests(&self, program: &Path, before: &[&str]) -> Command {
        let mut command = match before.split_first() {
            None => Command::new(program),
            Some((first, rest)) => {
                let mut command = Command::new(first);
                command.args(rest).arg(program);
                command
            }
        };
        let name = program.file_name().unwrap_or_default().to_string_lossy();
        let folder = self.folder.join(format!("files of {name}"));
        // If that fails the tests report it.
        let _ = std::fs::create_dir_all(&folder);
        command.arg(tools::root().join("model/anthronet.safetensors")).arg(folder);
        command
    }

    /// Likewise under valgrind, with fewer rounds; with its name.
    fn under_valgrind(&self, name: &str, program: &Path) -> (String, Command) {
        let mut command = self.tests(program, &VALGRIND);
        command.arg("few");
        (format!("{name} under valgrind"), command)
    }
}

/// Tests of the results of every function: C99 and C++17, both libraries, both compilers, the sanitizers, valgrind.
fn values(bench: &Bench, tally: &mut Tally) -> Vec<(String, Command)> {
    let clang = tools::output(Command::new("clang").arg("--version")).is_ok();
    let sanitized = |standard: &[&'static str]| [standard, &SANITIZERS].concat();
    let mut programs = vec![
        bench.build(tally, "values in C99 under sanitizers", "gcc", &sanitized(&C99), &VALUES),
        bench.build(tally, "values in C++17 under sanitizers", "g++", &sanitized(&CPP17), &VALUES),
        bench.build_static(tally, "values, linked statically", &C99, &VALUES),
    ];
    if clang {
        programs.push(bench.build(tally, "values in clang's C99", "clang", &C99, &VALUES));
        programs.push(bench.build(tally, "values in clang's C++17", "clang++", &CPP17, &VALUES));
    } else {
        tally.skip("values by clang", "there is no clang");
    }
    let run = |program: PathBuf| {
        let name = program.file_name().unwrap_or_default().to_string_lossy().into_owned();
        (name, bench.tests(&program, &[]))
    };
    let mut scripts: Vec<_> = programs.into_iter().flatten().map(run).collect();
    for (name, compiler, standard) in
        [("values in C99", "gcc", &C99[..]), ("values in C++17", "g++", &CPP17[..])]
    {
        if let Some(program) = bench.build(tally, name, compiler, &[standard, &["-g"]].concat(), &VALUES) {
            scripts.push(bench.under_valgrind(name, &program));
        }
    }
    scripts
}

/// Tests of what every function refuses, under the sanitizers and, with fewer rounds, under valgrind, which checks the
/// library too.
fn abuse(bench: &Bench, tally: &mut Tally) -> Vec<(String, Command)> {
    let mut scripts = Vec::new();
    let sanitized = [&C99[..], &SANITIZERS].concat();
    if let Some(program) = bench.build(tally, "abuse under sanitizers", "gcc", &sanitized, &ABUSE) {
        scripts.push(("abuse under sanitizers".to_owned(), bench.tests(&program, &[])));
    }
    if let Some(program) = bench.build(tally, "abuse", "gcc", &[&C99[..], &["-g"]].concat(), &ABUSE) {
        scripts.push(bench.under_valgrind("abuse", &program));
    }
    scripts
}

/// Fails on invalid reads and writes and on lost memory.
const VALGRIND: [&str; 6] = [
    "valgrind",
    "--quiet",
    "--error-exitcode=9",
    "--leak-check=full",
    "--show-leak-kinds=definite,indirect",
    "--errors-for-leak-kinds=definite,indirect",
];

/// Many bodies made and freed: the resident set does not grow, and valgrind finds no leak after a few.
fn leaks(bench: &Bench, tally: &mut Tally) -> Option<(String, Command)> {
    let flags = [&C99[..], &["-O1", "-g"]].concat();
    let program = bench.build(tally, "cycles", "gcc", &flags, &["cycles.c"])?;
    let mut few = Command::new(VALGRIND[0]);
    // Valgrind delays the reuse of freed memory, so the resident set is not limited.
    few.args(&VALGRIND[1..]).arg(&program).args(["12", "1000000"]);
    let lost = tools::output(&mut few).map(drop);
    tally.case("valgrind finds nothing lost in 12 cycles of generate and free", lost);
    let mut many = Command::new(program);
    many.args([CYCLES, GROWTH]);
    Some(("generate and free".to_owned(), many))
}

/// The same requests through the crate and through the library, as it is released, opened by a Rust program. Writes the lists
/// of requests and of expected hashes for the tests in other languages to `tmp/same_bytes`.
pub(super) fn byte_lists(tally: &mut Tally) {
    let name = "same bytes: 200 requests through the crate and through the library";
    // With the packages, features and profile of the unit tests, which have built it by now; a profile other than the
    // library's makes the test stricter.
    let mut test = cargo("test");
    test.args(tools::EVERYTHING).args(["--test", "same_bytes"]);
    test.env("ANTHRONET_LIBRARY", tools::target().join("release/libanthronet.so"));
    tally.case(name, tools::run(&mut test));
}

/// The same requests through the library opened by a Rust program under checkers, C and C++.
fn same_bytes(bench: &Bench, tally: &mut Tally) -> Result<()> {
    let library = bench.library.join("libanthronet.so");
    // The code is not instrumented; the sanitizer's allocator still finds double frees, leaks, and uses of freed memory by
    // libc.
    let sanitizer = tools::output(Command::new("gcc").arg("-print-file-name=libasan.so"))?;
    let preload = format!("LD_PRELOAD={}", sanitizer.trim());
    let sanitized = ["env", &preload, "ASAN_OPTIONS=detect_leaks=1"];
    for (checker, runner) in [("AddressSanitizer's allocator", &sanitized[..]), ("valgrind", &VALGRIND[..])] {
        let runner = runner.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(",");
        let mut test = cargo("test");
        test.args(tools::EVERYTHING)
            .args(["--test", "same_bytes"])
            .args(["--config", &format!("target.'cfg(unix)'.runner=[{runner}]")])
            .env("ANTHRONET_LIBRARY", &library)
            .env("ANTHRONET_REQUESTS", "4");
        let name = format!("{checker}: a program in Rust that opens the library, 4 requests");
        tally.case(&name, tools::run(&mut test));
    }
    let list = tools::target().join("tmp/same_bytes");
    let expected = tools::read(&list.join("sha256.txt"))?;
    let programs = [
        bench.build(tally, "same bytes in C", "gcc", &["-std=c99", "-O2"], &["same_bytes.c"]),
        bench.build(tally, "same bytes in C++", "g++", &["-std=c++17", "-O2"], &["same_bytes.cpp"]),
    ];
    let requests = list.join("requests.jsonl");
    let hash = |program: &Option<PathBuf>| {
        program.as_ref().map(|program| tools::output(Command::new(program).arg(&requests)))
    };
    let (in_c, in_cpp) = std::thread::scope(|scope| {
        let other = scope.spawn(|| hash(&programs[1]));
        (hash(&programs[0]), other.join().unwrap_or(None))
    });
    for (name, got) in [("same bytes in C: 200 requests", in_c), ("same bytes in C++: 200 requests", in_cpp)]
    {
        if let Some(got) = got {
            tally.case(name, got.and_then(|got| same_lines(&expected, &got)));
        }
    }
    Ok(())
}

/// Fails with the first line that differs.
fn same_lines(expected: &str, got: &str) -> Result<()> {
    let (expected, got): (Vec<_>, Vec<_>) = (expected.lines().collect(), got.lines().collect());
    if expected.len() != got.len() {
        bail!("expected {} lines, got {}", expected.len(), got.len());
    }
    match expected.iter().zip(&got).enumerate().find(|(_, (a, b))| a != b) {
        None => Ok(()),
        Some((i, (a, b))) => Err(anyhow!("request {i}: expected {a}, got {b}")),
    }
}

/// Exported symbols, size and dependencies of the stripped library.
fn exports(bench: &Bench, tally: &mut Tally) {
    let stripped = bench.folder.join("libanthronet.so");
    let made = bench.library.join("libanthronet.so");
    if let Err(why) = tools::output(Command::new("strip").arg("-o").arg(&stripped).arg(&made)) {
        return tally.case("the library is stripped", Err(why));
    }
    let symbols = tools::output(Command::new("nm").args(["-D", "--defined-only"]).arg(&stripped));
    let shown = symbols.and_then(|text| {
        let shown: BTreeSet<_> = text.lines().filter_map(|line| line.split(' ').next_back()).collect();
        let header = tools::read(&tools::root().join(HEADER))?;
        let promised = functions(&header);
        let differ: Vec<_> = shown.symmetric_difference(&promised).copied().collect();
        none("not in both library and header", &differ)
    });
    tally.case("the library exports the functions of the header and nothing else", shown);

    let size = std::fs::metadata(&stripped).map(|file| file.len()).map_err(Error::from);
    let name = format!(
        "stripped it has {} MiB, limit {}",
        size.as_ref().map_or(0, |s| s / MEBIBYTE),
        LARGEST / MEBIBYTE
    );
    tally.case(
        &name,
        size.and_then(|size| if size < LARGEST { Ok(()) } else { Err(anyhow!("{size} bytes")) }),
    );

    let dynamic = tools::output(Command::new("readelf").args(["--wide", "--dynamic"]).arg(&stripped));
    let foreign = dynamic.and_then(|text| {
        let needed = text.lines().filter(|line| line.contains("(NEEDED)"));
        let names = needed.filter_map(|line| line.split(['[', ']']).nth(1));
        none(
            "needed",
            &names.filter(|name| !NEEDED.iter().any(|known| name.starts_with(known))).collect::<Vec<_>>(),
        )
    });
    tally.case("it needs glibc and the unwinder only", foreign);

    let versions = tools::output(Command::new("readelf").args(["--wide", "--version-info"]).arg(&stripped));
    let newest = versions.map(|text| {
        let of = |word: &str| {
            let (major, minor) = word.strip_prefix("GLIBC_")?.split_once('.')?;
            Some((major.parse().ok()?, minor.split('.').next()?.parse().ok()?))
        };
        text.split_whitespace().filter_map(of).max().unwrap_or_default()
    });
    let (major, minor) = GLIBC;
    let old_enough = newest.and_then(|newest: (u32, u32)| match newest <= GLIBC {
        true => Ok(()),
        false => Err(anyhow!("needs {}.{}", newest.0, newest.1)),
    });
    tally.case(&format!("it runs with glibc {major}.{minor}"), old_enough);
}

fn none(what: &str, found: &[&str]) -> Result<()> {
    if found.is_empty() { Ok(()) } else { Err(anyhow!("{what}: {}", found.join(", "))) }
}

/// Every function of the header is called by the tests of values, and by those of abuse unless it cannot be misused.
fn every_function_is_called() -> Result<()> {
    let header = tools::read(&tools::root().join(HEADER))?;
    let read = |names: &[&str]| -> Result<String> {
        names.iter().map(|name| tools::read(&tools::root().join("tests/c").join(name))).collect()
    };
    let (values, abuse) = (read(&VALUES)?, read(&ABUSE)?);
    let (values, abuse) = (functions(&values), functions(&abuse));
    let functions = functions(&header);
    if functions.len() < 50 {
        bail!("{HEADER}: found {} functions", functions.len());
    }
    let takes_nothing = |name: &str| name.ends_with("_count") || name == "anthronet_abi_version";
    let untested = functions.iter().filter(|name| !values.contains(*name));
    let unabused = functions.iter().filter(|name| !abuse.contains(*name) && !takes_nothing(name));
    none("without a test", &untested.chain(unabused).copied().collect::<Vec<_>>())
}

/// The words `anthronet_…(` of a text in C, comments left out.
pub(super) fn functions(text: &str) -> BTreeSet<&str> {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    code.flat_map(|line| {
        line.match_indices("anthronet_").filter_map(|(start, _)| {
            let word = &line[start..];
            let end = word.find(|c: char| !c.is_ascii_alphanumeric() && c != '_')?;
            let whole = !line[..start].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
            (whole && word[end..].starts_with('(')).then_some(&word[..end])
        })
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::functions;

    #[test]
    fn functions_are_words_before_a_parenthesis() {
        let text =
            "anthronet_status anthronet_a_b(int anthronet_c); // anthronet_d(\nx_anthronet_e(anthronet_f());";
        assert_eq!(functions(text).into_iter().collect::<Vec<_>>(), ["anthronet_a_b", "anthronet_f"]);
    }
}
