//! Exports of the WebAssembly module. The page writes JSON to where [`input`] says, calls [`run`],
//! and reads the result from where [`output`] says. A page has one module per worker, so one call
//! at a time.

use std::sync::{Mutex, MutexGuard, PoisonError};

static INPUT: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static REPORT: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static FILE: Mutex<Vec<u8>> = Mutex::new(Vec::new());

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Progress of the work, 0 to 1, and its name.
    safe fn progress(fraction: f32, name: *const u8, length: usize);
}

fn open(place: &Mutex<Vec<u8>>) -> MutexGuard<'_, Vec<u8>> {
    place.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Room for so many bytes of JSON.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    let mut input = open(&INPUT);
    input.clear();
    input.resize(length, 0);
    input.as_mut_ptr()
}

/// Lists what can be asked for; the report has it.
#[unsafe(no_mangle)]
pub extern "C" fn list() {
    *open(&REPORT) = crate::list().to_string().into_bytes();
}

/// Grows what the input asks for: 1 if there is a file, 0 if the report has what is wrong.
#[unsafe(no_mangle)]
pub extern "C" fn run() -> u32 {
    let input = std::mem::take(&mut *open(&INPUT));
    let told = |fraction: f32, name: &str| progress(fraction, name.as_ptr(), name.len());
    match crate::answer(&String::from_utf8_lossy(&input), &told) {
        Ok(answer) => {
            *open(&REPORT) = answer.report.to_string().into_bytes();
            *open(&FILE) = answer.file;
            1
        }
        Err(error) => {
            *open(&REPORT) = error.to_string().into_bytes();
            *open(&FILE) = Vec::new();
            0
        }
    }
}

/// Address of a result: 0 the report, 1 the file.
#[unsafe(no_mangle)]
pub extern "C" fn output(which: u32) -> *const u8 {
    open(if which == 0 { &REPORT } else { &FILE }).as_ptr()
}

/// Length of a result.
#[unsafe(no_mangle)]
pub extern "C" fn output_length(which: u32) -> usize {
    open(if which == 0 { &REPORT } else { &FILE }).len()
}
