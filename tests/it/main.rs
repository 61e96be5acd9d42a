//! What must hold of every strategy and every tree.

mod invariants;
mod layers;
mod mint_vectors;
