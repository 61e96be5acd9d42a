//! Guarantees of `BlobTree`: the paper's equations, precise contact, errors, depth, and the skin of
//! trees.
//! trees.

mod bad_input;
mod equations;
mod skin;
mod smooth;
mod strangers;
