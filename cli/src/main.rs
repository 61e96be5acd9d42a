//! The program `treesynth`: trees by name, as models, pictures and data.

mod arguments;
mod clothe;
mod convert;
mod failure;
mod files;
mod forest;
mod grow;
mod list;
mod measure;
mod number;
mod progress;
mod read;
mod report;
mod shape;
mod wish;
mod write;
mod years;

use arguments::{Cli, Command};
use clap::{CommandFactory, Parser};
pub(crate) use failure::Failure;
use failure::Refused;
use std::process::ExitCode;

fn main() -> ExitCode {
    // A wrong command line ends here: status 2, and what is wrong on standard error.
    let cli = Cli::parse();
    // Ctrl-C and termination leave the old files as they were, and no new ones.
    let handled = ctrlc::set_handler(|| {
        files::abandon();
        std::process::exit(130);
    });
    match handled.map_err(Into::into).and_then(|()| run(cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(if error.is::<Refused>() { 2 } else { 1 })
        }
    }
}

fn run(cli: Cli) -> Result<(), Failure> {
    if let Some(threads) = cli.common.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    match cli.command {
        Command::List(options) => list::run(&options, &cli.common),
        Command::Grow(options) => grow::run(&options, &cli.common),
        Command::Shape(options) => shape::run(&options, &cli.common),
        Command::Forest(options) => forest::run(&options, &cli.common),
        Command::Years(options) => years::run(&options, &cli.common),
        Command::Measure(options) => measure::run(&options, &cli.common),
        Command::Convert(options) => convert::run(&options, &cli.common),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "treesynth", &mut script);
            report::print(&String::from_utf8_lossy(&script));
            Ok(())
        }
    }
}
