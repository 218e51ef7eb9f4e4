//! The program `abf`; see [`bench_harness`].

fn main() -> std::process::ExitCode {
    bench_harness::main()
}
