//! A test of how well species can be told apart: each tree is named by the nearest mean of the
//! other trees' measures.

use crate::common::Failure;
use crate::measure::{self, COUNT};
use rayon::prelude::*;
use treesynth::species::{self, SpeciesError};

/// The measures of a tree that names are told by: leaf areas at given trunks are left out.
fn features(tree: &species::Specimen) -> Result<Vec<f64>, SpeciesError> {
    let all = measure::all(tree)?;
    // Stems that end below a height have no diameter there.
    let kept = (0..COUNT).filter(|index| ![2, 3, 9, 10, 11].contains(index)).map(|index| all[index]);
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    Ok(kept.chain(measure::more(tree)).map(finite).collect())
}

pub(crate) fn lines(seeds: u64) -> Result<Vec<String>, Failure> {
    let all = species::all();
    let count = all.len() * seeds as usize;
    let trees: Result<Vec<Vec<f64>>, SpeciesError> = (0..count)
        .into_par_iter()
        .map(|index| {
            let species = &all[index / seeds as usize];
            features(&species.request().with_seed(index as u64 % seeds).grow()?)
        })
        .collect();
    let trees = trees?;
    let width = trees[0].len();
    // Every measure counts by its spread within species.
    let group = |species: usize| &trees[species * seeds as usize..(species + 1) * seeds as usize];
    let mean = |rows: &[Vec<f64>], at: usize| rows.iter().map(|row| row[at]).sum::<f64>() / rows.len() as f64;
    let spread: Vec<f64> = (0..width)
        .map(|at| {
            let squares = (0..all.len()).map(|species| {
                let rows = group(species);
                let middle = mean(rows, at);
                rows.iter().map(|row| (row[at] - middle).powi(2)).sum::<f64>()
            });
            (squares.sum::<f64>() / count as f64).sqrt().max(1e-9)
        })
        .collect();
    let mut lines = Vec::new();
    let mut right = 0;
    for (index, tree) in trees.iter().enumerate() {
        let own = index / seeds as usize;
        let distance = |species: usize| -> f64 {
            let rows = group(species);
            (0..width)
                .map(|at| {
                    let mut middle = mean(rows, at);
                    if species == own {
                        // Without the tree itself.
                        middle += (middle - tree[at]) / (seeds as f64 - 1.0);
                    }
                    ((tree[at] - middle) / spread[at]).powi(2)
                })
                .sum()
        };
        let named = (0..all.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(own);
        right += usize::from(named == own);
        if named != own {
            let seed = index as u64 % seeds;
            lines.push(format!("{}, seed {seed}, is taken for {}", all[own].name, all[named].name));
        }
    }
    lines.push(format!(
        "{right} of {count} trees are named right ({:.1}%)",
        100.0 * right as f64 / count as f64
    ));
    Ok(lines)
}
