//! Trees that grow over the years by positional information.

mod curves;
mod figures;
mod habit;
mod invariants;
mod seasons;
mod timelines;
mod wood;
