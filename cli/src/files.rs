//! Files that replace older ones when all of them are whole.

use super::Failure;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};
use treesynth::export::ImageFile;

/// The files that this process is writing under names of their own.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Takes away what is not whole. Waits while files get their names.
pub(crate) fn abandon() {
    for path in unfinished().drain(..) {
        drop(fs::remove_file(path));
    }
}

/// The files of a run. Each is written beside its place under another name; all get their names at the end, by
/// [`finish`](Self::finish), so that a run that fails or is stopped changes nothing, and of two runs one has all names.
pub(crate) struct Outputs {
    folder: PathBuf,
    /// Paths of files in the making, and their final paths.
    files: Vec<(PathBuf, PathBuf)>,
}

impl Outputs {
    /// Files for a folder, which is made if it is not there; an error names the option that has it.
    pub(crate) fn new(option: &str, folder: &Path) -> Result<Self, Failure> {
        if folder.as_os_str().is_empty() {
            return Err(format!("{option} is empty, but must be a folder").into());
        }
        let named = |error: std::io::Error| format!("{option} {}: {error}", folder.display());
        if folder.exists() && !folder.is_dir() {
            return Err(format!("{option} {}: it is a file, but must be a folder", folder.display()).into());
        }
        fs::create_dir_all(folder).map_err(named)?;
        let outputs = Self { folder: folder.into(), files: Vec::new() };
        Self::check(option, &folder.join("any"))?;
        Ok(outputs)
    }

    /// Checks that a file can be made there; called before the work begins.
    pub(crate) fn check(option: &str, path: &Path) -> Result<(), Failure> {
        if path.as_os_str().is_empty() || path.is_dir() {
            return Err(format!("{option} is \"{}\", but must be a file", path.display()).into());
        }
        let other = beside(path);
        File::create(&other).map_err(|error| format!("{option} {}: {error}", path.display()))?;
        Ok(fs::remove_file(other)?)
    }

    /// A file in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Fills a file; a failure names it.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        content: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let other = beside(path);
        unfinished().push(other.clone());
        self.files.push((other.clone(), path.into()));
        let fill = || -> Result<(), Failure> {
            if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
                fs::create_dir_all(folder)?;
            }
            let mut writer = BufWriter::new(File::create(&other)?);
            content(&mut writer)?;
            writer.flush()?;
            Ok(writer.get_ref().sync_all()?)
        };
        fill().map_err(|error| format!("{}: {error}", path.display()).into())
    }

    /// Writes the images that a file in the folder names, beside it; one that is there already is the same.
    pub(crate) fn write_images(&mut self, images: &[ImageFile<'_>]) -> Result<(), Failure> {
        for image in images {
            let path = self.path(image.name());
            if !self.files.iter().any(|(_, other)| *other == path) {
                self.write(&path, |writer| Ok(writer.write_all(&image.png())?))?;
            }
        }
        Ok(())
    }

    /// Gives all files their names.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        let mut unfinished = unfinished();
        let _turn = Turn::wait(&self.folder);
        for (from, to) in &self.files {
            fs::rename(from, to).map_err(|error| format!("{}: {error}", to.display()))?;
            unfinished.retain(|path| path != from);
        }
        self.files.clear();
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        let mut unfinished = unfinished();
        for (path, _) in self.files.drain(..) {
            drop(fs::remove_file(&path));
            unfinished.retain(|other| *other != path);
        }
    }
}

/// A name beside a file that no other process uses.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.tmp", std::process::id()))
}

/// The right to rename files in a folder, which takes no longer than a moment.
struct Turn(PathBuf);

impl Turn {
    fn wait(folder: &Path) -> Self {
        let path = folder.join(".treesynth.lock");
        let start = Instant::now();
        // A process that was killed amid its turn leaves it taken.
        while OpenOptions::new().write(true).create_new(true).open(&path).is_err() {
            if start.elapsed() > Duration::from_secs(5) {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        Self(path)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        drop(fs::remove_file(&self.0));
    }
}
