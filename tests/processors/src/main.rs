//! A line for each thing that is made: its hash and its name. `processors [PART OF A NAME]`

use std::process::ExitCode;

fn main() -> ExitCode {
    let part = std::env::args().nth(1).unwrap_or_default();
    let mut failed = false;
    for made in treesynth_processors::all().iter().filter(|made| made.name.contains(&part)) {
        match (made.hash)() {
            Ok(hash) => println!("{hash:016x} {}", made.name),
            Err(error) => {
                println!("---------------- {}: {error}", made.name);
                failed = true;
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
