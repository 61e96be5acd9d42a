//! Exports of the WebAssembly module; `scripts/check_processors` calls it with Node.js.

/// Number of results.
#[unsafe(no_mangle)]
pub extern "C" fn count() -> usize {
    crate::all().len()
}

/// The hash of one of them; traps if it cannot be made.
#[unsafe(no_mangle)]
pub extern "C" fn hash(index: usize) -> u64 {
    (crate::all()[index].hash)().expect("it can be made")
}
