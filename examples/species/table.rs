//! Medians of measures over seeds beside published ranges.

use crate::common::Failure;
use crate::measure::{self, COUNT, LEAF_AREA, NAMES};
use crate::reference::{KNOWN, STANDS, quartiles};
use rayon::prelude::*;
use treesynth::species::{self, SpeciesError};

/// A Markdown table, one row per cell that has a reference, and how many medians lie within.
pub(crate) fn lines(seeds: u64) -> Result<Vec<String>, Failure> {
    let mut lines =
        vec!["| species | measure | median | reference | |".to_owned(), "|---|---|---|---|---|".to_owned()];
    let (mut cells, mut inside) = (0, 0);
    let mut add = |species: &str, name: &str, value: f64, [low, high]: [f64; 2]| {
        let digits = if high < 3.0 { 2 } else { usize::from(high < 20.0) };
        let fits = value >= low && value <= high;
        cells += 1;
        inside += i32::from(fits);
        let mark = if fits { "" } else { "outside" };
        lines.push(format!(
            "| {species} | {name} | {value:.digits$} | {low:.digits$} to {high:.digits$} | {mark} |"
        ));
    };
    for known in &KNOWN {
        let species = species::by_name(known.name)?;
        let medians = medians(known.name, seeds)?;
        let ranges = known.ranges();
        for ((name, value), range) in NAMES.iter().zip(medians).zip(ranges) {
            if let Some(range) = range {
                add(&species.name, name, value, range);
            }
        }
    }
    for (name, slenderness, form) in STANDS {
        let species = species::by_name(name)?;
        let trees: Result<Vec<_>, SpeciesError> = (0..seeds)
            .into_par_iter()
            .map(|seed| {
                let tree = species.request().with_height(10.0).in_a_stand(2.0).with_seed(seed).grow()?;
                let all = measure::all(&tree)?;
                Ok([all[0], all[8]])
            })
            .collect();
        let trees = trees?;
        let median = |index: usize| measure::median(trees.iter().map(|tree| tree[index]).collect());
        let title = format!("{name}, 10 m in a stand of 2 m");
        for (index, label, range) in [(0, NAMES[0], slenderness), (1, NAMES[8], form)] {
            if let Some(range) = quartiles(range) {
                add(&title, label, median(index), range);
            }
        }
    }
    lines.push(String::new());
    lines.push(format!(
        "{inside} of {cells} medians of {seeds} trees lie within their reference ({:.0}%).",
        100.0 * f64::from(inside) / f64::from(cells.max(1))
    ));
    Ok(lines)
}

fn medians(name: &str, seeds: u64) -> Result<[f64; COUNT], Failure> {
    let species = species::by_name(name)?;
    let trees: Result<Vec<[f64; COUNT]>, SpeciesError> = (0..seeds)
        .into_par_iter()
        .map(|seed| {
            let mut all = measure::all(&species.request().with_seed(seed).grow()?)?;
            for (index, dbh) in LEAF_AREA.into_iter().zip([0.2, 0.4]) {
                if (species.size.diameter[0]..=species.size.diameter[1]).contains(&dbh) {
                    let tree = species.request().with_dbh(dbh).with_seed(seed).grow()?;
                    all[index] = f64::from(tree.numbers.leaf_area);
                }
            }
            Ok(all)
        })
        .collect();
    let trees = trees?;
    Ok(std::array::from_fn(|index| measure::median(trees.iter().map(|tree| tree[index]).collect())))
}
