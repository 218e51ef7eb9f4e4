//! The program `abf` under its other name; see [`bench_harness`].

fn main() -> std::process::ExitCode {
    bench_harness::main()
}
