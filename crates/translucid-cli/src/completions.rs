//! `translucid completions`: what shells complete, and manual pages for packagers.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Command, ValueEnum};
use clap_complete::Shell;
use translucid_files::write_atomically;

use crate::failure::Failure;
use crate::table::print;

const HELP: &str = "\
Examples:
  translucid completions bash > ~/.local/share/bash-completion/completions/translucid
  translucid completions zsh > ~/.zfunc/_translucid
  translucid completions fish > ~/.config/fish/completions/translucid.fish
  translucid completions -o package";

/// Prints shell completions; for packagers also writes manual pages
#[derive(Args, Debug)]
#[command(after_help = HELP)]
#[group(required = true, multiple = false)]
pub(crate) struct CompletionsArguments {
    /// Shell whose script to print
    shell: Option<Shell>,
    /// Directory for the scripts of all shells and the manual pages (translucid.1, translucid-render.1, …)
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs the verb.
pub(crate) fn run(arguments: &CompletionsArguments, command: Command) -> Result<(), Failure> {
    match (arguments.shell, &arguments.output) {
        (Some(shell), _) => print(&String::from_utf8_lossy(&script(shell, command))),
        (None, Some(directory)) => write_all(directory, &command),
        (None, None) => Ok(()),
    }
}

fn script(shell: Shell, mut command: Command) -> Vec<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, "translucid", &mut script);
    script
}

fn write_all(directory: &Path, command: &Command) -> Result<(), Failure> {
    let failed = |error: io::Error| Failure::work(format!("{}: {error}", directory.display()));
    std::fs::create_dir_all(directory).map_err(failed)?;
    for &shell in Shell::value_variants() {
        let name = clap_complete::Generator::file_name(&shell, "translucid");
        write_atomically(&directory.join(name), |file| file.write_all(&script(shell, command.clone())))?;
    }
    clap_mangen::generate_to(command.clone().disable_help_subcommand(true), directory).map_err(failed)
}
