//! What must hold of every strategy and every tree.

mod invariants;
