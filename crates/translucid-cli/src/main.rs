//! The program `translucid`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(translucid_cli::run(std::env::args_os()))
}
