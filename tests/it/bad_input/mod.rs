//! Whatever goes in, what is wrong comes back as an error that names it: no panic, no endless loop.

mod graphs;
mod json;
mod options;
mod strategies;
