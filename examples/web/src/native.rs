//! The same answer as the page's, natively: `native '{"tree":"oak"}' FILE`. A test compares the bytes.

use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(ask), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err("usage: native JSON FILE".into());
    };
    let start = Instant::now();
    let answer = treesynth_web::answer(&ask, &|_, _| {})?;
    eprintln!("{} {:.0} ms", answer.report, start.elapsed().as_secs_f64() * 1e3);
    Ok(std::fs::write(path, answer.file)?)
}
