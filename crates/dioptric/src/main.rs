// SPDX-License-Identifier: MIT OR Apache-2.0
//! The program `dioptric`: everything is in [`cli`], a file a command.

#![forbid(unsafe_code)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
