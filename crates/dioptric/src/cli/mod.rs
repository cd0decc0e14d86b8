// SPDX-License-Identifier: MIT OR Apache-2.0
//! The commands, and what their ends mean: exit status 0 done, 1 a scene or file is at fault, 2 wrong
//! usage, 130 interrupted.

mod compare;
mod convert;
mod denoise;
mod encode;
mod failure;
mod frames;
mod info;
mod list;
mod long;
mod manual;
mod merge;
mod output;
mod page;
mod picture_options;
mod progress;
mod render;
mod scene_options;
mod stage;
mod stats;
mod terminal;
mod trace;
mod until;
mod why;
mod why_text;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use failure::Failure;
use terminal::{ColorChoice, Terminal};

/// A ray tracer for exact shapes that explains every pixel.
#[derive(Debug, Parser)]
#[command(name = "dioptric", version, max_term_width = 100, after_help = EXIT_STATUS)]
pub struct Cli {
    /// Whether to colour messages and swatches.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    color: ColorChoice,
    #[command(subcommand)]
    command: Command,
}

const EXIT_STATUS: &str = "Exit status: 0 done; 1 a scene or file is at fault (compare: beyond the tolerance); \
                           2 wrong usage; 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    Render(Box<render::RenderArgs>),
    Why(Box<why::WhyArgs>),
    Trace(Box<trace::TraceArgs>),
    Info(info::InfoArgs),
    Convert(convert::ConvertArgs),
    Compare(compare::CompareArgs),
    Merge(merge::MergeArgs),
    List(list::ListArgs),
    Manual(manual::ManualArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// Prints the completions of a shell.
#[derive(Debug, clap::Args)]
#[command(hide = true)]
struct CompletionsArgs {
    /// The shell.
    shell: clap_complete::Shell,
}

/// Prints the man page.
#[derive(Debug, clap::Args)]
#[command(hide = true)]
struct ManArgs {
    /// The command whose page is wanted; the program's own without one.
    command: Option<String>,
}

/// Runs the command that the arguments ask for.
pub fn main() -> ExitCode {
    // Usage errors, `--help` and `--version` end here: clap prints and exits with 2 or 0.
    let cli = Cli::parse();
    let terminal = Terminal::new(cli.color);
    let done = match &cli.command {
        Command::Render(args) => render::run(args, &terminal),
        Command::Why(args) => why::run(args, &terminal),
        Command::Trace(args) => trace::run(args, &terminal),
        Command::Info(args) => info::run(args, &terminal),
        Command::Convert(args) => convert::run(args, &terminal),
        Command::Compare(args) => compare::run(args),
        Command::Merge(args) => merge::run(args),
        Command::List(args) => list::run(args),
        Command::Manual(args) => manual::run(args),
        Command::Completions(args) => completions(args),
        Command::Man(args) => man(args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(&terminal),
    }
}

fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "dioptric", &mut text);
    terminal::print(&text)
}

fn man(args: &ManArgs) -> Result<(), Failure> {
    let mut command = Cli::command();
    command.build();
    if let Some(name) = &args.command {
        let Some(found) = command.find_subcommand(name) else {
            let names = command.get_subcommands().map(clap::Command::get_name);
            return Err(Failure::unknown("command", name, names));
        };
        // The page of `dioptric render` is called dioptric-render, as git's are.
        command = found.clone().display_name(format!("dioptric-{name}"));
    }
    let mut text = Vec::new();
    clap_mangen::Man::new(command).render(&mut text).map_err(|e| Failure::output("-", &e))?;
    terminal::print(&text)
}
