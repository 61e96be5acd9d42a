//! The command line.

use crate::number::number;
use crate::{convert, forest, grow, list, measure, shape, years};
use clap::{Args, Parser, Subcommand};

/// Grows botanical trees by name and writes them as models, pictures and data.
#[derive(Parser)]
#[command(name = "treesynth", version, about, max_term_width = 110, after_help = AFTER, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

const AFTER: &str = "\
Examples:
  treesynth list species
  treesynth grow \"silver birch\" --height 12 --day 280 --out trees
  treesynth grow oak --budget 10000 --format glb,usdz --seed 7
  treesynth forest beech \"scots pine\" --trees 40 --spacing 5
  treesynth measure scan.csv --json

Exit status: 0 done; 1 a file could not be read or written, or the work failed; 2 the command line asks for
something impossible, and nothing was done; 130 interrupted. Files get their names when all of a run are whole.";

/// Options of all commands.
#[derive(Args)]
pub(crate) struct Common {
    /// Print one JSON value for programs instead of text for people
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// No progress on the terminal; there is none on a pipe anyway
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Threads, 1 to 1024; the result is the same with any number of them [default: one a core]
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=1024_usize, "threads"))]
    pub(crate) threads: Option<usize>,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    List(list::Options),
    Grow(Box<grow::Options>),
    Shape(shape::Options),
    Forest(Box<forest::Options>),
    Years(years::Options),
    Measure(measure::Options),
    Convert(convert::Options),
    /// Print the completion script of a shell
    #[command(after_help = "\
Examples:
  treesynth completions bash > ~/.local/share/bash-completion/completions/treesynth
  treesynth completions zsh > ~/.zfunc/_treesynth
  treesynth completions fish > ~/.config/fish/completions/treesynth.fish")]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::CommandFactory;

    #[test]
    fn commands_are_sound_and_have_examples() {
        let mut cli = Cli::command();
        cli.clone().debug_assert();
        for command in cli.get_subcommands_mut() {
            let help = command.render_help().to_string();
            assert!(help.contains("Examples:\n  treesynth "), "{help}");
        }
    }
}
