//! What must hold of every strategy and every tree, and what the figures show.

mod figures;
mod invariants;
